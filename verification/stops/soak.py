# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Hours of virtual driving with faults: no deadline missed, no count lost, a quick recovery.

`python -m verification.stops.soak [HOURS [DRIVES]]` divides the hours among so many drives, one for
each seed from 1 on: those with odd seeds drive the vehicle, the others the motor bench, with a
computer that connects over Bluetooth and is lost again. Faults come at random instants. A deadline
counts as missed unless its job overlaps a fault or the 100 ms after it.
"""

from __future__ import annotations

import gc
import json
import os
import random
import resource
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import Any

import numpy as np
import virtual_brick
from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.trace.recording import EventKind, decode_events

from verification.built_examples import build_example
from verification.commands import Counts
from verification.support.paths import BUILD, ROOT

__all__ = ["Drive", "drive", "growth_kb", "soak_suite"]

HOURS, DRIVES, WORKERS = 24.0, 8, 2
RECOVERY_MS = 100
POLL_MS = 2
# The longest loss after which the link goes on; a longer one ends the program.
LONGEST_CUT_MS = 150
ALL_FRAMES = 65_535
REST_MS = (2_000, 10_000)
COMPUTER = "00:1A:7D:00:00:01"
LEFT_BUTTON = 2
ROBOTS = {"vehicle": "drive", "motor-bench": "monitored"}
BRICKS, SETTLED_BRICKS, GROWTH_MAX_KB = 1_000, 100, 8_192


@dataclass
class Drive:
    """A drive and what was wrong with it; `recovery_ms` is the longest after a fault of the link.

    `declared_misses` fell into a fault or the time after it.
    """

    robot: str
    seed: int
    virtual_s: float = 0.0
    jobs: int = 0
    misses: int = 0
    declared_misses: int = 0
    recovery_ms: float = 0.0
    lost_counts: int = 0
    faults: Counter[str] = field(default_factory=Counter)
    end: str = ""

    @property
    def problems(self) -> list[str]:
        """What must not be."""
        head = f"{self.robot}, seed {self.seed}"
        found = []
        if self.misses:
            found.append(f"{head}: {self.misses} deadlines missed outside of faults")
        if self.lost_counts:
            found.append(f"{head}: {self.lost_counts} counts lost")
        if self.recovery_ms > RECOVERY_MS:
            found.append(f"{head}: the link was back after {self.recovery_ms:g} ms")
        if self.end:
            found.append(f"{head}: ended after {self.virtual_s:.0f} s: {self.end}")
        return found


class _Course:
    """The brick of a drive, its faults and its measures."""

    def __init__(self, name: str, seed: int) -> None:
        project = ROOT / "examples" / name
        self.robot: Robot = read_robot(project)
        scenario = read_scenario(project / "scenarios" / f"{ROBOTS[name]}.toml", self.robot)
        configuration = brick_configuration(self.robot, scenario, MASTER_CLOCK) | {
            "seed": seed,
            "signal_period_cycles": 48_000_000,
            "bluetooth": {"known": [{"address": COMPUTER, "name": "computer"}]},
        }
        elf = (BUILD / name / "ram" / f"{name}.elf").read_bytes()
        self.brick: Any = virtual_brick.VirtualBrick(json.dumps(configuration), elf)
        self.random = random.Random(seed)
        self.result = Drive(name, seed)
        self.connected = False
        self.faults_cycles: list[tuple[int, int]] = []
        self.deadlines = self._deadlines()
        self.button = -1

    def _deadlines(self) -> dict[int, int]:
        """In cycles by the number of the thread, when all have been created."""
        self.run_ms(50)
        found = {}
        for number, thread in enumerate(self.brick.threads()):
            task = self.robot.task(thread.name)
            if task is not None and task.deadline_us is not None:
                found[number] = MASTER_CLOCK.cycles_of_ms(task.deadline_us) // 1_000
        return found

    def run_ms(self, ms: int) -> None:
        """Let time pass."""
        stop = self.brick.run_until(self.brick.cycles + MASTER_CLOCK.cycles_of_ms(ms))
        self.result.virtual_s = MASTER_CLOCK.seconds(self.brick.cycles)
        if stop.reason != "reached":
            self.result.end = f"{stop.reason}: {stop.message}"
            raise EOFError

    def set(self, name: str, value: float) -> None:
        """An input, now."""
        self.brick.schedule_input(self.brick.cycles, name, value)

    def judge(self) -> None:
        """The jobs completed since the last call."""
        events = decode_events(self.brick.take_events())
        done = events[events["kind"] == int(EventKind.COMPLETION)]
        for number, deadline in self.deadlines.items():
            own = done[done["subject"] == number]
            at, release = own["at_cycles"].astype(np.int64), own["value"]
            self.result.jobs += len(own)
            for end, begin in zip(
                *(a[at - release > deadline].tolist() for a in (at, release)), strict=True
            ):
                declared = any(begin < f[1] and end > f[0] for f in self.faults_cycles)
                self.result.declared_misses += declared
                self.result.misses += not declared
        self.faults_cycles.clear()

    def find_button(self) -> None:
        """Where the drivers keep which button is pressed."""
        address, size = self.brick.symbol("nxt__avr__shared")
        before = bytes(self.brick.read_memory(address, size))
        self.set("button.left", 1)
        self.run_ms(20)
        after = bytes(self.brick.read_memory(address, size))
        self.set("button.left", 0)
        self.run_ms(20)
        (offset,) = (
            i for i, (old, new) in enumerate(zip(before, after, strict=True))
            if (old, new) == (0, LEFT_BUTTON)
        )  # fmt: skip
        self.button = address + offset

    def recover(self, begun_cycles: int) -> None:
        """After a fault of the link: how long until a button is seen again."""
        ended = self.brick.cycles
        self.set("button.left", 1)
        waited_ms = 0
        while self.brick.read_memory(self.button, 1)[0] != LEFT_BUTTON and waited_ms < 1_000:
            self.run_ms(POLL_MS)
            waited_ms += POLL_MS
        self.result.recovery_ms = max(self.result.recovery_ms, waited_ms)
        self.set("button.left", 0)
        self.declare(begun_cycles, ended)

    def declare(self, begun_cycles: int, ended_cycles: int) -> None:
        """Misses until a recovery after the fault are the fault's."""
        tail = MASTER_CLOCK.cycles_of_ms(RECOVERY_MS)
        self.faults_cycles.append((begun_cycles, ended_cycles + tail))

    def cut(self, name: str) -> None:
        """The link is stuck, or the co-processor refuses frames, for a while."""
        begun = self.brick.cycles
        self.set(name, 1)
        self.run_ms(self.random.randrange(1, LONGEST_CUT_MS))
        self.set(name, 0)
        self.recover(begun)

    def noise(self, name: str) -> None:
        """All frames are damaged for a while."""
        begun = self.brick.cycles
        self.set(name, ALL_FRAMES)
        self.run_ms(self.random.randrange(1, LONGEST_CUT_MS))
        self.set(name, 0)
        self.recover(begun)

    def sag(self) -> None:
        """The battery falls, at most for 0.8 s below what ends the program."""
        deep = self.random.random() < 0.3
        self.set("battery.voltage", self.random.uniform(5.5, 6.4) if deep else 7.0)
        self.run_ms(self.random.randrange(50, 800 if deep else 5_000))
        self.set("battery.voltage", 8.0)

    def pull_sensor(self) -> None:
        """The plug of the touch sensor."""
        self.set("sensor.1.plugged", 0)
        self.run_ms(self.random.randrange(50, 2_000))
        self.set("sensor.1.plugged", 1)

    def bluetooth(self) -> None:
        """The computer opens its connection, sends what is no message, or is lost."""
        kind = "close" if self.connected and self.random.random() < 0.5 else "data"
        if not self.connected:
            self.brick.bluetooth_send(self.brick.cycles, COMPUTER, "page", name="computer")
        elif kind == "data":
            self.brick.bluetooth_send(
                self.brick.cycles, COMPUTER, "data", self.random.randbytes(40)
            )
        else:
            self.brick.bluetooth_send(self.brick.cycles, COMPUTER, "close")
        self.run_ms(500)
        kinds = [signal[2] for signal in self.brick.bluetooth_sent()]
        self.connected = (self.connected or "accept" in kinds) and kind != "close"

    def disturb(self) -> None:
        """One fault, drawn."""
        kinds = ["cut", "refusal", "checksums", "torn words", "sag", "sensor"]
        if self.result.robot == "motor-bench":
            kinds += ["bluetooth"] * 2
        kind = self.random.choice(kinds)
        self.result.faults[kind] += 1
        {
            "cut": lambda: self.cut("fault.twi_stuck"),
            "refusal": lambda: self.cut("fault.coprocessor_refuses"),
            "checksums": lambda: self.noise("fault.coprocessor_checksum"),
            "torn words": lambda: self.noise("fault.coprocessor_torn_words"),
            "sag": self.sag,
            "sensor": self.pull_sensor,
            "bluetooth": self.bluetooth,
        }[kind]()

    def steer(self) -> None:
        """Start or stop, and turn the joystick."""
        self.set("touch.1", 1)
        self.run_ms(100)
        self.set("touch.1", 0)
        if self.result.robot == "vehicle":
            self.set("motor.A.hand_angle", self.random.uniform(-0.8, 0.8))

    def count(self) -> None:
        """The program's counts against those of the encoders."""
        address, size = self.brick.symbol("nxt__motor_encoders__encoder_count")
        counts = np.frombuffer(bytes(self.brick.read_memory(address, size)), "<i4")
        true = dict(self.brick.quantities())
        for port, found in zip("ABC", counts.tolist(), strict=True):
            # An edge may be on its way to the handler.
            error = abs(found - true.get(f"motor.{port}.encoder", found))
            self.result.lost_counts = max(self.result.lost_counts, int(error) - 1)


