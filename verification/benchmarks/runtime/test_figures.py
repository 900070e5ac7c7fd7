# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the run-time: complete, well formed, and within the limits of its README."""

from __future__ import annotations

from types import ModuleType

import pytest

from verification.benchmarks.runtime import footprints, paths, sections
from verification.benchmarks.runtime.measure import figures
from verification.support.bricks.runtime_programs import build

# Limit of the worst sample in cycles
LIMITS = {
    "protected procedure": 60,
    "protected procedure with its call": 60,
    "entry call, barrier open": 150,
    "context switch, voluntary": 90,
    "suspension object to task": 110,
    "entry opened to task": 300,
    "interrupt to handler": 80,
    "interrupt to task": 300,
    "interrupt to handler under load": 300,
    "masked section seen by the highest level": 250,
    "delay until, idle processor, from the clock's tick": 350,
    "delay until, idle processor": 350,
    "delay until, busy processor": 350,
    "delay until, six tasks released together": 1_800,
    "timing event to handler": 350,
}
SPREAD_CYCLES = 20


def test_every_figure_is_within_its_limit_at_random_phases() -> None:
    """Worst of at least 10 000 samples each; the processor works at most 400 idle cycles/s."""
    rows = {row["figure"]: row for row in figures()}
    assert set(rows) == {*LIMITS, "work while idle, per second"}
    for figure, limit in LIMITS.items():
        assert rows[figure]["samples"] >= 10_000
        assert rows[figure]["best"] <= rows[figure]["mean"] <= rows[figure]["worst"] <= limit
    from_tick = rows["delay until, idle processor, from the clock's tick"]
    assert from_tick["worst"] - from_tick["best"] <= SPREAD_CYCLES
    assert 0 < rows["work while idle, per second"]["mean"] <= 400


@pytest.mark.parametrize(("state", "limit_bytes"), [("arm", 6_800), ("thumb", 4_600)])
def test_kernel_and_language_layer_fit(state: str, limit_bytes: int) -> None:
    """Linked code and constants of the run-time, the compiler's helpers included."""
    elf = build("footprint", code=state, runtime=state)
    assert 2_000 < footprints.linked_bytes(elf) <= limit_bytes


@pytest.mark.long("records each step of ten programs")
@pytest.mark.parametrize("measured", [paths, sections, footprints])
def test_a_generated_page_is_what_is_measured_now(measured: ModuleType) -> None:
    """The chapter's walk through the code, the critical sections, the footprint of each feature."""
    assert measured.PAGE.read_text() == measured.page()
