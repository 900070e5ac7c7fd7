# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Perfetto: TrackEvent packets (protobuf), for ui.perfetto.dev and the trace processor.

A lane per interrupt source and per task, counters for signals, and per job a flow from its
release through each piece of its execution to its completion.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.atomic_write import atomic_write
from ravenbrick.installation import optional_module
from ravenbrick.trace.export.timeline import Lane, Series, Timeline, nanoseconds

__all__ = ["write_perfetto"]

SEQUENCE = 1
BUILT_IN_ROOTS = (("interrupt", "Interrupts"), ("task", "Tasks"), ("processor", "Processor"))
SERIES_ROOTS = (("input", "Inputs"), ("command", "Motor commands"), ("signal", "Signals"))
# Of packets of one instant: slices end before marks, marks come before slices begin.
END, RELEASE, BEGIN, COUNTER = 0, 1, 2, 3
# Instant, kind, track, name, flows that pass and that end, value.
Item = tuple[int, int, int, str, tuple[int, ...], tuple[int, ...], float]


class _Tracks:
    """Descriptors and numbers of all tracks."""

    def __init__(self, trace: Any, packets: Any) -> None:
        self._trace = trace
        self._packets = packets
        self._numbers: dict[tuple[str, str], int] = {}

    def add(self, kind: str, name: str, shown: str, parent: int | None, rank: int) -> Any:
        """A track below `parent`; returns its descriptor."""
        number = len(self._numbers) + 1
        self._numbers[kind, name] = number
        packet = self._trace.packet.add()
        packet.trusted_packet_sequence_id = SEQUENCE
        descriptor = packet.track_descriptor
        descriptor.uuid, descriptor.name = number, shown
        descriptor.sibling_order_rank = rank
        if parent is not None:
            descriptor.parent_uuid = parent
        descriptor.child_ordering = self._packets.TrackDescriptor.EXPLICIT
        return descriptor

    def of(self, kind: str, name: str) -> int:
        """Number of a track."""
        return self._numbers[kind, name]


def _declare(timeline: Timeline, tracks: _Tracks) -> None:
    for rank, (kind, title) in enumerate(BUILT_IN_ROOTS):
        root = tracks.add("root", kind, title, None, rank).uuid
        for place, lane in enumerate(lane for lane in timeline.lanes if lane.kind == kind):
            priority = "" if lane.priority is None else f" (priority {lane.priority})"
            tracks.add(kind, lane.name, f"{lane.name}{priority}", root, place)
    for rank, (kind, title) in enumerate(SERIES_ROOTS, len(BUILT_IN_ROOTS)):
        root = tracks.add("root", kind, title, None, rank).uuid
        for place, series in enumerate(s for s in timeline.series if s.kind == kind):
            descriptor = tracks.add(kind, series.name, series.name, root, place)
            descriptor.counter.unit_name = series.unit
    tracks.add("root", "lcd", "LCD and power", None, len(BUILT_IN_ROOTS) + len(SERIES_ROOTS))


def _lane_items(timeline: Timeline, lane: Lane, track: int, first_flow: int) -> Iterator[Item]:
    """Slices of a lane, and releases and completions of its jobs; flows are numbered by job."""
    clock = timeline.clock
    begins = nanoseconds(clock, lane.begin_cycles).tolist()
    ends = nanoseconds(clock, lane.end_cycles).tolist()
    completions = [
        timeline.end_cycles if job.completion_cycles is None else job.completion_cycles
        for job in lane.jobs
    ]
    # The piece that begins at an instant belongs to the first job that is not complete by then.
    owners = np.searchsorted(np.array(completions, np.int64), lane.begin_cycles, side="right")
    for begin, end, owner, at in zip(
        begins, ends, owners.tolist(), lane.begin_cycles.tolist(), strict=True
    ):
        working = owner < len(lane.jobs) and lane.jobs[owner].release_cycles <= at
        flow = (first_flow + owner,) if working else ()
        yield begin, BEGIN, track, lane.name, flow, (), 0.0
        yield end, END, track, "", (), (), 0.0
    releases = nanoseconds(clock, [job.release_cycles for job in lane.jobs]).tolist()
    for number, (job, release) in enumerate(zip(lane.jobs, releases, strict=True)):
        yield release, RELEASE, track, "release", (first_flow + number,), (), 0.0
        if job.completion_cycles is not None:
            at = int(nanoseconds(clock, [job.completion_cycles])[0])
            yield at, RELEASE, track, "completion", (), (first_flow + number,), 0.0


def _series_items(timeline: Timeline, series: Series, track: int) -> Iterator[Item]:
    """Only the changes: a counter holds its value."""
    kept = np.ones(series.values.shape, dtype=bool)
    kept[1:] = series.values[1:] != series.values[:-1]
    instants = nanoseconds(timeline.clock, series.cycles[kept]).tolist()
    for at, value in zip(instants, series.values[kept].tolist(), strict=True):
        yield at, COUNTER, track, "", (), (), value


def _items(timeline: Timeline, tracks: _Tracks) -> list[Item]:
    items: list[Item] = []
    flow = 1
    for lane in timeline.lanes:
        items += _lane_items(timeline, lane, tracks.of(lane.kind, lane.name), flow)
        flow += len(lane.jobs)
    for series in timeline.series:
        items += _series_items(timeline, series, tracks.of(series.kind, series.name))
    track = tracks.of("root", "lcd")
    marks = [(mark.at_cycles, mark.text) for mark in timeline.marks if "LCD" not in mark.text]
    marks += [(s.at_cycles, " | ".join(line.strip() for line in s.text)) for s in timeline.screens]
    for at_cycles, text in marks:
        at = int(nanoseconds(timeline.clock, [at_cycles])[0])
        items.append((at, RELEASE, track, text, (), (), 0.0))
    items.sort(key=lambda item: (item[0], item[1], item[2]))
    return items


def write_perfetto(timeline: Timeline, path: Path) -> tuple[Path, ...]:
    """Write `path` and return it; raises `ToolMissingError`."""
    packets = optional_module("perfetto.protos.perfetto.trace.perfetto_trace_pb2", "perfetto")
    trace = packets.Trace()
    tracks = _Tracks(trace, packets)
    _declare(timeline, tracks)
    items = _items(timeline, tracks)
    names = {name: i for i, name in enumerate(sorted({item[3] for item in items} - {""}), 1)}
    first = trace.packet.add()
    first.trusted_packet_sequence_id = SEQUENCE
    first.sequence_flags = packets.TracePacket.SEQ_INCREMENTAL_STATE_CLEARED
    for name, number in names.items():
        first.interned_data.event_names.add(iid=number, name=name)
    event_type = packets.TrackEvent
    types = {END: event_type.TYPE_SLICE_END, BEGIN: event_type.TYPE_SLICE_BEGIN}
    types |= {RELEASE: event_type.TYPE_INSTANT, COUNTER: event_type.TYPE_COUNTER}
    for at, kind, track, name, flows, ended, value in items:
        packet = trace.packet.add()
        packet.timestamp = at
        packet.trusted_packet_sequence_id = SEQUENCE
        packet.sequence_flags = packets.TracePacket.SEQ_NEEDS_INCREMENTAL_STATE
        event = packet.track_event
        event.type = types[kind]
        event.track_uuid = track
        if name:
            event.name_iid = names[name]
        event.flow_ids.extend(flows)
        event.terminating_flow_ids.extend(ended)
        if kind == COUNTER:
            event.double_counter_value = value
    atomic_write(path, trace.SerializeToString(deterministic=True))
    return (path,)
