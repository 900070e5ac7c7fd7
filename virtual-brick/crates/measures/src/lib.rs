// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures of a recorded run, and verdicts on what was expected of it.
//!
//! A run is events, signals, threads and texts of the display; nothing here knows how it was made.
//! The host and the page judge with this crate, so both say the same of the same run.
//! Transcendental functions come from `libm`, which gives the same bits everywhere.

mod answer;
mod general;
mod interpolation;
mod measures;
mod motion;
mod run;
mod schedule;
mod sentence;
mod units;
mod verdict;

pub use interpolation::{monotone_cubic, moving_slope};
pub use measures::{
    measure, Criterion, Measures, Plan, Setpoint, StepRecord, StepWindow, StraightDrive,
};
pub use motion::{
    count_difference_speed, fitted_speed, path_measures, step_measures, PathMeasures, StepMeasures,
    RADIANS_PER_COUNT, SETTLING_BAND, WINDOW,
};
pub use run::{Clock, Input, Run, Screen, Stop, Thread};
pub use schedule::{
    by_priority, jobs, stretches, utilization, Job, Stretch, Task, TaskMeasures, Utilization,
    IDLE_OWNER, INTERRUPT_OWNER, KERNEL_OWNER,
};
pub use sentence::{Bounds, Expectation, Expected, Window};
pub use units::signal_unit;
pub use verdict::{judge, judge_criterion, CriterionVerdict, Value, Verdict};
