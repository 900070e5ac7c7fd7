# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet on interrupts: lines of an encoder, polling, the handler, masked time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import EventKind, Recording

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, project
from tools.docs.lessons import SHEETS, edited, files_of, steps, teaching_page

SHEET = SHEETS / "14-driver.md"
SOLUTION = teaching_page(SHEET)
POLLED, DRIVEN, HELD = "polled", "interrupt", "held"
TACHO, DIRECTION, PIOA = 26, 9, 2
PINS = [f'\n[[criteria]]\nexpect = "pin {pin} ever high"\n' for pin in (TACHO, DIRECTION)]
LOOK_S = 0.020
HELD_US = (0, 20, 30, 35, 40, 50, 60, 80, 100)
FAST_JOBS = 24  # of the control task, while the shaft has its full speed

Cycles = NDArray[np.int64]
Reals = NDArray[np.floating]


def _changed(text: str, folder: str, name: str, page: str) -> str:
    """A file after a page's edits of it, without the one that takes the polling out again."""
    for step in steps(page):
        if step.kind == "edit" and step.argument == f"{folder}/{name}":
            text = edited(text, step.content)
    return text


def _edits(driver: str, held_us: int) -> Edits:
    sheet, solution = SHEET.read_text("utf-8"), SOLUTION.read_text("utf-8")
    tasks = (project("blank") / "src/tasks.adb").read_text("utf-8")
    sources = files_of(SHEET if driver == POLLED else SOLUTION)
    files = {f"src/shaft.{kind}": sources[f"lab14/src/shaft.{kind}"] for kind in ("ads", "adb")}
    tasks = _changed(tasks, "lab14", "src/tasks.adb", sheet)
    if driver != POLLED:
        tasks = _changed(tasks, "lab14", "src/tasks.adb", solution)
    files["src/tasks.adb"] = tasks
    if driver == HELD:
        files = {name: _changed(text, "held14", name, solution) for name, text in files.items()}
        wanted = f"Shaft.Hold ({held_us});"
        files["src/tasks.adb"] = files["src/tasks.adb"].replace("Shaft.Hold (40);", wanted)
        assert wanted in files["src/tasks.adb"]
    files["scenarios/drill.toml"] = files_of(SHEET)["lab14/scenarios/drill.toml"] + "".join(PINS)
    return files


@cache
def _run(
    driver: str, torque: float, held_us: int = 0, turning_ms: int = 500, after: float = 0.0
) -> Recording:
    """The shaft is turned from 0.5 s on by a torque (N m), then by another one."""
    folder = project("blank", _edits(driver, held_us))
    robot = read_robot(folder)
    image = read_image(Workspace.of(folder).image("ram", robot.name))
    scenario = read_scenario(scenario_path(folder, "drill"), robot)
    on, off = scenario.inputs
    inputs = (replace(on, value=torque), replace(off, at_ms=on.at_ms + turning_ms, value=after))
    changed = replace(scenario, inputs=inputs, duration_ms=on.at_ms + turning_ms + 1_000)
    return VirtualTarget().run(robot, changed, image)


def _level_changes(recording: Recording, pin: int) -> Cycles:
    line = recording.signals[f"pin.{pin}"]
    cycles: Cycles = line.cycles[1:][np.diff(line.values) != 0].astype(np.int64)
    return cycles


def _changes(recording: Recording) -> Cycles:
    return np.sort(np.concatenate([_level_changes(recording, p) for p in (TACHO, DIRECTION)]))


def _shown(recording: Recording, at_cycles: int | None = None) -> int:
    """The count on the display at an instant, or at the end."""
    screens = [s for s in recording.screens if at_cycles is None or s.at_cycles <= at_cycles]
    return int(screens[-1].text[0].split()[-1])


def levels() -> str:
    """Both lines and the count while a hand turns the shaft, forwards and back."""
    recording = _run(DRIVEN, -0.02, turning_ms=100, after=0.02)
    figure, (lines, count) = new_figure(7.0, 4.0, rows=2)
    instants = _changes(recording)
    levels = {}
    for pin, name, offset, colour in (
        (TACHO, "tacho", 1.5, SERIES[0]),
        (DIRECTION, "direction", 0.0, SERIES[1]),
    ):
        line = recording.signals[f"pin.{pin}"]
        cycles = line.cycles.astype(np.int64)
        levels[pin] = line.values[np.searchsorted(cycles, instants, side="right") - 1] > 0
        since = _milliseconds(recording, cycles)
        lines.step(since, line.values + offset, where="post", color=colour, label=name)
    phase = np.where(levels[TACHO], 1 + levels[DIRECTION], 3 * levels[DIRECTION])
    moved = (np.diff(phase, prepend=0) + 1) % 4 - 1
    since = _milliseconds(recording, instants)
    counted = np.concatenate(([0], np.cumsum(moved)))
    count.step(np.concatenate(([0.0], since)), counted, where="post", color=SERIES[2])
    lines.set(ylabel="level", yticks=(0, 1, 1.5, 2.5), yticklabels=("0", "1", "0", "1"))
    lines.set(ylim=(-0.2, 3.4))
    count.set(xlabel="time (ms)", ylabel="count", xlim=(0, 200), ylim=(-0.5, 6.9))
    legend(lines, "upper right", columns=2)
    return picture(figure)


