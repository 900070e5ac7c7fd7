# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The drivers' costs are measured, and stay within what their descriptions promise."""

from __future__ import annotations

from collections.abc import Callable

from ravenbrick.telemetry.frames import frame
from ravenbrick.telemetry.messages import Sample, encode

from drivers.tests.cost_table import (
    MORE_OPERATIONS,
    SAMPLE_BYTES,
    TELEMETRY_END_MS,
    TELEMETRY_OPERATIONS,
    measure,
    start_with_host,
    telemetry_memory,
)

CYCLES_PER_MS = 48_055
READINGS = ("Encoder_Count", "Pressed", "Raw_Input", "Light_Value", "Sound_Level", "Voltage")


def test_no_operation_polls_and_readings_are_short(image: Callable[[str, str], bytes]) -> None:
    """The longest operation takes less than 1 ms of its task, a reading less than 20 us."""
    operations, interrupts, tasks = measure(image("costs", "ram"))
    for row in operations[1:-1]:
        assert 0 < row.task < CYCLES_PER_MS, row
        assert row.masked < CYCLES_PER_MS // 20, row
        if any(name in row.name for name in READINGS):
            assert row.task < CYCLES_PER_MS // 50, row
    by_name = {row.name: row for row in interrupts}
    assert by_name["co-processor (TWI)"].longest < 22 * CYCLES_PER_MS // 1000
    assert by_name["sensor buses (TC1)"].longest < 52 * CYCLES_PER_MS // 1000
    assert abs(operations[-1].task) < 50
    assert [task.name for task in tasks] == ["coprocessor_task"]
    assert 0 < tasks[0].longest < CYCLES_PER_MS // 10


def test_the_other_drivers_are_short_too(image: Callable[[str, str], bytes]) -> None:
    """A line of 100 pixels takes less than 1 ms, all else 0.2 ms; three regulators 0.5 ms."""
    operations, interrupts, tasks = measure(image("more_costs", "ram"), MORE_OPERATIONS)
    for row in operations[1:-1]:
        limit = CYCLES_PER_MS if "Draw_Line" in row.name else CYCLES_PER_MS // 5
        assert 0 < row.task < limit, row
        assert row.masked < CYCLES_PER_MS // 20, row
    assert {row.name for row in interrupts} >= {"RS485 (USART0)"}
    longest = {task.name: task.longest for task in tasks}
    assert 0 < longest["regulator_task"] < CYCLES_PER_MS // 2


def test_telemetry_is_cheap_where_it_is_published(image: Callable[[str, str], bytes]) -> None:
    """While a host listens: 8 values in 20 us, a parameter in 1 us, the server below 1 ms a job."""
    elf = image("telemetry_costs", "ram")
    operations, _, tasks = measure(elf, TELEMETRY_OPERATIONS, start_with_host, TELEMETRY_END_MS)
    one, four, eight, current = operations[1:-1]
    assert 0 < one.task < four.task < eight.task < CYCLES_PER_MS // 50
    assert eight.masked < CYCLES_PER_MS // 50
    assert 0 < current.task < CYCLES_PER_MS // 1000
    assert 0 < {task.name: task.longest for task in tasks}["talker"] < CYCLES_PER_MS
    memory = telemetry_memory(elf)
    assert all(row["code_bytes"] > 0 and row["data_bytes"] > 0 for row in memory)
    assert sum(row["code_bytes"] + row["data_bytes"] for row in memory) < 16_384


def test_the_bytes_of_a_sample_are_those_of_the_page() -> None:
    """Frame included, for one value and for eight."""
    for count in (1, 8):
        words = (b"\1\2\3\4",) * count
        line = frame(encode(Sample(1, 7, 9, words)))
        assert len(line) == SAMPLE_BYTES + 4 * count
