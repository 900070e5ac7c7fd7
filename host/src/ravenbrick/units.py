# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Units of the recorded signals, and the units that people may write instead."""

from __future__ import annotations

import math

from ravenbrick.catalogue import sensor_input

__all__ = ["UNITS", "signal_unit"]

_QUANTITIES = {
    "angle": "rad",
    "load_angle": "rad",
    "hand_angle": "rad",
    "angular_velocity": "rad/s",
    "voltage": "V",
    "current": "A",
    "encoder": "counts",
    "duty": "",
    "load_torque": "N m",
    "x": "m",
    "y": "m",
    "heading": "rad",
    "pitch": "rad",
    "pitch_rate": "rad/s",
    "rate": "rad/s",
    "push": "N",
}

# Written unit -> unit of the signals, and its size in it.
UNITS: dict[str, tuple[str, float]] = {
    "rad/s": ("rad/s", 1.0),
    "deg/s": ("rad/s", math.pi / 180),
    "°/s": ("rad/s", math.pi / 180),
    "rpm": ("rad/s", math.pi / 30),
    "rad": ("rad", 1.0),
    "deg": ("rad", math.pi / 180),
    "°": ("rad", math.pi / 180),
    "V": ("V", 1.0),
    "mV": ("V", 1e-3),
    "A": ("A", 1.0),
    "mA": ("A", 1e-3),
    "m": ("m", 1.0),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "N m": ("N m", 1.0),
    "N": ("N", 1.0),
    "dB": ("dB", 1.0),
    "Hz": ("Hz", 1.0),
    "s": ("s", 1.0),
    "ms": ("s", 1e-3),
    "us": ("s", 1e-6),
    "µs": ("s", 1e-6),
    "counts": ("counts", 1.0),
    "%": ("", 1e-2),
}


def signal_unit(name: str) -> str:
    """Unit of a signal or input; empty for a ratio, a switch or a variable of the program."""
    if name.startswith("probe."):
        return ""
    found = sensor_input(name)
    if found is not None:
        return found[1].unit
    return _QUANTITIES.get(name.rpartition(".")[2], "")
