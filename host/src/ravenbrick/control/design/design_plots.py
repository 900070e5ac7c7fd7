# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The pictures of a design: frequency response, poles, gain family, discretisation, tolerances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ravenbrick.control.analysis import frequency_plots, robustness
from ravenbrick.control.analysis.metrics import crossovers
from ravenbrick.control.analysis.sampled import SampledLoop
from ravenbrick.control.design.family import FamilyMember, gain_family
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.control.synthesis.discretisation import DiscretisationMethod, discretise
from ravenbrick.control.synthesis.tuning import PiGains
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem, SpeedLoop
from ravenbrick.model.lazy import control

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["DesignedLoop", "Robustness", "read_system", "write_figure", "written_system"]

TOLERANCE = 0.2
SAMPLES = 60
_DURATION = 0.8


def written_system(system: control.StateSpace | LinearSystem) -> dict[str, Any]:
    """A linear system as JSON values; `sample_time` is None in continuous time."""
    matrices = {name: np.asarray(getattr(system, name.upper())).tolist() for name in "abcd"}
    sample_time = float(system.dt) if system.isdtime(strict=True) else None
    return {**matrices, "sample_time": sample_time}


def read_system(values: Mapping[str, Any]) -> control.StateSpace:
    """The system that `written_system` wrote."""
    states = len(values["a"])
    b = np.asarray(values["b"], dtype=float).reshape(states, -1)
    d = np.asarray(values["d"], dtype=float)
    a = np.asarray(values["a"], dtype=float).reshape(states, states)
    c = np.asarray(values["c"], dtype=float).reshape(len(d), states)
    dt = values["sample_time"]
    return control.ss(a, b, c, d, 0 if dt is None else dt)


@dataclass(frozen=True)
class Robustness:
    """Figures over the plant's tolerances: random samples, and the worst case."""

    samples: robustness.MonteCarlo
    extremes: Mapping[str, tuple[robustness.Extreme, robustness.Extreme]]

    def rows(self) -> list[dict[str, float | str]]:
        """Least, median, largest of the samples and of the worst case by figure."""
        return [
            {
                "figure": name,
                "least": low.value,
                "median": self.samples.percentile(name, 0.5),
                "largest": high.value,
            }
            for name, (low, high) in self.extremes.items()
        ]