def drive(name: str, seed: int, seconds: float) -> Drive:
    """Drive for so long in virtual time."""
    course = _Course(name, seed)
    try:
        course.run_ms(500)
        course.find_button()
        while course.result.virtual_s < seconds:
            if course.random.random() < 0.3:
                course.steer()
            course.disturb()
            course.run_ms(course.random.randrange(*REST_MS))
            course.judge()
            course.count()
    except EOFError:
        pass
    return course.result


def _make_and_drop(count: int) -> int:
    """The process's memory in KB afterwards."""
    elf = (BUILD / "vehicle" / "ram" / "vehicle.elf").read_bytes()
    robot = read_robot(ROOT / "examples" / "vehicle")
    scenario = read_scenario(ROOT / "examples" / "vehicle" / "scenarios" / "drive.toml", robot)
    configuration = json.dumps(brick_configuration(robot, scenario, MASTER_CLOCK))
    for _ in range(count):
        brick = virtual_brick.VirtualBrick(configuration, elf)
        brick.run_until(MASTER_CLOCK.cycles_of_ms(100))
        del brick
    gc.collect()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def growth_kb() -> int:
    """Growth of the largest memory of a process from the hundredth brick to the last."""
    settled = _make_and_drop(SETTLED_BRICKS)
    return _make_and_drop(BRICKS - SETTLED_BRICKS) - settled


def soak_suite(hours: float | None = None, drives: int = DRIVES) -> Counts:
    """All drives, and a thousand bricks made and dropped in one process."""
    if hours is None:
        hours = float(os.environ.get("RAVENBRICK_SOAK_HOURS", HOURS))
    for name in ROBOTS:
        build_example(name)
    names = list(ROBOTS)
    wrong: list[str] = []
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        grown = pool.submit(growth_kb)
        running = [
            pool.submit(drive, names[(seed - 1) % len(names)], seed, 3_600 * hours / drives)
            for seed in range(1, drives + 1)
        ]
        for each in running:
            print(each.result(), flush=True)
            wrong += each.result().problems
        if grown.result() > GROWTH_MAX_KB:
            wrong.append(f"{BRICKS} bricks: the process grew by {grown.result()} KB")
        print(f"{BRICKS} bricks made and dropped: {grown.result()} KB more", flush=True)
    failed = len({text.split(":")[0] for text in wrong})
    return Counts(drives + 1, drives + 1 - failed, failures=wrong)


if __name__ == "__main__":
    given = sys.argv[1:]
    print("\n".join(
        soak_suite(float(given[0]) if given else None, *(int(n) for n in given[1:])).failures
    ))  # fmt: skip
