// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Motors as configured.

use serde::Deserialize;

use super::error::{check, ConfigurationError, Range};

/// A motor plugged in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Electrical and mechanical parameters.
    pub parameters: MotorParameters,
    /// The hand that turns the shaft, when the motor serves as a joystick.
    pub hand: Option<Hand>,
}

/// A hand on the shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// How fast it turns to a commanded angle, rad/s.
    pub rate: f64,
}

/// Parameters seen at the output shaft.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorParameters {
    /// Winding resistance, ohm.
    pub resistance: f64,
    /// Torque constant, N m/A.
    pub torque_constant: f64,
    /// Electric constant, V s/rad.
    pub electric_constant: f64,
    /// Viscous friction, N m s/rad.
    pub viscous_friction: f64,
    /// Inertia, kg m².
    pub inertia: f64,
    /// Coulomb friction, N m.
    #[serde(default)]
    pub coulomb_friction: f64,
    /// Friction at rest, N m.
    #[serde(default)]
    pub static_friction: f64,
    /// Backlash, rad, whole width.
    #[serde(default)]
    pub backlash: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotorFields {
    parameters: MotorParameters,
    #[serde(default)]
    held_by_hand: bool,
    hand_rate: Option<f64>,
}

impl MotorFields {
    pub(super) fn check(self, path: &str) -> Result<Motor, ConfigurationError> {
        self.parameters.check(path)?;
        let rate_path = format!("{path}.hand_rate");
        let hand = match (self.held_by_hand, self.hand_rate) {
            (true, Some(rate)) => {
                check(&rate_path, rate, Range::Positive)?;
                Some(Hand { rate })
            }
            (true, None) => {
                let problem = "missing; a motor held by hand needs it, in rad/s";
                return Err(ConfigurationError::field(&rate_path, problem));
            }
            (false, _) => None,
        };
        Ok(Motor {
            parameters: self.parameters,
            hand,
        })
    }
}

impl MotorParameters {
    fn check(&self, path: &str) -> Result<(), ConfigurationError> {
        let fields = [
            ("resistance", self.resistance, Range::Positive),
            ("torque_constant", self.torque_constant, Range::Positive),
            ("electric_constant", self.electric_constant, Range::Positive),
            (
                "viscous_friction",
                self.viscous_friction,
                Range::NotNegative,
            ),
            ("inertia", self.inertia, Range::Positive),
            (
                "coulomb_friction",
                self.coulomb_friction,
                Range::NotNegative,
            ),
            ("static_friction", self.static_friction, Range::NotNegative),
            ("backlash", self.backlash, Range::NotNegative),
        ];
        fields.into_iter().try_for_each(|(name, number, range)| {
            check(&format!("{path}.parameters.{name}"), number, range)
        })
    }
}
