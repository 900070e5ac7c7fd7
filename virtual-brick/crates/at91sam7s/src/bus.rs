// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip as the core's bus: address regions, their costs, aborts.
//!
//! Map (AT91SAM7S datasheet, 6175M, chapter 8): 1 MiB windows at 0 (flash, or SRAM after the
//! remap), 0x0010_0000 (flash), 0x0020_0000 (SRAM); each memory repeats through its window.
//! Peripherals above 0xF000_0000. Everything between is undefined and aborts, as do misaligned
//! data accesses (chapter 18). An access takes effect at the end of its cycles.

use arm7tdmi::bus::{Abort, Bus, Cycle, Width};

use crate::board::Board;
use crate::chip::Chip;
use crate::fault::FaultKind;
use crate::mc::{AbortCause, AbortedAccess};

pub(crate) const SRAM_WINDOW: u32 = 2;
const BOOT_ROM_WINDOW: u32 = 3;
pub(crate) const PERIPHERALS: u32 = 0xF000_0000;

#[inline(always)]
pub(crate) fn misaligned(address: u32, width: Width) -> bool {
    match width {
        Width::Byte => false,
        Width::Halfword => address & 1 != 0,
        Width::Word => address & 3 != 0,
    }
}

/// What the core's byte lanes show of `word`.
#[inline(always)]
pub(crate) fn lane(word: u32, address: u32, width: Width) -> u32 {
    match width {
        Width::Byte => word >> ((address & 3) * 8) & 0xFF,
        Width::Halfword => word >> ((address & 2) * 8) & 0xFFFF,
        Width::Word => word,
    }
}

/// A narrow store repeats its value on every lane (DDI 0029E, 6.1).
fn replicate(value: u32, width: Width) -> u32 {
    match width {
        Width::Byte => (value & 0xFF) * 0x0101_0101,
        Width::Halfword => (value & 0xFFFF) * 0x0001_0001,
        Width::Word => value,
    }
}

impl<B: Board> Chip<B> {
    #[inline(always)]
    pub(crate) fn is_sram(&self, address: u32) -> bool {
        let window = address >> 20;
        window == SRAM_WINDOW || window == self.sram_alias
    }

    /// In the flash windows, given that the address is not in SRAM.
    pub(crate) fn is_flash(address: u32) -> bool {
        address >> 20 < SRAM_WINDOW
    }

    /// Wait for a flash command to end.
    fn wait_for_flash(&mut self) {
        if self.flash.ready_at() > self.now {
            self.now = self.flash.ready_at();
            if self.now >= self.schedule.earliest() {
                self.serve_events();
            }
        }
    }

    #[cold]
    fn abort(
        &mut self,
        cause: AbortCause,
        access: AbortedAccess,
        width: Width,
        address: u32,
    ) -> Abort {
        self.spend(1);
        self.mc.record_abort(cause, access, width, address);
        Abort
    }

    /// An address outside memory and peripherals: abort; the boot ROM is a fault besides.
    #[cold]
    fn outside(&mut self, access: AbortedAccess, width: Width, address: u32, value: u32) -> Abort {
        if address >> 20 == BOOT_ROM_WINDOW {
            let write = (access == AbortedAccess::Write).then_some(value);
            self.record_fault(FaultKind::BootRom, address, write);
        }
        self.abort(AbortCause::Undefined, access, width, address)
    }

    #[inline(never)]
    fn fetch_elsewhere(&mut self, address: u32, width: Width) -> Result<u32, Abort> {
        if !Self::is_flash(address) {
            if address >= PERIPHERALS {
                self.record_fault(FaultKind::NoPeripheral, address, None);
            }
            return Err(self.outside(AbortedAccess::Fetch, width, address, 0));
        }
        self.wait_for_flash();
        let cycles = self.flash.fetch_cycles(self.now, address, width);
        self.flash.fetch_ends(self.now + cycles * self.ratio);
        self.spend(cycles);
        Ok(lane(self.flash.word(address), address, width))
    }

