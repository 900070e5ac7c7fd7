# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of a scenario, slice by slice: what is recorded, and what is done on the way."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.brick.exception_name import source_place, with_name, with_source
from ravenbrick.brick.lcd_text import FONT_SIZE, FONT_SYMBOL, lcd_text
from ravenbrick.brick.links.peers import BluetoothLink
from ravenbrick.brick.port_use import DriverCall, port_warnings
from ravenbrick.brick.protocol import Progress
from ravenbrick.brick.snapshot import Snapshot, SnapshotOptions
from ravenbrick.brick.sound_file import save_sound
from ravenbrick.brick.stimulus_callback import Callback
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.criteria import PIN, expected_pins
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.trace.recording import (
    EventKind,
    Picture,
    Recording,
    Screen,
    Signal,
    Stop,
    Thread,
    decode_events,
)

__all__ = ["ScenarioRun"]

SLICE_MS = 5
PROGRESS_MS = 500


class _BrickState:
    """The brick as a callback sees it."""

    def __init__(self, brick: Any, image: ElfImage) -> None:
        self.brick = brick
        self._image = image

    @property
    def time(self) -> float:
        """s."""
        return MASTER_CLOCK.seconds(self.brick.cycles)

    @property
    def cycles(self) -> int:
        """Since power-on."""
        return int(self.brick.cycles)

    @property
    def lcd(self) -> tuple[str, ...]:
        """Text by line."""
        return _picture(self.brick, self._image).text

    def signal(self, name: str) -> float:
        """The last sample."""
        signals = _signals(self.brick)
        if name not in signals:
            raise KeyError(f"no signal '{name}'; there are: {', '.join(signals)}")
        return float(signals[name].values[-1]) if signals[name].values.size else 0.0

    def read(self, symbol: str) -> float:
        """A variable now."""
        return float(self.brick.read_float(symbol))


class ScenarioRun:
    """One run of a brick in slices, with pictures, screens and the callback's inputs."""

    def __init__(
        self,
        brick: Any,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        callback: Callback | None,
        refused: type[Exception],
        inputs: Sequence[TimedInput],
    ) -> None:
        self.brick, self._robot = brick, robot
        self._scenario, self._image = scenario, image
        self._scheduled = inputs
        self._callback, self._refused = callback, refused
        self._state = _BrickState(brick, image)
        self._slice_ends: list[int] = []
        self._displays: list[tuple[int, Picture]] = []
        self._version = -1
        self._content = b""
        self._stop: Any = None
        self._pictures: list[Picture] = []
        self._inputs: list[TimedInput] = []
        self._snapshot: tuple[SnapshotOptions, str, tuple[tuple[str, str], ...]] | None = None
        self._monitor = _monitor(brick, scenario)

    def _event_times_ms(self) -> set[int]:
        """Milliseconds at which there is something to do besides looking at the display."""
        end = self._scenario.duration_ms
        events_ms = {end, *range(PROGRESS_MS, end, PROGRESS_MS), *self._scenario.pictures_ms}
        if self._callback is not None:
            events_ms |= set(range(0, end, self._callback.period_ms))
        if self._snapshot is not None:
            events_ms.add(self._snapshot[0].save_ms)
        if self._monitor is not None:
            events_ms |= set(range(SLICE_MS, end, SLICE_MS))
        return events_ms

    def save_snapshot_later(
        self, options: SnapshotOptions, configuration: str, probes: tuple[tuple[str, str], ...]
    ) -> None:
        """Save a snapshot on the way."""
        self._snapshot = (options, configuration, probes)

    def _save_snapshot(self, at_ms: int) -> None:
        if self._snapshot is None:
            return
        options, configuration, probes = self._snapshot
        if options.save is not None and at_ms == options.save_ms:
            inputs = (*self._scheduled, *self._inputs)
            snapshot = Snapshot.take(self.brick, configuration, self._image, inputs, probes)
            snapshot.save(options.save)

    def run(self, progress: Progress, peer: ScenarioRun | None = None) -> None:
        """To the end of the scenario or of both runs; `peer` is in range and runs beside."""
        link = BluetoothLink(self.brick, peer.brick) if peer is not None else None
        events_ms = self._event_times_ms()
        instants = sorted({*range(SLICE_MS, self._scenario.duration_ms, SLICE_MS), *events_ms})
        cycles = MASTER_CLOCK.cycles_of_all_ms(instants)
        next_index = 0
        for event_ms in sorted(events_ms):
            due = bisect_left(instants, event_ms)
            while next_index <= due:
                first, last, peer_ended = next_index, next_index, True
                if link is None or peer is None:
                    stop, last = self.brick.run_until_picture(cycles, first, due + 1)
                else:
                    stop, other = link.run_until(cycles[first])
                    peer._after_slice(instants[first], cycles[first : first + 1], other)
                    peer_ended = other.reason != "reached"
                self._after_slice(instants[last], cycles[first : last + 1], stop)
                if stop.reason != "reached" and peer_ended:
                    return
                next_index = last + 1
            self._handle_event(event_ms, progress)
        if self._monitor is not None:
            self._monitor.check()

    def _handle_event(self, at_ms: int, progress: Progress) -> None:
        if at_ms % PROGRESS_MS == 0:
            progress(at_ms / self._scenario.duration_ms)
        self._save_snapshot(at_ms)
        if self._monitor is not None:
            self._monitor.poll(at_ms)
        if self._callback is not None and at_ms % self._callback.period_ms == 0:
            self._apply_callback(self._callback)

    def save_sound(self, path: Path) -> None:
        """What was played so far."""
        save_sound(self.brick, path)

    def _after_slice(self, at_ms: int, ends_cycles: list[int], stop: Any) -> None:
        self._stop = stop
        self._slice_ends += ends_cycles
        version = self.brick.lcd_version
        if version != self._version:
            self._version = version
            self._record_display()
        if at_ms in self._scenario.pictures_ms and stop.reason == "reached":
            self._pictures.append(_picture(self.brick, self._image))

    def recording(self) -> Recording:
        """The run so far."""
        stop = _stop(self.brick, self._stop, self._robot.directory)
        events = decode_events(self.brick.events())
        inputs = [timed for timed in self._scheduled if timed.at_cycles <= stop.at_cycles]
        pins = expected_pins(self._scenario.expectations)
        return Recording(
            scenario=self._scenario.name,
            clock=MASTER_CLOCK,
            stop=stop,
            events=events,
            signals=_signals(self.brick) | _pins(self.brick, pins),
            threads=_threads(self.brick),
            pictures=(*self._pictures, _picture(self.brick, self._image)),
            digest=self.brick.trace_digest(),
            inputs=tuple(sorted([*inputs, *self._inputs], key=lambda timed: timed.at_cycles)),
            screens=self._screens(events),
            overflows=tuple(self.brick.stack_overflows()),
            warnings=self._warnings(events),
        )

    def _warnings(self, events: NDArray[np.void]) -> tuple[str, ...]:
        calls = [
            DriverCall(function, argument, callers, partial(self.brick.call_place, chain), cycles)
            for function, argument, callers, chain, cycles in self.brick.traced_calls()
        ]
        return port_warnings(self._robot, calls, events, self.brick.link_up_cycles)

    def _record_display(self) -> None:
        content = self.brick.lcd()
        if content != self._content:
            self._content = content
            self._displays.append((self._slice_ends[-1], _picture(self.brick, self._image)))

    def _apply_callback(self, callback: Callback) -> None:
        for name, value in callback.inputs(self._state):
            try:
                self.brick.schedule_input(self.brick.cycles, name, value)
            except self._refused as error:
                raise callback.error(f"returned what is refused: {error}") from None
            self._inputs.append(TimedInput(self.brick.cycles, name, value))

    def _screens(self, events: NDArray[np.void]) -> tuple[Screen, ...]:
        """Text after each whole picture: from the event that ends its transfer on.

        What is seen between such events is a picture half drawn.
        """
        changed = events[events["kind"] == int(EventKind.DISPLAY_CHANGED)]["at_cycles"].tolist()
        screens: list[Screen] = []
        for at in changed:
            slice_end = min(bisect_left(self._slice_ends, at), len(self._slice_ends) - 1)
            end = self._slice_ends[slice_end]
            text = next(p.text for seen, p in reversed(self._displays) if seen <= end)
            if not screens or screens[-1].text != text:
                screens.append(Screen(at, text))
        return tuple(screens)


