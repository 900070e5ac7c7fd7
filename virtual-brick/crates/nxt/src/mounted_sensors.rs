// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Sensors mounted on the robot, which measure what the plant and its surroundings do.

use std::sync::Arc;

use plant::{Robot, RobotParameters, Surroundings};

use crate::configuration::SensorPorts;
use crate::ports::Ports;
use crate::sensors::{GyroAxis, Measurement, Sensor, SensorInput};

/// Distance in m that stands for no wall.
const FAR: f64 = 100.0;

/// A sensor that measures, at the port of this index, and the input that it replaces.
#[derive(Clone, Debug)]
struct Source {
    index: usize,
    input: &'static SensorInput,
    measurement: Measurement,
}

/// All mounted sensors.
#[derive(Clone, Debug)]
pub struct MountedSensors {
    sources: Vec<Source>,
    surroundings: Arc<Surroundings>,
}

impl MountedSensors {
    pub fn new(ports: &SensorPorts, robot: &RobotParameters) -> Self {
        let sources = ports
            .all()
            .into_iter()
            .enumerate()
            .filter_map(|(index, sensor)| source(index, sensor?))
            .collect();
        Self {
            sources,
            surroundings: Arc::new(robot.surroundings.clone()),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// Gives each sensor what it measures of `robot` now.
    pub fn update(&self, robot: &Robot, ports: &mut Ports) {
        for source in &self.sources {
            if let Some(value) = self.value(&source.measurement, robot) {
                ports.set_quantity(source.index, &source.input.key, value);
            }
        }
    }

    /// Names of what the sensors measure, in the order of [`Self::sample`].
    pub fn names(&self) -> impl Iterator<Item = String> + '_ {
        let name = |source: &Source| source.input.signal(source.index + 1);
        self.sources.iter().map(name)
    }

    /// What each sensor measures of `robot`; 0 where there is nothing to measure.
    pub fn sample<'a>(&'a self, robot: &'a Robot) -> impl Iterator<Item = f64> + 'a {
        self.sources
            .iter()
            .map(|source| self.value(&source.measurement, robot).unwrap_or(0.0))
    }

    fn value(&self, measurement: &Measurement, robot: &Robot) -> Option<f64> {
        match measurement {
            Measurement::Floor { mount, spot } => {
                self.surroundings.reflectance(robot.pose()?, mount, *spot)
            }
            Measurement::Wall(mount) => {
                let distance = self.surroundings.distance(robot.pose()?, mount)?;
                Some(libm::fmin(distance, FAR))
            }
            Measurement::Rotation(GyroAxis::Pitch) => Some(robot.pitch()?.1),
            Measurement::Rotation(GyroAxis::Yaw) => Some(robot.yaw_rate()),
        }
    }
}

fn source(index: usize, sensor: &Sensor) -> Option<Source> {
    Some(Source {
        index,
        input: sensor.inputs().iter().find(|input| input.measured)?,
        measurement: sensor.measurement()?,
    })
}
