// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Step response and path.
//!
//! The speed is the slope of a straight line fitted to the encoder's edges over a window around
//! each instant, never a difference of raw counts: one count of 1 degree in 4 ms is 250 degrees/s.

use std::f64::consts::PI;

use serde::Serialize;

use crate::interpolation::{monotone_cubic, moving_slope};

/// The encoder's signal is in counts of 1 degree at the output shaft.
pub const RADIANS_PER_COUNT: f64 = PI / 180.0;
/// Length of the fitted line in s.
pub const WINDOW: f64 = 0.080;
/// Share of the final value within which a response has settled.
pub const SETTLING_BAND: f64 = 0.02;
const FINAL_SHARE: f64 = 0.25;
const HOLD: f64 = 0.1;

/// Step response; times in s after the step, speeds in rad/s, overshoot as a fraction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepMeasures {
    /// Height of the step.
    pub setpoint: f64,
    /// Mean over the last quarter of the window.
    pub final_value: f64,
    /// Last instant outside 2 % of the final value; none when the speed does not stay inside for
    /// the last 0.1 s of the window.
    pub settling_time: Option<f64>,
    /// Largest excess over the final value, as a share of it.
    pub overshoot: f64,
    /// From a tenth to nine tenths of the final value.
    pub rise_time: Option<f64>,
    /// Share of the set-point that is missing at the end.
    pub steady_state_error: f64,
}

/// Deviation from the initial straight line, and length of the path, in m.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathMeasures {
    /// The largest; none when the vehicle did not drive the distance asked for.
    pub lateral_deviation: Option<f64>,
    /// Length of the path.
    pub distance: f64,
}

/// Angular velocity (rad/s) at `times` (s, evenly spaced) from encoder counts.
#[must_use]
pub fn fitted_speed(
    times: &[f64],
    counts: &[f64],
    radians_per_count: f64,
    window: f64,
) -> Vec<f64> {
    let [first, second, ..] = times else {
        return vec![0.0; times.len()];
    };
    let interval = second - first;
    let half = (window / interval / 2.0).round_ties_even().max(1.0) as usize;
    let mut speed = moving_slope(&position(times, counts), interval, half);
    speed
        .iter_mut()
        .for_each(|slope| *slope *= radians_per_count);
    speed
}

/// Angle (counts) at `times`, smooth through the edges, on with the last slope after the last.
///
/// Before the first edge the shaft is taken to be at rest in the middle of its count.
fn position(times: &[f64], counts: &[f64]) -> Vec<f64> {
    let (mut knots, mut values) = (vec![times[0]], vec![counts[0]]);
    for at in (1..counts.len()).filter(|&at| counts[at] != counts[at - 1]) {
        knots.push((times[at] + times[at - 1]) / 2.0);
        values.push((counts[at] + counts[at - 1]) / 2.0);
    }
    let edges = knots.len() - 1;
    if edges < 2 {
        return counts.to_vec();
    }
    let slope = (values[edges] - values[edges - 1]) / (knots[edges] - knots[edges - 1]);
    let (end_time, end_count) = (times[times.len() - 1], counts[counts.len() - 1]);
    let end = values[edges] + slope * (end_time - knots[edges]);
    knots.push(end_time);
    values.push(end.clamp(end_count - 0.5, end_count + 0.5));
    monotone_cubic(&knots, &values, times)
}

/// The plain difference of counts every `sample_time`, for comparison: instants and rad/s.
#[must_use]
pub fn count_difference_speed(
    times: &[f64],
    counts: &[f64],
    radians_per_count: f64,
    sample_time: f64,
) -> (Vec<f64>, Vec<f64>) {
    let [first, second, ..] = times else {
        return (Vec::new(), Vec::new());
    };
    let step = (sample_time / (second - first)).round_ties_even().max(1.0) as usize;
    let sampled: Vec<f64> = counts.iter().copied().step_by(step).collect();
    let speeds = sampled.windows(2);
    (
        times.iter().copied().step_by(step).skip(1).collect(),
        speeds
            .map(|pair| (pair[1] - pair[0]) * radians_per_count / sample_time)
            .collect(),
    )
}

/// Measures of a response to a step from rest at `times[0]` to `setpoint` (rad/s).
///
/// `times` and `speed` have the same length of at least 1.
#[must_use]
pub fn step_measures(times: &[f64], speed: &[f64], setpoint: f64) -> StepMeasures {
    let tail = &speed[(speed.len() as f64 * (1.0 - FINAL_SHARE)) as usize..];
    let final_value = tail.iter().sum::<f64>() / tail.len() as f64;
    let scale = if final_value == 0.0 {
        1.0
    } else {
        final_value.abs()
    };
    let (begin, end) = (times[0], times[times.len() - 1]);
    let outside = |value: &f64| (value - final_value).abs() > SETTLING_BAND * scale;
    let settling_time = match speed.iter().rposition(outside) {
        None => Some(0.0),
        Some(last) => (end - times[last] >= HOLD).then(|| times[last] - begin),
    };
    let sign = if final_value == 0.0 {
        0.0
    } else {
        final_value.signum()
    };
    let peak = speed
        .iter()
        .map(|value| value * sign)
        .fold(f64::NEG_INFINITY, f64::max);
    StepMeasures {
        setpoint,
        final_value,
        settling_time,
        overshoot: (peak / scale - 1.0).max(0.0),
        rise_time: rise_time(times, speed, final_value),
        steady_state_error: if setpoint == 0.0 {
            0.0
        } else {
            (setpoint - final_value) / setpoint
        },
    }
}

fn rise_time(times: &[f64], speed: &[f64], final_value: f64) -> Option<f64> {
    if final_value == 0.0 {
        return None;
    }
    let reached = |level: f64| speed.iter().position(|value| value / final_value >= level);
    Some(times[reached(0.9)?] - times[reached(0.1)?])
}

/// Length of a path.
#[must_use]
pub fn path_length(x: &[f64], y: &[f64]) -> f64 {
    steps(x, y).sum()
}

fn steps<'a>(x: &'a [f64], y: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let both = x.windows(2).zip(y.windows(2));
    both.map(|(x, y)| libm::hypot(x[1] - x[0], y[1] - y[0]))
}

/// Deviation over `distance` (m) from the line through the first point along `heading` (rad).
#[must_use]
pub fn path_measures(x: &[f64], y: &[f64], heading: f64, distance: f64) -> PathMeasures {
    let (sine, cosine) = (libm::sin(heading), libm::cos(heading));
    let (mut length, mut largest) = (0.0, 0.0_f64);
    let lengths = std::iter::once(0.0).chain(steps(x, y));
    for ((x_now, y_now), step) in x.iter().zip(y).zip(lengths) {
        length += step;
        if length <= distance {
            let across = -(x_now - x[0]) * sine + (y_now - y[0]) * cosine;
            largest = largest.max(across.abs());
        }
    }
    PathMeasures {
        lateral_deviation: (length >= distance).then_some(largest),
        distance: length,
    }
}
