# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""MCAP with JSON messages and JSON schemas, for Foxglove, Lichtblick, PlotJuggler and Rerun.

Topics: one per group of signals (`/motor/B` with `angle`, `voltage` ...), `/schedule` with each
piece of execution, `/jobs` with each completed job, `/inputs`, `/commands` and `/lcd`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.installation import optional_module
from ravenbrick.trace.export.timeline import Series, Timeline, nanoseconds

__all__ = ["write_mcap"]

NUMBER, INTEGER, TEXT = {"type": "number"}, {"type": "integer"}, {"type": "string"}
SCHEMAS: dict[str, dict[str, Any]] = {
    "/schedule": {"lane": TEXT, "kind": TEXT, "begin_cycles": INTEGER, "end_cycles": INTEGER},
    "/jobs": {
        "task": TEXT,
        "release_cycles": INTEGER,
        "start_cycles": {"type": ["integer", "null"]},
        "completion_cycles": INTEGER,
        "response_time_cycles": INTEGER,
    },
    "/inputs": {"at_cycles": INTEGER, "input": TEXT, "value": NUMBER},
    "/commands": {"at_cycles": INTEGER, "command": TEXT, "value": NUMBER},
    "/lcd": {"at_cycles": INTEGER, "lines": {"type": "array", "items": TEXT}},
}
Message = tuple[int, str, dict[str, Any]]


def _topic(signal: str) -> tuple[str, str]:
    """`motor.B.angle` -> topic `/motor/B`, field `angle`."""
    group, _, field = signal.rpartition(".")
    return "/" + group.replace(".", "/"), field


def _groups(timeline: Timeline) -> dict[str, dict[str, Series]]:
    groups: dict[str, dict[str, Series]] = {}
    for series in timeline.series:
        if series.kind == "signal":
            topic, field = _topic(series.name)
            groups.setdefault(topic, {})[field] = series
    return groups


def _signal_messages(topic: str, group: dict[str, Series]) -> Iterator[Message]:
    """One message per sampling instant, with the signals that were sampled then."""
    instants = np.unique(np.concatenate([series.cycles for series in group.values()]))
    rows: list[dict[str, Any]] = [{"at_cycles": at} for at in instants.tolist()]
    for field, series in group.items():
        places = np.searchsorted(instants, series.cycles).tolist()
        for place, value in zip(places, series.values.tolist(), strict=True):
            rows[place][field] = value
    for row in rows:
        yield row["at_cycles"], topic, row


def _schedule_messages(timeline: Timeline) -> Iterator[Message]:
    for lane in timeline.lanes:
        pieces = zip(lane.begin_cycles.tolist(), lane.end_cycles.tolist(), strict=True)
        for begin, end in pieces:
            piece = {"lane": lane.name, "kind": lane.kind, "begin_cycles": begin, "end_cycles": end}
            yield begin, "/schedule", piece
        for job in lane.jobs:
            if job.completion_cycles is not None:
                values = {
                    "task": lane.name,
                    "release_cycles": job.release_cycles,
                    "start_cycles": job.start_cycles,
                    "completion_cycles": job.completion_cycles,
                    "response_time_cycles": job.response_time_cycles,
                }
                yield job.completion_cycles, "/jobs", values


def _other_messages(timeline: Timeline) -> Iterator[Message]:
    for series in timeline.series:
        if series.kind != "signal":
            samples = zip(series.cycles.tolist(), series.values.tolist(), strict=True)
            for at, value in samples:
                named = {"at_cycles": at, series.kind: series.name, "value": value}
                yield at, f"/{series.kind}s", named
    for screen in timeline.screens:
        at = screen.at_cycles
        yield at, "/lcd", {"at_cycles": at, "lines": list(screen.text)}


def _messages(timeline: Timeline, groups: dict[str, dict[str, Series]]) -> list[Message]:
    messages = [*_schedule_messages(timeline), *_other_messages(timeline)]
    for topic, group in groups.items():
        messages += _signal_messages(topic, group)
    messages.sort(key=lambda message: (message[0], message[1]))
    return messages


def _schema(title: str, properties: dict[str, Any], required: list[str]) -> bytes:
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "type": "object",
        "properties": properties,
        "required": required,
    }
    return json.dumps(schema, sort_keys=True).encode()


def _channels(writer: Any, groups: dict[str, dict[str, Series]]) -> dict[str, int]:
    schemas = {topic: (fields, sorted(fields)) for topic, fields in SCHEMAS.items()}
    for topic, group in sorted(groups.items()):
        fields = {n: {**NUMBER, "description": f"unit: {s.unit or '1'}"} for n, s in group.items()}
        schemas[topic] = ({"at_cycles": INTEGER, **fields}, ["at_cycles"])
    channels = {}
    for topic, (fields, required) in schemas.items():
        name = "ravenbrick." + topic.strip("/").replace("/", "_")
        schema = writer.register_schema(
            name=name, encoding="jsonschema", data=_schema(name, fields, required)
        )
        channels[topic] = writer.register_channel(
            topic=topic, message_encoding="json", schema_id=schema
        )
    return channels


def write_mcap(timeline: Timeline, path: Path) -> tuple[Path, ...]:
    """Write `path` and return it; raises `ToolMissingError`."""
    mcap = optional_module("mcap.writer", "mcap")
    groups = _groups(timeline)
    messages = _messages(timeline, groups)
    instants = nanoseconds(timeline.clock, [at for at, _, _ in messages]).tolist()
    with path.open("wb") as file:
        writer = mcap.Writer(file)
        writer.start(profile="", library="ravenbrick")
        channels = _channels(writer, groups)
        hertz = timeline.clock.hertz
        about = {
            "scenario": timeline.scenario,
            "trace_digest": timeline.digest,
            "clock_hz": f"{hertz.numerator}/{hertz.denominator}",
        }
        writer.add_metadata("ravenbrick", about)
        for at, (_, topic, message) in zip(instants, messages, strict=True):
            data = json.dumps(message, separators=(",", ":")).encode()
            writer.add_message(channels[topic], log_time=at, publish_time=at, data=data)
        writer.finish()
    return (path,)
