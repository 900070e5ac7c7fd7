// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Which register of a serial line answers at which offset.

use super::{Usart, MODEM_CHANGES};
use crate::board::Cycles;
use crate::fault::{Access, FaultKind};

/// Flags that can interrupt: of a USART, of the debug unit.
const MASKABLE: u32 = 0x000F_3FFF;
const MASKABLE_DEBUG_UNIT: u32 = 0xC000_1AFB;

impl Usart {
    fn unknown<T>(&self, offset: u32) -> Access<T> {
        Err(FaultKind::RegisterNotModelled {
            peripheral: self.name(),
            offset,
        })
    }

    /// Read a register; the identifiers of the debug unit are read elsewhere.
    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x08 | 0x0C | 0x1C => 0,
            0x04 => self.mode,
            0x10 => self.mask,
            0x14 => {
                let value = self.status();
                self.flags &= !MODEM_CHANGES;
                value
            }
            0x18 => self.take_received(),
            0x20 => self.divider,
            0x48 if self.is_debug_unit() => self.force_ntrst,
            0x100..=0x124 => return self.pdc.read(offset, self.name()),
            _ if self.is_debug_unit() => return self.unknown(offset),
            0x24 => self.time_out,
            0x28 => self.time_guard,
            0x40 => self.fi_over_di,
            0x44 => 0,
            0x4C => self.filter,
            _ => return self.unknown(offset),
        })
    }

    /// Write a register; `unclocked` is the line's identifier while its clock is off.
    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: Cycles,
        unclocked: Option<u8>,
    ) -> Access<()> {
        match offset {
            0x00 => return self.control(value, now, unclocked),
            0x04 => return self.set_mode(value, now),
            0x08 => self.mask |= value & self.maskable(),
            0x0C => self.mask &= !value,
            0x1C => self.transmit(value, now),
            0x20 => {
                let fraction = if self.is_debug_unit() { 0 } else { 7 << 16 };
                self.divider = value & (0xFFFF | fraction);
                self.start(now);
            }
            0x10 | 0x14 | 0x18 => {}
            0x48 if self.is_debug_unit() => self.force_ntrst = value & 1,
            0x100..=0x124 => return self.pdc.write(offset, value, self.name()),
            _ if self.is_debug_unit() => return self.unknown(offset),
            0x24 => self.time_out = value & 0xFFFF,
            0x28 => self.time_guard = value & 0xFF,
            0x40 => self.fi_over_di = value & 0x7FF,
            0x4C => self.filter = value & 0xFF,
            0x44 => {}
            _ => return self.unknown(offset),
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
