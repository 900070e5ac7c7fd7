# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The drivers' costs are measured, and stay within what their descriptions promise."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import cache

import pytest
from ravenbrick.telemetry.frames import frame
from ravenbrick.telemetry.messages import Sample, encode

from verification.benchmarks.driver_costs import (
    PROGRAMS,
    SAMPLE_BYTES,
    TELEMETRY,
    Measured,
    figures,
    measure,
    table,
    telemetry_memory,
)
from verification.support.bricks.driver_programs import image_of
from verification.support.paths import ROOT

CYCLES_PER_MS = 48_055
SHORT = CYCLES_PER_MS // 50
READINGS = (
    "Encoder_Count",
    "Pressed",
    "Raw_Input",
    "Light_Value",
    "Sound_Level",
    "Voltage",
    "Current_Button",
    "Last_Reset",
    "Convert",
    "Publish",
)
SUSPENDING = {
    "`Ultrasonic_Sensors.Measure`",
    "`Color_Sensors.Measure`",
    "`Parameters.Store.Save`",
    "`Brick_Name.Set_Name`",
    "`Power.Reset_At_Brown_Out`",
}
BOUNDED_WAITS = {
    "nxt-flash_pages.adb": "6 ms for the flash memory in which the image lies",
    "nxt-last_chance.adb": "after an unhandled exception, when nothing runs any more",
    "nxt-spi-bus.adb": "after an unhandled exception, when nothing runs any more",
    "nxt-usb.adb": "20 reads of a register that follows a write a few clocks later",
}
EMPTY_LOOP = re.compile(r"\bloop\s+(?:null;\s*|exit when[^;]*;\s*)?end loop")
PAGE = ROOT / "docs" / "reference" / "driver-costs.md"


@pytest.fixture(scope="module")
def results() -> Callable[[str], Measured]:
    """From the name of a program to what its run gives."""
    programs = {program.name: program for program in PROGRAMS}
    return cache(lambda name: measure(programs[name], image_of(name, "ram")))


@pytest.fixture(params=[program.name for program in PROGRAMS])
def measured(request: pytest.FixtureRequest, results: Callable[[str], Measured]) -> Measured:
    """What a program's run gives."""
    return results(request.param)


def test_operations_are_short(measured: Measured) -> None:
    """Less than 1 ms of its task for any, 20 us for a reading, 50 us of masking."""
    operations, interrupts, tasks = measured
    for row in operations[1:-1]:
        assert 0 < row.task < CYCLES_PER_MS, row
        assert row.masked < CYCLES_PER_MS // 20, row
        if any(name in row.name for name in READINGS):
            assert row.task < SHORT, row
    assert abs(operations[-1].task) < 50
    limits = {"co-processor (TWI)": 22, "sensor buses (TC1)": 52, "colour sensors (TC2)": 40}
    for interrupt in interrupts:
        limit_us = limits.get(interrupt.name, 1_000)
        assert interrupt.longest < limit_us * CYCLES_PER_MS // 1_000, interrupt
    longest = {task.name: task.longest for task in tasks}
    assert 0 < longest["coprocessor_task"] < CYCLES_PER_MS // 10
    assert longest.get("regulator_task", 1) < CYCLES_PER_MS // 2


def test_no_operation_polls(measured: Measured) -> None:
    """One that lasts longer than its net time is suspended: the processor is free meanwhile."""
    for row in measured[0][1:-1]:
        suspended = row.returns_after - row.task - row.interrupts
        if row.name in SUSPENDING:
            assert suspended > 4 * row.task, row
        else:
            assert row.returns_after < row.task + SHORT, row


def test_no_loop_waits_for_a_register() -> None:
    """But for waits that are bounded, each with its reason."""
    sources = (ROOT / "drivers" / "src").rglob("*.adb")
    waiting = {path.name for path in sources if EMPTY_LOOP.search(path.read_text())}
    assert waiting == set(BOUNDED_WAITS)


def test_the_page_has_the_figures_of_today(results: Callable[[str], Measured]) -> None:
    """Else it is stale: `make -C drivers costs` writes it."""
    known = json.loads(PAGE.with_suffix(".json").read_text(encoding="utf-8"))
    assert table(known) == PAGE.read_text(encoding="utf-8")
    assert known == figures(results, image_of(TELEMETRY, "ram"))


def test_telemetry_is_cheap_where_it_is_published(results: Callable[[str], Measured]) -> None:
    """While a host listens: 8 values in 20 us, a parameter in 1 us, the server below 1 ms a job."""
    operations, _, tasks = results(TELEMETRY)
    one, four, eight, current = operations[1:-1]
    assert 0 < one.task < four.task < eight.task < CYCLES_PER_MS // 50
    assert eight.masked < CYCLES_PER_MS // 50
    assert 0 < current.task < CYCLES_PER_MS // 1000
    assert 0 < {task.name: task.longest for task in tasks}["server_task"] < CYCLES_PER_MS
    memory = telemetry_memory(image_of(TELEMETRY, "ram"))
    assert all(row["code_bytes"] > 0 and row["data_bytes"] > 0 for row in memory)
    assert sum(row["code_bytes"] + row["data_bytes"] for row in memory) < 16_384


def test_the_bytes_of_a_sample_are_those_of_the_page() -> None:
    """Frame included, for one value and for eight."""
    for count in (1, 8):
        words = (b"\1\2\3\4",) * count
        line = frame(encode(Sample(1, 7, 9, words)))
        assert len(line) == SAMPLE_BYTES + 4 * count
