# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each format is read back with that format's own library and compared with the recording."""

from __future__ import annotations

import csv
import json
import math
import shutil
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.recordings import preempted

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ToolMissingError
from ravenbrick.trace.export import Format, export
from ravenbrick.trace.export.timeline import nanoseconds
from ravenbrick.trace.recording import EVENT_TYPE, IDLE, EventKind, Recording

RECORDING = preempted()
WORKER = [(1010, 1500), (1600, 2005), (2100, 2130), (3040, 6020)]
URGENT = [(2130, 3040), (100_210, 101_020)]
MODULES = {
    Format.PERFETTO: "perfetto.protos.perfetto.trace.perfetto_trace_pb2",
    Format.VCD: "vcd",
    Format.MCAP: "mcap.writer",
    Format.PARQUET: "pyarrow",
}


def cycle(ns: int) -> int:
    """The cycle that an instant of a file stands for."""
    return math.ceil(Fraction(ns, 1_000_000_000) * MASTER_CLOCK.hertz)


def written(tmp_path: Path, file_format: Format) -> Path:
    """The export of the recording."""
    return export(RECORDING, file_format, tmp_path / f"made{file_format.suffix}")[0]


def test_nanoseconds_lead_back_to_the_exact_cycle() -> None:
    """No two cycles share a nanosecond, up to a day of virtual time."""
    cycles = [0, 1, 2, 47, 48, 48_054_857, 48_054_858, 86_400 * 48_054_857, 10**17]
    assert [cycle(ns) for ns in nanoseconds(MASTER_CLOCK, cycles).tolist()] == cycles


@pytest.mark.parametrize("file_format", Format)
def test_the_same_recording_gives_the_same_bytes(tmp_path: Path, file_format: Format) -> None:
    """No file holds the time or the place of its making."""
    first = export(RECORDING, file_format, tmp_path / f"one{file_format.suffix}")
    (tmp_path / "other").mkdir()
    again = export(preempted(), file_format, tmp_path / "other" / f"two{file_format.suffix}")
    assert len(first) == len(again) > 0
    for one, two in zip(first, again, strict=True):
        assert one.read_bytes() == two.read_bytes()


@pytest.mark.parametrize("file_format", MODULES)
def test_a_missing_library_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file_format: Format
) -> None:
    """The extra that brings the library is named; exit code 4."""
    monkeypatch.setitem(sys.modules, MODULES[file_format], None)
    with pytest.raises(ToolMissingError, match=r"pip install 'ravenbrick\[export\]'") as caught:
        written(tmp_path, file_format)
    assert caught.value.exit_code == 4


