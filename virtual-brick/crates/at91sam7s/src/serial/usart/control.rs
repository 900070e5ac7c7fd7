// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Control and mode registers of a serial line.

use super::{Usart, FRAME, OVRE, TIMEOUT};
use crate::clock::{Cycles, NEVER};
use crate::fault::{clock_disabled, Access};
use crate::serial::pdc::Stream;

/// PARE, NACK and ITERATION, besides the flags that this model can set.
const RESET_STATUS: u32 = OVRE | FRAME;

impl Usart {
    /// Write of the control register; `clocked` is the identifier of a clock that is off.
    pub(super) fn control(&mut self, value: u32, now: Cycles, unclocked: Option<u8>) -> Access {
        let bit = |number: u32| value >> number & 1 != 0;
        if let Some(identifier) = unclocked.filter(|_| bit(4) || bit(6)) {
            return clock_disabled(self.name(), identifier);
        }
        self.control_receiver(value);
        self.control_transmitter(value, now);
        if !self.is_debug_unit() {
            self.control_lines(value, now);
        }
        Ok(())
    }

    fn control_receiver(&mut self, value: u32) {
        if value & 1 << 2 != 0 {
            self.receiver = false;
            self.received = None;
            self.time_out_at = NEVER;
        }
        if value & 1 << 5 != 0 {
            self.receiver = false;
        } else if value & 1 << 4 != 0 {
            self.receiver = true;
        }
        if value & 1 << 8 != 0 {
            self.flags &= !RESET_STATUS;
        }
    }

    fn control_transmitter(&mut self, value: u32, now: Cycles) {
        if value & 1 << 3 != 0 {
            self.transmitter = false;
            self.holding = None;
            self.shifting = None;
        }
        if value & 1 << 7 != 0 {
            self.transmitter = false;
        } else if value & 1 << 6 != 0 {
            self.transmitter = true;
            self.start(now);
        }
    }

    fn control_lines(&mut self, value: u32, now: Cycles) {
        if value & 1 << 11 != 0 {
            self.flags &= !TIMEOUT;
            self.time_out_at = NEVER;
        }
        if value & 1 << 15 != 0 {
            self.flags &= !TIMEOUT;
            self.restart_time_out(now);
        }
        if value & 1 << 19 != 0 {
            self.request_to_send = false;
        } else if value & 1 << 18 != 0 {
            self.request_to_send = true;
        }
    }

    pub(super) fn set_mode(&mut self, value: u32, now: Cycles) {
        if self.is_debug_unit() {
            self.mode = value & 0xCE00;
        } else {
            self.mode = value & 0x173F_FFFF;
            self.start(now);
        }
    }
}
