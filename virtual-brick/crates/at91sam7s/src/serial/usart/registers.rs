// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Which register of a serial line answers at which offset.

use super::{Usart, MODEM_CHANGES};
use crate::clock::Cycles;
use crate::fault::{no_register, Access};
use crate::registers::{check_written, registers, unmodelled, Unmodelled};
use crate::serial::pdc::Stream;

registers! {
    US_CR = 0x00, US_MR = 0x04, US_IER = 0x08, US_IDR = 0x0C, US_IMR = 0x10, US_CSR = 0x14,
    US_RHR = 0x18, US_THR = 0x1C, US_BRGR = 0x20, US_RTOR = 0x24, US_TTGR = 0x28,
    US_FIDI = 0x40, US_NER = 0x44, US_IF = 0x4C, DBGU_FNR = 0x48,
}

/// Flags that can interrupt: of a USART, of the debug unit.
const MASKABLE: u32 = 0x000F_3FFF;
const MASKABLE_DEBUG_UNIT: u32 = 0x1AFB;

const LOOPS: Unmodelled = unmodelled(US_MR, 1 << 14, "automatic echo or remote loopback");
/// Without effect are STPBRK and RXBRK, since breaks are refused; RSTIT, RSTNACK, INACK, DSNACK,
/// MAX_ITERATION, ITERATION, NACK, FIDI, NER and IF, which only refused modes have; FILTER, since
/// the board's lines have no glitches; DTREN and DTRDIS, since USART 0 has no such line and nothing
/// on the board listens to the other's.
const USART: &[Unmodelled] = &[
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
const DEBUG_UNIT: &[Unmodelled] = &[
    LOOPS,
    unmodelled(US_IER, 3 << 30, "the debug communication channel"),
];

impl Usart {
    /// Read a register; the identifiers of the debug unit are read elsewhere.
    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            US_CR | US_IER | US_IDR | US_THR => 0,
            US_MR => self.mode,
            US_IMR => self.mask,
            US_CSR => {
                let value = self.status();
                self.flags &= !MODEM_CHANGES;
                value
            }
            US_RHR => self.take_received(),
            US_BRGR => self.divider,
            DBGU_FNR if self.is_debug_unit() => self.force_ntrst,
            0x100..=0x124 => return self.pdc.read(offset, self.name()),
            _ if self.is_debug_unit() => return no_register(self.name(), offset),
            US_RTOR => self.time_out,
            US_TTGR => self.time_guard,
            US_FIDI => self.fi_over_di,
            US_NER => 0,
            US_IF => self.filter,
            _ => return no_register(self.name(), offset),
        })
    }

    /// Write a register; `unclocked` is the line's identifier while its clock is off.
    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: Cycles,
        unclocked: Option<u8>,
    ) -> Access {
        let unmodelled = if self.is_debug_unit() {
            DEBUG_UNIT
        } else {
            USART
        };
        check_written(self.name(), unmodelled, offset, value)?;
        match offset {
            US_CR => return self.control(value, now, unclocked),
            US_MR => self.set_mode(value, now),
            US_IER => self.mask |= value & self.maskable(),
            US_IDR => self.mask &= !value,
            US_THR => self.transmit(value, now)?,
            US_BRGR => {
                let fraction = if self.is_debug_unit() { 0 } else { 7 << 16 };
                self.divider = value & (0xFFFF | fraction);
                self.start(now);
            }
            US_IMR | US_CSR | US_RHR => {}
            DBGU_FNR if self.is_debug_unit() => self.force_ntrst = value & 1,
            0x100..=0x124 => return self.pdc.write(offset, value, self.name()),
            _ if self.is_debug_unit() => return no_register(self.name(), offset),
            US_RTOR => self.time_out = value & 0xFFFF,
            US_TTGR => self.time_guard = value & 0xFF,
            US_FIDI => self.fi_over_di = value & 0x7FF,
            US_IF => self.filter = value & 0xFF,
            US_NER => {}
            _ => return no_register(self.name(), offset),
        }
        Ok(())
    }

    fn maskable(&self) -> u32 {
        if self.is_debug_unit() {
            MASKABLE_DEBUG_UNIT
        } else {
            MASKABLE
        }
    }
}
