# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures: critical instant beside the worst window of the run; phase margin against delay."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ravenbrick.project.robot import Robot
from ravenbrick.report.plots.style import COLOURS, legend, new_figure, task_colour
from ravenbrick.schedule.model import TaskSet
from ravenbrick.schedule.releases import critical_instant
from ravenbrick.schedule.simulation import simulate
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.chain import ChainDelay
from ravenbrick.timing.observation.observed import worst_job
from ravenbrick.timing.results.phase_margin import Loop, phase_margin
from ravenbrick.timing.results.result import microseconds
from ravenbrick.timing.task_set.scheduled_tasks import TaskTiming
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import INTERRUPT_OWNER, stretches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["margin_figure", "spreads_figure", "terms_figure", "windows_figure"]

TERMS = (
    ("own_cycles", "own", "#1f5fa8"),
    ("suspension_cycles", "waiting inside", "#a9c2df"),
    ("interference_cycles", "interference", "#8e4585"),
    ("interrupts_cycles", "interrupts", "#8a8a8a"),
    ("blocking_cycles", "blocking", "#b3372f"),
    ("overheads_cycles", "overheads", "#c9b458"),
    ("release_jitter_cycles", "release jitter", "#4a6b2a"),
)


def terms_figure(result: dict[str, Any]) -> Figure:
    """Each bound as shares of its terms with the observed maximum as a mark, beside the share of
    the deadline that bound and observed maximum take."""
    from matplotlib.figure import Figure  # slow to load

    tasks = [task for task in reversed(result["tasks"]) if task["terms"] is not None]
    figure = Figure(figsize=(10.0, 1.3 + 0.6 * len(tasks)), layout="constrained")
    shares, times = figure.subplots(1, 2, sharey=True, width_ratios=(5, 3))
    for axis in (shares, times):
        axis.grid(visible=True, axis="x", color=COLOURS["grid"], linewidth=0.7)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
        axis.tick_params(labelsize=9)
    _share_bars(shares, tasks)
    _deadline_bars(times, tasks)
    shares.set_yticks(range(len(tasks)), [task["name"] for task in tasks])
    handles, labels = shares.get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, fontsize=8.5, ncols=8, loc="outside lower center")
    return figure


def _share_bars(axis: Axes, tasks: list[dict[str, Any]]) -> None:
    """Terms of each bound, and the observed maximum."""
    shown = [term for term in TERMS if any(task["terms"][term[0]] for task in tasks)]
    left = [0.0] * len(tasks)
    for key, label, colour in shown:
        widths = [100 * task["terms"][key] / task["response_bound_cycles"] for task in tasks]
        axis.barh(range(len(tasks)), widths, left=left, height=0.5, color=colour, label=label)
        left = [before + width for before, width in zip(left, widths, strict=True)]
    name: str | None = "observed maximum"
    for row, task in enumerate(tasks):
        if task["observed"] is not None:
            seen = 100 * task["observed"]["response_cycles"] / task["response_bound_cycles"]
            axis.plot([seen, seen], [row - 0.32, row + 0.32], color="#000000", label=name)
            name = None
    axis.set_xlim(0, max([102.0, *left]))
    axis.set_xlabel("share of the response-time bound (%)")


def _deadline_bars(axis: Axes, tasks: list[dict[str, Any]]) -> None:
    """Bounds and observed maxima over the deadline, on a log scale."""
    for row, task in enumerate(tasks):
        bound = microseconds(task["response_bound_cycles"])
        share = 100 * bound / task["deadline_us"]
        colour = COLOURS["deadline"] if share > 100 else COLOURS["raw"]
        axis.barh(row, share, height=0.5, color=colour)
        text = f"{bound:.0f} of {task['deadline_us']} us"
        axis.text(0.012, row + 0.28, text, va="bottom", fontsize=8)
        if task["observed"] is not None:
            seen = 100 * microseconds(task["observed"]["response_cycles"]) / task["deadline_us"]
            axis.plot([seen, seen], [row - 0.32, row + 0.32], color="#000000")
    axis.axvline(100, color=COLOURS["deadline"], linestyle="--")
    axis.set_xscale("log")
    highest = max(axis.get_xlim()[1], 150)
    axis.set_xlim(0.01, highest)
    axis.set_xticks([0.01, 0.1, 1, 10, 100], ["0.01", "0.1", "1", "10", "100"])
    axis.set_xlabel("share of the deadline (%)")


