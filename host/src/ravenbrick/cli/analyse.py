# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick analyse`: every response time bounded before the run, beside what the run showed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import process_time
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import play, project_scenarios
from ravenbrick.errors import UsageError
from ravenbrick.target.bounds_file import image_digest
from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.elf_image import ElfImage, read_image
from ravenbrick.target.robot import Robot, read_robot
from ravenbrick.target.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.target.virtual import VirtualTarget
from ravenbrick.target.workspace import Workspace
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.chain import ChainDelay, LoopFigures, chain_delay
from ravenbrick.timing.explanation import why_apart
from ravenbrick.timing.facts import Facts, read_facts
from ravenbrick.timing.figures import (
    margin_figure,
    spreads_figure,
    terms_figure,
    windows_figure,
)
from ravenbrick.timing.hunt import hunt, largest
from ravenbrick.timing.long_run import long_run
from ravenbrick.timing.observed import (
    Observed,
    check_bounds,
    check_event_rates,
    check_interrupt_rates,
    observe,
)
from ravenbrick.timing.report import (
    EVENT_HEAD,
    INTERRUPT_HEAD,
    SHORT_HEAD,
    event_rows,
    interrupt_rows,
    short_rows,
    write_timing_report,
)
from ravenbrick.timing.result import advice, microseconds, result_of
from ravenbrick.timing.task_set_file import task_set_text
from ravenbrick.trace.design import read_design
from ravenbrick.trace.measures import check_survival
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.task_set import check_task_set

__all__ = ["analyse_command"]

ELABORATED_MS = 300


def _scenario(workspace: Workspace, robot: Robot, name: str | None) -> Scenario:
    if name is not None:
        return read_scenario(scenario_path(workspace.project, name), robot)
    scenarios = project_scenarios(workspace, robot)
    if not scenarios:
        raise UsageError(f"'{workspace.project}' has no scenario; add one below scenarios/")
    return scenarios[0]


def _bounds(robot: Robot, scenario: Scenario, image: ElfImage, facts: Facts) -> Analysis:
    brick = VirtualTarget().prepare(robot, scenario, image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(min(ELABORATED_MS, scenario.duration_ms)))
    return analyse(robot, image, brick, facts)


def _recording(
    workspace: Workspace, robot: Robot, scenario: Scenario, image: ElfImage, reporter: Reporter
) -> Recording:
    with reporter.step(f"run '{scenario.name}'") as step:
        recording = play(workspace, robot, scenario, image, VirtualTarget(), step.progress)
        step.note = f"{recording.clock.seconds(recording.stop.at_cycles):.1f} s of the brick"
    check_survival(scenario, recording)
    check_task_set(robot, recording)
    return recording


def _loop(workspace: Workspace, robot: Robot) -> LoopFigures | None:
    """The loop that design.py left behind, if it says what is needed; speeds in volts."""
    if not workspace.design_file.is_file() or not robot.setpoints:
        return None
    found = read_design(workspace.design_file).figures
    keys = (
        "plant_gain",
        "plant_time_constant",
        "proportional_gain",
        "integral_gain",
        "sample_time",
        "estimator_window",
        "actuator_delay",
        "phase_margin_deg",
    )
    if not all(key in found for key in keys):
        return None
    gain, *rest = (found[key] for key in keys)
    time_constant, proportional, integral, sample_time, window, delay, margin = rest
    speed = gain / robot.setpoints[0].scale.value
    return LoopFigures(
        speed, time_constant, proportional, integral, sample_time, int(window), delay, margin
    )


def _chain_line(chain: ChainDelay) -> str:
    def shown(cycles: int | None) -> str:
        return "unknown" if cycles is None else f"{microseconds(cycles) / 1000:.3f} ms"

    return (
        f"{chain.name}: at most {shown(chain.edge_bound_cycles)}, "
        f"seen {shown(chain.edge_max_cycles)}; from the sample at most "
        f"{shown(chain.sample_bound_cycles)}, seen "
        f"{shown(chain.sample_min_cycles)} to {shown(chain.sample_max_cycles)}"
    )


