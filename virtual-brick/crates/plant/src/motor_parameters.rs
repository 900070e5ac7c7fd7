// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Parameters of the motors and their ports, and their limits.

use serde::Deserialize;

use crate::error::{within, ParameterError};
use crate::thermal::CutOut;

/// A motor port of the brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub enum MotorPort {
    /// Port A.
    A,
    /// Port B.
    B,
    /// Port C.
    C,
}

impl MotorPort {
    /// Every port, in the order of the index.
    pub const ALL: [Self; 3] = [Self::A, Self::B, Self::C];

    /// 0 for A to 2 for C.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The letter on the brick.
    #[must_use]
    pub const fn letter(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::C => "C",
        }
    }
}

/// A direct-current motor with its gear train, all values seen from the output shaft.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorParameters {
    /// Winding resistance in ohm.
    pub resistance: f64,
    /// Torque per current in N m/A.
    pub torque_constant: f64,
    /// Back-EMF per angular velocity in V s/rad.
    pub electric_constant: f64,
    /// Viscous friction in N m s/rad.
    pub viscous_friction: f64,
    /// Moment of inertia in kg m^2.
    pub inertia: f64,
    /// Coulomb friction while turning, in N m.
    #[serde(default)]
    pub coulomb_friction: f64,
    /// Friction at rest in N m, not less than the Coulomb friction; that one when absent.
    #[serde(default)]
    pub static_friction: Option<f64>,
    /// Stribeck velocity in rad/s: the friction at rest falls to the Coulomb friction as
    /// exp(-velocity / this). 0: as soon as the shaft turns.
    #[serde(default)]
    pub stribeck_velocity: f64,
    /// Share of the transmitted torque that the gear train adds to the friction at rest.
    #[serde(default)]
    pub gear_friction: f64,
    /// Total play between gear train and load in rad. The encoder is before the play.
    #[serde(default)]
    pub backlash: f64,
    /// Winding inductance in H; 0 neglects it.
    #[serde(default)]
    pub inductance: f64,
    /// Voltage that the bridge's switches take away while current flows, in V.
    #[serde(default)]
    pub driver_drop: f64,
    /// Resistance of the bridge's switches in ohm.
    #[serde(default)]
    pub driver_resistance: f64,
    /// Resettable fuse in the motor; none when absent.
    #[serde(default)]
    pub cut_out: Option<CutOut>,
}

impl MotorParameters {
    /// Friction at rest in N m.
    #[must_use]
    pub fn breakaway_friction(&self) -> f64 {
        self.static_friction.unwrap_or(self.coulomb_friction)
    }

    /// Bound of the friction in N m at this velocity in rad/s (0 at rest) with this torque in N m
    /// in the gear train: Stribeck's curve (Armstrong-Helouvry, Dupont and Canudas de Wit,
    /// Automatica 30, 1994), whose excess at rest grows with the torque.
    #[inline(always)]
    pub(crate) fn friction(&self, velocity: f64, torque: f64) -> f64 {
        let (at_rest, coulomb) = (self.breakaway_friction(), self.coulomb_friction);
        if self.stribeck_velocity == 0.0 && velocity != 0.0 {
            return coulomb;
        }
        if self.stribeck_velocity == 0.0 && self.gear_friction == 0.0 {
            return at_rest;
        }
        let excess = at_rest - coulomb + self.gear_friction * libm::fabs(torque);
        let share = if velocity == 0.0 {
            1.0
        } else {
            libm::exp(-libm::fabs(velocity) / self.stribeck_velocity)
        };
        coulomb + excess * share
    }

    /// Resistance of winding and bridge in ohm.
    pub(crate) fn circuit_resistance(&self) -> f64 {
        self.resistance + self.driver_resistance
    }

