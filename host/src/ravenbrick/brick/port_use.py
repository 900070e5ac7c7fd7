# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Devices that a program used beside those that robot.toml plugs in, as warnings.

A program tells by its calls of the drivers; what answers direct commands asks for every port and
says nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.catalogue import sensor_kinds
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Robot
from ravenbrick.trace.recording import EventKind

__all__ = ["WATCHED", "DriverCall", "port_warnings"]

_READ = "nxt__avr__reading"
_RAW = "nxt__avr__raw_input"
_BUS = "nxt__i2c_ports__start_transaction"
# Readings of no single port.
_OTHERS = ("nxt__avr__inputs", "nxt__avr__button", "nxt__avr__raw_battery")
WATCHED = (_READ, _RAW, _BUS, *_OTHERS)

_COMMANDS = "nxt__direct_commands__"
_DUTY = 0xFF
_PORTS = "1234"


def _driver(kind: str) -> str:
    """What the symbols of a kind of sensor's package begin with."""
    return f"nxt__{kind}_sensors__"


@dataclass(frozen=True)
class DriverCall:
    """Calls of one function with one argument from one place; symbols of the callers."""

    function: str
    argument: int
    callers: Sequence[str]
    place: Callable[[], str | None]
    cycles: tuple[int, int]

    @property
    def port(self) -> str | None:
        """The sensor port that is read."""
        of_port = self.function not in _OTHERS and self.argument < len(_PORTS)
        return _PORTS[self.argument] if of_port else None

    @property
    def device(self) -> str | None:
        """The kind of sensor that the driver is for; None when no driver reads the port."""
        found = (k for c in self.callers for k in sensor_kinds() if c.startswith(_driver(k)))
        return next(found, None)

    @property
    def at(self) -> str:
        """The place, to be appended."""
        place = self.place()
        return f" ({place})" if place else ""


def _sensors(robot: Robot, calls: Iterable[DriverCall]) -> Iterator[str]:
    for call in calls:
        if call.port is None:
            continue
        plugged = robot.sensor_ports.get(call.port)
        if plugged is None:
            has = f"nothing plugged into port {call.port}; add [ports.{call.port}]"
        elif call.device not in (None, plugged.device) and plugged.device != "analogue":
            has = f'device = "{plugged.device}" in [ports.{call.port}]; correct one of both'
        else:
            continue
        as_device = f" as {_article(call.device)} sensor" if call.device else ""
        yield f"the program reads port {call.port}{as_device}{call.at}, but robot.toml has {has}"


def _article(device: str | None) -> str:
    return f"an {device}" if device == "ultrasonic" else f"a {device}"


def _motors(robot: Robot, events: NDArray[np.void]) -> Iterator[str]:
    commands = events[events["kind"] == int(EventKind.MOTOR_COMMAND)]
    driven = commands[commands["value"] & _DUTY != 0]
    for index in sorted(set(driven["subject"].tolist())):
        port = "ABC"[index]
        if port not in robot.motor_ports:
            yield (
                f"the program drives motor {port}, but robot.toml has nothing plugged into port "
                f"{port}; add [ports.{port}]"
            )


def _too_early(calls: Iterable[DriverCall], link_up_cycles: int | None) -> Iterator[str]:
    """What was read before the link was up, and never again."""
    for call in calls:
        first, last = call.cycles
        if link_up_cycles is not None and last >= link_up_cycles:
            continue
        known = call.port and f"port {call.port} is read"
        what = known or "buttons or battery are read"
        answered = (
            "which did not answer in this run"
            if link_up_cycles is None
            else f"which first answered at {1000 * MASTER_CLOCK.seconds(link_up_cycles):.1f} ms"
        )
        yield (
            f"{what} at {1000 * MASTER_CLOCK.seconds(first):.1f} ms{call.at}, before the link to "
            f"the co-processor was up, {answered}: the value is that of an idle brick; call "
            "NXT.AVR.Await_Data_Available before"
        )


def port_warnings(
    robot: Robot,
    calls: Sequence[DriverCall],
    events: NDArray[np.void],
    link_up_cycles: int | None,
) -> tuple[str, ...]:
    """A sentence for each port that is used but not plugged in, or read too early."""
    own = [c for c in calls if not any(name.startswith(_COMMANDS) for name in c.callers)]
    found = [*_sensors(robot, own), *_motors(robot, events), *_too_early(own, link_up_cycles)]
    return tuple(dict.fromkeys(found))
