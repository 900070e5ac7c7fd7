// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Sensors that sit on the robot and measure what the plant and its surroundings do.

use std::sync::Arc;

use plant::{Mount, Robot, RobotParameters, Surroundings};

use crate::configuration::{GyroAxis, SensorConfiguration, SensorPorts};
use crate::ports::Ports;
use crate::sensors::Quantity;

/// Distance in m that stands for no wall.
const FAR: f64 = 100.0;

/// What a sensor port measures.
#[derive(Clone, Debug)]
enum Source {
    Floor { mount: Mount, spot: f64 },
    Wall(Mount),
    Gyro(GyroAxis),
}

/// All sensors on the robot.
#[derive(Clone, Debug)]
pub struct Measured {
    sources: Vec<(usize, Source)>,
    surroundings: Arc<Surroundings>,
}

impl Measured {
    pub fn new(ports: &SensorPorts, robot: &RobotParameters) -> Self {
        let sources = ports
            .all()
            .into_iter()
            .enumerate()
            .filter_map(|(index, sensor)| Some((index, source(sensor?)?)))
            .collect();
        Self {
            sources,
            surroundings: Arc::new(robot.surroundings.clone()),
        }
    }

    /// Gives each sensor what it measures of `robot` now; false when there is none.
    pub fn update(&self, robot: &Robot, ports: &mut Ports) -> bool {
        for (index, source) in &self.sources {
            if let Some((quantity, value)) = self.value(source, robot) {
                ports.set_quantity(*index, quantity, value);
            }
        }
        !self.sources.is_empty()
    }

    /// Names of what the sensors measure, in the order of [`Self::sample`].
    pub fn names(&self) -> impl Iterator<Item = String> + '_ {
        self.sources.iter().map(|(index, source)| {
            let port = index + 1;
            match source {
                Source::Floor { .. } => format!("light.{port}.reflectance"),
                Source::Wall(_) => format!("distance.{port}"),
                Source::Gyro(_) => format!("gyro.{port}.rate"),
            }
        })
    }

    /// What each sensor measures of `robot`; 0 where there is nothing to measure.
    pub fn sample<'a>(&'a self, robot: &'a Robot) -> impl Iterator<Item = f64> + 'a {
        self.sources
            .iter()
            .map(|(_, source)| self.value(source, robot).map_or(0.0, |(_, value)| value))
    }

    fn value(&self, source: &Source, robot: &Robot) -> Option<(Quantity, f64)> {
        match source {
            Source::Floor { mount, spot } => {
                let share = self.surroundings.reflectance(robot.pose()?, mount, *spot)?;
                Some((Quantity::Reflectance, share))
            }
            Source::Wall(mount) => {
                let distance = self.surroundings.distance(robot.pose()?, mount)?;
                Some((Quantity::Distance, libm::fmin(distance, FAR)))
            }
            Source::Gyro(GyroAxis::Pitch) => Some((Quantity::Rate, robot.pitch()?.1)),
            Source::Gyro(GyroAxis::Yaw) => Some((Quantity::Rate, robot.yaw_rate())),
        }
    }
}

fn source(sensor: &SensorConfiguration) -> Option<Source> {
    match sensor {
        SensorConfiguration::Light { mount, spot } => Some(Source::Floor {
            mount: (*mount)?,
            spot: *spot,
        }),
        SensorConfiguration::Ultrasonic { mount } => Some(Source::Wall((*mount)?)),
        SensorConfiguration::Gyro { axis, .. } => Some(Source::Gyro((*axis)?)),
        _ => None,
    }
}
