# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The drivers' costs are measured, and stay within what their descriptions promise."""

from __future__ import annotations

from collections.abc import Callable

from drivers.tests.cost_table import measure

CYCLES_PER_MS = 48_055
READINGS = ("Encoder_Count", "Pressed", "Raw_Input", "Light_Value", "Sound_Level", "Voltage")


def test_no_operation_polls_and_readings_are_short(image: Callable[[str, str], bytes]) -> None:
    """The longest operation takes less than 1 ms of its task, a reading less than 20 us."""
    operations, interrupts, link = measure(image("costs", "ram"))
    for row in operations[1:-1]:
        assert 0 < row.task < CYCLES_PER_MS, row
        assert row.masked < CYCLES_PER_MS // 20, row
        if any(name in row.name for name in READINGS):
            assert row.task < CYCLES_PER_MS // 50, row
    by_name = {row.name: row for row in interrupts}
    assert by_name["co-processor (TWI)"].longest < 22 * CYCLES_PER_MS // 1000
    assert by_name["sensor buses (TC1)"].longest < 52 * CYCLES_PER_MS // 1000
    assert abs(operations[-1].task) < 50
    assert 0 < link < CYCLES_PER_MS // 10
