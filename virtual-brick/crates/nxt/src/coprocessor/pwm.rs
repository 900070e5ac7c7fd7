// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Pulse-width modulation of the bridges.

use plant::{Decay, MotorDrive};

use super::frame::MotorCommand;

/// Lowest frequency in kHz that the fast timer clock serves.
const FAST_FROM_KHZ: u16 = 4;

/// State of the bridge: the timer counts to 1000 / f at 1 MHz, below 4 kHz to 125 / f at 125 kHz,
/// and compares with the duty cycle scaled to that in whole counts.
pub fn drive(command: MotorCommand, frequency_khz: u8) -> MotorDrive {
    let frequency = u16::from(frequency_khz);
    let (top, clock) = if frequency >= FAST_FROM_KHZ {
        (1000 / frequency, 1e6)
    } else {
        (125 / frequency, 125e3)
    };
    let compare = (u16::from(command.duty.unsigned_abs()).min(100) * top) / 100;
    if compare == 0 {
        return if command.brake {
            MotorDrive::Brake
        } else {
            MotorDrive::Coast
        };
    }
    let duty = f64::from(compare) / f64::from(top);
    MotorDrive::Pwm {
        duty: if command.duty < 0 { -duty } else { duty },
        decay: if command.brake {
            Decay::Slow
        } else {
            Decay::Fast
        },
        period: f64::from(top) / clock,
    }
}
