# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How programs end: power off, and an exception that nothing handles."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from verification.support.bricks.observe import Brick

SOURCE = Path(__file__).resolve().parent / "programs" / "last_chance" / "last_chance.adb"


def failing_line() -> int:
    """Line of the source that breaks the range."""
    lines = SOURCE.read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if "the failure" in line)


def test_power_down_stops_the_motors_and_switches_off(brick: Callable[..., Brick]) -> None:
    """The brick goes off soon after the call, with no motor driven."""
    device = brick("power_off")
    device.run(490)
    assert device.motors(at_ms=490)["B"] == (80, True)
    stop = device.run_to_end(2_000)
    assert stop.reason == "power_off"
    assert device.cycles(500) < stop.at_cycles < device.cycles(600)
    assert device.motors(at_ms=2_000)["B"][0] == 0


def test_an_unhandled_exception_brakes_the_motors(brick: Callable[..., Brick]) -> None:
    """Until the failure the motors run; soon after it all are braked, and stay so."""
    device = brick("last_chance")
    device.run(395)
    assert device.motors(at_ms=395) == {"A": (0, True), "B": (60, True), "C": (-60, True)}
    device.run_to_end(700)
    stopped = {"A": (0, True), "B": (0, True), "C": (0, True)}
    assert device.motors(at_ms=415) == stopped
    assert device.motors(at_ms=700) == stopped


def test_an_unhandled_exception_names_its_place(brick: Callable[..., Brick]) -> None:
    """The display shows the file and the line of the failing statement."""
    device = brick("last_chance")
    device.run_to_end(700)
    text = device.text()
    assert text[0] == "Program failed"
    assert "".join(text[2:4]) == f"last_chance.adb:{failing_line()}"


def test_a_failed_program_goes_on_noting_the_count_of_its_clock(
    brick: Callable[..., Brick],
) -> None:
    """Else it misses every second wrap of the 32 bits, and waits 24 minutes for the power button.

    What was noted last stands first in the record; a count is 16 cycles.
    """
    device = brick("last_chance")
    device.set(5_000, "button.orange", 1)
    noted = []
    for ms in (600, 700, 800):
        device.run(ms)
        address, _ = device.device.symbol("ravenbrick__clock__seen")
        noted.append(int.from_bytes(device.device.read_memory(address, 4), "little"))
    per_100_ms = device.cycles(100) / 16
    for earlier, later in pairwise(noted):
        assert abs(later - earlier - per_100_ms) < 0.1 * per_100_ms


def test_a_full_stack_is_reported_with_the_name_of_its_task(brick: Callable[..., Brick]) -> None:
    """As pragma Task_Name gives it, before anything below the stack is overwritten."""
    device = brick("stack_overflow")
    assert device.run_to_end(400).reason == "halted"
    assert device.text() == [
        "Program failed",
        "",
        "Storage_Error: s",
        "tack overflow",
        "task recursive",
        "priority 12",
        "",
        "",
    ]
    (recursive,) = (thread for thread in device.device.threads() if thread.name == "recursive")
    assert recursive.stack_used <= recursive.stack_size - 100


def test_a_ceiling_violation_is_reported_with_task_and_object(brick: Callable[..., Brick]) -> None:
    """The object by its ceiling and an address in it, which the linker's map names."""
    device = brick("ceiling_violation")
    assert device.run_to_end(400).reason == "halted"
    *text, last = device.text()
    assert text == [
        "Program failed",
        "",
        "Program_Error: c",
        "eiling violated",
        "task climber",
        "priority 12",
        "ceiling 10",
    ]
    address, size = device.device.symbol("low_ceiling__shared")
    word, shown = last.split()
    assert word == "object"
    assert address <= int(shown, 16) < address + size


def test_the_greeting_keeps_the_brick_on(brick: Callable[..., Brick]) -> None:
    """The co-processor switches off after 298 s, but only a program that did not greet it."""
    mute = brick("messages", signal_period_cycles=48_000_000)
    assert mute.run_to_end(310_000).reason == "power_off"
    assert mute.cycles(290_000) < mute.device.cycles < mute.cycles(300_000)
    greeting = brick("inputs", signal_period_cycles=48_000_000)
    greeting.run(310_000)
    assert greeting.integer("errors") == 0
