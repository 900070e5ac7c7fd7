# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From a recorded run to the voltages and counts of one motor."""

from __future__ import annotations

import numpy as np

from ravenbrick.control.estimation.identification import MotorData
from ravenbrick.errors import UsageError
from ravenbrick.trace.recording import EventKind, Recording

__all__ = ["motor_data", "signal_data"]

_BRAKE = 0x100
_BATTERY_STEP = 1e-3


def motor_data(recording: Recording, motor: str) -> MotorData:
    """Commands and encoder of motor A, B or C from its first voltage to the next stop.

    Voltage is duty times battery, as a robot can know it; the duty is the one that the
    co-processor's pulses really have, at the exact instants of the commands.
    Raises `UsageError` if the motor was not driven, or with open windings between the pulses,
    which has no constant gain.
    """
    if motor not in ("A", "B", "C"):
        raise UsageError(f"there are the motors A, B and C, not '{motor}'")
    events = recording.of_kind(EventKind.MOTOR_COMMAND)
    mine = events[events["subject"] == "ABC".index(motor)]
    duty = (mine["value"] & 0xFF).astype(np.uint8).view(np.int8).astype(np.float64)
    driven = np.flatnonzero(duty)
    if not driven.size:
        raise UsageError(f"motor {motor} was not driven in the run; choose another scenario")
    first = int(driven[0])
    stops = np.flatnonzero(duty[first:] == 0)
    last = first + int(stops[0]) if stops.size else len(duty)
    if not (mine["value"][first:last] & _BRAKE).all():
        raise UsageError(
            f"motor {motor} was driven with open windings between the pulses; identify it in the "
            "braking mode, in which the mean voltage counts"
        )
    clock = recording.clock
    change = clock.instants(mine["at_cycles"])
    end = float(change[last]) if last < len(change) else np.inf
    times, counts = recording.signal(f"motor.{motor}.encoder")
    instants, volts = recording.signal("battery.voltage")
    begin = float(change[first])
    kept = times < end
    moved = np.flatnonzero(np.abs(np.diff(volts)) > _BATTERY_STEP) + 1
    moved = moved[(instants[moved] > begin) & (instants[moved] < end)]
    at = np.unique(np.concatenate([change[first:last], instants[moved]]))
    steps, applied = recording.signal(f"motor.{motor}.duty")
    share = applied[np.minimum(np.searchsorted(steps, at, side="right"), len(steps) - 1)]
    battery = volts[np.maximum(np.searchsorted(instants, at, side="right") - 1, 0)]
    return MotorData(times[kept], counts[kept], at, share * battery)


def signal_data(recording: Recording, voltage: str, angle: str) -> MotorData:
    """Voltage (V) and counts that a program published, from the first voltage to the next 0.

    The motor must have stood when the recording began. Raises `UsageError` otherwise, or if
    the signals are not there.
    """
    times, volts = recording.signal(voltage)
    instants, counts = recording.signal(angle)
    driven = np.flatnonzero(volts)
    if not driven.size or driven[0] == 0:
        raise UsageError(
            f"'{voltage}' must be 0 at first and then not; start recording before the motor runs"
        )
    first = int(driven[0])
    stops = np.flatnonzero(volts[first:] == 0)
    last = first + int(stops[0]) if stops.size else len(volts)
    end = float(times[last]) if last < len(times) else np.inf
    kept = instants < end
    return MotorData(instants[kept], counts[kept], times[first:last], volts[first:last])
