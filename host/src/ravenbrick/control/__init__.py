# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers: tuning, discretisation, sampled loops, step metrics."""

from __future__ import annotations

from ravenbrick.control.analysis.frequency_plots import (
    bode_figure,
    nyquist_figure,
    plane_grid,
    root_locus_figure,
)
from ravenbrick.control.analysis.metrics import Margins, StepMetrics, margins, step_metrics
from ravenbrick.control.analysis.robustness import (
    Extreme,
    MonteCarlo,
    Tolerance,
    monte_carlo,
    worst_case,
)
from ravenbrick.control.analysis.sampled import SampledLoop, StepResponse
from ravenbrick.control.design.design import Design, EstimatorComparison, finish_design
from ravenbrick.control.design.design_plots import DesignedLoop, Robustness, write_figure
from ravenbrick.control.design.family import FamilyMember, gain_family
from ravenbrick.control.design.interactive import InteractiveDesign, TunableLoop
from ravenbrick.control.design.responses import write_diagram_results, write_loop_results
from ravenbrick.control.estimation.encoder_run import (
    EncoderRun,
    RunMeasures,
    SampleTiming,
    encoder_run,
    measure_runs,
)
from ravenbrick.control.estimation.estimator import LoopSpecification, pi_with_estimator
from ravenbrick.control.estimation.estimator_menu import (
    EstimatorRow,
    compare_speed_estimators,
    plot_speed_estimators,
    standard_menu,
)
from ravenbrick.control.rounding.limit_cycles import (
    LimitCycle,
    LimitCycleSearch,
    search_limit_cycles,
)
from ravenbrick.control.rounding.peak_gain import peak_gain
from ravenbrick.control.rounding.rounding_error import (
    ClosedLoopBound,
    PlantInLoop,
    closed_loop_bound,
    one_step_errors,
)
from ravenbrick.control.synthesis.compensators import feed_forward, lag, lead, smith_predictor
from ravenbrick.control.synthesis.controller import pi_diagram
from ravenbrick.control.synthesis.discretisation import (
    Discretisation,
    DiscretisationMethod,
    compare_discretisations,
    discretise,
)
from ravenbrick.control.synthesis.pid_tuning import PidGains, pid_by_margin, pid_by_poles
from ravenbrick.control.synthesis.regulator import (
    Observer,
    StateFeedback,
    dlqr,
    kalman,
    lqg,
    lqr,
    observer_by_poles,
    observer_system,
    with_integrators,
)
from ravenbrick.control.synthesis.tuning import (
    DiscretePi,
    PiGains,
    pi_by_damping,
    pi_by_lambda,
    pi_direct,
    pi_family,
)

__all__ = [
    "ClosedLoopBound",
    "Design",
    "DesignedLoop",
    "DiscretePi",
    "Discretisation",
    "DiscretisationMethod",
    "EncoderRun",
    "EstimatorComparison",
    "EstimatorRow",
    "Extreme",
    "FamilyMember",
    "InteractiveDesign",
    "LimitCycle",
    "LimitCycleSearch",
    "LoopSpecification",
    "Margins",
    "MonteCarlo",
    "Observer",
    "PiGains",
    "PidGains",
    "PlantInLoop",
    "Robustness",
    "RunMeasures",
    "SampleTiming",
    "SampledLoop",
    "StateFeedback",
    "StepMetrics",
    "StepResponse",
    "Tolerance",
    "TunableLoop",
    "bode_figure",
    "closed_loop_bound",
    "compare_discretisations",
    "compare_speed_estimators",
    "discretise",
    "dlqr",
    "encoder_run",
    "feed_forward",
    "finish_design",
    "gain_family",
    "kalman",
    "lag",
    "lead",
    "lqg",
    "lqr",
    "margins",
    "measure_runs",
    "monte_carlo",
    "nyquist_figure",
    "observer_by_poles",
    "observer_system",
    "one_step_errors",
    "peak_gain",
    "pi_by_damping",
    "pi_by_lambda",
    "pi_diagram",
    "pi_direct",
    "pi_family",
    "pi_with_estimator",
    "pid_by_margin",
    "pid_by_poles",
    "plane_grid",
    "plot_speed_estimators",
    "root_locus_figure",
    "search_limit_cycles",
    "smith_predictor",
    "standard_menu",
    "step_metrics",
    "with_integrators",
    "worst_case",
    "write_diagram_results",
    "write_figure",
    "write_loop_results",
]
