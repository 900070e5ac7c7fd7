# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""VCD (value change dump, IEEE 1364) for GTKWave and Surfer; time unit 1 ns.

Scopes: `tasks.<task>` with the wires `running` and `job` (high from release to completion, so its
width is the response time), `interrupts`, `processor`, and reals for `inputs`, `commands` and
`signals`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.installation import optional_module
from ravenbrick.trace.export.timeline import Lane, Series, Timeline, nanoseconds

__all__ = ["write_vcd"]

Column = tuple[NDArray[np.int64], NDArray[np.float64], Any]
SCOPES = {"interrupt": "interrupts", "processor": "processor"}
SERIES_SCOPES = {"input": "inputs", "command": "commands", "signal": "signals"}


def vcd_name(name: str) -> str:
    """A name without blanks and signs that the format gives a meaning."""
    return re.sub(r"\W+", "_", name) or "_"


def _pulses(begin: NDArray[np.int64], end: NDArray[np.int64]) -> tuple[Any, Any]:
    """Edges of a wire that is high in intervals, which may overlap."""
    instants = np.concatenate((begin, end))
    steps = np.concatenate((np.ones(begin.size), -np.ones(end.size)))
    order = np.argsort(instants, kind="stable")
    level = np.cumsum(steps[order])
    instants = instants[order]
    # The last of several edges at one instant is the level from then on.
    last = np.append(instants[1:] != instants[:-1], True) if instants.size else np.empty(0, bool)
    return instants[last], (level[last] > 0).astype(np.float64)


def _lane_columns(timeline: Timeline, lane: Lane, writer: Any) -> list[Column]:
    name = vcd_name(lane.name)
    scope = f"tasks.{name}" if lane.kind == "task" else SCOPES[lane.kind]
    own = "running" if lane.kind == "task" else name
    wires = [(own, lane.begin_cycles, lane.end_cycles)]
    if lane.kind == "task":
        releases = np.array([job.release_cycles for job in lane.jobs], np.int64)
        ends = [
            timeline.end_cycles if job.completion_cycles is None else job.completion_cycles
            for job in lane.jobs
        ]
        wires.append(("job", releases, np.array(ends, np.int64)))
    columns: list[Column] = []
    for wire, begin, end in wires:
        variable = writer.register_var(scope, wire, "wire", size=1, init=0)
        columns.append((*_pulses(begin, end), variable))
    return columns


def _series_column(series: Series, writer: Any) -> Column:
    parts = [vcd_name(part) for part in series.name.split(".")]
    scope = ".".join([SERIES_SCOPES[series.kind], *parts[:-1]])
    variable = writer.register_var(scope, parts[-1], "real", init=0.0)
    return series.cycles, series.values, variable


def write_vcd(timeline: Timeline, path: Path) -> tuple[Path, ...]:
    """Write `path` and return it; raises `ToolMissingError`."""
    vcd = optional_module("vcd", "pyvcd")
    about = f"scenario {timeline.scenario}, trace digest {timeline.digest}"
    with path.open("w", encoding="ascii", newline="\n") as file:
        writer = vcd.VCDWriter(file, timescale="1 ns", date="", comment=about, version="Ravenbrick")
        columns: list[Column] = []
        for lane in timeline.lanes:
            columns += _lane_columns(timeline, lane, writer)
        columns += [_series_column(series, writer) for series in timeline.series]
        _write_changes(timeline, columns, writer)
        writer.close(int(nanoseconds(timeline.clock, [timeline.end_cycles])[0]))
    return (path,)


def _write_changes(timeline: Timeline, columns: list[Column], writer: Any) -> None:
    """All changes in the order of time, and of the declarations at one instant."""
    instants = np.concatenate([nanoseconds(timeline.clock, cycles) for cycles, _, _ in columns])
    values = np.concatenate([values for _, values, _ in columns])
    numbers = np.repeat(np.arange(len(columns)), [cycles.size for cycles, _, _ in columns])
    order = np.argsort(instants, kind="stable")
    variables = [variable for _, _, variable in columns]
    wires = [variable.type.value == "wire" for variable in variables]
    last = [0.0] * len(columns)
    for at, number, value in zip(
        instants[order].tolist(), numbers[order].tolist(), values[order].tolist(), strict=True
    ):
        if value != last[number]:
            last[number] = value
            writer.change(variables[number], at, int(value) if wires[number] else value)
