// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is around the robot: a floor that is brighter here than there, and walls.

use serde::Deserialize;

use crate::error::{within, ParameterError};
use crate::pose::Pose;

/// Half the angle in rad within which the ultrasonic sensor hears an echo (about 30 degrees in
/// all: NXT Hardware Developer Kit, appendix of the ultrasonic sensor, gives no figure; chosen).
const HALF_BEAM: f64 = 0.26;
const RAYS: i32 = 4;

/// The floor's picture and the walls.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// What the light sensor sees below it.
    #[serde(default)]
    pub floor: Option<Floor>,
    /// What the ultrasonic sensor sees in front of it.
    #[serde(default)]
    pub walls: Vec<Wall>,
}

/// A picture on the floor; beyond its edges the floor is like `outside`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Side of a pixel in m.
    pub pixel: f64,
    /// Place of the picture's lower left corner in m, in the coordinates of [`Pose`].
    pub corner: [f64; 2],
    /// Pixels in a row.
    pub width: usize,
    /// Share of the light that each pixel throws back in 1/255, row by row from the top.
    pub reflectance: Vec<u8>,
    /// Share of the light that the floor around the picture throws back.
    #[serde(default = "white")]
    pub outside: f64,
}

const fn white() -> f64 {
    1.0
}

/// A straight wall between two points in m.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// One end.
    pub from: [f64; 2],
    /// The other end.
    pub to: [f64; 2],
}

/// Where a sensor sits, in the robot's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mount {
    /// Forwards from the middle of the axle in m.
    pub x: f64,
    /// To the left of it in m.
    pub y: f64,
    /// Anticlockwise from the heading in rad.
    #[serde(default)]
    pub direction: f64,
}

impl Mount {
    /// Checks that the sensor is not far off the robot; `field` names it in the error.
    ///
    /// # Errors
    /// The first member out of range.
    pub fn check(&self, field: &str) -> Result<(), ParameterError> {
        within(&format!("{field}.x"), self.x, -1.0, 1.0, "m")?;
        within(&format!("{field}.y"), self.y, -1.0, 1.0, "m")?;
        within(
            &format!("{field}.direction"),
            self.direction,
            -7.0,
            7.0,
            "rad",
        )
    }

    fn place(&self, pose: Pose) -> (f64, f64) {
        let (sine, cosine) = (libm::sin(pose.heading), libm::cos(pose.heading));
        (
            pose.x + cosine * self.x - sine * self.y,
            pose.y + sine * self.x + cosine * self.y,
        )
    }
}

impl Surroundings {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        if let Some(floor) = &self.floor {
            floor.check()?;
        }
        for (index, wall) in self.walls.iter().enumerate() {
            for (name, [x, y]) in [("from", wall.from), ("to", wall.to)] {
                let field = format!("surroundings.walls[{index}].{name}");
                within(&field, x, -1000.0, 1000.0, "m")?;
                within(&field, y, -1000.0, 1000.0, "m")?;
            }
        }
        Ok(())
    }

    /// Mean share of light that the floor throws back below a sensor, over a round spot of radius
    /// `spot` m: its middle and eight points of its edge.
    #[must_use]
    pub fn reflectance(&self, pose: Pose, mount: &Mount, spot: f64) -> Option<f64> {
        let floor = self.floor.as_ref()?;
        let (x, y) = mount.place(pose);
        let mut sum = floor.at(x, y);
        for eighth in 0..8 {
            let angle = f64::from(eighth) * core::f64::consts::FRAC_PI_4;
            sum += floor.at(x + spot * libm::cos(angle), y + spot * libm::sin(angle));
        }
        Some(sum / 9.0)
    }

    /// Distance in m from a sensor to the nearest wall in its beam, if there are walls; infinite
    /// when none is in it.
    #[must_use]
    pub fn distance(&self, pose: Pose, mount: &Mount) -> Option<f64> {
        if self.walls.is_empty() {
            return None;
        }
        let from = mount.place(pose);
        let mut nearest = f64::INFINITY;
        for ray in -RAYS..=RAYS {
            let off = HALF_BEAM * f64::from(ray) / f64::from(RAYS);
            let angle = pose.heading + mount.direction + off;
            let direction = (libm::cos(angle), libm::sin(angle));
            for wall in &self.walls {
                if let Some(distance) = wall.hit(from, direction) {
                    nearest = libm::fmin(nearest, distance);
                }
            }
        }
        Some(nearest)
    }
}

impl Floor {
    fn rows(&self) -> usize {
        self.reflectance.len() / self.width.max(1)
    }

    fn check(&self) -> Result<(), ParameterError> {
        within("surroundings.floor.pixel", self.pixel, 1e-4, 1.0, "m")?;
        for corner in self.corner {
            within("surroundings.floor.corner", corner, -1000.0, 1000.0, "m")?;
        }
        within(
            "surroundings.floor.outside",
            self.outside,
            0.0,
            1.0,
            "share",
        )?;
        let pixels = self.reflectance.len();
        if self.width == 0 || pixels == 0 || pixels % self.width != 0 {
            return Err(ParameterError {
                field: "surroundings.floor.width".to_owned(),
                value: self.width.to_string(),
                expected: format!("a divisor of the {pixels} pixels"),
            });
        }
        Ok(())
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        let column = libm::floor((x - self.corner[0]) / self.pixel);
        let up = libm::floor((y - self.corner[1]) / self.pixel);
        let (width, rows) = (self.width as f64, self.rows() as f64);
        if !(column >= 0.0 && column < width && up >= 0.0 && up < rows) {
            return self.outside;
        }
        let row = self.rows() - 1 - up as usize;
        f64::from(self.reflectance[row * self.width + column as usize]) / 255.0
    }
}

impl Wall {
    /// Distance along a ray of unit length to the wall.
    fn hit(&self, from: (f64, f64), ray: (f64, f64)) -> Option<f64> {
        let along = (self.to[0] - self.from[0], self.to[1] - self.from[1]);
        let off = (self.from[0] - from.0, self.from[1] - from.1);
        let cross = ray.0 * along.1 - ray.1 * along.0;
        if cross == 0.0 {
            return None;
        }
        let distance = (off.0 * along.1 - off.1 * along.0) / cross;
        let share = (off.0 * ray.1 - off.1 * ray.0) / cross;
        (distance >= 0.0 && (0.0..=1.0).contains(&share)).then_some(distance)
    }
}