def _milliseconds(recording: Recording, cycles: Cycles) -> Reals:
    """Since the shaft is turned."""
    since: Reals = 1e3 * cycles / float(recording.clock.hertz) - 500.0
    return since


def _apparent(changes: Reals) -> Reals:
    """Counts per look for this many changes between two looks, at all phases alike."""
    seen = np.array((0.0, 1.0, 0.0, -1.0))
    below = np.floor(changes).astype(int)
    share = changes - below
    result: Reals = (1 - share) * seen[below % 4] + share * seen[(below + 1) % 4]
    return result


def aliasing() -> str:
    """Counts per look of the polled driver over the changes between two looks."""
    figure, (axes,) = new_figure(7.0, 3.2)
    exact = np.linspace(0, 9, 361)
    axes.plot(exact, exact, color="0.5", linestyle=":", label="true")
    axes.plot(exact, _apparent(exact), color=SERIES[0], label="formula (1)")
    turned, counted = [], []
    for torque in 0.004 + 0.01 * np.arange(0.3, 8.9, 0.43):
        recording = _run(POLLED, -float(torque), turning_ms=1_400)
        begin, end = (int(s * float(recording.clock.hertz)) for s in (0.63, 1.63))
        changes = _changes(recording)
        looks = (end - begin) / float(recording.clock.hertz) / LOOK_S
        turned.append(((changes >= begin) & (changes < end)).sum() / looks)
        counted.append((_shown(recording, end) - _shown(recording, begin)) / looks)
    axes.plot(turned, counted, "o", color=SERIES[1], label="virtual brick")
    axes.set(xlabel="changes between two looks", ylabel="counted per look", ylim=(-1.4, 2.4))
    legend(axes, "upper right", columns=3)
    return picture(figure)


def handler() -> str:
    """Both lines and the calls of the handler over 250 microseconds of the fastest turn."""
    recording = _run(DRIVEN, -5.0)
    figure, (axes,) = new_figure(7.0, 2.8)
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    late = entered["at_cycles"] > 0.8 * float(recording.clock.hertz)
    other = int(entered["at_cycles"][late & (entered["subject"] != PIOA)][0])
    begin = other - int(100e-6 * float(recording.clock.hertz))
    end = begin + int(250e-6 * float(recording.clock.hertz))

    def micro(cycles: Cycles) -> Reals:
        return 1e6 * (cycles - begin) / float(recording.clock.hertz)

    for pin, offset, colour in ((TACHO, 3.0, SERIES[0]), (DIRECTION, 1.5, SERIES[1])):
        line = recording.signals[f"pin.{pin}"]
        axes.step(
            micro(line.cycles.astype(np.int64)), line.values + offset, where="post", color=colour
        )
    left = recording.of_kind(EventKind.INTERRUPT_LEFT)["at_cycles"].astype(np.int64)
    for event in entered[(entered["at_cycles"] > begin) & (entered["at_cycles"] < end)]:
        start = int(event["at_cycles"])
        finish = int(left[np.searchsorted(left, start)])
        own = event["subject"] == PIOA
        begun, ended = micro(np.array((start, finish)))
        axes.broken_barh([(begun, ended - begun)], (0.0, 1.0), color=SERIES[2] if own else "0.6")
    axes.set(xlabel="time (\N{MICRO SIGN}s)", xlim=(0, 250), yticks=(0.5, 2.0, 3.5))
    axes.set_yticklabels(("handlers", "direction", "tacho"))
    return picture(figure)


def _lost(changes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Half degrees that are missing when so many changes come before the handler looks."""
    lost: NDArray[np.int64] = changes - np.array((0, 1, 0, -1))[changes % 4]
    return lost


def held() -> str:
    """Half degrees lost by the time for which a task keeps the driver's object, at full speed."""
    figure, (axes,) = new_figure(7.0, 3.2)
    longest, lost = [], []
    for held_us in HELD_US:
        recording = _run(HELD, -5.0, held_us)
        changes = _changes(recording)
        entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
        calls = entered["at_cycles"][entered["subject"] == PIOA].astype(np.int64)
        longest.append((calls[np.searchsorted(calls, changes)] - changes).max())
        lost.append(changes.size - abs(_shown(recording)))
    interval = np.diff(_changes(_run(DRIVEN, -5.0))).min()
    masked = np.linspace(0, 5000, 501)
    least, most = (_lost(round_(masked / interval).astype(int)) for round_ in (np.floor, np.ceil))
    bounds = FAST_JOBS * least, FAST_JOBS * most
    axes.fill_between(
        masked, *bounds, color=SERIES[0], alpha=0.2, step="mid", linewidth=0, label="possible"
    )
    axes.plot(longest, lost, "o", color=SERIES[1], label="virtual brick")
    axes.axvline(interval, color="black", linestyle=":", label=f"interval, {interval} cycles")
    axes.set(
        xlabel="longest time from a change to the handler (cycles)", ylabel="lost half degrees"
    )
    axes.set(xlim=(0, 5000), ylim=(-4, 105))
    legend(axes, "upper left")
    return picture(figure)
