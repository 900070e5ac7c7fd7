// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Inputs by name: what can be pressed, turned, loaded or set from outside.

use std::error::Error;
use std::fmt;

use plant::{BodyParameters, MotorPort, RobotParameters};

use crate::battery::VOLTAGE_LIMITS;
use crate::buttons::Button;
use crate::sensors::{Sensor, SensorInput};

/// An input of this brick.
#[derive(Clone, Debug, PartialEq)]
pub struct InputDescription {
    /// Its name.
    pub name: String,
    /// Lowest value.
    pub lowest: f64,
    /// Highest value.
    pub highest: f64,
    /// Only whole numbers.
    pub whole: bool,
    /// Unit of the value; empty for a count or a switch.
    pub unit: &'static str,
    pub(crate) target: Target,
}

/// What an input acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Port and key of the input.
    Sensor(usize, &'static str),
    Plugged(usize),
    Short(usize, usize),
    Button(Button),
    HandAngle(MotorPort),
    LoadTorque(MotorPort),
    Held,
    Push,
    BatteryVoltage,
    CorruptChecksums,
    TornWords,
    FramesRefused,
    BusStuck,
    UsbCable,
}

/// An input that this brick does not have, or a value that it does not take.
#[derive(Clone, Debug, PartialEq)]
pub enum InputError {
    /// There is no input of this name.
    UnknownName {
        /// The name given.
        name: String,
        /// The names of this configuration.
        valid: Vec<String>,
    },
    /// The value is not accepted.
    OutOfRange {
        /// The value given.
        value: f64,
        /// The input.
        input: InputDescription,
    },
}

impl fmt::Display for InputError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownName { name, valid } => write!(
                formatter,
                "input {name}: this brick has no such input; it has {}",
                valid.join(", ")
            ),
            Self::OutOfRange { value, input } => {
                let kind = if input.whole {
                    "whole number"
                } else {
                    "number"
                };
                let InputDescription {
                    name,
                    lowest,
                    highest,
                    unit,
                    ..
                } = input;
                write!(formatter, "input {name} = {value}: expected a {kind} ")?;
                write!(formatter, "from {lowest} to {highest}")?;
                if unit.is_empty() {
                    Ok(())
                } else {
                    write!(formatter, " ({unit})")
                }
            }
        }
    }
}

impl Error for InputError {}

/// The inputs of a brick with these sensors and motors, in a fixed order.
pub fn inputs(sensors: [&Sensor; 4], robot: &RobotParameters) -> Vec<InputDescription> {
    let mut inputs = Vec::new();
    for button in Button::ALL {
        let name = format!("button.{}", button.name());
        inputs.push(switch(name, Target::Button(button)));
    }
    for (index, sensor) in sensors.into_iter().enumerate() {
        inputs.extend(sensor_inputs(index, sensor));
    }
    for port in MotorPort::ALL {
        inputs.extend(motor_input(port, robot));
    }
    if matches!(robot.body, BodyParameters::Balancer(_)) {
        inputs.push(switch("body.held".to_owned(), Target::Held));
        inputs.push(InputDescription {
            name: "body.push".to_owned(),
            lowest: -100.0,
            highest: 100.0,
            whole: false,
            unit: "N",
            target: Target::Push,
        });
    }
    inputs.push(InputDescription {
        name: "battery.voltage".to_owned(),
        lowest: VOLTAGE_LIMITS.0,
        highest: VOLTAGE_LIMITS.1,
        whole: false,
        unit: "V",
        target: Target::BatteryVoltage,
    });
    for (name, target) in [
        ("fault.coprocessor_checksum", Target::CorruptChecksums),
        ("fault.coprocessor_torn_words", Target::TornWords),
    ] {
        inputs.push(InputDescription {
            highest: 65_535.0,
            ..switch(name.to_owned(), target)
        });
    }
    let name = "fault.coprocessor_refuses".to_owned();
    inputs.push(switch(name, Target::FramesRefused));
    inputs.push(switch("fault.twi_stuck".to_owned(), Target::BusStuck));
    inputs.push(switch("usb.plugged".to_owned(), Target::UsbCable));
    inputs
}

/// The quantities at a sensor, its plug and shorts of its digital lines.
fn sensor_inputs(index: usize, sensor: &Sensor) -> Vec<InputDescription> {
    let port = index + 1;
    let quantity = |input: &'static SensorInput| InputDescription {
        name: input.name(port),
        lowest: input.range.0,
        highest: input.range.1,
        whole: input.whole,
        unit: &input.unit,
        target: Target::Sensor(index, &input.key),
    };
    let mut inputs: Vec<_> = sensor.inputs().iter().map(quantity).collect();
    if !inputs.is_empty() {
        inputs.push(switch(
            format!("sensor.{port}.plugged"),
            Target::Plugged(index),
        ));
        for line in [0, 1] {
            let name = format!("fault.{port}.digital_{line}_low");
            inputs.push(switch(name, Target::Short(index, line)));
        }
    }
    inputs
}

fn switch(name: String, target: Target) -> InputDescription {
    InputDescription {
        name,
        lowest: 0.0,
        highest: 1.0,
        whole: true,
        unit: "",
        target,
    }
}

fn motor_input(port: MotorPort, robot: &RobotParameters) -> Option<InputDescription> {
    let held = robot.motors.get(port)?.held_by_hand;
    let (quantity, limit, unit, target) = if held {
        ("hand_angle", 1000.0, "rad", Target::HandAngle(port))
    } else {
        ("load_torque", 5.0, "N m", Target::LoadTorque(port))
    };
    Some(InputDescription {
        name: format!("motor.{}.{quantity}", port.letter()),
        lowest: -limit,
        highest: limit,
        whole: false,
        unit,
        target,
    })
}

/// The target of the input `name` if it takes `value`.
pub fn find(inputs: &[InputDescription], name: &str, value: f64) -> Result<Target, InputError> {
    let Some(input) = inputs.iter().find(|input| input.name == name) else {
        return Err(InputError::UnknownName {
            name: name.to_owned(),
            valid: inputs.iter().map(|input| input.name.clone()).collect(),
        });
    };
    let whole = !input.whole || libm::trunc(value) == value;
    if value >= input.lowest && value <= input.highest && whole {
        return Ok(input.target);
    }
    Err(InputError::OutOfRange {
        value,
        input: input.clone(),
    })
}
