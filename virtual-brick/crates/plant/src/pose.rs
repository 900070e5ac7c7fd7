// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where the robot is on the floor.

/// Place of the middle of the axle on the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Along the heading at the start, in m.
    pub x: f64,
    /// To the left of the heading at the start, in m.
    pub y: f64,
    /// Anticlockwise from the heading at the start, in rad; not wrapped.
    pub heading: f64,
}

impl Pose {
    /// Moves along the arc that belongs to these turns of wheels of this radius and distance.
    pub(crate) fn roll(&mut self, wheel_radius: f64, track: f64, left: f64, right: f64) {
        let length = wheel_radius * (left + right) / 2.0;
        let turn = wheel_radius * (right - left) / track;
        let half = turn / 2.0;
        let chord = if half == 0.0 {
            length
        } else {
            length * libm::sin(half) / half
        };
        let direction = self.heading + half;
        let (sine, cosine) = libm::sincos(direction);
        self.x += chord * cosine;
        self.y += chord * sine;
        self.heading += turn;
    }
}