    fn check(&self, path: &str) -> Result<(), ParameterError> {
        let rows = [
            ("resistance", self.resistance, 0.1, 100.0, "ohm"),
            ("torque_constant", self.torque_constant, 1e-4, 10.0, "N m/A"),
            (
                "electric_constant",
                self.electric_constant,
                1e-4,
                10.0,
                "V s/rad",
            ),
            (
                "viscous_friction",
                self.viscous_friction,
                0.0,
                1.0,
                "N m s/rad",
            ),
            ("inertia", self.inertia, 1e-6, 1.0, "kg m^2"),
            ("coulomb_friction", self.coulomb_friction, 0.0, 1.0, "N m"),
            ("backlash", self.backlash, 0.0, 0.5, "rad"),
            ("inductance", self.inductance, 0.0, 1.0, "H"),
            ("driver_drop", self.driver_drop, 0.0, 5.0, "V"),
            (
                "driver_resistance",
                self.driver_resistance,
                0.0,
                100.0,
                "ohm",
            ),
            (
                "stribeck_velocity",
                self.stribeck_velocity,
                0.0,
                100.0,
                "rad/s",
            ),
            ("gear_friction", self.gear_friction, 0.0, 0.9, "share"),
        ];
        for (name, value, lowest, highest, unit) in rows {
            within(&format!("{path}.{name}"), value, lowest, highest, unit)?;
        }
        if let Some(fuse) = &self.cut_out {
            fuse.check(&format!("{path}.cut_out"))?;
        }
        let field = format!("{path}.static_friction");
        let unit = "N m, not less than coulomb_friction";
        within(
            &field,
            self.breakaway_friction(),
            self.coulomb_friction,
            1.0,
            unit,
        )
    }
}

/// What is plugged into a motor port.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PluggedMotor {
    /// The motor.
    pub parameters: MotorParameters,
    /// The shaft follows a hand and nothing else: a joystick.
    #[serde(default)]
    pub held_by_hand: bool,
    /// Greatest angular velocity of the hand in rad/s; needed when held by hand.
    #[serde(default)]
    pub hand_rate: Option<f64>,
}

impl PluggedMotor {
    pub(crate) fn check(&self, path: &str) -> Result<(), ParameterError> {
        self.parameters.check(&format!("{path}.parameters"))?;
        match self.hand_rate {
            Some(rate) => within(&format!("{path}.hand_rate"), rate, 1e-3, 100.0, "rad/s"),
            None if self.held_by_hand => Err(ParameterError {
                field: format!("{path}.hand_rate"),
                value: "(absent)".to_owned(),
                expected: "a number from 0.001 to 100 (rad/s), as the motor is held by hand"
                    .to_owned(),
            }),
            None => Ok(()),
        }
    }
}

/// The three motor ports; an absent one has nothing plugged in.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorPorts {
    /// Port A.
    #[serde(default, rename = "A")]
    pub a: Option<PluggedMotor>,
    /// Port B.
    #[serde(default, rename = "B")]
    pub b: Option<PluggedMotor>,
    /// Port C.
    #[serde(default, rename = "C")]
    pub c: Option<PluggedMotor>,
}

impl MotorPorts {
    /// What is plugged into `port`.
    #[must_use]
    pub const fn get(&self, port: MotorPort) -> Option<&PluggedMotor> {
        match port {
            MotorPort::A => self.a.as_ref(),
            MotorPort::B => self.b.as_ref(),
            MotorPort::C => self.c.as_ref(),
        }
    }
}

/// Both wheels are there, and are not the same one.
pub(crate) fn check_wheels(
    left: MotorPort,
    right: MotorPort,
    motors: &MotorPorts,
) -> Result<(), ParameterError> {
    check_wheel("body.left", left, motors)?;
    check_wheel("body.right", right, motors)?;
    if left == right {
        return Err(ParameterError {
            field: "body.right".to_owned(),
            value: right.letter().to_owned(),
            expected: "another motor than body.left".to_owned(),
        });
    }
    Ok(())
}

fn check_wheel(field: &str, port: MotorPort, motors: &MotorPorts) -> Result<(), ParameterError> {
    if motors.get(port).is_some_and(|motor| !motor.held_by_hand) {
        return Ok(());
    }
    Err(ParameterError {
        field: field.to_owned(),
        value: port.letter().to_owned(),
        expected: "a port of `motors` with a motor that is not held by hand".to_owned(),
    })
}
