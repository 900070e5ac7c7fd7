// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Physical quantities by name, sampled at any cycle.

use at91sam7s::board::Cycles;
use plant::{Motor, MotorDrive, MotorPort};

use crate::board::NxtBoard;

const PER_MOTOR: [&str; 6] = [
    "angle",
    "angular_velocity",
    "voltage",
    "current",
    "encoder",
    "duty",
];

impl NxtBoard {
    /// Names of the signals, in the order of [`NxtBoard::sample_signals`]: per motor
    /// `motor.X.angle` (rad), `.angular_velocity` (rad/s), `.voltage` (mean at the terminals,
    /// V), `.current` (A), `.encoder` (tacho edges, 360 per turn), `.duty` (-1 to 1) and with
    /// backlash `.load_angle` (rad); on wheels `body.x`, `body.y` (m), `body.heading` (rad), of a
    /// body that balances `body.pitch` (rad) and `body.pitch_rate` (rad/s); of sensors on the
    /// robot `light.N.reflectance`, `distance.N` (m), `gyro.N.rate` (rad/s);
    /// `battery.voltage` (V).
    #[must_use]
    pub fn signal_names(&self) -> Vec<String> {
        let (_, robot, _) = self.physics().around(0);
        let mut names = Vec::new();
        for port in MotorPort::ALL {
            let Some(motor) = robot.motor(port) else {
                continue;
            };
            let letter = port.letter();
            names.extend(PER_MOTOR.map(|name| format!("motor.{letter}.{name}")));
            if has_backlash(motor) {
                names.push(format!("motor.{letter}.load_angle"));
            }
        }
        if robot.pose().is_some() {
            names.extend(["body.x", "body.y", "body.heading"].map(str::to_owned));
        }
        if robot.pitch().is_some() {
            names.extend(["body.pitch", "body.pitch_rate"].map(str::to_owned));
        }
        names.extend(self.mounted_sensors().names());
        names.push("battery.voltage".to_owned());
        names
    }

    /// Appends the value of each signal at `now`. Within a step of the plant angles, velocities
    /// and pose are interpolated; voltages and currents are the means of the step.
    pub fn sample_signals(&self, now: Cycles, values: &mut Vec<f64>) {
        let (behind, ahead, share) = self.physics().around(now);
        let between = |from: f64, to: f64| from + share * (to - from);
        let drives = self.drives();
        for port in MotorPort::ALL {
            let (Some(from), Some(to)) = (behind.motor(port), ahead.motor(port)) else {
                continue;
            };
            let encoder = self
                .physics()
                .encoder(port)
                .map_or(0, |encoder| encoder.count());
            values.extend([
                between(from.angle(), to.angle()),
                between(from.angular_velocity(), to.angular_velocity()),
                to.voltage(),
                to.current(),
                encoder as f64,
                duty(drives[port.index()]),
            ]);
            if has_backlash(to) {
                values.push(between(from.load_angle(), to.load_angle()));
            }
        }
        if let (Some(from), Some(to)) = (behind.pose(), ahead.pose()) {
            values.push(between(from.x, to.x));
            values.push(between(from.y, to.y));
            values.push(between(from.heading, to.heading));
        }
        if let (Some(from), Some(to)) = (behind.pitch(), ahead.pitch()) {
            values.push(between(from.0, to.0));
            values.push(between(from.1, to.1));
        }
        values.extend(self.mounted_sensors().sample(behind));
        values.push(self.battery_voltage());
    }

    /// Names and values of all signals at `now`.
    #[must_use]
    pub fn signals(&self, now: Cycles) -> Vec<(String, f64)> {
        let mut values = Vec::new();
        self.sample_signals(now, &mut values);
        self.signal_names().into_iter().zip(values).collect()
    }
}

fn has_backlash(motor: &Motor) -> bool {
    motor.parameters().backlash > 0.0
}

const fn duty(drive: MotorDrive) -> f64 {
    match drive {
        MotorDrive::Coast | MotorDrive::Brake => 0.0,
        MotorDrive::Pwm { duty, .. } => duty,
    }
}
