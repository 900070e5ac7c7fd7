# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every operation of GNAT GPL for MINDSTORMS under its name, with its parameters and types."""

from __future__ import annotations

from collections.abc import Callable

from verification.support.bricks.observe import Brick

SENSORS = {
    "1": {"kind": "touch"},
    "2": {"kind": "light"},
    "3": {"kind": "sound"},
    "4": {"kind": "ultrasonic"},
}
CHECKS = 26


def test_every_operation_does_what_its_name_says(brick: Callable[..., Brick]) -> None:
    """The program's own expectations hold, the display shows what it wrote, and it ends."""
    device = brick("compatibility", sensors=SENSORS)
    device.set(10, "distance.4", 0.4)
    device.set(10, "light.2.reflectance", 0.5)
    stop = device.run_to_end(5_000)
    assert (device.integer("wrong"), device.integer("step")) == (0, CHECKS)
    assert stop.reason == "power_off"
    rows = device.text()
    assert rows[:4] == ["all -1234", "5ABEEF00123456", "two tasks", "7"]
    assert rows[5] == "    here"
    picture = device.picture()
    assert picture[50][88:97] == "..####..."
    assert picture[51][88:97] == "..#..#..."
    assert [picture[y][9:16] for y in (56, 57, 58)] == ["...#...", "..#.#..", ".#...#."]


def test_messages_to_the_co_processor_are_made_by_hand(brick: Callable[..., Brick]) -> None:
    """Motors keep what messages before have set; inputs come back; the last one is power off."""
    device = brick("link_messages", sensors={"1": {"kind": "touch"}})
    device.set(300, "button.left", 1)
    device.run(450)
    motors = device.motors(at_ms=450)
    assert (motors["A"], motors["C"]) == ((40, True), (-30, True))
    assert (device.integer("button"), device.integer("invalid")) == (2, 0)
    assert device.integer("sensor") > 1000
    assert device.integer("battery") * 13.848 > 7_900
    assert device.run_to_end(2_000).reason == "power_off"


def test_an_empty_message_puts_nothing_on_the_bus(brick: Callable[..., Brick]) -> None:
    """After the greeting only messages of nine bytes; the interface could send what was left."""
    device = brick("link_messages")
    device.device.record_buses()
    device.run(100)
    written = [event for _, event in device.device.bus_log() if event.startswith("twi")]
    frames = " ".join(written).split("twi P")
    assert {frame.count("twi") for frame in frames if "S 02" in frame} == {10, 48}


def test_functions_make_limited_objects_with_a_heap_of_no_bytes(
    brick: Callable[..., Brick],
) -> None:
    """The compiler refers to the heap, which nobody uses; NXT.Malloc stands for it."""
    device = brick("limited_types")
    device.run(10)
    assert device.integer("total") == 42
