// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Control and mode registers of a serial line.

use super::{Usart, FRAME, OVRE, TIMEOUT};
use crate::clock::{Cycles, NEVER};
use crate::fault::{clock_disabled, Access};
use crate::registers::{unmodelled, Unmodelled};
use crate::serial::pdc::Stream;
use crate::serial::usart::registers::{US_CR, US_IER, US_MR};

/// PARE, NACK and ITERATION, besides the flags that this model can set.
const RESET_STATUS: u32 = OVRE | FRAME;

const LOOPS: Unmodelled = unmodelled(US_MR, 1 << 14, "automatic echo or remote loopback");
/// Without effect are STPBRK and RXBRK, since breaks are refused; RSTIT, RSTNACK, INACK, DSNACK,
/// MAX_ITERATION, ITERATION, NACK, FIDI, NER and IF, which only refused modes have; FILTER, since
/// the board's lines have no glitches; DTREN and DTRDIS, since USART 0 has no such line and nothing
/// on the board listens to the other's.
pub(super) const USART: &[Unmodelled] = &[
    unmodelled(US_CR, 1 << 9, "sending a break"),
    unmodelled(US_CR, 1 << 12, "multidrop mode"),
    unmodelled(
        US_MR,
        0xF,
        "a mode other than normal, RS485 and hardware handshaking",
    )
    .above(2),
    unmodelled(US_MR, 3 << 4, "a clock other than MCK and MCK/8").above(1 << 4),
    unmodelled(US_MR, 1 << 8, "synchronous mode"),
    unmodelled(US_MR, 7 << 9, "multidrop mode").above(5 << 9),
    LOOPS,
    unmodelled(US_MR, 1 << 18, "the clock output SCK"),
];
/// FNTRST has no effect: the board has no debug probe.
pub(super) const DEBUG_UNIT: &[Unmodelled] = &[
    LOOPS,
    unmodelled(US_IER, 3 << 30, "the debug communication channel"),
];

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
