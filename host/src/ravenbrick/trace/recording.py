# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is left of a run: events, signals, threads and pictures, with exact instants."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import IntEnum
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
from numpy.typing import NDArray

from ravenbrick.atomic_write import atomic_write
from ravenbrick.clock import Clock
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.installation import brick_module
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.trace.flow_counts import FlowCount

__all__ = [
    "ENVIRONMENT",
    "EVENT_TYPE",
    "IDLE",
    "EventKind",
    "Picture",
    "Recording",
    "Screen",
    "Signal",
    "Stop",
    "Thread",
    "decode_events",
]

# Unpacked; an hour of the vehicle takes a tenth of it.
LARGEST_BYTES = 2 << 30
# Level 6 compresses a run of 20 s to a twentieth less, in three to four times as long.
COMPRESSION_LEVEL = 1
EVENT_TYPE = np.dtype([("at_cycles", "<u8"), ("kind", "<u4"), ("subject", "<u4"), ("value", "<i8")])
IDLE = 0xFFFF_FFFF
# The thread that executes the main procedure (runtime/kernel/ravenbrick-threads.ads).
ENVIRONMENT = "environment"


class EventKind(IntEnum):
    """Kinds of events; `subject` and `value` depend on the kind."""

    THREAD_RUNNING = 1
    THREAD_STATE = 2
    RELEASE = 3
    COMPLETION = 4
    INTERRUPT_ENTERED = 5
    INTERRUPT_LEFT = 6
    DISPLAY_CHANGED = 7
    MOTOR_COMMAND = 8
    INPUT = 9
    PROCESSOR_STOPPED = 10
    PROCESSOR_RESUMED = 11
    POWER_OFF = 12
    COPROCESSOR_CLICK = 13


@dataclass(frozen=True)
class Signal:
    """Samples of one quantity: instants in cycles and values, shape (n,) each."""

    cycles: NDArray[np.uint64]
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Thread:
    """A task as the run-time holds it; `stack_used_bytes` is the high-water mark of the run."""

    name: str
    base_priority: int
    stack_bytes: int
    stack_used_bytes: int


@dataclass(frozen=True)
class Picture:
    """The LCD at an instant: 64 rows of 100 pixels, True is dark; `text` if it could be read."""

    at_cycles: int
    pixels: NDArray[np.bool_]
    text: tuple[str, ...]


@dataclass(frozen=True)
class Screen:
    """The text that the LCD shows from an instant on."""

    at_cycles: int
    text: tuple[str, ...]


@dataclass(frozen=True)
class Stop:
    """Why and when the run ended: reached, power_off, fault or halted; the source line if known."""

    reason: str
    at_cycles: int
    message: str
    source: str = ""


