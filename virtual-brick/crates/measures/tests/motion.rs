// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Step responses and paths whose measures are known by hand.

use std::f64::consts::PI;

use measures::{
    count_difference_speed, fitted_speed, path_measures, step_measures, RADIANS_PER_COUNT, WINDOW,
};

fn times() -> Vec<f64> {
    (0..20_000).map(|index| 1e-4 * f64::from(index)).collect()
}

/// Encoder counts of a first-order response from rest at time 0.
fn counts(speed: f64, time_constant: f64) -> Vec<f64> {
    let angle = |t: f64| speed * (t - time_constant * (1.0 - (-t / time_constant).exp()));
    let count = |t: f64| (angle(t).to_degrees() + 0.37).floor();
    times().into_iter().map(count).collect()
}

fn close(value: f64, expected: f64, within: f64) {
    assert!(
        (value - expected).abs() <= within,
        "{value} is not {expected}"
    );
}

/// A first-order response settles to 2 % after tau ln 50; counts show it within 4 ms.
#[test]
fn settling_from_encoder_counts_is_that_of_the_true_speed() {
    for time_constant in [0.08, 0.102_249, 0.12] {
        for speed in [4.0, 8.1] {
            let counted = counts(speed, time_constant);
            let fitted = fitted_speed(&times(), &counted, RADIANS_PER_COUNT, WINDOW);
            let measures = step_measures(&times(), &fitted, speed);
            let settled = measures.settling_time.unwrap_or(f64::NAN);
            close(settled, time_constant * 50_f64.ln(), 0.004);
            close(measures.overshoot, 0.0, 0.004);
            close(measures.final_value, speed, 0.001 * speed);
            close(measures.steady_state_error, 0.0, 0.001);
        }
    }
}

/// 4 ms and 1 degree give steps of 250 degrees/s: no 2 % band can be read from it.
#[test]
fn the_plain_difference_knows_only_multiples_of_the_count() {
    let (_, speed) = count_difference_speed(&times(), &counts(8.1, 0.1), RADIANS_PER_COUNT, 0.004);
    for value in &speed {
        let steps = value.to_degrees() / 250.0;
        close(steps, steps.round(), 1e-9);
    }
    let late = &speed[speed.len() / 2..];
    let largest = late.iter().copied().fold(f64::MIN, f64::max);
    let smallest = late.iter().copied().fold(f64::MAX, f64::min);
    close((largest - smallest).to_degrees(), 250.0, 1e-6);
}

/// Ten counts in each of 4 ms: the same speed and instants, only later.
#[test]
fn the_difference_does_not_depend_on_when_the_recording_begins() {
    let counted: Vec<f64> = (0..40).map(|at| 10.0 * f64::from(at / 4)).collect();
    for begin in [0.0, 2.5] {
        let times: Vec<f64> = (0..40).map(|at| begin + 0.001 * f64::from(at)).collect();
        let (instants, speed) = count_difference_speed(&times, &counted, 0.01, 0.004);
        assert_eq!((instants.len(), speed.len()), (9, 9));
        for (index, (at, value)) in (1..10).zip(instants.iter().zip(&speed)) {
            close(*at, begin + 0.004 * f64::from(index), 1e-12);
            close(*value, 10.0 * 0.01 / 0.004, 1e-9);
        }
    }
}

/// A second-order response with damping 0.5 overshoots by exp(-pi / sqrt 3) = 16.3 %.
#[test]
fn overshoot_is_measured_against_the_final_value() {
    let (omega, damping) = (20.0, 0.5_f64);
    let root = (1.0 - damping * damping).sqrt();
    let response = |t: f64| {
        let phase = omega * root * t;
        1.0 - (-damping * omega * t).exp() * (phase.cos() + damping / root * phase.sin())
    };
    let speed: Vec<f64> = times().into_iter().map(response).collect();
    close(step_measures(&times(), &speed, 1.0).overshoot, 0.1630, 2e-4);
}

#[test]
fn a_response_that_leaves_the_band_until_the_end_has_no_settling_time() {
    let response = |t: f64| 1.0 + 0.1 * (2.0 * PI * 5.0 * t).sin();
    let speed: Vec<f64> = times().into_iter().map(response).collect();
    assert_eq!(step_measures(&times(), &speed, 1.0).settling_time, None);
}

/// Settling takes tau ln 50, rising from a tenth to nine tenths tau ln 9.
#[test]
fn a_backward_step_is_measured_like_a_forward_one() {
    for height in [3.0, -3.0] {
        let response = |t: f64| height * (1.0 - (-t / 0.1).exp());
        let speed: Vec<f64> = times().into_iter().map(response).collect();
        let measures = step_measures(&times(), &speed, height);
        close(
            measures.settling_time.unwrap_or(f64::NAN),
            0.1 * 50_f64.ln(),
            2e-4,
        );
        close(
            measures.rise_time.unwrap_or(f64::NAN),
            0.1 * 9_f64.ln(),
            3e-4,
        );
        assert!(measures.overshoot < 1e-6);
    }
}

/// An arc of radius 10 m leaves its tangent by 10 (1 - cos 0.2) m after 2 m.
#[test]
fn lateral_deviation_of_an_arc_is_its_height() {
    for heading in [0.0_f64, 0.7, -2.0] {
        let turns = (0..=5000).map(|index| 0.3 * f64::from(index) / 5000.0);
        let points = turns.map(|turn| {
            let (along, across) = (10.0 * turn.sin(), 10.0 * (1.0 - turn.cos()));
            (
                3.0 + along * heading.cos() - across * heading.sin(),
                1.0 + along * heading.sin() + across * heading.cos(),
            )
        });
        let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
        let measures = path_measures(&x, &y, heading, 2.0);
        let height = 10.0 * (1.0 - 0.2_f64.cos());
        close(
            measures.lateral_deviation.unwrap_or(f64::NAN),
            height,
            1e-3 * height,
        );
        close(measures.distance, 3.0, 3e-6);
    }
}

#[test]
fn a_path_that_is_too_short_has_no_deviation() {
    let x: Vec<f64> = (0..100).map(|index| 0.012 * f64::from(index)).collect();
    let measures = path_measures(&x, &[0.0; 100], 0.0, 2.0);
    assert_eq!(measures.lateral_deviation, None);
}
