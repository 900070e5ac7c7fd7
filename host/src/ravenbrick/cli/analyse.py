# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick analyse`: bounds of execution and response times, compared with a run."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.build import ImageChoice, ImageOption
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image, project_scenarios, run_scenario
from ravenbrick.cli.timing_profile import TimingProfile, TimingProfileOption
from ravenbrick.errors import DeadlineError, UsageError, shown_path
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.chain import ChainDelay, chain_delay
from ravenbrick.timing.facts.counted_facts import points_text
from ravenbrick.timing.facts.facts import Facts, read_facts
from ravenbrick.timing.facts.unmatched_facts import check_facts
from ravenbrick.timing.initial_state import elaborated
from ravenbrick.timing.observation.fact_counts import (
    check_facts_of_run,
    fact_counts,
    left_modes,
)
from ravenbrick.timing.observation.job_facts import FactCount
from ravenbrick.timing.observation.job_path import paths_of_longest_jobs
from ravenbrick.timing.observation.long_run import long_run
from ravenbrick.timing.observation.observed import (
    Observed,
    check_bounds,
    check_event_rates,
    check_job_kinds,
    observe,
    outside_counts,
    used_stacks,
    worst_job,
)
from ravenbrick.timing.observation.worst_case_search import WorstSample, largest, search_worst_case
from ravenbrick.timing.results.explanation import overestimation
from ravenbrick.timing.results.figures import (
    margin_figure,
    spreads_figure,
    terms_figure,
    windows_figure,
)
from ravenbrick.timing.results.phase_margin import Loop, margin_words, margins_of, read_loop
from ravenbrick.timing.results.report import (
    EVENT_HEAD,
    INTERRUPT_HEAD,
    SHORT_HEAD,
    event_rows,
    interrupt_rows,
    short_rows,
    write_timing_report,
)
from ravenbrick.timing.results.result import advice, microseconds, result_of
from ravenbrick.timing.results.stacks import MAY_OVERFLOW, check_stacks
from ravenbrick.timing.results.task_set_file import task_set_text
from ravenbrick.timing.results.worst_path import worst_paths
from ravenbrick.timing.task_set.scheduled_interrupts import STOLEN_CYCLES
from ravenbrick.trace.measures import check_survival
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.task_set import check_shortest_interval, check_task_set

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["analyse_command", "checked"]


def _scenario(workspace: Workspace, robot: Robot, name: str | None) -> Scenario:
    if name is not None:
        return read_scenario(scenario_path(robot.directory, name), robot)
    scenarios = project_scenarios(robot)
    if not scenarios:
        raise UsageError(f"'{workspace.project}' has no scenario; add one below scenarios/")
    return scenarios[0]


def _recording(
    workspace: Workspace,
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    target: VirtualTarget,
    outside: Collection[str],
    reporter: Reporter,
) -> Recording:
    with reporter.step(f"run '{scenario.name}'") as step:
        recording = run_scenario(workspace, robot, scenario, image, target, step.progress)
        step.note = f"{recording.clock.seconds(recording.stop.at_cycles):.1f} s of the brick"
    check_survival(scenario, recording)
    check_task_set(robot, recording, outside=outside)
    return recording


def _chain_line(chain: ChainDelay) -> str:
    def shown(cycles: int | None) -> str:
        return "unknown" if cycles is None else f"{microseconds(cycles) / 1000:.3f} ms"

    seen = "" if chain.edge_max_cycles is None else f", observed {shown(chain.edge_max_cycles)}"
    return (
        f"{chain.name}: at most {shown(chain.edge_bound_cycles)}{seen}; from the sample at most "
        f"{shown(chain.sample_bound_cycles)}, observed "
        f"{shown(chain.sample_min_cycles)} to {shown(chain.sample_max_cycles)}"
    )


@dataclass(frozen=True)
class _Search:
    """The largest values of the run and of a worst-case search, in all and undisturbed, the worst
    samples, those without disturbances, those in which a fact was exceeded, and the results of
    search and long run."""

    seen: dict[str, Observed]
    undisturbed: dict[str, Observed]
    worst: Mapping[str, WorstSample]
    faultless: Mapping[str, WorstSample]
    exceeded: Mapping[str, WorstSample]
    more: dict[str, Any]


