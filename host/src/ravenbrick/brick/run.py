# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The virtual brick as a target."""

from __future__ import annotations

import json
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.brick.exception_name import source_place, with_name, with_source
from ravenbrick.brick.fmu_body import CoSimulation, FmuBody
from ravenbrick.brick.lcd_text import FONT_SIZE, FONT_SYMBOL, lcd_text
from ravenbrick.brick.links.peers import BluetoothLink
from ravenbrick.brick.port_use import WATCHED, DriverCall, port_warnings
from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.brick.snapshot import Snapshot, SnapshotWishes
from ravenbrick.brick.sound_file import save_sound
from ravenbrick.brick.stimulus_callback import Callback
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import (
    ImageFileError,
    ProjectFileError,
    ToolMissingError,
    UsageError,
)
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.installation import advice_for_python, brick_module
from ravenbrick.project.criteria_text import PIN, expected_pins
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.project.workspace import Workspace
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

__all__ = ["Station", "VirtualTarget"]

SLICE_MS = 5
PROGRESS_MS = 500
PEER_ADDRESS = "00:16:53:00:00:02"


@dataclass(frozen=True)
class Station:
    """A scenario's peer: what it is, and how it ran."""

    robot: Robot
    scenario: Scenario
    image: ElfImage
    recording: Recording | None = None


class VirtualTarget:
    """Runs images on the cycle-accurate virtual brick; `module` is for tests.

    `callback` gives further inputs while the scenario runs. `settings` are fields of the brick's
    configuration that concern the simulation: `engine`, `timing` (docs/reference/timing.md).
    `body` is an FMU in place of the robot's body, `snapshots` what to begin with and to save,
    `sound` where to save what the loudspeaker plays.
    """

    def __init__(
        self,
        module: Any = None,
        callback: Callback | None = None,
        settings: Mapping[str, Any] | None = None,
        body: FmuBody | None = None,
        snapshots: SnapshotWishes | None = None,
        sound: Path | None = None,
    ) -> None:
        self._module = module if module is not None else brick_module()
        self._callback = callback
        self._settings = dict(settings or {})
        self._body = body
        self._snapshots = snapshots or SnapshotWishes()
        self._sound = sound

    @property
    def name(self) -> str:
        """What to call it in messages."""
        return "virtual brick"

    def run(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        progress: Progress = no_progress,
    ) -> Recording:
        """See `Target.run`. The scenario's peer or monitor, if any, runs beside."""
        return self.run_with_peer(robot, scenario, image, progress)[0]

    def run_with_peer(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        progress: Progress = no_progress,
    ) -> tuple[Recording, Station | None]:
        """The recording of `run`, and the scenario's peer as it ran, if there is one."""
        play = self._play(robot, scenario, image, self._callback)
        station = self._station(scenario)
        if station is None:
            play.run(progress)
        else:
            address = {"bluetooth": {"address": PEER_ADDRESS}}
            other = self._play(station.robot, station.scenario, station.image, None, address)
            play.run(progress, other)
            station = replace(station, recording=other.recording())
        if self._sound is not None:
            play.save_sound(self._sound)
        return play.recording(), station

    def _station(self, scenario: Scenario) -> Station | None:
        """The peer's robot, scenario and image; raises as for the first brick's."""
        if scenario.peer is None:
            return None
        project = scenario.peer.project
        robot = read_robot(project)
        chosen = read_scenario(scenario_path(project, scenario.peer.scenario), robot)
        return Station(robot, chosen, build_image(Workspace.of(project), robot, "ram").image)

    def _play(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        callback: Callback | None,
        fields: Mapping[str, Any] | None = None,
    ) -> _Play:
        wishes = self._snapshots if fields is None else SnapshotWishes()
        if wishes.start is not None:
            brick, inputs = wishes.start.restore(self._module, image), wishes.start.inputs
        else:
            brick = self._assemble(robot, scenario, image, fields=fields)
            inputs = self._schedule(brick, scenario)
            self._probe(brick, robot, image)
            brick.watch_calls(list(WATCHED))
        pins = expected_pins(scenario.expectations)
        if pins and (wishes.start or wishes.save):
            raise UsageError("a snapshot holds no record of pins; leave out what expects them")
        if pins:
            brick.log_pins(pins)
        play = _Play(brick, robot, scenario, image, callback, self._module.InputError, inputs)
        if wishes.save is not None:
            probes = tuple((setpoint.symbol, setpoint.type) for setpoint in robot.setpoints)
            configuration = self._configuration(robot, scenario, None)
            play.keep(wishes, configuration, () if image.bare else probes)
        return play

    def _configuration(
        self, robot: Robot, scenario: Scenario, fields: Mapping[str, Any] | None
    ) -> str:
        own = brick_configuration(robot, scenario, MASTER_CLOCK)
        if self._body is not None and fields is None:
            own = self._body.configuration(own)
        return json.dumps({**own, **self._settings, **(fields or {})})

    def prepare(
        self, robot: Robot, scenario: Scenario, image: ElfImage, any_program: bool = False
    ) -> Any:
        """A brick with the image and the scenario's inputs, for others to run; errors as `run`.

        With `any_program` it need not be linked with the run-time: then it has no tasks.
        A peer or a monitor of the scenario is not there.
        """
        brick = self._assemble(robot, scenario, image, any_program)
        self._schedule(brick, scenario)
        if brick.threads_unobserved is None:
            self._probe(brick, robot, image)
        return brick

    def _assemble(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        any_program: bool = False,
        fields: Mapping[str, Any] | None = None,
    ) -> Any:
        configuration = self._configuration(robot, scenario, fields)
        kind = self._module.VirtualBrick
        try:
            if image.bare:
                brick = kind.from_binary(configuration, image.content, image.entry)
            else:
                brick = kind(configuration, image.content)
        except self._module.ImageError as error:
            raise ImageFileError(f"{image.path}: {error}; build the image again") from None
        except self._module.ConfigurationError as error:
            raise ProjectFileError(robot.document.path, 1, "", str(error)) from None
        if Fraction(*brick.clock_hz) != MASTER_CLOCK.hertz:
            raise ToolMissingError(
                f"the module 'virtual_brick' has another clock ({brick.clock_hz}); "
                f"{advice_for_python()} to have the one of this version"
            )
        if brick.threads_unobserved is not None and not image.bare and not any_program:
            raise ImageFileError(
                f"{image.path}: its tasks cannot be observed ({brick.threads_unobserved}); "
                "link it with the project's run-time"
            )
        outside = self._body if fields is None else None
        return brick if outside is None else CoSimulation(brick, outside)

    def _schedule(self, brick: Any, scenario: Scenario) -> tuple[TimedInput, ...]:
        inputs = scenario.timed_inputs()
        for timed in inputs:
            try:
                brick.schedule_input(timed.at_cycles, timed.name, timed.value)
            except self._module.InputError as error:
                path, _, line = timed.place.rpartition(":")
                raise ProjectFileError(Path(path), int(line), timed.name, str(error)) from None
        return inputs

    def _probe(self, brick: Any, robot: Robot, image: ElfImage) -> None:
        if image.bare:
            return
        for index, setpoint in enumerate(robot.setpoints):
            if setpoint.symbol not in image.symbols:
                raise robot.document.error(
                    ("setpoints", index, "symbol"),
                    f"the image {image.path.name} has no symbol '{setpoint.symbol}'; "
                    "name an exported variable of the application",
                )
            brick.add_probe(setpoint.symbol, setpoint.type)