def _stop(brick: Any, stop: Any, project: Path) -> Stop:
    place = source_place(brick.raised_at(), project) if stop.reason == "halted" else None
    message = with_name(stop.message, place)
    return Stop(stop.reason, stop.at_cycles, message, with_source(place))


def _monitor(brick: Any, scenario: Scenario) -> Any:
    """The scenario's monitor, if there is one; telemetry is loaded only then."""
    if scenario.monitor is None:
        return None
    from ravenbrick.brick.links.monitored import ScriptedMonitor

    return ScriptedMonitor(brick, scenario.monitor)


def _picture(brick: Any, image: ElfImage) -> Picture:
    pixels = np.frombuffer(brick.lcd(), dtype=np.uint8).reshape(64, 100).astype(bool)
    font = image.symbols.get(FONT_SYMBOL)
    text = lcd_text(pixels, brick.read_memory(font.address, FONT_SIZE)) if font else ()
    return Picture(brick.cycles, pixels, text)


def _signals(brick: Any) -> dict[str, Signal]:
    return {
        name: Signal(np.frombuffer(cycles, "<u8"), np.frombuffer(values, "<f8"))
        for name, (cycles, values) in sorted(brick.signals().items())
    }


def _pins(brick: Any, pins: list[int]) -> dict[str, Signal]:
    """A signal for each pin, with the instants at which its level changes."""
    if not pins:
        return {}
    log = np.array(brick.logged_pins(), np.int64).reshape(-1, 2)
    found = {}
    for pin in pins:
        levels = log[:, 1] >> pin & 1
        changes = np.concatenate([[True], np.diff(levels) != 0])
        cycles = log[changes, 0].astype(np.uint64)
        found[f"{PIN}{pin}"] = Signal(cycles, levels[changes].astype(np.float64))
    return found


def _threads(brick: Any) -> tuple[Thread, ...]:
    """A thread's position is the subject of its events."""
    return tuple(
        Thread(
            thread.name or f"task at 0x{thread.address:08X}",
            thread.base_priority,
            thread.stack_size,
            thread.stack_used,
        )
        for thread in brick.threads()
    )
