# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""CSV and Parquet: three tables, beside one another.

`<name>` holds the signals, a column each; `<name>.jobs` a row per job; `<name>.schedule` a row per
piece of execution. Instants are in cycles and in ns; empty (null) is what there is not.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.installation import optional_module
from ravenbrick.trace.export.timeline import Timeline, nanoseconds

__all__ = ["write_csv", "write_parquet"]

# Columns by name; integers and texts as lists, None for what there is not.
Table = dict[str, list[Any]]
INTEGERS = ("_cycles", "_ns")


def _signals(timeline: Timeline) -> Table:
    signals = [series for series in timeline.series if series.kind == "signal"]
    if not signals:
        return {"at_cycles": [], "at_ns": []}
    instants = np.unique(np.concatenate([series.cycles for series in signals]))
    table: Table = {
        "at_cycles": instants.tolist(),
        "at_ns": nanoseconds(timeline.clock, instants).tolist(),
    }
    for series in signals:
        column: list[Any] = [None] * instants.size
        places = np.searchsorted(instants, series.cycles).tolist()
        for place, value in zip(places, series.values.tolist(), strict=True):
            column[place] = value
        table[series.name] = column
    return table


def _jobs(timeline: Timeline) -> Table:
    rows = sorted(
        (
            (job.release_cycles, lane.name, job.start_cycles, job.completion_cycles)
            for lane in timeline.lanes
            for job in lane.jobs
        ),
        key=lambda row: row[:2],
    )
    names = ("release_cycles", "task", "start_cycles", "completion_cycles")
    columns: Table = {name: [row[i] for row in rows] for i, name in enumerate(names)}
    columns["response_time_cycles"] = [
        None if end is None else end - release for release, _, _, end in rows
    ]
    return {"release_ns": nanoseconds(timeline.clock, columns["release_cycles"]).tolist()} | columns


def _schedule(timeline: Timeline) -> Table:
    rows = sorted(
        (begin, end, lane.name, lane.kind)
        for lane in timeline.lanes
        for begin, end in zip(lane.begin_cycles.tolist(), lane.end_cycles.tolist(), strict=True)
    )
    names = ("begin_cycles", "end_cycles", "lane", "kind")
    columns: Table = {name: [row[i] for row in rows] for i, name in enumerate(names)}
    return {"begin_ns": nanoseconds(timeline.clock, columns["begin_cycles"]).tolist()} | columns


def tables_of(timeline: Timeline, path: Path) -> dict[Path, Table]:
    """The file of each table, and its columns."""
    stem, suffix = path.with_suffix(""), path.suffix
    return {
        path: _signals(timeline),
        stem.with_name(f"{stem.name}.jobs{suffix}"): _jobs(timeline),
        stem.with_name(f"{stem.name}.schedule{suffix}"): _schedule(timeline),
    }


def write_csv(timeline: Timeline, path: Path) -> Sequence[Path]:
    """Write the tables; returns their files."""
    tables = tables_of(timeline, path)
    for file, table in tables.items():
        with file.open("w", encoding="utf-8", newline="") as opened:
            writer = csv.writer(opened, lineterminator="\n")
            writer.writerow(table)
            writer.writerows(zip(*table.values(), strict=True))
    return tuple(tables)


def write_parquet(timeline: Timeline, path: Path) -> Sequence[Path]:
    """Write the tables; returns their files. Raises `ToolMissingError`."""
    arrow = optional_module("pyarrow", "pyarrow")
    parquet = optional_module("pyarrow.parquet", "pyarrow")
    hertz = timeline.clock.hertz
    about = {
        "scenario": timeline.scenario,
        "trace_digest": timeline.digest,
        "clock_hz": f"{hertz.numerator}/{hertz.denominator}",
    }
    tables = tables_of(timeline, path)
    for file, table in tables.items():
        fields = [arrow.field(name, _type(arrow, name)) for name in table]
        schema = arrow.schema(fields, metadata=about)
        columns = [
            arrow.array(column, field.type)
            for column, field in zip(table.values(), fields, strict=True)
        ]
        parquet.write_table(
            arrow.Table.from_arrays(columns, schema=schema), file, compression="zstd"
        )
    return tuple(tables)


def _type(arrow: Any, name: str) -> Any:
    if name.endswith(INTEGERS):
        return arrow.int64()
    return arrow.string() if name in ("task", "lane", "kind") else arrow.float64()