@dataclass(frozen=True, eq=False)
class Recording:
    """One run of one image; a thread's index is the `subject` of its events.

    `inputs` are all that were applied, from wherever: they play the run again. `screens` are the
    texts of the LCD in the order of time. `overflows`: a sentence for each stack that overflowed.
    `warnings`: sentences about what the program uses and robot.toml does not have. `flow_counts`
    are what was counted about flow facts, `transfers` the instants of the data controller's
    transfers by peripheral, `profiles` the instructions of chosen jobs, all only of runs that count
    them; a file does not have them.
    """

    scenario: str
    clock: Clock
    stop: Stop
    events: NDArray[np.void]
    signals: Mapping[str, Signal]
    threads: tuple[Thread, ...]
    pictures: tuple[Picture, ...]
    digest: str
    inputs: tuple[TimedInput, ...] = ()
    screens: tuple[Screen, ...] = ()
    overflows: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    flow_counts: tuple[FlowCount, ...] = ()
    transfers: Mapping[str, NDArray[np.int64]] | None = None
    profiles: tuple[bytes, ...] = ()

    @cached_property
    def native(self) -> Any:
        """The `RecordedRun` of the compiled module, which measures and judges."""
        hertz, stop = self.clock.hertz, self.stop
        signals = self.signals.items()
        return brick_module().RecordedRun(
            (hertz.numerator, hertz.denominator),
            (stop.reason, stop.at_cycles, stop.message),
            self.events.tobytes(),
            [(name, signal.cycles, signal.values) for name, signal in signals],
            [(thread.name, thread.base_priority) for thread in self.threads],
            [(screen.at_cycles, list(screen.text)) for screen in self.screens],
            [(timed.at_cycles, timed.name, timed.value) for timed in self.inputs],
        )

    def thread_index(self, name: str) -> int:
        """Place of the thread with this name in whatever letter case; raises `ValueError`."""
        return [thread.name.lower() for thread in self.threads].index(name.lower())

    def of_kind(self, *kinds: EventKind) -> NDArray[np.void]:
        """The events of these kinds, in order."""
        return self.events[np.isin(self.events["kind"], [int(kind) for kind in kinds])]

    def signal(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Instants (s) and values of a signal; raises `UsageError` when it was not recorded."""
        found = self.signals.get(name)
        if found is None:
            known = ", ".join(sorted(self.signals))
            raise UsageError(f"the signal '{name}' was not recorded; recorded are: {known}")
        return self.clock.instants(found.cycles), found.values

    def save(self, path: Path) -> None:
        """Write everything to one compressed file, whole or not at all."""
        arrays: dict[str, Any] = _event_columns(self.events)
        instants = _names_of_instants(self.signals)
        for name, signal in self.signals.items():
            if instants[name] == name:
                arrays[f"cycles:{name}"] = signal.cycles
            arrays[f"values:{name}"] = signal.values
        for index, picture in enumerate(self.pictures):
            arrays[f"picture:{index}"] = np.packbits(picture.pixels)
        pictures = [{"at_cycles": p.at_cycles, "text": list(p.text)} for p in self.pictures]
        head = {
            "scenario": self.scenario,
            "clock_hz": [self.clock.hertz.numerator, self.clock.hertz.denominator],
            "stop": asdict(self.stop),
            "threads": [asdict(thread) for thread in self.threads],
            "pictures": pictures,
            "digest": self.digest,
            "instants": instants,
            "inputs": [[i.at_cycles, i.name, i.value] for i in self.inputs],
            "screens": [[s.at_cycles, list(s.text)] for s in self.screens],
            "overflows": self.overflows,
            "warnings": self.warnings,
        }
        content = io.BytesIO()
        arrays["head"] = np.array(json.dumps(head))
        with ZipFile(content, "w", ZIP_DEFLATED, compresslevel=COMPRESSION_LEVEL) as archive:
            for name, array in arrays.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                    np.lib.format.write_array(file, array, allow_pickle=False)
        atomic_write(path, content.getvalue())

    @classmethod
    def load(cls, path: Path) -> Recording:
        """Read what `save` wrote; raises `UsageError` for a file that is not a recording."""
        if not path.is_file():
            raise UsageError(
                f"{shown_path(path)}: there is no such recording; make one with 'ravenbrick run'"
            )
        try:
            with ZipFile(path) as archive:
                if sum(info.file_size for info in archive.infolist()) > LARGEST_BYTES:
                    raise ValueError("larger than any run")
            with np.load(path, allow_pickle=False) as arrays:
                return cls._from_arrays({name: arrays[name] for name in arrays.files})
        except Exception:
            # NumPy reads heads of arrays as Python: any error of a parser may come.
            raise UsageError(
                f"{shown_path(path)}: not a recording of a run, or damaged; "
                "run the scenario again with 'ravenbrick run'"
            ) from None

    @classmethod
    def _from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Recording:
        head = json.loads(str(arrays["head"]))
        names = [key.removeprefix("values:") for key in arrays if key.startswith("values:")]
        # Files of version 0.4 and before have all instants of each signal, and events as records.
        cycles = {n: arrays[f"cycles:{head.get('instants', {}).get(n, n)}"] for n in names}
        pictures = []
        for index, picture in enumerate(head["pictures"]):
            pixels = np.unpackbits(arrays[f"picture:{index}"], count=6400).reshape(64, 100)
            pictures.append(
                Picture(picture["at_cycles"], pixels.astype(bool), tuple(picture["text"]))
            )
        return cls(
            scenario=head["scenario"],
            clock=Clock(Fraction(*head["clock_hz"])),
            stop=Stop(**head["stop"]),
            events=arrays["events"] if "events" in arrays else _events(arrays),
            signals={n: Signal(cycles[n], arrays[f"values:{n}"]) for n in names},
            threads=tuple(Thread(**thread) for thread in head["threads"]),
            pictures=tuple(pictures),
            digest=head["digest"],
            inputs=tuple(TimedInput(*item) for item in head["inputs"]),
            screens=tuple(Screen(at, tuple(text)) for at, text in head["screens"]),
            overflows=tuple(head.get("overflows", ())),
            warnings=tuple(head.get("warnings", ())),
        )


def decode_events(packed: bytes) -> NDArray[np.void]:
    """Records of 24 bytes (u64 instant, u32 kind, u32 subject, i64 value), shape (n,)."""
    return np.frombuffer(packed, dtype=EVENT_TYPE)


def _event_columns(events: NDArray[np.void]) -> dict[str, NDArray[Any]]:
    """Events by field, instants as differences, each in the smallest type that holds them.

    They take a third of the file that records take, and of the time to compress it.
    """
    columns = {name: events[name] for name in EVENT_TYPE.names or ()}
    at_cycles = columns["at_cycles"]
    columns["at_cycles"] = np.diff(at_cycles, prepend=at_cycles.dtype.type(0))
    return {
        f"event:{name}": column.astype(np.min_scalar_type(column.max(initial=0)))
        if column.dtype.kind == "u"
        else column
        for name, column in columns.items()
    }


def _events(arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.void]:
    """The events of their columns; raises `ValueError` where these do not fit each other."""
    columns = {name: arrays[f"event:{name}"] for name in EVENT_TYPE.names or ()}
    (length,) = columns["at_cycles"].shape
    if length * EVENT_TYPE.itemsize > LARGEST_BYTES:
        raise ValueError("larger than any run")
    events = np.zeros(length, EVENT_TYPE)
    for name, column in columns.items():
        if column.shape != events.shape or column.dtype.kind not in "iu":
            raise ValueError("no column of events")
        events[name] = column
    events["at_cycles"] = events["at_cycles"].cumsum()
    return events


def _names_of_instants(signals: Mapping[str, Signal]) -> dict[str, str]:
    """For each signal the first one with the same instants: signals are sampled together."""
    found: dict[str, str] = {}
    for name, signal in signals.items():
        same = (n for n in set(found.values()) if np.array_equal(signals[n].cycles, signal.cycles))
        found[name] = next(same, name)
    return found
