# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs of an image on the virtual brick, alone or beside a scenario's peer."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.brick.fmu_body import CoSimulation, FmuBody
from ravenbrick.brick.port_use import WATCHED
from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.brick.scenario_run import ScenarioRun
from ravenbrick.brick.snapshot import SnapshotOptions
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
from ravenbrick.project.criteria import expected_pins
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.flow_counts import flow_counts
from ravenbrick.trace.recording import Recording

__all__ = ["PeerRun", "VirtualTarget"]

PEER_ADDRESS = "00:16:53:00:00:02"


@dataclass(frozen=True)
class PeerRun:
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
    `sound` where to save what the loudspeaker plays. `flow_points` are what to count about flow
    facts (JSON); with them, transfers of the data controller are recorded too.
    """

    def __init__(
        self,
        module: Any = None,
        callback: Callback | None = None,
        settings: Mapping[str, Any] | None = None,
        body: FmuBody | None = None,
        snapshots: SnapshotOptions | None = None,
        sound: Path | None = None,
        flow_points: str | None = None,
    ) -> None:
        self._module = module if module is not None else brick_module()
        self._callback = callback
        self._settings = dict(settings or {})
        self._body = body
        self._snapshots = snapshots or SnapshotOptions()
        self._sound = sound
        self._flow_points = flow_points
        self._profile: Sequence[tuple[int, int, int]] = ()

    def with_profile(self, windows: Sequence[tuple[int, int, int]]) -> VirtualTarget:
        """The same that notes the instructions of threads (by position) from a cycle to another."""
        profiling = copy.copy(self)
        profiling._profile = windows
        return profiling

    def without_counts(self) -> VirtualTarget:
        """The same that counts nothing: a run of hours would fill the memory with transfers."""
        plain = copy.copy(self)
        plain._flow_points = None
        return plain

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
    ) -> tuple[Recording, PeerRun | None]:
        """The recording of `run`, and the scenario's peer as it ran, if there is one."""
        run = self._scenario_run(robot, scenario, image, self._callback)
        peer = self._peer(scenario)
        if peer is None:
            run.run(progress)
        else:
            address = {"bluetooth": {"address": PEER_ADDRESS}}
            other = self._scenario_run(peer.robot, peer.scenario, peer.image, None, address)
            run.run(progress, other)
            peer = replace(peer, recording=other.recording())
        if self._sound is not None:
            run.save_sound(self._sound)
        return self._with_counts(run.recording(), run.brick), peer

    def _with_counts(self, recording: Recording, brick: Any) -> Recording:
        """What was counted beside the run, if anything is."""
        if self._flow_points is None:
            return recording
        transfers = brick.logged_transfers().items()
        return replace(
            recording,
            flow_counts=flow_counts(brick),
            profiles=tuple(brick.profiled()),
            transfers={
                name.replace("USART", "USART "): np.frombuffer(at, "<u8").astype(np.int64)
                for name, at in transfers
            },
        )

    def _peer(self, scenario: Scenario) -> PeerRun | None:
        """The peer's robot, scenario and image; raises as for the first brick's."""
        if scenario.peer is None:
            return None
        project = scenario.peer.project
        robot = read_robot(project)
        chosen = read_scenario(scenario_path(project, scenario.peer.scenario), robot)
        return PeerRun(robot, chosen, build_image(Workspace.of(project), robot, "ram").image)

    def _scenario_run(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        callback: Callback | None,
        fields: Mapping[str, Any] | None = None,
    ) -> ScenarioRun:
        options = self._snapshots if fields is None else SnapshotOptions()
        if options.start is not None:
            brick, inputs = options.start.restore(self._module, image), options.start.inputs
        else:
            brick = self._assemble(robot, scenario, image, fields=fields)
            inputs = self._schedule(brick, scenario)
            self._probe(brick, robot, image)
            brick.trace_calls(list(WATCHED))
        pins = expected_pins(scenario.expectations)
        if pins and (options.start or options.save):
            raise UsageError("a snapshot contains no record of pins; omit expectations about pins")
        if pins:
            brick.log_pins(pins)
        run = ScenarioRun(brick, robot, scenario, image, callback, self._module.InputError, inputs)
        if options.save is not None:
            probes = tuple((setpoint.symbol, setpoint.type) for setpoint in robot.setpoints)
            configuration = self._configuration(robot, scenario, None)
            run.save_snapshot_later(options, configuration, () if image.bare else probes)
        return run

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
        if self._flow_points is not None and fields is None:
            brick.count_flow(self._flow_points)
            brick.log_transfers()
            brick.profile(list(self._profile))
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
