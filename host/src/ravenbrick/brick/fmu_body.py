# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A body from outside: a co-simulation unit (FMU) of FMI 2 or 3 in place of the built-in one.

The unit takes the voltage at a motor's terminals (input `voltage_A`, `_B` or `_C`, in V) and gives
the angle of its shaft (output `angle_A`, `_B` or `_C`, in rad). It steps with the plant, every
4,800 cycles; an angle acts on the encoder one step later, as in any explicit co-simulation. What
the unit gives are inputs of the run with their cycles, so a run is the same each time.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from ravenbrick.brick.slices import run_until_picture
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import UsageError
from ravenbrick.fmu import FmuFile, FmuUnit

__all__ = ["CoSimulation", "FmuBody"]

STEP_CYCLES = 4_800
# No NXT motor turns faster; the hand that the unit is follows it at once (rad/s).
_HAND_RATE = 100.0


class FmuBody:
    """An FMU, unpacked and initialised."""

    def __init__(self, path: Path) -> None:
        file = FmuFile(path)
        known = file.variables
        self.ports = tuple(p for p in "ABC" if f"angle_{p}" in known and f"voltage_{p}" in known)
        if not self.ports:
            raise UsageError(
                f"{path}: has no motor; name its inputs voltage_A, _B, _C and its outputs "
                "angle_A, _B, _C"
            )
        self.path = path
        inputs, outputs = ([f"{n}_{p}" for p in self.ports] for n in ("voltage", "angle"))
        self._unit = FmuUnit(file, inputs, outputs)

    def configuration(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """A brick's configuration with this body: its motors follow the unit."""
        motors = {port: dict(motor) for port, motor in fields.get("motors", {}).items()}
        for port in self.ports:
            if port not in motors:
                raise UsageError(
                    f"{self.path}: has a motor in port {port}, where the robot has none; add "
                    f"[ports.{port}]"
                )
            motors[port] |= {"held_by_hand": True, "hand_rate": _HAND_RATE}
        return {**fields, "motors": motors, "body": {"kind": "bench"}}

    def step(self, number: int, voltages: list[float]) -> list[float]:
        """Angles in rad of `ports` after a step with these voltages. Raises RunFaultError."""
        length = Fraction(STEP_CYCLES) / MASTER_CLOCK.hertz
        return self._unit.step(float(number * length), float(length), voltages)

    def close(self) -> None:
        """End the unit."""
        self._unit.close()


class CoSimulation:
    """A brick whose motors turn as an FMU says; otherwise the brick itself."""

    def __init__(self, brick: Any, body: FmuBody) -> None:
        self._brick, self._body = brick, body
        self._first = self._step = brick.cycles // STEP_CYCLES

    def __getattr__(self, name: str) -> Any:
        return getattr(self._brick, name)

    def run_until(self, cycles: int) -> Any:
        """As the brick's, with a step of the unit after each step of the plant."""
        while True:
            boundary = (self._step + 1) * STEP_CYCLES
            stop = self._brick.run_until(min(boundary, cycles))
            if stop.reason != "reached":
                return stop
            if self._brick.cycles >= boundary:
                self._exchange()
            if self._brick.cycles >= cycles:
                return stop

    def run_until_picture(self, instants: list[int], first: int, end: int) -> tuple[Any, int]:
        """As the brick's, in the same steps."""
        return run_until_picture(self, instants, first, end)

    def _exchange(self) -> None:
        quantities = dict(self._brick.quantities())
        voltages = [quantities[f"motor.{port}.voltage"] for port in self._body.ports]
        angles = self._body.step(self._step - self._first, voltages)
        self._step = self._brick.cycles // STEP_CYCLES
        for port, angle in zip(self._body.ports, angles, strict=True):
            self._brick.schedule_input(self._brick.cycles, f"motor.{port}.hand_angle", angle)
