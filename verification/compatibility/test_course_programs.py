# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Course programs that others wrote for GNAT GPL for MINDSTORMS, compiled unchanged and run.

RAVENBRICK_COURSE_PROGRAMS names a folder that holds checkouts of public repositories as
`<owner>/<repository>`. None of their files is part of this project; digests tell that the sources
are those that were tried.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import virtual_brick

from verification.support.bricks.observe import Brick, bench
from verification.support.bricks.programs import gprbuild

HERE = Path(__file__).resolve().parent
FOLDER = os.environ.get("RAVENBRICK_COURSE_PROGRAMS", "")


@dataclass(frozen=True)
class Program:
    """A folder of sources, its main unit, and the digest of its Ada files in order of names.

    `code`: state of the application's code; the larger ones need Thumb to fit into the RAM.
    """

    folder: str
    main: str
    digest: str
    code: str = "arm"


NIM = Program(
    "przemko/ada-nxt2/nim",
    "nim",
    "71fbe800898b2c88b2cfb6baabf417ef7e791f19bcfe60cce737cf131798f59e",
)
TWO_WRITERS = Program(
    "przemko/ada-nxt2/tests/display",
    "display_test",
    "b6c2a6e6ae88e7f6d0cf606c47a203022172f4757a09b80b928b008114a44f01",
)
MOTOR = Program(
    "przemko/ada-nxt2/tests/motor",
    "motor_test",
    "792d465c5d578ddc4208ab43066c6c94ab4d333175fd60563a414f6cca929663",
)
TOUCH = Program(
    "przemko/ada-nxt2/tests/touch_sensor",
    "touch_test",
    "64e1b82721c5b7cb6775f5bf89a35d37b58d84898f9888984d093c6c2b31b114",
)
KEEP_DISTANCE = Program(
    "NguoiTotBung/Real-time-assignment-2/part3",
    "my_main",
    "024d4cfdde7f14efa3de612860c271bea632fa8362a414da679999a7424a8ae9",
)
FOLLOWER = Program(
    "NguoiTotBung/Real-time-assignment-2/part4",
    "my_main",
    "76429021951162623a18f0dc2e8fa014ed7f6ffe6c62d65b358af92f4ce0fbbf",
    "thumb",
)
LINE = Program(
    "xdawax/ADA_LABB/task4",
    "line_follower",
    "e2a59935678381f64cdc80c063004b0978dc12d991991e4912e45b66066b84bb",
    "thumb",
)
CALIBRATED = Program(
    "Nusrat-16/Lego-mindstrom-design/Final task",
    "helloworld",
    "3994324f2478a6e389f188769204b7f75ef20fa3052642067d503d5b771e49a3",
)


def sources(program: Program) -> Path:
    """The program's folder; skips without it, fails when the files are others."""
    if not FOLDER:
        pytest.skip("RAVENBRICK_COURSE_PROGRAMS names no folder of course programs")
    folder = Path(FOLDER) / program.folder
    if not folder.is_dir():
        pytest.skip(f"RAVENBRICK_COURSE_PROGRAMS has no {program.folder}")
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.ad[bs]")):
        digest.update(path.read_bytes())
    assert digest.hexdigest() == program.digest, f"{folder}: other sources than those tried"
    return folder


@pytest.fixture(scope="session")
def image(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Program], bytes]:
    """From a program to its ELF, compiled in a folder of its own."""

    def build(program: Program) -> bytes:
        objects = tmp_path_factory.mktemp(program.main)
        gprbuild(
            HERE / "course.gpr",
            CODE=program.code,
            SOURCES=sources(program),
            MAIN=program.main,
            OBJECTS=objects,
        )
        return (objects / f"{program.main}.elf").read_bytes()

    return build


@pytest.fixture
def brick(image: Callable[[Program], bytes]) -> Callable[..., Brick]:
    """From a program to a brick that is about to start it."""

    def start(program: Program, sensors: dict[str, str] | None = None) -> Brick:
        ports: dict[str, Any] = {port: {"kind": kind} for port, kind in (sensors or {}).items()}
        configuration = json.dumps(bench() | {"sensors": ports})
        return Brick(virtual_brick.VirtualBrick(configuration, image(program)))

    return start


def press(device: Brick, name: str, at_ms: float, for_ms: float = 120) -> None:
    """Press and release a button or touch sensor."""
    device.set(at_ms, name, 1)
    device.set(at_ms + for_ms, name, 0)


def heaps(device: Brick) -> int:
    """Pieces left on the board of the game, without the text of its last row."""
    return sum(row.count("O") for row in device.text()[:7])


