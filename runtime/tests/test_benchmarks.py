# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The benchmark's figures: complete, well formed, and within the limits of the README."""

from __future__ import annotations

from runtime.benchmarks.measure import figures

# Limit of the worst sample in cycles
LIMITS = {
    "protected procedure": 60,
    "voluntary switch": 90,
    "suspension object to task": 110,
    "entry opened to task": 300,
    "interrupt to handler": 90,
    "interrupt to task": 320,
    "interrupt to handler under load": 300,
    "masked section seen by the highest level": 250,
    "delay until, idle processor": 320,
    "delay until, busy processor": 350,
}


def test_every_figure_is_within_its_limit_at_random_phases() -> None:
    """Worst of at least 1 000 samples each; the processor works at most 400 idle cycles/s."""
    rows = {row["figure"]: row for row in figures()}
    assert set(rows) == {*LIMITS, "work while idle, per second"}
    for figure, limit in LIMITS.items():
        assert rows[figure]["samples"] >= 1_000
        assert rows[figure]["best"] <= rows[figure]["mean"] <= rows[figure]["worst"] <= limit
    assert 0 < rows["work while idle, per second"]["mean"] <= 400