class Perfetto:
    """A trace as the protobuf classes of the `perfetto` package read it."""

    def __init__(self, path: Path) -> None:
        module = pytest.importorskip(MODULES[Format.PERFETTO], reason="perfetto is an extra")
        self.types = module.TrackEvent
        trace = module.Trace()
        trace.ParseFromString(path.read_bytes())
        self.packets = list(trace.packet)
        self.tracks = {
            p.track_descriptor.uuid: p.track_descriptor
            for p in self.packets
            if p.HasField("track_descriptor")
        }
        self.names = {
            name.iid: name.name for p in self.packets for name in p.interned_data.event_names
        }

    def events(self, track: str) -> list[tuple[int, Any]]:
        """Cycle and event of each packet of a track."""
        (uuid,) = [n for n, t in self.tracks.items() if t.name == track]
        return [
            (cycle(p.timestamp), p.track_event)
            for p in self.packets
            if p.HasField("track_event") and p.track_event.track_uuid == uuid
        ]

    def slices(self, track: str) -> list[tuple[int, int]]:
        """Begin and end of the slices of a track; they may not overlap."""
        kinds = (self.types.TYPE_SLICE_BEGIN, self.types.TYPE_SLICE_END)
        edges = [(at, e.type) for at, e in self.events(track) if e.type in kinds]
        assert [kind for _, kind in edges] == list(kinds) * (len(edges) // 2)
        return [(edges[i][0], edges[i + 1][0]) for i in range(0, len(edges), 2)]


def test_perfetto_has_a_lane_per_task_and_interrupt_source(tmp_path: Path) -> None:
    """Slices begin and end at the cycles of the schedule, below named roots in a fixed order."""
    trace = Perfetto(written(tmp_path, Format.PERFETTO))
    assert trace.slices("worker (priority 1)") == WORKER
    assert trace.slices("urgent (priority 5)") == URGENT
    assert trace.slices("TWI") == [(1500, 1600)]
    assert trace.slices("TC0") == [(2005, 2100), (100_000, 100_200)]
    parents = {t.name: trace.tracks[t.parent_uuid].name for t in trace.tracks.values()
               if t.parent_uuid}  # fmt: skip
    assert parents["TWI"] == "Interrupts"
    assert parents["worker (priority 1)"] == parents["urgent (priority 5)"] == "Tasks"
    assert parents["motor.B.angular_velocity"] == "Signals"
    roots = [t for t in trace.tracks.values() if not t.parent_uuid]
    assert all(t.child_ordering == t.EXPLICIT for t in roots)
    assert [t.name for t in sorted(roots, key=lambda t: t.sibling_order_rank)] == [
        *("Interrupts", "Tasks", "Processor", "Inputs", "Motor commands", "Signals"),
        "LCD and power",
    ]


def test_perfetto_flows_go_from_release_through_execution_to_completion(tmp_path: Path) -> None:
    """One flow per job: its release, each piece of its execution, its completion."""
    trace = Perfetto(written(tmp_path, Format.PERFETTO))
    events = trace.events("worker (priority 1)")
    ((release, first),) = [(at, e) for at, e in events if trace.names.get(e.name_iid) == "release"]
    (flow,) = first.flow_ids
    ((completion, last),) = [
        (at, e) for at, e in events if trace.names.get(e.name_iid) == "completion"
    ]
    assert (release, completion) == (1000, 6000)
    assert list(last.terminating_flow_ids) == [flow]
    pieces = [at for at, e in events if e.type == trace.types.TYPE_SLICE_BEGIN]
    assert pieces == [begin for begin, _ in WORKER]
    assert all(
        list(e.flow_ids) == [flow] for _, e in events if e.type == trace.types.TYPE_SLICE_BEGIN
    )
    others = [f for _, e in trace.events("urgent (priority 5)") for f in e.flow_ids]
    assert len(set(others)) == 2
    assert flow not in others


def back_to_back() -> Recording:
    """A worker whose job ends where the next is released, just when a handler returns to it."""
    kinds = EventKind
    events = [
        (1000, kinds.RELEASE, 0, 1000),
        (1000, kinds.THREAD_RUNNING, 0, 0),
        (2000, kinds.INTERRUPT_ENTERED, 9, 0),
        (3000, kinds.INTERRUPT_LEFT, 0, 0),
        (3000, kinds.COMPLETION, 0, 1000),
        (3000, kinds.RELEASE, 0, 3000),
        (4000, kinds.COMPLETION, 0, 3000),
        (4000, kinds.THREAD_RUNNING, IDLE, 0),
        (5000, kinds.RELEASE, 0, 5000),
        (5000, kinds.COMPLETION, 0, 5000),
    ]
    return replace(RECORDING, events=np.array(events, dtype=EVENT_TYPE))


def test_a_piece_that_begins_where_a_job_ends_belongs_to_the_next_job(tmp_path: Path) -> None:
    """Its flow in Perfetto is that of the second release."""
    (path,) = export(back_to_back(), Format.PERFETTO, tmp_path / "made.pftrace")
    trace = Perfetto(path)
    events = trace.events("worker (priority 1)")
    first, second, _ = (
        e.flow_ids[0] for _, e in events if trace.names.get(e.name_iid) == "release"
    )
    pieces = [(at, list(e.flow_ids)) for at, e in events if e.type == trace.types.TYPE_SLICE_BEGIN]
    assert pieces == [(1000, [first]), (3000, [second])]


def test_a_wire_stays_high_where_one_job_follows_another(tmp_path: Path) -> None:
    """No edge in the VCD file where a job ends and the next is released, or is done at once."""
    (path,) = export(back_to_back(), Format.VCD, tmp_path / "made.vcd")
    assert vcd_changes(path)["tasks.worker.job"] == [(0, "0"), (1000, "1"), (4000, "0")]


def test_perfetto_counters_are_the_signals(tmp_path: Path) -> None:
    """Each change is there with its value and unit; a value that stays is not repeated."""
    trace = Perfetto(written(tmp_path, Format.PERFETTO))
    signal = RECORDING.signals["motor.B.angular_velocity"]
    found = [(at, e.double_counter_value) for at, e in trace.events("motor.B.angular_velocity")]
    assert found == list(zip(signal.cycles.tolist(), signal.values.tolist(), strict=True))
    late = trace.events("probe.late")
    assert [(at, e.double_counter_value) for at, e in late] == [(96_110, 5.0), (192_220, 7.0)]
    assert trace.events("motor.B.command")[0][1].double_counter_value == -40.0
    units = {t.name: t.counter.unit_name for t in trace.tracks.values()}
    assert units["motor.B.angular_velocity"] == "rad/s"
    assert [trace.names[e.name_iid] for _, e in trace.events("LCD and power")] == [
        "closed  loop | set  4.79",
        "power off",
    ]


def vcd_changes(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Cycle and value of each change by the variable's full name, as pyvcd reads them."""
    reader = pytest.importorskip("vcd.reader", reason="pyvcd is an extra")
    kinds = reader.TokenKind
    names: dict[str, str] = {}
    changes: dict[str, list[tuple[int, Any]]] = {}
    scopes: list[str] = []
    now = 0
    with path.open("rb") as file:
        for token in reader.tokenize(file):
            if token.kind is kinds.SCOPE:
                scopes.append(token.scope.ident)
            elif token.kind is kinds.UPSCOPE:
                scopes.pop()
            elif token.kind is kinds.VAR:
                names[token.var.id_code] = ".".join([*scopes, token.var.ref_str])
            elif token.kind is kinds.TIMESCALE:
                assert (int(token.timescale.magnitude), token.timescale.unit.value) == (1, "ns")
            elif token.kind is kinds.CHANGE_TIME:
                now = cycle(token.time_change)
            elif token.kind in (kinds.CHANGE_SCALAR, kinds.CHANGE_REAL):
                changes.setdefault(names[token.data.id_code], []).append((now, token.data.value))
    assert now == RECORDING.stop.at_cycles
    return changes


def test_vcd_wires_are_the_schedule(tmp_path: Path) -> None:
    """`running` follows the pieces of execution, `job` is high from release to completion."""
    changes = vcd_changes(written(tmp_path, Format.VCD))
    edges = [(at, value) for piece in URGENT for at, value in zip(piece, "10", strict=True)]
    assert changes["tasks.urgent.running"] == [(0, "0"), *edges]
    assert changes["tasks.worker.job"] == [(0, "0"), (1000, "1"), (6000, "0")]
    assert changes["tasks.urgent.job"][1:] == [
        (2000, "1"), (3000, "0"), (99_000, "1"), (101_000, "0"),
    ]  # fmt: skip
    assert changes["interrupts.TWI"] == [(0, "0"), (1500, "1"), (1600, "0")]


def test_vcd_reals_are_the_signals_to_the_last_bit(tmp_path: Path) -> None:
    """Values change at the sampling instants; inputs have their own scope."""
    changes = vcd_changes(written(tmp_path, Format.VCD))
    signal = RECORDING.signals["motor.B.angular_velocity"]
    inside = signal.cycles <= RECORDING.stop.at_cycles
    expected = list(
        zip(signal.cycles[inside].tolist(), signal.values[inside].tolist(), strict=True)
    )
    assert changes["signals.motor.B.angular_velocity"] == expected
    assert changes["inputs.touch.1"] == [(0, 1.0), (7_209, 0.0)]
    assert changes["commands.motor.B.command"] == [(0, 0.0), (4000, -40.0)]


@pytest.mark.skipif(
    shutil.which("vcd2fst") is None, reason="GTKWave is not installed (Debian package gtkwave)"
)
def test_gtkwave_reads_a_vcd_and_finds_the_same_changes(tmp_path: Path) -> None:
    """Through its own format and back, with its own converters."""
    made, waves, back = written(tmp_path, Format.VCD), tmp_path / "made.fst", tmp_path / "back.vcd"
    subprocess.run(["vcd2fst", made, waves], check=True, capture_output=True)
    subprocess.run(["fst2vcd", "-f", waves, "-o", back], check=True, capture_output=True)
    assert vcd_changes(back) == vcd_changes(made)


def mcap_messages(path: Path) -> dict[str, list[tuple[int, dict[str, Any]]]]:
    """Log time (cycles) and content of each message by topic; each fits its schema."""
    module = pytest.importorskip("mcap.reader", reason="mcap is an extra")
    jsonschema = pytest.importorskip("jsonschema")
    topics: dict[str, list[tuple[int, dict[str, Any]]]] = {}
    with path.open("rb") as file:
        for schema, channel, message in module.make_reader(file).iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            content = json.loads(message.data)
            jsonschema.validate(content, json.loads(schema.data))
            topics.setdefault(channel.topic, []).append((cycle(message.log_time), content))
    return topics


def test_mcap_has_signals_schedule_jobs_and_texts(tmp_path: Path) -> None:
    """Messages are logged at the exact instants with the values of the recording."""
    topics = mcap_messages(written(tmp_path, Format.MCAP))
    signal = RECORDING.signals["motor.B.angular_velocity"]
    speeds = [(at, message["angular_velocity"]) for at, message in topics["/motor/B"]]
    assert speeds == list(zip(signal.cycles.tolist(), signal.values.tolist(), strict=True))
    jobs = [(m["task"], m["release_cycles"], m["response_time_cycles"]) for _, m in topics["/jobs"]]
    assert jobs == [("urgent", 2000, 1000), ("worker", 1000, 5000), ("urgent", 99_000, 2000)]
    worker = [
        (m["begin_cycles"], m["end_cycles"])
        for at, m in topics["/schedule"]
        if m["lane"] == "worker" and m["begin_cycles"] == at
    ]
    assert worker == WORKER
    assert topics["/lcd"] == [
        (50_000, {"at_cycles": 50_000, "lines": ["closed  loop", "set  4.79"]})
    ]
    assert [m["value"] for _, m in topics["/inputs"]] == [1.0, 0.0]


def _csv(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_csv_holds_signals_jobs_and_schedule(tmp_path: Path) -> None:
    """Numbers survive; what was not sampled yet is empty."""
    files = export(RECORDING, Format.CSV, tmp_path / "made.csv")
    assert [file.name for file in files] == ["made.csv", "made.jobs.csv", "made.schedule.csv"]
    signals, jobs, schedule = (_csv(file) for file in files)
    signal = RECORDING.signals["motor.B.angular_velocity"]
    assert [int(row["at_cycles"]) for row in signals] == signal.cycles.tolist()
    assert [cycle(int(row["at_ns"])) for row in signals] == signal.cycles.tolist()
    assert [float(row["motor.B.angular_velocity"]) for row in signals] == signal.values.tolist()
    assert [row["probe.late"] for row in signals] == ["", "", "5.0", "5.0", "7.0"]
    assert [(row["task"], row["response_time_cycles"]) for row in jobs] == [
        ("worker", "5000"), ("urgent", "1000"), ("urgent", "2000"),
    ]  # fmt: skip
    total = sum(int(row["end_cycles"]) - int(row["begin_cycles"]) for row in schedule)
    assert total == RECORDING.stop.at_cycles


def test_parquet_holds_the_same_tables_with_types(tmp_path: Path) -> None:
    """Integers stay integers, missing samples are null, the digest is in the metadata."""
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is an extra")
    files = export(RECORDING, Format.PARQUET, tmp_path / "made.parquet")
    signals, jobs, schedule = (parquet.read_table(file) for file in files)
    assert signals.schema.metadata[b"trace_digest"].decode() == RECORDING.digest
    assert str(signals.schema.field("at_cycles").type) == "int64"
    signal = RECORDING.signals["body.x"]
    assert np.array_equal(signals["body.x"].to_numpy(), signal.values)
    assert signals["probe.late"].to_pylist() == [None, None, 5.0, 5.0, 7.0]
    assert jobs["response_time_cycles"].to_pylist() == [5000, 1000, 2000]
    urgent = [
        (row["begin_cycles"], row["end_cycles"])
        for row in schedule.to_pylist()
        if row["lane"] == "urgent"
    ]
    assert urgent == URGENT