def test_nim_is_played_with_the_buttons(brick: Callable[..., Brick]) -> None:
    """One piece taken leaves 27 and the program takes two; then two and two; then off."""
    device = brick(NIM)
    device.run(900)
    assert device.text()[:1] == ["    NIM Game"]
    press(device, "button.grey", 1_000)
    device.run(1_500)
    assert heaps(device) == 28
    assert device.text()[7] == "  [1]  2   3"
    press(device, "button.grey", 1_600)
    device.run(2_500)
    assert heaps(device) == 25
    press(device, "button.right", 2_600, for_ms=60)
    device.run(3_000)
    assert device.text()[7] == "   1  [2]  3"
    press(device, "button.grey", 3_100)
    device.run(4_000)
    assert heaps(device) == 21
    press(device, "button.orange", 4_100)
    assert device.run_to_end(6_000).reason == "power_off"


def test_two_tasks_write_on_one_display(brick: Callable[..., Brick]) -> None:
    """64 letters of each fill the screen, and none is lost."""
    device = brick(TWO_WRITERS)
    device.run(1_000)
    letters = "".join(device.text())
    assert (letters.count("A"), letters.count("B")) == (64, 64)


def test_a_touch_runs_the_motor_for_a_second(brick: Callable[..., Brick]) -> None:
    """Full power, then the brake; the orange button ends the program."""
    device = brick(MOTOR, {"1": "touch"})
    press(device, "touch.1", 500)
    press(device, "button.orange", 3_000)
    assert device.run_to_end(5_000).reason == "power_off"
    start, stop = [c for c in device.motor_commands() if c.motor == "A"][:2]
    assert (start.duty, start.brake, stop.duty, stop.brake) == (100, True, 0, True)
    assert stop.at_ms - start.at_ms == pytest.approx(1_000, abs=60)


def test_a_touch_switches_the_brick_off(brick: Callable[..., Brick]) -> None:
    """The whole program: a text, and off."""
    device = brick(TOUCH, {"1": "touch"})
    device.run(600)
    assert device.text()[:2] == ["Press Touch_Sens", "or(1) to Power D"]
    press(device, "touch.1", 700)
    assert device.run_to_end(3_000).reason == "power_off"


@pytest.mark.parametrize(("metres", "sign"), [(0.6, 1), (0.2, -1), (0.355, 0)])
def test_a_car_keeps_its_distance(brick: Callable[..., Brick], metres: float, sign: int) -> None:
    """35 cm is the set-point: further away it drives on, closer back, else it brakes."""
    device = brick(KEEP_DISTANCE, {"1": "ultrasonic", "2": "touch"})
    device.set(10, "distance.1", metres)
    device.run(3_000)
    duty, brake = device.motors(at_ms=3_000)["A"]
    assert duty == device.motors(at_ms=3_000)["B"][0]
    assert (duty > 0) - (duty < 0) == sign
    assert brake
    assert "PRIO_DIST" in "".join(device.text())


def test_a_line_follower_is_calibrated_and_follows(brick: Callable[..., Brick]) -> None:
    """Black, grey and white are shown to it; 45 cm behind a car it drives at 30 %."""
    device = brick(FOLLOWER, {"1": "ultrasonic", "2": "touch", "3": "light"})
    device.set(10, "distance.1", 0.455)
    for step, reflectance in enumerate((0.1, 0.4, 0.7)):
        device.set(500 + 1_000 * step, "light.3.reflectance", reflectance)
        press(device, "touch.2", 1_200 + 1_000 * step)
    device.run(3_700)
    values = [row.split(":")[-1].strip() for row in device.text() if row.startswith("- ")]
    black, grey, white = map(int, values)
    assert black < grey < white
    device.set(3_800, "light.3.reflectance", 0.4)
    press(device, "touch.2", 4_000)
    device.run(6_000)
    assert device.motors(at_ms=6_000)["B"] == (30, True)
    device.set(6_100, "light.3.reflectance", 0.7)
    device.run(8_000)
    right, left = (device.motors(at_ms=8_000)[motor][0] for motor in "AB")
    assert right == 33
    assert left < 15


def test_a_line_follower_steers_with_a_motor(brick: Callable[..., Brick]) -> None:
    """The drive motor turns at 20 %, four other tasks show and regulate; then off."""
    device = brick(LINE, {"1": "light", "3": "ultrasonic", "4": "touch"})
    device.set(10, "distance.3", 0.8)
    device.set(10, "light.1.reflectance", 0.5)
    device.run(2_000)
    assert device.motors(at_ms=2_000)["B"][0] == 20
    assert "LightControl" in "".join(device.text())
    press(device, "button.orange", 2_100, for_ms=1_000)
    assert device.run_to_end(5_000).reason == "power_off"


def test_a_calibrated_car_follows_at_a_distance(brick: Callable[..., Brick]) -> None:
    """After the touch it drives towards a far car, and stops when the car is near."""
    device = brick(CALIBRATED, {"1": "touch", "2": "ultrasonic", "3": "light"})
    device.set(10, "distance.2", 1.0)
    device.set(10, "light.3.reflectance", 0.4)
    press(device, "touch.1", 1_500, for_ms=300)
    device.run(6_000)
    assert device.motors(at_ms=6_000)["A"][0] > 0
    device.set(6_001, "distance.2", 0.05)
    device.run(8_000)
    assert device.motors(at_ms=8_000)["A"][0] == 0