def _in_window(analysis: Analysis, met: dict[str, Any], length: float) -> TaskSet:
    """The task set with what comes of each interrupt in the window as one burst."""
    seldom = 2 * int(length) + 2
    interrupts = (task for task in analysis.task_set if task.release == "interrupt")
    bursts = [
        replace(task, wcet=met[task.name], period=seldom, deadline=seldom, limits=())
        for task in interrupts
        if met.get(task.name)
    ]
    tasks = (task for task in analysis.task_set if task.release != "interrupt")
    return TaskSet((*bursts, *tasks))


def _critical(
    axis: Axes, analysis: Analysis, lanes: dict[str, int], timing: TaskTiming, length: float
) -> None:
    """The blocking first, then all jobs as early and as long as they can be."""
    blocking = timing.blocking.cycles * (1 + timing.suspension_count)
    if blocking:
        lane = lanes.get(timing.blocking.task, lanes["interrupts"])
        width = microseconds(blocking)
        axis.barh(lane, width, height=0.6, color=COLOURS["deadline"], label="blocking")
    terms = analysis.bounds[timing.task.name].terms
    met = {} if terms is None else {part.task: part.time for part in terms.interference}
    run = simulate(_in_window(analysis, met, length), int(length) + 1, releases=critical_instant)
    hidden = {t.task.name for t in analysis.tasks if t.task.priority < timing.task.priority}
    for part in run.intervals:
        if part.task in hidden:
            continue
        lane = lanes.get(part.task, lanes["interrupts"])
        begin, width = microseconds(part.begin + blocking), microseconds(part.end - part.begin)
        colour = task_colour(lane) if part.task in lanes else COLOURS["interrupts"]
        axis.barh(lane, width, left=begin, height=0.6, color=colour)
    more = 0.0 if terms is None else microseconds(terms.overheads + terms.release_jitter)
    axis.axvline(
        microseconds(length), color="#000000", label=f"bound: {microseconds(length):.0f} us"
    )
    axis.set_title(
        f"critical instant of the analysis; {more:.0f} us of overheads and jitter come on top",
        fontsize=9,
    )


def _observed(
    axis: Axes,
    recording: Recording,
    lanes: dict[str, int],
    begin: int,
    length: float,
    what: str,
) -> None:
    names = [thread.name.lower() for thread in recording.threads]
    by_name = {name.lower(): lane for name, lane in lanes.items()}
    for first, last, owner in stretches(recording).within(begin, begin + int(length)):
        if owner == INTERRUPT_OWNER:
            lane, colour = lanes["interrupts"], COLOURS["interrupts"]
        elif owner >= 0 and names[owner] in by_name:
            lane = by_name[names[owner]]
            colour = task_colour(lane)
        else:
            continue
        start, width = microseconds(first - begin), microseconds(last - first)
        axis.barh(lane, width, left=start, height=0.6, color=colour)
    place = f"at {microseconds(begin) / 1e6:.6f} s"
    axis.set_title(f"worst window of {what}, {place}", fontsize=9)