def _search(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    analysis: Analysis,
    recording: Recording,
    wanted: tuple[int, float, int],
    target: VirtualTarget,
    reporter: Reporter,
) -> _Search:
    """`wanted` are variants to search, hours to observe, and cycles that a transfer takes."""
    variants, hours, transfer_cycles = wanted
    outside = analysis.outside
    seen = undisturbed = observe(robot, recording, transfer_cycles, outside)
    worst: Mapping[str, WorstSample] = {}
    faultless: Mapping[str, WorstSample] = {}
    exceeded: Mapping[str, WorstSample] = {}
    more: dict[str, Any] = {}
    if variants:
        with reporter.step(f"search in {variants} variants of '{scenario.name}'") as step:
            found = search_worst_case(
                robot,
                scenario,
                image,
                variants,
                step.progress,
                target=target,
                transfer_cycles=transfer_cycles,
                outside=outside,
                facts_counted=[
                    n
                    for n, fact in enumerate(analysis.counted)
                    if not fact.mode and fact.turn is None
                ],
            )
        worst = found.worst
        faultless, exceeded = found.undisturbed, found.exceeded
        seen, undisturbed = largest(seen, worst), largest(seen, found.undisturbed)
        more["worst_case_search"] = found.plain()
    if hours:
        with reporter.step(f"observe '{scenario.name}' over and over") as step:
            seconds = 3600 * hours
            run = long_run(
                robot, scenario, image, seconds, step.progress, target=target, outside=outside
            )
            step.note = f"{run.seconds:.0f} s of the brick, {run.events} events"
        more["long_run"] = run.plain()
    return _Search(seen, undisturbed, worst, faultless, exceeded, more)


def _of_image(facts: Facts, image: ElfImage) -> Facts:
    """The facts that concern this program; one that matches nothing is refused."""
    check_facts(facts, image)
    return facts.of_image(image)


def _target(profile: TimingProfile, analysis: Analysis) -> VirtualTarget:
    """A brick that counts what facts say."""
    points = points_text(analysis.counted)
    return VirtualTarget(settings=profile.settings, flow_points=points)


def _check_facts(
    robot: Robot,
    facts: Facts,
    image: ElfImage,
    analysis: Analysis,
    recording: Recording,
    found: _Search,
    transfer_cycles: int,
) -> tuple[list[FactCount], dict[str, str]]:
    """What was counted in the run, and modes that the run or a variant without disturbances leaves.
    Raises `ExecutionTimeError` for a fact that the run or a sample of the search contradicts."""

    def named(samples: Iterable[WorstSample]) -> dict[str, Recording | None]:
        return {
            f"variant {one.variant} of '{recording.scenario}'": one.recording for one in samples
        }

    own = f"the run '{recording.scenario}'"
    faultless = {own: recording, **named(found.faultless.values())}
    runs = faultless | named([*found.worst.values(), *found.exceeded.values()])
    counts, left = [], dict[str, str]()
    for what, run in runs.items():
        if run is not None:
            counted = fact_counts(robot, facts, image, analysis.counted, run, analysis.requests)
            counted += outside_counts(robot, facts, analysis, run, transfer_cycles)
            counts.append(counted)
            check_facts_of_run(counted, what)
            if what in faultless:
                left = left_modes(counted, what) | left
            check_event_rates(robot, facts, run)
            check_job_kinds(robot, analysis, run, transfer_cycles)
            for timing in analysis.tasks:
                if timing.task.name in analysis.outside:
                    continue  # its releases are counted with its code outside of jobs
                waits_us = microseconds(timing.suspension_cycles)
                waits = (timing.releases * (1 + timing.suspension_count) - 1, waits_us)
                check_shortest_interval(robot, run, timing.task.name, *waits)
    return counts[0], left


def _chain_result(chain: ChainDelay, loop: Loop | None) -> dict[str, Any]:
    margins = None if loop is None else margins_of(loop, chain)
    return {**vars(chain), "jitter_cycles": chain.jitter_cycles, "phase_margin": margins}


def _window(
    robot: Robot,
    analysis: Analysis,
    recording: Recording,
    worst: Mapping[str, WorstSample],
    name: str,
) -> Figure | None:
    """From the longest response of run and search."""
    sample, own = worst.get(name), worst_job(robot, recording, name, analysis.outside)
    longest = 0 if own is None else own.response_time_cycles or 0
    if sample is None or sample.recording is None or sample.response_cycles <= longest:
        return windows_figure(robot, analysis, recording, name)
    what = f"variant {sample.variant} of the worst-case search"
    return windows_figure(robot, analysis, sample.recording, name, what)


def _figures(
    robot: Robot, analysis: Analysis, recording: Recording, found: _Search, result: dict[str, Any]
) -> list[tuple[str, Figure]]:
    """Pictures of tasks with their captions."""
    figures = [("Bounds by term", terms_figure(result))]
    if "long_run" in result:
        figures.append(("Responses and jitter of the long run", spreads_figure(result)))
    for timing in analysis.tasks:
        figure = _window(robot, analysis, recording, found.worst, timing.task.name)
        if figure is not None:
            figures.append((f"Worst windows of {timing.task.name}", figure))
    return figures


def _chain_notes(
    chains: Sequence[ChainDelay], result: dict[str, Any], directory: Path
) -> list[str]:
    """Delays of the chains, and the phase margins with them."""
    notes = []
    for chain, found in zip(chains, result["chains"], strict=True):
        margins = found["phase_margin"]
        advised = f"run 'ravenbrick design {directory}' to see the phase margin"
        notes += [_chain_line(chain), margin_words(margins) if margins else advised]
    return notes


