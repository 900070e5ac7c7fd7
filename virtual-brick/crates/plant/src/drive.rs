// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the bridge does to the winding, and the winding's mean current in one step.

use crate::motor_parameters::MotorParameters;

/// How the winding is left in the off phase of pulse-width modulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decay {
    /// Shorted: the current goes on, the mean voltage is the duty cycle times the supply.
    Slow,
    /// Open: the current dies through the bridge's diodes against the supply.
    Fast,
}

/// State of a motor's bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorDrive {
    /// Winding open: no current.
    Coast,
    /// Winding shorted.
    Brake,
    /// Pulse-width modulation.
    Pwm {
        /// Duty cycle, -1 to 1.
        duty: f64,
        /// What the off phase does.
        decay: Decay,
        /// Period of the modulation in s; matters only for fast decay with inductance.
        period: f64,
    },
}

/// Mean current over a step as a function of the angular velocity at its end:
/// `i = offset - slope * w1`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepCurrent {
    pub offset: f64,
    pub slope: f64,
}

/// State of the winding at the beginning of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    pub velocity: f64,
    pub current: f64,
    pub supply: f64,
    pub dt: f64,
}

impl MotorDrive {
    /// Linear law of the mean current in the next step (trapezoidal rule).
    pub(crate) fn step_current(&self, motor: &MotorParameters, winding: Winding) -> StepCurrent {
        match *self {
            Self::Coast => StepCurrent::default(),
            Self::Brake => winding.driven(motor, 0.0),
            Self::Pwm {
                duty,
                decay: Decay::Slow,
                ..
            } => winding.driven(motor, duty * winding.supply),
            Self::Pwm {
                duty,
                decay: Decay::Fast,
                period,
            } => winding.less(motor.driver_drop).chopped(motor, duty, period),
        }
    }

    /// Mean voltage at the motor's terminals with this mean current and angular velocity.
    pub(crate) fn terminal_voltage(
        &self,
        motor: &MotorParameters,
        supply: f64,
        current: f64,
        velocity: f64,
    ) -> f64 {
        match *self {
            Self::Brake => 0.0,
            Self::Pwm {
                duty,
                decay: Decay::Slow,
                ..
            } if motor.driver_resistance == 0.0 => duty * supply,
            Self::Pwm {
                duty,
                decay: Decay::Slow,
                ..
            } => duty * supply - motor.driver_resistance * current,
            _ => motor.resistance * current + motor.electric_constant * velocity,
        }
    }

    /// Mean current drawn from the supply.
    pub(crate) fn supply_current(
        &self,
        motor: &MotorParameters,
        supply: f64,
        current: f64,
        velocity: f64,
    ) -> f64 {
        match *self {
            Self::Coast | Self::Brake => 0.0,
            Self::Pwm {
                duty,
                decay: Decay::Slow,
                ..
            } => duty * current,
            Self::Pwm {
                duty,
                decay: Decay::Fast,
                ..
            } if motor.inductance == 0.0 => {
                if duty < 0.0 {
                    -current
                } else {
                    current
                }
            }
            Self::Pwm { .. } if supply > 0.0 => {
                current * self.terminal_voltage(motor, supply, current, velocity) / supply
            }
            Self::Pwm { .. } => 0.0,
        }
    }
}

impl Winding {
    /// The same with that many volts less of supply.
    fn less(self, drop: f64) -> Self {
        let supply = libm::fmax(self.supply - drop, 0.0);
        Self { supply, ..self }
    }

    /// Winding always connected to a source of `voltage`.
    /// The bridge's drop works against the current, like friction: below it none flows.
    fn driven(self, motor: &MotorParameters, voltage: f64) -> StepCurrent {
        let emf = motor.electric_constant;
        let driving = voltage - emf * self.velocity;
        let flows = motor.inductance > 0.0 && self.current != 0.0;
        let direction = if flows { self.current } else { driving };
        if motor.driver_drop > 0.0 && !flows && libm::fabs(driving) <= motor.driver_drop {
            return StepCurrent::default();
        }
        let voltage = voltage - libm::copysign(motor.driver_drop, direction);
        let per_step = motor.inductance / self.dt;
        let half = motor.circuit_resistance() / 2.0;
        if motor.inductance == 0.0 {
            return StepCurrent {
                offset: (voltage - emf * self.velocity / 2.0) / motor.circuit_resistance(),
                slope: emf / (2.0 * motor.circuit_resistance()),
            };
        }
        let sum = per_step + half;
        let carried = (per_step - half) * self.current + voltage - emf * self.velocity / 2.0;
        StepCurrent {
            offset: (self.current + carried / sum) / 2.0,
            slope: emf / (4.0 * sum),
        }
    }

    /// Winding connected for the fraction |duty| of each period, open in the rest.
    fn chopped(self, motor: &MotorParameters, duty: f64, period: f64) -> StepCurrent {
        let sign = if duty < 0.0 { -1.0 } else { 1.0 };
        let fraction = libm::fabs(duty);
        let emf = motor.electric_constant * self.velocity * sign;
        let (current, conductance) = if motor.inductance == 0.0 || emf >= self.supply {
            let conductance = fraction / motor.circuit_resistance();
            (conductance * (self.supply - emf), conductance)
        } else {
            self.freewheeling(motor, fraction, period, emf)
        };
        let slope = conductance * motor.electric_constant / 2.0;
        StepCurrent {
            offset: sign * current + slope * self.velocity,
            slope,
        }
    }

    /// Mean current and its decrease per volt of EMF when the off phase returns the current to
    /// the supply. Continuous conduction has the mean voltage (2d - 1)U; discontinuous
    /// conduction neglects the resistance within one period.
    fn freewheeling(
        self,
        motor: &MotorParameters,
        fraction: f64,
        period: f64,
        emf: f64,
    ) -> (f64, f64) {
        let supply = self.supply;
        let ripple = fraction * (1.0 - fraction) * period * supply / motor.inductance;
        let continuous = ((2.0 * fraction - 1.0) * supply - emf) / motor.circuit_resistance();
        if continuous >= ripple {
            return (continuous, 1.0 / motor.circuit_resistance());
        }
        if emf <= (2.0 * fraction - 1.0) * supply {
            return (ripple, 0.0);
        }
        let scale = fraction * fraction * period * supply / motor.inductance;
        let sum = supply + emf;
        (
            scale * (supply - emf) / sum,
            scale * 2.0 * supply / (sum * sum),
        )
    }
}