class _Moment:
    """What a callback sees of the brick."""

    def __init__(self, brick: Any, image: ElfImage) -> None:
        self._brick = brick
        self._image = image

    @property
    def time(self) -> float:
        """s."""
        return MASTER_CLOCK.seconds(self._brick.cycles)

    @property
    def cycles(self) -> int:
        """Since power-on."""
        return int(self._brick.cycles)

    @property
    def lcd(self) -> tuple[str, ...]:
        """Text by line."""
        return _picture(self._brick, self._image).text

    def signal(self, name: str) -> float:
        """The last sample."""
        signals = _signals(self._brick)
        if name not in signals:
            raise KeyError(f"no signal '{name}'; there are: {', '.join(signals)}")
        return float(signals[name].values[-1]) if signals[name].values.size else 0.0

    def read(self, symbol: str) -> float:
        """A variable now."""
        return float(self._brick.read_float(symbol))


class _Play:
    """One run in slices: pictures, screens and the callback's inputs on the way."""

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
        self._brick, self._robot = brick, robot
        self._scenario, self._image = scenario, image
        self._scheduled = inputs
        self._callback, self._refused = callback, refused
        self._moment = _Moment(brick, image)
        self._visited: list[int] = []
        self._seen: list[tuple[int, Picture]] = []
        self._version = -1
        self._content = b""
        self._stop: Any = None
        self._pictures: list[Picture] = []
        self._inputs: list[TimedInput] = []
        self._kept: tuple[SnapshotWishes, str, tuple[tuple[str, str], ...]] | None = None
        self._listener = _listener(brick, scenario)

    def _occasions(self) -> set[int]:
        """Milliseconds at which there is something to do besides looking at the display."""
        end = self._scenario.duration_ms
        occasions = {end, *range(PROGRESS_MS, end, PROGRESS_MS), *self._scenario.pictures_ms}
        if self._callback is not None:
            occasions |= set(range(0, end, self._callback.period_ms))
        if self._kept is not None:
            occasions.add(self._kept[0].save_ms)
        if self._listener is not None:
            occasions |= set(range(SLICE_MS, end, SLICE_MS))
        return occasions

    def keep(
        self, wishes: SnapshotWishes, configuration: str, probes: tuple[tuple[str, str], ...]
    ) -> None:
        """Save a snapshot on the way."""
        self._kept = (wishes, configuration, probes)

    def _save_snapshot(self, at_ms: int) -> None:
        if self._kept is None:
            return
        wishes, configuration, probes = self._kept
        if wishes.save is not None and at_ms == wishes.save_ms:
            inputs = (*self._scheduled, *self._inputs)
            snapshot = Snapshot.take(self._brick, configuration, self._image, inputs, probes)
            snapshot.save(wishes.save)

    def run(self, progress: Progress, peer: _Play | None = None) -> None:
        """To the end of the scenario or of the run; `peer` is in range and runs beside."""
        link = BluetoothLink(self._brick, peer._brick) if peer is not None else None
        occasions = self._occasions()
        instants = sorted({*range(SLICE_MS, self._scenario.duration_ms, SLICE_MS), *occasions})
        cycles = [MASTER_CLOCK.cycles_of_ms(at_ms) for at_ms in instants]
        next_one = 0
        for occasion_ms in sorted(occasions):
            due = bisect_left(instants, occasion_ms)
            while next_one <= due:
                first, last = next_one, next_one
                if link is None or peer is None:
                    stop, last = self._brick.run_until_picture(cycles, first, due + 1)
                else:
                    stop, other = link.run_until(cycles[first])
                    peer._visit(instants[first], cycles[first : first + 1], other)
                self._visit(instants[last], cycles[first : last + 1], stop)
                if stop.reason != "reached":
                    return
                next_one = last + 1
            self._attend(occasion_ms, progress)
        if self._listener is not None:
            self._listener.check()

    def _attend(self, at_ms: int, progress: Progress) -> None:
        if at_ms % PROGRESS_MS == 0:
            progress(at_ms / self._scenario.duration_ms)
        self._save_snapshot(at_ms)
        if self._listener is not None:
            self._listener.look(at_ms)
        if self._callback is not None and at_ms % self._callback.period_ms == 0:
            self._ask(self._callback)

    def save_sound(self, path: Path) -> None:
        """What was played so far."""
        save_sound(self._brick, path)

    def _visit(self, at_ms: int, visited_cycles: list[int], stop: Any) -> None:
        self._stop = stop
        self._visited += visited_cycles
        version = self._brick.lcd_version
        if version != self._version:
            self._version = version
            self._look()
        if at_ms in self._scenario.pictures_ms and stop.reason == "reached":
            self._pictures.append(_picture(self._brick, self._image))

    def recording(self) -> Recording:
        """The run so far."""
        stop = _stop(self._brick, self._stop, self._robot.directory)
        events = decode_events(self._brick.events())
        inputs = [timed for timed in self._scheduled if timed.at_cycles <= stop.at_cycles]
        pins = expected_pins(self._scenario.expectations)
        return Recording(
            scenario=self._scenario.name,
            clock=MASTER_CLOCK,
            stop=stop,
            events=events,
            signals=_signals(self._brick) | _pins(self._brick, pins),
            threads=_threads(self._brick),
            pictures=(*self._pictures, _picture(self._brick, self._image)),
            digest=self._brick.trace_digest(),
            inputs=tuple(sorted([*inputs, *self._inputs], key=lambda timed: timed.at_cycles)),
            screens=self._screens(events),
            overflows=tuple(self._brick.stack_overflows()),
            warnings=self._warnings(events),
        )

    def _warnings(self, events: NDArray[np.void]) -> tuple[str, ...]:
        calls = [DriverCall(*call) for call in self._brick.watched_calls()]
        return port_warnings(self._robot, calls, events, self._brick.link_up_cycles)

    def _look(self) -> None:
        content = self._brick.lcd()
        if content != self._content:
            self._content = content
            self._seen.append((self._visited[-1], _picture(self._brick, self._image)))

    def _ask(self, callback: Callback) -> None:
        for name, value in callback.inputs(self._moment):
            try:
                self._brick.schedule_input(self._brick.cycles, name, value)
            except self._refused as error:
                raise callback.error(f"returned what is refused: {error}") from None
            self._inputs.append(TimedInput(self._brick.cycles, name, value))

    def _screens(self, events: NDArray[np.void]) -> tuple[Screen, ...]:
        """Text after each whole picture: from the event that ends its transfer on.

        What is seen between such events is a picture half drawn.
        """
        changed = events[events["kind"] == int(EventKind.DISPLAY_CHANGED)]["at_cycles"].tolist()
        screens: list[Screen] = []
        for at in changed:
            visit = self._visited[min(bisect_left(self._visited, at), len(self._visited) - 1)]
            text = next(p.text for visited, p in reversed(self._seen) if visited <= visit)
            if not screens or screens[-1].text != text:
                screens.append(Screen(at, text))
        return tuple(screens)


def _stop(brick: Any, stop: Any, project: Path) -> Stop:
    place = source_place(brick.raised_at(), project) if stop.reason == "halted" else None
    message = with_name(stop.message, place)
    return Stop(stop.reason, stop.at_cycles, message, with_source(place))


def _listener(brick: Any, scenario: Scenario) -> Any:
    """The scenario's monitor, if there is one; telemetry is loaded only then."""
    if scenario.monitor is None:
        return None
    from ravenbrick.brick.links.monitored import Listener

    return Listener(brick, scenario.monitor)


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