@dataclass(frozen=True, eq=False)
class DesignedLoop:
    """What the pictures need of a design: plant, specification, continuous gains, controller.

    `controller` goes from set-point and speed (V) to control input (V), or from their difference.
    """

    loop: SpeedLoop
    specification: LoopSpecification
    continuous: PiGains
    controller: control.StateSpace | LinearSystem

    def sampled(self, loop: SpeedLoop | None = None) -> SampledLoop:
        """The loop as it runs, with another plant if given."""
        own = self.specification
        return SampledLoop(loop or self.loop, self.controller, own.window, own.delay)

    def written(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            "plant": vars(self.loop),
            "specification": vars(self.specification),
            "continuous_gains": vars(self.continuous),
            "controller": written_system(LinearSystem.of(self.controller)),
            "crossovers": crossovers(self.sampled().open_loop_system()),
        }

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> DesignedLoop:
        """The loop that `written` gave; raises `DesignError`."""
        try:
            return cls(
                SpeedLoop(**values["plant"]),
                LoopSpecification(**values["specification"]),
                PiGains(**values["continuous_gains"]),
                read_system(values["controller"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError(f"the design's loop is incomplete: {error}") from error

    def frequency_figures(self) -> dict[str, Figure]:
        """Bode, Nyquist and root locus by file name, the ideal loop beside."""
        own = self.sampled().open_loop()
        ideal = self.loop.plant() * self.continuous.controller()
        return {
            "bode": frequency_plots.bode_figure(own, "Open loop", ideal),
            "nyquist": frequency_plots.nyquist_figure(own, "Open loop", ideal),
            "root-locus": frequency_plots.root_locus_figure(own, "Speed loop"),
        }

    def family(
        self, progress: Callable[[int, int], None] | None = None
    ) -> tuple[FamilyMember, ...]:
        """All gains that meet the specification."""
        return gain_family(self.loop, self.specification, progress=progress)

    def family_figure(self, members: Sequence[FamilyMember]) -> Figure:
        """Step responses of the continuous members, and the band that they enter together."""
        figure, axes = frequency_plots.new_figure(8, 4.5)
        axis = axes[0, 0]
        time = np.linspace(0.0, _DURATION, 801)
        for member in members:
            if member.where != "continuous":
                continue
            closed = self.loop.closed_loop(member.gains.controller())
            values = control.step_response(closed, time).outputs
            gains = f"Kp {member.gains.proportional:.4g}, Ki {member.gains.integral:.4g}/s"
            axis.plot(time, values, label=f"{member.design}: {gains}")
        wanted = self.specification.settling_time
        axis.axhspan(0.98, 1.02, color="0.92", zorder=0)
        axis.axvline(wanted, color="#555555", linewidth=1, linestyle=":")
        axis.set_xlabel("time (s)")
        axis.set_ylabel("speed / set-point (V/V)")
        axis.set_xlim(0, _DURATION)
        axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
        axis.legend(fontsize=9, loc="lower right")
        axis.set_title(f"All of these settle in {wanted:g} s (2 %)", fontsize=10)
        return figure  # type: ignore[no-any-return]

    def discretisation_figure(self) -> Figure:
        """The controller made discrete by each method: frequency response and step, side by side.

        The step is that of the loop with ideal speed samples and no delay.
        """
        figure, axes = frequency_plots.new_figure(10, 5.5, rows=2, columns=2)
        step_axis, error_axis = axes[0, 1], axes[1, 1]
        system, dt = self.continuous.controller(), self.specification.sample_time
        frequencies = np.geomspace(0.5, np.pi / dt * 0.999, 400)
        exact = system(1j * frequencies)
        closed = control.step_response(self.loop.closed_loop(system), np.arange(0, _DURATION, dt))
        step_axis.plot(closed.time, closed.outputs, "k", linewidth=2.5, alpha=0.25,
                       label="continuous")  # fmt: skip
        for method in DiscretisationMethod:
            try:
                found = discretise(system, dt, method)
            except DesignError:
                continue
            ratio = found(np.exp(1j * frequencies * dt)) / exact
            name = method.name.lower().replace("_", " ")
            axes[0, 0].semilogx(frequencies, 20 * np.log10(np.abs(ratio)), label=name)
            axes[1, 0].semilogx(frequencies, np.degrees(np.angle(ratio)), label=name)
            response = SampledLoop(self.loop, found).step_response(_DURATION, 1)
            step_axis.plot(response.time, response.output, linewidth=1, label=name)
            length = min(len(response.time), len(closed.time))
            difference = response.output[:length] - closed.outputs[:length]
            error_axis.plot(response.time[:length], difference, linewidth=1)
        axes[0, 0].set_ylabel("magnitude over continuous (dB)")
        axes[1, 0].set_ylabel("phase less continuous (deg)")
        axes[1, 0].set_xlabel("frequency (rad/s)")
        step_axis.set_ylabel("speed / set-point (V/V)")
        error_axis.set_ylabel("less continuous (V/V)")
        error_axis.set_xlabel("time (s)")
        axes[0, 0].legend(fontsize=8)
        step_axis.legend(fontsize=8)
        figure.suptitle(f"The controller at {1000 * dt:g} ms, by method", fontsize=10)
        return figure  # type: ignore[no-any-return]

    def robustness(
        self, progress: Callable[[int, int], None] | None = None, samples: int = SAMPLES
    ) -> Robustness:
        """Settling time, overshoot and phase margin with gain and time constant within 20 %."""

        def figures(point: Mapping[str, float]) -> Mapping[str, float]:
            plant = SpeedLoop(point["gain"], point["time_constant"], self.loop.degrees_per_volt)
            sampled = self.sampled(plant)
            metrics = sampled.step_metrics()
            return {
                "settling_time": metrics.settling_time,
                "overshoot": metrics.overshoot,
                "phase_margin_deg": sampled.margins().phase_margin_deg,
            }

        tolerances = (
            robustness.Tolerance.relative("gain", self.loop.gain, TOLERANCE),
            robustness.Tolerance.relative("time_constant", self.loop.time_constant, TOLERANCE),
        )

        def second_half(done: int, total: int) -> None:
            if progress is not None:
                progress(total + done, 2 * total)

        def first_half(done: int, total: int) -> None:
            if progress is not None:
                progress(done, 2 * total)

        found = robustness.monte_carlo(figures, tolerances, samples, seed=1, progress=first_half)
        return Robustness(found, robustness.worst_case(figures, tolerances, second_half))

    def robustness_figure(self, found: Robustness) -> Figure:
        """Settling time over the plant's gain, coloured by its time constant; its distribution."""
        figure, axes = frequency_plots.new_figure(10, 4.5, columns=2)
        left, right = axes[0]
        samples = found.samples
        settling = 1000 * samples.figures["settling_time"]
        dots = left.scatter(samples.parameters["gain"], settling, s=18,
                            c=1000 * samples.parameters["time_constant"])  # fmt: skip
        figure.colorbar(dots, ax=left, label="time constant of the motor (ms)")
        left.set_xlabel("gain of the motor (rad/s per V)")
        left.set_ylabel("settling time (ms)")
        right.hist(settling, bins=20, color="#1f5fa8")
        low, high = found.extremes["settling_time"]
        for extreme, name in ((low, "least"), (high, "largest")):
            right.axvline(1000 * extreme.value, color="#b3372f", linestyle="--", linewidth=1)
            right.annotate(f" {name} {1000 * extreme.value:.0f} ms", (1000 * extreme.value, 0.5),
                           rotation=90, fontsize=8, va="bottom")  # fmt: skip
        right.set_xlabel("settling time (ms)")
        right.set_ylabel(f"samples of {len(settling)}")
        figure.suptitle(f"Motor within {TOLERANCE:.0%} of its gain and time constant", fontsize=10)
        return figure  # type: ignore[no-any-return]


def write_figure(figure: Figure, path: Path) -> None:
    """The figure as a file, the same bytes each time; the suffix says the format."""
    import matplotlib

    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": "ravenbrick"}):
        figure.savefig(path, metadata=metadata, dpi=150)
