// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Monotone cubic interpolation, and the slope of a moving line fit.

/// The cubic through all points that rises and falls only where they do, at `at`.
///
/// `knots` (ascending) and `values` have the same length of at least 3; `at` lies within the knots.
/// Slopes are those of F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984).
#[must_use]
pub fn monotone_cubic(knots: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let widths: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rises = values.windows(2).zip(&widths);
    let rises: Vec<f64> = rises
        .map(|(pair, width)| (pair[1] - pair[0]) / width)
        .collect();
    let slopes = slopes(&widths, &rises);
    let interpolate = |&instant: &f64| {
        let after = knots.partition_point(|&knot| knot <= instant);
        let cell = after.saturating_sub(1).min(widths.len() - 1);
        let (width, along) = (widths[cell], instant - knots[cell]);
        let (first, last, rise) = (slopes[cell], slopes[cell + 1], rises[cell]);
        let bend = (3.0 * rise - 2.0 * first - last) / width;
        let twist = (first + last - 2.0 * rise) / (width * width);
        values[cell] + along * (first + along * (bend + along * twist))
    };
    at.iter().map(interpolate).collect()
}

/// At each knot: a weighted harmonic mean of the rises beside it, 0 at an extremum.
fn slopes(widths: &[f64], rises: &[f64]) -> Vec<f64> {
    let last = widths.len() - 1;
    let inner = (0..last).map(|i| {
        let (before, after) = (rises[i], rises[i + 1]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let early = 2.0 * widths[i + 1] + widths[i];
        let late = widths[i + 1] + 2.0 * widths[i];
        (early + late) / (early / before + late / after)
    });
    let first = end_slope(widths[0], widths[1], rises[0], rises[1]);
    let end = end_slope(widths[last], widths[last - 1], rises[last], rises[last - 1]);
    std::iter::once(first).chain(inner).chain([end]).collect()
}

/// That of the parabola through the three outermost points, limited to keep the shape.
fn end_slope(width: f64, next_width: f64, rise: f64, next_rise: f64) -> f64 {
    let slope = ((2.0 * width + next_width) * rise - width * next_rise) / (width + next_width);
    if slope * rise <= 0.0 {
        0.0
    } else if rise * next_rise <= 0.0 && slope.abs() > 3.0 * rise.abs() {
        3.0 * rise
    } else {
        slope
    }
}

/// Slope per unit of `interval` of the least-squares line through each value and its `half`
/// neighbours on either side; mirrored through the end points beyond the ends.
#[must_use]
pub fn moving_slope(values: &[f64], interval: f64, half: usize) -> Vec<f64> {
    if values.len() < 2 {
        return vec![0.0; values.len()];
    }
    let squares: f64 = (1..=half)
        .map(|offset| 2.0 * (offset * offset) as f64)
        .sum();
    let (half_length, length) = (half as isize, values.len() as isize);
    let padded: Vec<f64> = (-half_length..length + half_length)
        .map(|place| mirrored(values, place))
        .collect();
    let slope = |line: &[f64]| {
        let before = line[..half].iter().rev();
        let pairs = before.zip(&line[half + 1..]).zip(1..=half);
        let rises = pairs.map(|((before, after), offset)| offset as f64 * (after - before));
        rises.sum::<f64>() / (squares * interval)
    };
    padded.windows(2 * half + 1).map(slope).collect()
}

/// The value at a place that may lie beyond the ends.
fn mirrored(values: &[f64], place: isize) -> f64 {
    let last = values.len() as isize - 1;
    if place < 0 {
        2.0 * values[0] - mirrored(values, -place)
    } else if place > last {
        2.0 * values[last as usize] - mirrored(values, 2 * last - place)
    } else {
        values[place as usize]
    }
}
