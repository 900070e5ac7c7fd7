// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One motor: parameters and state.

use crate::drive::{MotorDrive, StepCurrent, Winding};
use crate::motor_parameters::{MotorParameters, PluggedMotor};
use crate::thermal::Heat;

/// Share of the motor's inertia that lies behind the play (hub and last wheel of the train).
const SHARE_BEHIND_PLAY: f64 = 0.02;

/// A motor with its gear train. Angles and velocities are of the output shaft.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    parameters: MotorParameters,
    hand: Option<Hand>,
    angle: f64,
    angular_velocity: f64,
    /// Within half the backlash of the gear train's angle.
    load_angle: f64,
    load_velocity: f64,
    load_torque: f64,
    current: f64,
    voltage: f64,
    supply_current: f64,
    heat: Heat,
}

/// A hand that turns the shaft to an angle, no faster than its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hand {
    rate: f64,
    wanted_angle: f64,
}

impl Motor {
    pub(crate) fn new(plugged: &PluggedMotor) -> Self {
        let rate = plugged.hand_rate.unwrap_or(0.0);
        Self {
            parameters: plugged.parameters.clone(),
            hand: plugged.held_by_hand.then_some(Hand {
                rate,
                wanted_angle: 0.0,
            }),
            angle: 0.0,
            angular_velocity: 0.0,
            load_angle: 0.0,
            load_velocity: 0.0,
            load_torque: 0.0,
            current: 0.0,
            voltage: 0.0,
            supply_current: 0.0,
            heat: Heat::default(),
        }
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &MotorParameters {
        &self.parameters
    }

    /// Angle of the gear train, where the encoder is, in rad.
    #[must_use]
    pub const fn angle(&self) -> f64 {
        self.angle
    }

    /// Angular velocity of the gear train in rad/s.
    #[must_use]
    pub const fn angular_velocity(&self) -> f64 {
        self.angular_velocity
    }

    /// Angle of the load, behind the backlash, in rad.
    #[must_use]
    pub const fn load_angle(&self) -> f64 {
        self.load_angle
    }

    /// Mean winding current of the last step in A (at its end when inductance is modelled).
    #[must_use]
    pub const fn current(&self) -> f64 {
        self.current
    }

    /// Mean voltage at the terminals in the last step in V.
    #[must_use]
    pub const fn voltage(&self) -> f64 {
        self.voltage
    }

    /// Mean current taken from the supply in the last step in A.
    #[must_use]
    pub const fn supply_current(&self) -> f64 {
        self.supply_current
    }

    /// The fuse in the motor has opened.
    #[must_use]
    pub const fn cut_out(&self) -> bool {
        self.heat.is_open()
    }

    /// What the bridge can do to the winding: nothing while the fuse is open.
    const fn effective<'a>(&self, drive: &'a MotorDrive) -> &'a MotorDrive {
        if self.heat.is_open() {
            &MotorDrive::Coast
        } else {
            drive
        }
    }

    /// Law of the current in the step that begins.
    pub(crate) fn step_current(&self, drive: &MotorDrive, supply: f64, dt: f64) -> StepCurrent {
        let winding = self.winding(self.angular_velocity, supply, dt);
        self.effective(drive)
            .step_current(&self.parameters, winding)
    }

    /// Whether the shaft follows a hand.
    #[must_use]
    pub const fn held_by_hand(&self) -> bool {
        self.hand.is_some()
    }

    /// Angle that the hand turns to in rad. Without effect on a motor that no hand holds.
    pub fn set_hand_angle(&mut self, wanted_angle: f64) {
        if let Some(hand) = &mut self.hand {
            hand.wanted_angle = wanted_angle;
        }
    }

    /// Torque of a load that turns the shaft backwards (a hanging weight) in N m; negative
    /// turns it forwards.
    pub fn set_load_torque(&mut self, load_torque: f64) {
        self.load_torque = load_torque;
    }

    pub(crate) const fn load_torque(&self) -> f64 {
        self.load_torque
    }

    pub(crate) const fn load_velocity(&self) -> f64 {
        self.load_velocity
    }

    pub(crate) fn has_backlash(&self) -> bool {
        self.parameters.backlash > 0.0 && self.hand.is_none()
    }

    /// Inertia before and behind the play.
    pub(crate) fn inertias(&self) -> (f64, f64) {
        let behind = if self.has_backlash() {
            SHARE_BEHIND_PLAY
        } else {
            0.0
        };
        let inertia = self.parameters.inertia;
        (inertia * (1.0 - behind), inertia * behind)
    }

    /// Lowest and highest velocity of the gear train against the load that stays in the play.
    pub(crate) fn play_velocities(&self, dt: f64) -> (f64, f64) {
        let half = self.parameters.backlash / 2.0;
        let lead = self.angle - self.load_angle;
        ((-half - lead) / dt, (half - lead) / dt)
    }

    /// Becomes as another motor with the same parameters is.
    pub(crate) fn take_state(&mut self, other: &Self) {
        let Self {
            parameters: _,
            hand,
            angle,
            angular_velocity,
            load_angle,
            load_velocity,
            load_torque,
            current,
            voltage,
            supply_current,
            heat,
        } = *other;
        self.hand = hand;
        self.angle = angle;
        self.angular_velocity = angular_velocity;
        self.load_angle = load_angle;
        self.load_velocity = load_velocity;
        self.load_torque = load_torque;
        self.current = current;
        self.voltage = voltage;
        self.supply_current = supply_current;
        self.heat = heat;
    }

    /// Everything that a step changes.
    pub(crate) fn state(&self) -> [f64; 9] {
        [
            self.angle,
            self.angular_velocity,
            self.load_angle,
            self.load_velocity,
            self.current,
            self.voltage,
            self.supply_current,
            self.heat.square(),
            f64::from(u8::from(self.heat.is_open())),
        ]
    }

    /// The winding when the velocity was this and the current what it still is.
    pub(crate) const fn winding(&self, velocity: f64, supply: f64, dt: f64) -> Winding {
        Winding {
            velocity,
            current: self.current,
            supply,
            dt,
        }
    }

    /// Ends a step: new velocities of the gear train and the load, current by its law.
    pub(crate) fn finish_step(&mut self, velocity: f64, load_velocity: f64, dt: f64) {
        self.angle += dt * (self.angular_velocity + velocity) / 2.0;
        self.angular_velocity = velocity;
        if self.has_backlash() {
            let half = self.parameters.backlash / 2.0;
            let load_angle = self.load_angle + dt * (self.load_velocity + load_velocity) / 2.0;
            let pulled = libm::fmax(load_angle, self.angle - half);
            self.load_angle = libm::fmin(pulled, self.angle + half);
            self.load_velocity = load_velocity;
        } else {
            self.load_angle = self.angle;
            self.load_velocity = velocity;
        }
    }

    /// Records what the bridge did in the step that led from `before` to the velocity now.
    pub(crate) fn finish_current(&mut self, drive: &MotorDrive, law: StepCurrent, before: Winding) {
        let drive = self.effective(drive);
        let mean = law.offset - law.slope * self.angular_velocity;
        let velocity = (before.velocity + self.angular_velocity) / 2.0;
        let motor = &self.parameters;
        self.voltage = drive.terminal_voltage(motor, before.supply, mean, velocity);
        self.supply_current = drive.supply_current(motor, before.supply, mean, velocity);
        let carried = motor.inductance > 0.0 && drive.keeps_current();
        self.current = if carried {
            2.0 * mean - before.current
        } else {
            mean
        };
        if let Some(fuse) = &self.parameters.cut_out {
            self.heat.advance(fuse, mean, before.dt);
        }
    }

    /// Moves a shaft that a hand holds; false when no hand does.
    pub(crate) fn follow_hand(&mut self, dt: f64) -> bool {
        let Some(hand) = self.hand else {
            return false;
        };
        let reach = hand.rate * dt;
        let wanted = hand.wanted_angle - self.angle;
        if libm::fabs(wanted) <= reach {
            self.angular_velocity = wanted / dt;
            self.angle = hand.wanted_angle;
        } else {
            let sign = if wanted < 0.0 { -1.0 } else { 1.0 };
            self.angular_velocity = sign * hand.rate;
            self.angle += sign * reach;
        }
        self.load_angle = self.angle;
        self.load_velocity = self.angular_velocity;
        true
    }
}

impl MotorDrive {
    /// The winding stays connected, so that its inductance carries the current on.
    fn keeps_current(&self) -> bool {
        use crate::drive::Decay;
        matches!(
            self,
            Self::Brake
                | Self::Pwm {
                    decay: Decay::Slow,
                    ..
                }
        )
    }
}
