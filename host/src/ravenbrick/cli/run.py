# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick run`: one scenario on the virtual brick, for people and for graders."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.brick.fmu_body import FmuBody
from ravenbrick.brick.run import PeerRun, VirtualTarget
from ravenbrick.brick.snapshot import Snapshot, SnapshotOptions
from ravenbrick.brick.stimulus_callback import Callback, load_callback
from ravenbrick.cli.app import JsonOption, ProjectArgument, ScenarioArgument, command
from ravenbrick.cli.build import DebugOption, ElfOption, ImageChoice, ImageOption, build_kind
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import TASK_HEAD, keep_peer, project_image, read_run, task_rows
from ravenbrick.cli.timing_profile import TimingProfile, TimingProfileOption
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.image.elf import DEBUGGING_BUILD, ElfImage, read_binary, read_image
from ravenbrick.project.criteria_file import read_expectations_of
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import (
    Scenario,
    check_expectations,
    check_stimuli,
    input_check,
    read_scenario,
    scenario_path,
)
from ravenbrick.project.stimuli import Channels, read_stimulus
from ravenbrick.project.stimuli.run_file import read_run_file
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.measures import require_criteria
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.summary import Run, run_summary

__all__ = ["run_command"]


class Engine(StrEnum):
    """What executes instructions."""

    FAST = "fast"
    BLOCKS = "blocks"
    REFERENCE = "reference"


SaveSnapshotOption = Annotated[Path | None, typer.Option(help="File for a snapshot.")]
SoundOption = Annotated[
    Path | None, typer.Option(help="WAV file for the sound of the loudspeaker.")
]


def _with_options(
    scenario: Scenario, robot: Robot, expect: list[str], stimulus: list[Path]
) -> Scenario:
    """The scenario with what the command line adds; raises as for the scenario's own."""
    expectations = [e for text in expect for e in read_expectations_of(text)]
    channels = Channels(input_check(robot))
    stimuli = [t for file in stimulus for t in read_stimulus(file, MASTER_CLOCK, channels)]
    extended = replace(
        scenario,
        stimuli=(*scenario.stimuli, *stimuli),
        expectations=(*scenario.expectations, *expectations),
    )
    check_stimuli(extended)
    check_expectations(extended)
    return extended


def _replayed(scenario: Scenario, replay: Path) -> tuple[Scenario, str]:
    """The scenario with the inputs of a recording in place of its own, and the old digest."""
    recording = Recording.load(replay)
    if recording.scenario != scenario.name:
        raise UsageError(
            f"{replay}: is a recording of the scenario '{recording.scenario}', not of "
            f"'{scenario.name}'; name that scenario"
        )
    inputs = tuple(replace(timed, place=f"{replay}:1") for timed in recording.inputs)
    return replace(scenario, inputs=(), stimuli=inputs), recording.digest


def _from_page(robot: Robot, scenario: Scenario, replay: Path) -> tuple[Scenario, str]:
    """The scenario's surroundings with inputs and end of a run of the page, and its digest."""
    run = read_run_file(replay)
    if run.configuration != brick_configuration(robot, scenario, MASTER_CLOCK):
        raise UsageError(
            f"{replay}: was run in another environment than that of '{scenario.name}' (sensors, "
            "robot.toml, seed); name the scenario of that run, or open the file in the page"
        )
    played = replace(
        scenario,
        inputs=(),
        stimuli=run.inputs,
        duration_ms=run.until_ms,
        pictures_ms=(),
        criteria=(),
        expectations=(),
        straight=None,
        step=None,
    )
    return played, run.digest


def _with_inputs(
    scenario: Scenario, robot: Robot, expect: list[str], stimulus: list[Path], replay: Path | None
) -> tuple[Scenario, str | None]:
    """What the command line adds or replays, and the digest of what is replayed."""
    original: str | None = None
    if replay is not None and replay.suffix == ".json":
        scenario, original = _from_page(robot, scenario, replay)
    scenario = _with_options(scenario, robot, expect, stimulus)
    if replay is not None and original is None:
        scenario, original = _replayed(scenario, replay)
    return scenario, original


def _same_as_replayed(
    original: str | None, recording: Recording, reporter: Reporter
) -> dict[str, Any]:
    if original is None:
        return {}
    same = original == recording.digest
    reporter.print(
        "the same run again" if same else "the trace digest DIFFERS from the replayed one"
    )
    return {"same_as_replayed": same}


def _callback(text: str | None, period_ms: int, replay: Path | None) -> Callback | None:
    if text is None:
        return None
    if replay is not None:
        raise UsageError("--replay contains the inputs of the callback; omit --callback")
    return load_callback(text, period_ms)


def _peer_run(peer: PeerRun | None, reporter: Reporter) -> Run | None:
    """The run of the scenario's peer, kept, measured and shown."""
    recording = keep_peer(peer)
    if peer is None or recording is None:
        return None
    run = read_run(peer.robot, peer.scenario, recording)
    reporter.print(f"\nsecond brick: '{peer.scenario.name}' of '{peer.robot.name}'")
    _show(run, reporter)
    return run