def windows_figure(
    robot: Robot, analysis: Analysis, recording: Recording, task: str, what: str = "the run"
) -> Figure | None:
    """The critical instant of a task above its worst job of the run, on the same scale; `what` is
    the run in words."""
    bound = analysis.bounds[task].bound
    worst = worst_job(robot, recording, task, analysis.outside)
    if bound is None or worst is None or worst.response_time_cycles is None:
        return None
    begin, seen = worst.release_cycles, microseconds(worst.response_time_cycles)
    order = sorted(analysis.tasks, key=lambda timing: timing.task.priority)
    lanes = {timing.task.name: lane for lane, timing in enumerate(order)}
    lanes["interrupts"] = len(lanes)
    figure, axes = new_figure(10.0, 1.6 + 0.7 * len(lanes), rows=2)
    length = float(bound)
    timing = next(timing for timing in order if timing.task.name == task)
    _critical(axes[0], analysis, lanes, timing, length)
    _observed(axes[1], recording, lanes, begin, length, what)
    axes[1].axvline(seen, color="#000000", linestyle=":", label=f"response: {seen:.0f} us")
    deadline = microseconds(analysis.bounds[task].task.deadline)
    for axis in axes:
        if deadline < microseconds(bound):
            axis.axvline(deadline, color=COLOURS["deadline"], linestyle="--", label="deadline")
        axis.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
        axis.set_yticks(list(lanes.values()), list(lanes))
        axis.set_ylim(-0.6, len(lanes) - 0.4)
        axis.set_xlim(0, 1.02 * microseconds(bound))
    axes[1].set_xlabel(f"time after the release of {task} (us)")
    return figure


def spreads_figure(result: dict[str, Any]) -> Figure:
    """For each task of a long run, counts of responses and release latencies on a log scale, with
    the bound of the response."""
    tasks = [t for t in result["tasks"] if t["name"] in result["long_run"]["tasks"]]
    figure, axes = new_figure(9.0, 2.0 * len(tasks), rows=len(tasks))
    for axis, task in zip(axes, tasks, strict=True):
        found = result["long_run"]["tasks"][task["name"]]
        kinds = (
            ("response time", "response_time_cycles", COLOURS["design"]),
            ("release latency", "release_latency_cycles", COLOURS["deadline"]),
        )
        for label, key, colour in kinds:
            edges = [microseconds(edge) for edge, _ in found[key]["bins"]]
            counts = [count for _, count in found[key]["bins"]]
            axis.bar(edges, counts, width=1.0, align="edge", color=colour, label=label)
        if task["response_bound_cycles"] is not None:
            bound = microseconds(task["response_bound_cycles"])
            axis.axvline(bound, color="#000000", label=f"bound: {bound:.0f} us")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylabel(f"{task['name']}\njobs per us")
        legend(axis, "upper center")
    axes[-1].set_xlabel("time after the nominal release (us)")
    return figure


def margin_figure(loop: Loop, chain: ChainDelay) -> Figure:
    """Phase margin against the delay from sample to output; jitter is the width of the band."""
    figure, (axis,) = new_figure(8.0, 4.0)
    marks = [("designed", 1000 * loop.designed_delay, COLOURS["design"])]
    if chain.sample_bound_cycles is not None:
        bound = microseconds(chain.sample_bound_cycles) / 1000
        marks.append(("bound", bound, COLOURS["deadline"]))
    if chain.sample_min_cycles is not None and chain.sample_max_cycles is not None:
        low = microseconds(chain.sample_min_cycles) / 1000
        high = microseconds(chain.sample_max_cycles) / 1000
        label = f"seen: {low:.2f} to {high:.2f} ms, the width is the jitter"
        axis.axvspan(low, high, color=COLOURS["raw"], label=label)
    end = 1.2 * max(delay for _, delay, _ in marks) or 1.0
    delays = [end * step / 100 for step in range(101)]
    margins = [phase_margin(loop, delay / 1000) for delay in delays]
    axis.plot(delays, margins, color="#000000", label="the designed loop with another delay")
    for name, delay, colour in marks:
        margin = phase_margin(loop, delay / 1000)
        text = f"{name}: {delay:.2f} ms, {margin:.1f} degrees"
        axis.plot([delay, delay], [0, margin], color=colour, label=text)
        axis.plot([delay], [margin], "o", color=colour, markersize=5, clip_on=False)
    axis.set_xlim(0, end)
    axis.set_ylim(min(0, *margins), 1.15 * max(margins))
    axis.set_xlabel("delay from sample to motor voltage (ms)")
    axis.set_ylabel("phase margin (degrees)")
    figure.legend(frameon=False, fontsize=8.5, ncols=2, loc="outside lower center")
    return figure