def _print(reporter: Reporter, result: dict[str, Any], notes: Sequence[str]) -> None:
    reporter.print(f"cycles and bytes; deadlines in us; {result['timing']} timing")
    reporter.table(SHORT_HEAD, short_rows(result))
    reporter.table(INTERRUPT_HEAD, interrupt_rows(result), left=("handler",))
    if result["timing_events"]:
        reporter.table(EVENT_HEAD, event_rows(result))
    for line in result["scope"]:
        reporter.print(line)
    if result["schedulable"]:
        reporter.print("schedulable")
    for line in notes:
        reporter.print(f"  {line}")
    if _holds(result):
        for line in advice(result):
            reporter.print(f"  {line}")


def _holds(result: dict[str, Any]) -> bool:
    return result["schedulable"] and result["stacks_suffice"] is not False


def checked(result: dict[str, Any]) -> dict[str, Any]:
    """The result; raises `DeadlineError` with it when a deadline can be missed, or a stack may
    overflow or has no bound."""
    if _holds(result):
        return result
    if not result["schedulable"]:
        verdict = "NOT schedulable"
    elif any(stack["verdict"] == MAY_OVERFLOW for stack in result["stacks"]):
        verdict = "a stack may overflow"
    else:
        verdict = "a stack is not shown to suffice"
    first, *others = result["advice"]
    error = DeadlineError(f"{verdict}: {first}", detail="\n".join(others))
    error.data = result
    raise error


@command("ravenbrick analyse examples/vehicle --scenario drive")
def analyse_command(
    directory: ProjectArgument,
    scenario: Annotated[
        str | None, typer.Option(help="Scenario to simulate for comparison (default: the first).")
    ] = None,
    image: ImageOption = ImageChoice.RAM,
    search_variants: Annotated[
        int,
        typer.Option(
            "--worst-case-search", min=0, help="Number of input variants in the worst-case search."
        ),
    ] = 0,
    hours: Annotated[
        float,
        typer.Option(
            min=0.0, help="Additional observation in virtual hours, with the scenario repeated."
        ),
    ] = 0.0,
    timing_profile: TimingProfileOption = TimingProfile.NOMINAL,
    margins: Annotated[
        bool, typer.Option(help="Margins of execution times and periods, half of the effort.")
    ] = True,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    facts, reporter = read_facts(robot), Reporter(json_output)
    elf = project_image(workspace, robot, image.kind, reporter)
    facts = _of_image(facts, elf)
    chosen = _scenario(workspace, robot, scenario)
    with reporter.step("bound execution and response times"):
        begin = process_time()
        brick = elaborated(robot, chosen, elf)
        analysis = analyse(robot, elf, brick, facts, timing_profile.value)
        effort = {"seconds": round(process_time() - begin, 1), "text_bytes": elf.size_of("text")}
    target = _target(timing_profile, analysis)
    recording = _recording(workspace, robot, chosen, elf, target, analysis.outside, reporter)
    wanted = (search_variants, hours, STOLEN_CYCLES[timing_profile.value])
    found = _search(robot, chosen, elf, analysis, recording, wanted, target, reporter)
    counts, left = _check_facts(robot, facts, elf, analysis, recording, found, wanted[2])
    check_bounds(analysis, found.seen, found.more.get("long_run"))
    loop = read_loop(workspace.design_file)
    chains = [chain_delay(analysis, recording, chain) for chain in facts.chains]
    result = {
        "scenario": chosen.name,
        "image_sha256": elf.digest,
        "effort": effort,
        **result_of(
            analysis, found.seen, found.undisturbed, used_stacks(recording), left, margins=margins
        ),
        "chains": [_chain_result(chain, loop) for chain in chains],
        "facts": [count.plain() for count in counts],
        **found.more,
    }
    check_stacks(result["stacks"])
    notes = _chain_notes(chains, result, directory)
    notes += [f"mode '{mode}': {words}" for mode, words in left.items()]
    with reporter.step(f"run '{chosen.name}' again for the paths of its longest jobs"):
        runs = paths_of_longest_jobs(
            robot, chosen, elf, target, recording, wanted[2], analysis.outside
        )
    with reporter.step("write the report") as step:
        paths = worst_paths(analysis.tasks, elf, runs)
        figures = _figures(robot, analysis, recording, found, result)
        if loop is not None:
            figures += [
                (f"Phase margin against delay: {c.name}", margin_figure(loop, c)) for c in chains
            ]
        report = write_timing_report(robot.name, result, figures, notes, paths, workspace.results)
        step.note = shown_path(report)
        task_file = workspace.results / "taskset.toml"
        atomic_write(task_file, task_set_text(robot.name, analysis.task_set, analysis.overheads))
    _print(reporter, result, notes)
    return checked(
        {
            **result,
            "advice": advice(result),
            "overestimation": overestimation(result),
            "report": str(report),
            "task_set": str(task_file),
        }
    )
