# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Plots of runs; one module per picture, each returns a figure."""

from __future__ import annotations

from ravenbrick.trace.plots.dynamics import dynamics_figure
from ravenbrick.trace.plots.lcd import lcd_figure
from ravenbrick.trace.plots.path import path_figure
from ravenbrick.trace.plots.schedule import (
    cyclic_begin_cycles,
    first_release_cycles,
    schedule_figure,
)
from ravenbrick.trace.plots.speeds import speeds_figure
from ravenbrick.trace.plots.step_response import step_response_figure
from ravenbrick.trace.plots.tasks import tasks_figure

__all__ = [
    "cyclic_begin_cycles",
    "dynamics_figure",
    "first_release_cycles",
    "lcd_figure",
    "path_figure",
    "schedule_figure",
    "speeds_figure",
    "step_response_figure",
    "tasks_figure",
]
