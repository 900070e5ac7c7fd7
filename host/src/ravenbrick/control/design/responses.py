# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What design.py leaves for reports when its loop is not the speed loop of one motor."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ravenbrick.atomic_write import atomic_write
from ravenbrick.control.analysis.metrics import crossovers
from ravenbrick.control.design.design_plots import written_system
from ravenbrick.model import Diagram, diagram_svg, fidelity
from ravenbrick.model.lazy import control

__all__ = ["write_diagram_results", "write_loop_results"]

BAND = 0.02


def _response(system: control.StateSpace, duration: float) -> dict[str, object]:
    sample_time = system.dt if control.isdtime(system, strict=True) else duration / 500
    times = np.arange(round(duration / sample_time) + 1) * sample_time
    values = np.squeeze(control.step_response(system, times).outputs)
    outside = np.flatnonzero(np.abs(values - values[-1]) > BAND * abs(values[-1]))
    return {
        "time": times.tolist(),
        "value": values.tolist(),
        "settling_time": float(times[outside[-1] + 1]) if outside.size else 0.0,
        "overshoot": float(max(np.max(values / values[-1]) - 1.0, 0.0)),
    }


def write_loop_results(
    path: Path,
    name: str,
    loops: tuple[control.StateSpace, control.StateSpace],
    figures: Mapping[str, float],
    duration: float,
    open_loop: control.StateSpace | None = None,
    controller: Diagram | None = None,
) -> None:
    """Write figures and unit step responses of a continuous and a sampled closed loop as JSON.

    `open_loop`, if given, is for the frequency response and the root locus; `controller` is what
    runs: its blocks with the numbers as held are compared with the design, and drawn. Each loop has
    one input and one output and must be at rest after `duration` (s): settling time (2 %) and
    overshoot are taken from the samples against the last one.
    """
    continuous, sampled = (_response(loop, duration) for loop in loops)
    results: dict[str, object] = {
        "name": name,
        "figures": dict(figures),
        "continuous": continuous,
        "sampled": sampled,
    }
    if open_loop is not None:
        system = control.ss(open_loop)
        results["loop"] = {"open_loop": written_system(system), "crossovers": crossovers(system)}
    if controller is not None:
        results |= _compared(controller)
    atomic_write(path, json.dumps(results, indent=1) + "\n")


def write_diagram_results(path: Path, controller: Diagram) -> None:
    """Write what a controller without a plant has: its comparison with the design, its picture."""
    results = {"name": controller.name, "figures": {}, **_compared(controller)}
    atomic_write(path, json.dumps(results, indent=1) + "\n")


def _compared(controller: Diagram) -> dict[str, object]:
    return {
        "fidelity": fidelity(controller).written(),
        "diagram": diagram_svg(controller),
    }
