# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about priority inversion."""

from __future__ import annotations

from ravenbrick.trace.recording import Recording

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run
from tools.docs.figures.three_tasks import LANES, executions, robot_text
from tools.docs.lessons import SHEETS, files_of

SHEET = SHEETS / "06-inversion.md"
# Of Low, from whose release the pictures count.
FIRST_JOB = 1
LOCKS = {False: "a flag as the lock", True: "a protected object with a ceiling"}
PERIOD_MS = 250
RELEASE_MS, DEADLINE_MS = 10, 60


def _edits(ceiling: bool, middle_ms: int) -> Edits:
    """Of the template `blank`: the sheet's program."""
    written = files_of(SHEET)
    files = {name: written[f"lab06/{name}"] for name in ("src/tasks.ads", "src/resource.adb")}
    files["src/resource.ads"] = written["lab06/src/resource.ads"].replace(
        "Boolean := False", f"Boolean := {ceiling}"
    )
    files["src/tasks.adb"] = written["lab06/src/tasks.adb"].replace(
        "Compute (100)", f"Compute ({middle_ms})"
    )
    files["robot.toml"] = robot_text()
    files["scenarios/share.toml"] = written["lab06/scenarios/share.toml"]
    return files


def schedules() -> str:
    """One period of the three tasks with both locks."""
    figure, axes = new_figure(7.0, 4.4, rows=2)
    for axis, (ceiling, title) in zip(axes, LOCKS.items(), strict=True):
        recording = run("blank", "share", _edits(ceiling, 100))
        for lane, name in enumerate(LANES):
            for begin, end in executions(recording, name, FIRST_JOB):
                axis.barh(lane, end - begin, left=begin, height=0.5, color=SERIES[lane])
        axis.axvline(RELEASE_MS, color="black", linewidth=1)
        axis.axvline(RELEASE_MS + DEADLINE_MS, color="black", linestyle=":", linewidth=1)
        axis.set(
            title=title, xlim=(-3, 145), yticks=range(3), yticklabels=("Low", "Middle", "High")
        )
    axes[-1].set_xlabel("time after the release of Low (ms)")
    return picture(figure)


def _longest_ms(recording: Recording) -> float:
    """From a release of High to the end of its last execution before the next one."""
    shown = executions(recording, "high_task", FIRST_JOB)
    longest = 0.0
    for period in range(int(shown[-1][1] / PERIOD_MS)):
        release = RELEASE_MS + PERIOD_MS * period
        ends = [end for begin, end in shown if release - 1 < begin < release + PERIOD_MS - 1]
        longest = max(longest, ends[-1] - release)
    return longest


def response() -> str:
    """Longest response of High over the execution time of Middle, with both locks."""
    figure, (axes,) = new_figure(7.0, 3.2)
    times_ms = (1, 50, 100, 150)
    for (ceiling, title), colour in zip(LOCKS.items(), (SERIES[1], SERIES[0]), strict=True):
        found = [_longest_ms(run("blank", "share", _edits(ceiling, t))) for t in times_ms]
        axes.plot(times_ms, found, "o-", color=colour, label=title, linewidth=2)
    axes.axhline(DEADLINE_MS, color="black", linestyle=":", linewidth=1)
    axes.set(xlabel="execution time of Middle (ms)", ylabel="longest response of High (ms)")
    legend(axes, "upper left")
    return picture(figure)
