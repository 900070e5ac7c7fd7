# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about ceilings."""

from __future__ import annotations

import numpy as np
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import jobs_of

from tools.docs.figures import COLOURS, SERIES, Edits, legend, new_figure, picture, run
from tools.docs.figures.three_tasks import LANES, executions, robot_text
from tools.docs.lessons import SHEETS, files_of

SHEET = SHEETS / "13-ceilings.md"
# Of Low, from whose release the pictures count.
FIRST_JOB = 2
RELEASES_MS = {"low_task": 0.0, "middle_task": 4.0, "high_task": 3.0}
COMPUTING_MS, LINK_DEADLINE_MS, PERIOD_MS = 8, 2, 40
LENGTHS_MS = (1, 2, 4, 6, 8)


def _edits(action_ms: int, ceiling: str | None = "System.Priority'First + 3") -> Edits:
    """Of the template `blank`: the sheet's program; without a ceiling the flag."""
    written = files_of(SHEET)
    files = {f"src/{name}": written[f"lab13/src/{name}"] for name in ("tasks.ads", "store.adb")}
    store = written["lab13/src/store.ads"]
    if ceiling is not None:
        store = store.replace("Boolean := False", "Boolean := True")
        store = store.replace("System.Priority'First + 3", ceiling)
    files["src/store.ads"] = store
    short = f"Store.Use_It ({action_ms});"
    if action_ms < COMPUTING_MS:
        short += f" Store.Compute ({COMPUTING_MS - action_ms});"
    files["src/tasks.adb"] = written["lab13/src/tasks.adb"].replace("Store.Use_It (8);", short)
    files["robot.toml"] = robot_text()
    files["scenarios/share.toml"] = written["lab13/scenarios/share.toml"]
    return files


def schedules() -> str:
    """One period with the flag, with the ceiling, and with a short action."""
    figure, axes = new_figure(7.0, 5.2, rows=3)
    cases = (
        ("a flag as the lock", _edits(8, None)),
        ("a protected object with the ceiling 3", _edits(8)),
        ("the same, used for 1 ms", _edits(1)),
    )
    for axis, (title, edits) in zip(axes, cases, strict=True):
        recording = run("blank", "share", edits)
        for lane, name in enumerate(LANES):
            for begin, end in executions(recording, name, FIRST_JOB):
                axis.barh(lane, end - begin, left=begin, height=0.5, color=SERIES[lane])
        for name in ("high_task", "middle_task"):
            axis.axvline(RELEASES_MS[name], color="black", linewidth=0.8, linestyle=":")
        axis.set(title=title, xlim=(-0.5, 18), yticks=range(3))
        axis.set_yticklabels(("Low", "Middle", "High"))
    axes[-1].set_xlabel("time after the release of Low (ms)")
    return picture(figure)


def _longest_ms(recording: Recording, name: str) -> float:
    """From a release to the end of the last execution before the next one."""
    shown = executions(recording, name, FIRST_JOB)
    longest = 0.0
    for period in range(int(shown[-1][1] / PERIOD_MS)):
        release = RELEASES_MS[name] + PERIOD_MS * period
        ends = [end for begin, end in shown if release - 0.5 < begin < release + PERIOD_MS - 1]
        longest = max(longest, ends[-1] - release)
    return longest


def length() -> str:
    """Longest responses of High and Middle over the length of Low's protected action."""
    figure, (axis,) = new_figure(7.0, 3.2)
    line = np.linspace(LENGTHS_MS[0], LENGTHS_MS[-1], 50)
    for name, own, colour in (("high_task", 1.0, SERIES[2]), ("middle_task", 6.0, SERIES[1])):
        found = [_longest_ms(run("blank", "share", _edits(z)), name) for z in LENGTHS_MS]
        label = name.removesuffix("_task").capitalize()
        axis.plot(LENGTHS_MS, found, "o", color=colour, label=f"{label}, recorded")
        axis.plot(line, line + own, color=colour, lw=1, label=f"{label}, bound")
    axis.set(xlabel="length of the protected action (ms)", ylabel="response (ms)", ylim=(0, 16))
    legend(axis, "upper left", 2)
    return picture(figure)


def link() -> str:
    """Response times of the link's jobs with the right and with the highest ceiling."""
    figure, (axis,) = new_figure(7.0, 3.0)
    for title, ceiling, colour in (
        ("highest ceiling", "System.Priority'Last", SERIES[1]),
        ("ceiling 3", "System.Priority'First + 3", SERIES[0]),
    ):
        recording = run("blank", "share", _edits(8, ceiling))
        jobs = jobs_of(recording, recording.thread_index("coprocessor_task"))
        rows = [
            (1000 * recording.clock.seconds(job.release_cycles), job.response_time_cycles)
            for job in jobs
            if job.response_time_cycles is not None
        ]
        times, cycles = np.array(rows, dtype=float).T
        responses = [1000 * recording.clock.seconds(int(one)) for one in cycles]
        axis.plot(times, responses, ".", color=colour, label=title, markersize=5)
    axis.axhline(LINK_DEADLINE_MS, color=COLOURS["faint"], linestyle=":", label="deadline")
    axis.set(xlabel="time (ms)", ylabel="response of the link (ms)", xlim=(300, 500))
    legend(axis, "upper right")
    return picture(figure)