def _outcome(run: Run, beside: Run | None, kept: Path) -> dict[str, Any]:
    answer: dict[str, Any] = {**run_summary(run), "recording": str(kept)}
    return answer if beside is None else {**answer, "peer": run_summary(beside)}


def _snapshot_options(
    scenario: Scenario, body: Path | None, save: Path | None, at_s: float, start: Path | None
) -> SnapshotOptions:
    if (save or start) and (body or scenario.peer or scenario.monitor):
        raise UsageError(
            "a snapshot contains one brick: omit --body and use a scenario without peer and monitor"
        )
    at_ms = round(1000 * at_s)
    if save is not None and at_ms > scenario.duration_ms:
        raise UsageError(f"--snapshot-at {at_s:g}: the scenario ends before that")
    return SnapshotOptions(None if start is None else Snapshot.load(start), save, at_ms)


def _show(run: Run, reporter: Reporter) -> None:
    reporter.table(TASK_HEAD, task_rows(run))
    rows = [[r.label, r.shown, "met" if r.met else "not met"] for r in run.criteria]
    reporter.table(("criterion", "value", ""), rows)
    for warning in run.recording.warnings:
        reporter.print(f"warning: {warning}")


class LoadPlace(StrEnum):
    """Memory into which an image without headers is loaded."""

    RAM = "ram"
    WHOLE_RAM = "whole-ram"
    FLASH = "flash"


def _given_image(binary: Path | None, at: LoadPlace, elf: Path | None) -> ElfImage | None:
    """The image of the options; None for the project's own."""
    if binary:
        return read_binary(binary, at.value)
    return read_image(elf) if elf else None


@command("ravenbrick run examples/vehicle drive --expect 'lcd shows \"stopped\"'")
def run_command(
    directory: ProjectArgument,
    scenario: ScenarioArgument,
    elf: ElfOption = None,
    image: ImageOption = ImageChoice.RAM,
    debug: DebugOption = False,
    expect: Annotated[
        list[str] | None,
        typer.Option(help="Expectation: a sentence, or a file of sentences; may be repeated."),
    ] = None,
    stimulus: Annotated[
        list[Path] | None,
        typer.Option(help="Inputs over time (.csv, .vcd, run file of the page); may be repeated."),
    ] = None,
    callback: Annotated[
        str | None, typer.Option(help="Python function that provides inputs, as MODULE:FUNCTION.")
    ] = None,
    callback_period_ms: Annotated[
        int, typer.Option(min=1, help="Period of the callback in milliseconds.")
    ] = 10,
    replay: Annotated[
        Path | None, typer.Option(help="Recording or run file of the page to replay.")
    ] = None,
    binary: Annotated[Path | None, typer.Option("--bin", help="Raw binary image.")] = None,
    at: Annotated[
        LoadPlace,
        typer.Option(help="Load address of --bin: 0x202000, 0x200000 (by JTAG) or 0x100000."),
    ] = LoadPlace.FLASH,
    timing_profile: TimingProfileOption = TimingProfile.NOMINAL,
    engine: Annotated[
        Engine, typer.Option(help="Execution engine; 'make native' makes 'fast' faster.")
    ] = Engine.FAST,
    body: Annotated[Path | None, typer.Option(help="FMU that replaces the robot's body.")] = None,
    save_snapshot: SaveSnapshotOption = None,
    snapshot_at: Annotated[float, typer.Option(min=0.005, help="Snapshot time in s.")] = 1.0,
    from_snapshot: Annotated[
        Path | None, typer.Option(help="Snapshot of the same image to start from.")
    ] = None,
    sound: SoundOption = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    chosen = read_scenario(scenario_path(directory, scenario), robot)
    replay, scenario_ms = replay and workspace.named_recording(replay), chosen.duration_ms
    chosen, original = _with_inputs(chosen, robot, expect or [], stimulus or [], replay)
    target = VirtualTarget(
        callback=_callback(callback, callback_period_ms, replay),
        settings={"engine": engine.value, **timing_profile.settings},
        body=FmuBody(body) if body else None,
        snapshots=_snapshot_options(chosen, body, save_snapshot, snapshot_at, from_snapshot),
        sound=sound,
    )
    reporter = Reporter(json_output)
    loaded = _given_image(binary, at, elf)
    if loaded is None:
        loaded = project_image(workspace, robot, build_kind(image, debug), reporter)
    kept = workspace.recording(chosen.name, loaded.build)
    with reporter.step(f"run '{chosen.name}'") as step:
        recording, peer = target.run_with_peer(robot, chosen, loaded, step.progress)
        recording.save(kept)
        run = read_run(robot, chosen, recording, whole=chosen.duration_ms >= scenario_ms)
        stop = recording.stop
        words = f": {stop.message}" if stop.message else ""
        step.note = f"{recording.clock.seconds(stop.at_cycles):.3f} s on the brick{words}"
    _show(run, reporter)
    beside = _peer_run(peer, reporter)
    label = f" ({DEBUGGING_BUILD})" if loaded.build == "debug" else ""
    reporter.print(f"recording: {shown_path(kept)}{label}")
    answer = {**_outcome(run, beside, kept), "build": loaded.build}
    answer |= _same_as_replayed(original, recording, reporter)
    require_criteria([*run.criteria, *(beside.criteria if beside is not None else ())])
    return answer
