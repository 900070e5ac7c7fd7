# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Paths driven with the controller and without it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ravenbrick.target.scenario import Scenario
from ravenbrick.trace.measures import RunMeasures
from ravenbrick.trace.plots.style import COLOURS, legend, new_figure
from ravenbrick.trace.recording import Recording

__all__ = ["path_figure"]

PathRun = tuple[str, str, Scenario, Recording, RunMeasures]


def path_figure(runs: Sequence[PathRun]) -> Figure:
    """Seen from above, in m, both axes to the same scale; `runs`: label, colour name, run."""
    figure, (axis,) = new_figure(8.0, 4.8)
    for label, colour, scenario, recording, measures in runs:
        times, x = recording.signal("body.x")
        _, y = recording.signal("body.y")
        deviation = measures.path.lateral_deviation if measures.path else None
        text = label
        if deviation is not None and scenario.straight is not None:
            text += f": {1000 * deviation:.1f} mm off after {scenario.straight.distance:g} m"
        axis.plot(x, y, color=COLOURS[colour], linewidth=1.6, label=text)
        for second in range(0, int(times[-1]) + 1, 2):
            index = int(np.searchsorted(times, second))
            if index < len(x):
                axis.plot(x[index], y[index], ".", color=COLOURS[colour], markersize=4)
    axis.plot(0, 0, "o", color=COLOURS["setpoint"], markersize=5)
    axis.annotate("start", (0, 0), xytext=(5, 6), textcoords="offset points", fontsize=8.5)
    axis.axhline(0, color=COLOURS["setpoint"], linewidth=0.8, linestyle=":")
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("x (m); a dot every 2 s")
    axis.set_ylabel("y (m)")
    legend(axis, "best")
    return figure