    #[inline(never)]
    fn read_elsewhere(&mut self, address: u32, width: Width) -> Result<u32, Abort> {
        if Self::is_flash(address) {
            self.wait_for_flash();
            self.flash.data_was_read();
            self.spend(self.flash.data_cycles());
            return Ok(lane(self.flash.word(address), address, width));
        }
        if address < PERIPHERALS {
            return Err(self.outside(AbortedAccess::Read, width, address, 0));
        }
        self.spend(self.configuration.timing.apb_cycles);
        match self.read_register(address & !3) {
            Ok(word) => {
                self.after_register_access();
                Ok(lane(word, address, width))
            }
            Err(kind) => {
                self.record_fault(kind, address, None);
                Err(Abort)
            }
        }
    }

    #[inline(never)]
    fn write_elsewhere(&mut self, address: u32, width: Width, value: u32) -> Result<(), Abort> {
        if Self::is_flash(address) {
            self.wait_for_flash();
            self.spend(self.flash.data_cycles());
            if width != Width::Word {
                self.record_fault(FaultKind::FlashWriteWidth, address, Some(value));
                return Err(Abort);
            }
            self.flash.write_latch(address, value);
            return Ok(());
        }
        if address < PERIPHERALS {
            return Err(self.outside(AbortedAccess::Write, width, address, value));
        }
        self.spend(self.configuration.timing.apb_cycles);
        match self.write_register(address & !3, replicate(value, width)) {
            Ok(()) => {
                self.after_register_access();
                Ok(())
            }
            Err(kind) => {
                self.record_fault(kind, address, Some(value));
                Err(Abort)
            }
        }
    }

    /// Serve what the access made due at once, and take the cycles that the data controller took.
    fn after_register_access(&mut self) {
        if self.stolen != 0 || self.now >= self.schedule.earliest() {
            self.serve_events();
        }
    }
}

impl<B: Board> Bus for Chip<B> {
    #[inline(always)]
    fn fetch_word(&mut self, address: u32, _cycle: Cycle) -> Result<u32, Abort> {
        if !self.is_sram(address) {
            return self.fetch_elsewhere(address, Width::Word);
        }
        self.spend(self.configuration.timing.sram_cycles);
        Ok(self.sram.word(address))
    }

    #[inline(always)]
    fn fetch_halfword(&mut self, address: u32, _cycle: Cycle) -> Result<u16, Abort> {
        if !self.is_sram(address) {
            let word = self.fetch_elsewhere(address, Width::Halfword)?;
            return Ok(word as u16);
        }
        self.spend(self.configuration.timing.sram_cycles);
        Ok(self.sram.halfword(address))
    }

    #[inline(always)]
    fn read(&mut self, address: u32, width: Width, _cycle: Cycle) -> Result<u32, Abort> {
        if misaligned(address, width) {
            let access = AbortedAccess::Read;
            return Err(self.abort(AbortCause::Misaligned, access, width, address));
        }
        if !self.is_sram(address) {
            return self.read_elsewhere(address, width);
        }
        self.spend(self.configuration.timing.sram_cycles);
        Ok(match width {
            Width::Word => self.sram.word(address),
            Width::Halfword => u32::from(self.sram.halfword(address)),
            Width::Byte => u32::from(self.sram.byte(address)),
        })
    }

    #[inline(always)]
    fn write(
        &mut self,
        address: u32,
        width: Width,
        value: u32,
        _cycle: Cycle,
    ) -> Result<(), Abort> {
        if misaligned(address, width) {
            let access = AbortedAccess::Write;
            return Err(self.abort(AbortCause::Misaligned, access, width, address));
        }
        if !self.is_sram(address) {
            return self.write_elsewhere(address, width, value);
        }
        self.spend(self.configuration.timing.sram_cycles);
        self.sram.write(self.now, address, width, value);
        Ok(())
    }

    #[inline(always)]
    fn internal(&mut self, count: u32) {
        self.spend(u64::from(count));
    }

    #[inline(always)]
    fn irq(&self) -> bool {
        self.now >= self.aic.irq_seen_at()
    }

    #[inline(always)]
    fn fiq(&self) -> bool {
        self.now >= self.aic.fiq_seen_at()
    }
}
