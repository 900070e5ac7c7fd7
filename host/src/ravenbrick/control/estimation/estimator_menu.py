# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The speed estimators side by side on one loop: settling, ripple, what the actuator gets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ravenbrick.control.estimation.encoder_run import (
    EncoderRun,
    RunMeasures,
    SampleTiming,
    encoder_run,
    measure_runs,
)
from ravenbrick.control.estimation.speed_estimators import (
    EdgeTimes,
    FilteredDifference,
    MotorObserver,
    SpeedEstimator,
    TrackingLoop,
    WindowEstimator,
)
from ravenbrick.control.synthesis.controller import pi_diagram
from ravenbrick.control.synthesis.tuning import DiscretePi
from ravenbrick.model import Encoder, SpeedLoop

__all__ = ["EstimatorRow", "compare_speed_estimators", "plot_speed_estimators", "standard_menu"]

PHASES = 4
Maker = Callable[[Encoder], SpeedEstimator | None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class EstimatorRow:
    """One estimator at one set-point (V): measures over encoder phases, and the first run."""

    name: str
    set_point: float
    measures: RunMeasures
    run: EncoderRun


def standard_menu(loop: SpeedLoop, sample_time: float) -> dict[str, Maker]:
    """Makers by name; each run gets a new estimator."""

    def window(length: int) -> Maker:
        return lambda encoder: WindowEstimator(encoder, length, sample_time)

    return {
        "ideal speed": lambda encoder: None,
        "difference": window(1),
        "window of 4 samples": window(4),
        "window of 8 samples": window(8),
        "window of 16 samples": window(16),
        "difference, low pass 5 Hz": lambda e: FilteredDifference(e, 5.0, sample_time),
        "difference, low pass 2 Hz": lambda e: FilteredDifference(e, 2.0, sample_time),
        "edge times, 1 us": lambda e: EdgeTimes(e, 1e-6),
        "edge times, 1 ms": lambda e: EdgeTimes(e, 1e-3),
        "tracking loop 5 Hz": lambda e: TrackingLoop(e, 5.0, sample_time),
        "observer with motor model": lambda e: MotorObserver(e, loop, sample_time),
    }


def compare_speed_estimators(
    loop: SpeedLoop,
    pi: DiscretePi,
    supply_voltage: float,
    set_points: Sequence[float],
    menu: Mapping[str, Maker],
    timing: SampleTiming | None = None,
    duration: float = 2.0,
    progress: Progress | None = None,
) -> list[EstimatorRow]:
    """Encoder-true steps for each estimator and set-point, mean of four phases of the encoder."""
    diagram = pi_diagram(pi, supply_voltage, loop.time_constant)
    rows = []
    for name, maker in menu.items():
        for set_point in set_points:
            runs = []
            for index in range(PHASES):
                phase = index / PHASES
                runs.append(
                    encoder_run(
                        loop,
                        diagram,
                        set_point,
                        duration,
                        None,
                        phase=phase,
                        estimator=maker(Encoder(phase=phase)),
                        timing=timing,
                    )
                )
            rows.append(EstimatorRow(name, set_point, measure_runs(runs), runs[0]))
            if progress is not None:
                progress(len(rows), len(menu) * len(set_points))
    return rows


def plot_speed_estimators(rows: Sequence[EstimatorRow], path: Path) -> None:
    """True speed and motor voltage of the first runs over time, one curve per estimator."""
    import matplotlib
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for row in rows:
        upper.plot(row.run.fine_time, row.run.speed / row.set_point, label=row.name, linewidth=1)
        lower.step(row.run.time, row.run.control, where="post", linewidth=1)
    upper.axhspan(0.98, 1.02, color="0.9", zorder=0)
    upper.set_ylabel("true speed / set-point")
    lower.set_ylabel("motor voltage (V)")
    lower.set_xlabel("time (s)")
    lower.set_xlim(0, 1)
    upper.set_ylim(0, np.ceil(10 * max(r.run.speed.max() / r.set_point for r in rows)) / 10)
    upper.legend(fontsize="small", loc="lower right")
    with matplotlib.rc_context({"svg.hashsalt": "ravenbrick"}):
        figure.savefig(path, metadata={"Date": None})
