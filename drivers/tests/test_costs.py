# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The drivers' costs are measured, and stay within what their descriptions promise."""

from __future__ import annotations

from collections.abc import Callable

from drivers.tests.cost_table import MORE_OPERATIONS, measure

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