def _search(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    recording: Recording,
    attempts: int,
    hours: float,
    reporter: Reporter,
) -> tuple[dict[str, Observed], dict[str, Observed], dict[str, Any]]:
    """The largest values of the run and of a hunt, in all and undisturbed, and what hunt and long
    run showed."""
    seen = calm = observe(robot, recording)
    more: dict[str, Any] = {}
    if attempts:
        with reporter.step(f"hunt in {attempts} variants of '{scenario.name}'") as step:
            found = hunt(robot, scenario, image, attempts, step.progress)
        seen, calm = largest(seen, found.catches), largest(seen, found.calm)
        more["hunt"] = found.plain()
    if hours:
        with reporter.step(f"observe '{scenario.name}' over and over") as step:
            run = long_run(robot, scenario, image, 3600 * hours, step.progress)
            step.note = f"{run.seconds:.0f} s of the brick, {run.events} events"
        more["long_run"] = run.plain()
    return seen, calm, more


def _print(reporter: Reporter, result: dict[str, Any], chains: Sequence[ChainDelay]) -> None:
    reporter.print("cycles and bytes; deadlines in us")
    reporter.table(SHORT_HEAD, short_rows(result))
    reporter.table(INTERRUPT_HEAD, interrupt_rows(result), left=("handler",))
    if result["timing_events"]:
        reporter.table(EVENT_HEAD, event_rows(result))
    reporter.print("schedulable" if result["schedulable"] else "NOT schedulable")
    for chain in chains:
        reporter.print(f"  {_chain_line(chain)}")
    for line in advice(result):
        reporter.print(f"  {line}")


@command("ravenbrick analyse examples/vehicle --scenario drive")
def analyse_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with robot.toml.")],
    scenario: Annotated[
        str | None, typer.Option(help="What is run beside the bounds; the first unless given.")
    ] = None,
    image: Annotated[
        ImageChoice, typer.Option(help="RAM below the boot monitor, or flash.")
    ] = ImageChoice.RAM,
    hunt_attempts: Annotated[
        int,
        typer.Option("--hunt", min=0, help="Variants of the scenario tried for long responses."),
    ] = 0,
    hours: Annotated[
        float, typer.Option(min=0.0, help="Virtual time observed besides, the scenario repeated.")
    ] = 0.0,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    """Bound execution and response times from the binary and show them beside a run."""
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    reporter = Reporter(json_output)
    facts = read_facts(robot)
    elf = read_image(workspace.image(image.kind, robot.name))
    chosen = _scenario(workspace, robot, scenario)
    with reporter.step("bound execution and response times"):
        begin = process_time()
        analysis = _bounds(robot, chosen, elf, facts)
        effort = {"seconds": round(process_time() - begin, 1), "text_bytes": elf.size_of("text")}
    recording = _recording(workspace, robot, chosen, elf, reporter)
    check_interrupt_rates(robot, facts, recording)
    check_event_rates(robot, facts, recording)
    seen, calm, more = _search(robot, chosen, elf, recording, hunt_attempts, hours, reporter)
    check_bounds(analysis, seen, more.get("long_run"))
    chains = [chain_delay(analysis, recording, chain) for chain in facts.chains]
    result = {
        "scenario": chosen.name,
        "image_sha256": image_digest(elf),
        "effort": effort,
        **result_of(analysis, seen, calm),
        "chains": [{**vars(chain), "jitter_cycles": chain.jitter_cycles} for chain in chains],
        **more,
    }
    with reporter.step("write the report") as step:
        figures = [("Bounds by term", terms_figure(result))]
        if hours:
            figures.append(("Responses and jitter of the long run", spreads_figure(result)))
        for timing in analysis.tasks:
            figure = windows_figure(robot, analysis, recording, timing.task.name)
            if figure is not None:
                figures.append((f"Worst windows of {timing.task.name}", figure))
        loop = _loop(workspace, robot)
        if loop is not None:
            figures += [(f"What delay costs: {c.name}", margin_figure(loop, c)) for c in chains]
        report = write_timing_report(robot.name, result, figures, workspace.results)
        step.note = workspace.shown(report)
        task_file = workspace.results / "taskset.toml"
        task_file.write_text(task_set_text(robot.name, analysis.task_set, analysis.overheads))
    _print(reporter, result, chains)
    return {
        **result,
        "advice": advice(result),
        "why_apart": why_apart(result),
        "report": str(report),
        "task_set": str(task_file),
    }
