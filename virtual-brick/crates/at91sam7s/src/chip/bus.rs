// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip as the core's bus: address regions, their costs, aborts.
//!
//! Peripherals are above 0xF000_0000. Everything between them and the memories is undefined and
//! aborts, as do misaligned data accesses (AT91SAM7S datasheet, 6175M, chapter 18). An access takes
//! effect at the end of its cycles.

use arm7tdmi::bus::{Abort, Bus, Cycle, Width};

use crate::board::Board;
use crate::chip::Chip;
use crate::fault::FaultKind;
use crate::memory::mc::{AbortCause, AbortedAccess};
use crate::memory::{is_flash, lane, misaligned, WINDOW_BITS};

const BOOT_ROM_WINDOW: u32 = 3;
pub(super) const PERIPHERALS: u32 = 0xF000_0000;

/// A narrow store repeats its value on every lane (DDI 0029E, 6.1).
fn replicate(value: u32, width: Width) -> u32 {
    match width {
        Width::Byte => (value & 0xFF) * 0x0101_0101,
        Width::Halfword => (value & 0xFFFF) * 0x0001_0001,
        Width::Word => value,
    }
}

impl<B: Board> Chip<B> {
    /// Wait for a flash command to end.
    fn wait_for_flash(&mut self) {
        if self.memories.flash.ready_at() > self.now {
            self.now = self.memories.flash.ready_at();
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
        self.memories.mc.record_abort(cause, access, width, address);
        Abort
    }

    /// An address outside memory and peripherals: abort; the boot ROM is a fault besides.
    #[cold]
    fn outside(&mut self, access: AbortedAccess, width: Width, address: u32, value: u32) -> Abort {
        if address >> WINDOW_BITS == BOOT_ROM_WINDOW {
            let write = (access == AbortedAccess::Write).then_some(value);
            self.record_fault(FaultKind::BootRom, address, write);
        }
        self.abort(AbortCause::Undefined, access, width, address)
    }

    #[inline(never)]
    fn fetch_elsewhere(&mut self, address: u32, width: Width) -> Result<u32, Abort> {
        if !is_flash(address) {
            if address >= PERIPHERALS {
                self.record_fault(FaultKind::NoPeripheral, address, None);
            }
            return Err(self.outside(AbortedAccess::Fetch, width, address, 0));
        }
        self.wait_for_flash();
        let cycles = self.memories.flash.fetch_cycles(self.now, address, width);
        self.memories
            .flash
            .fetch_ends(self.now + cycles * self.ratio);
        self.spend(cycles);
        Ok(lane(self.memories.flash.word(address), address, width))
    }

    #[inline(never)]
    fn read_flash(&mut self, address: u32, width: Width) -> Result<u32, Abort> {
        if !is_flash(address) {
            return Err(self.outside(AbortedAccess::Read, width, address, 0));
        }
        self.wait_for_flash();
        self.memories.flash.data_was_read();
        self.spend(self.memories.flash.data_cycles());
        Ok(lane(self.memories.flash.word(address), address, width))
    }

    #[inline(never)]
    fn read_elsewhere(&mut self, address: u32, width: Width) -> Result<u32, Abort> {
        if address < PERIPHERALS {
            return self.read_flash(address, width);
        }
        self.spend(self.memories.timing.apb_cycles);
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
    fn write_flash(&mut self, address: u32, width: Width, value: u32) -> Result<(), Abort> {
        if !is_flash(address) {
            return Err(self.outside(AbortedAccess::Write, width, address, value));
        }
        self.wait_for_flash();
        self.spend(self.memories.flash.data_cycles());
        if width != Width::Word {
            self.record_fault(FaultKind::FlashWriteWidth, address, Some(value));
            return Err(Abort);
        }
        self.memories.flash.write_latch(address, value);
        Ok(())
    }

    #[inline(never)]
    fn write_elsewhere(&mut self, address: u32, width: Width, value: u32) -> Result<(), Abort> {
        if address < PERIPHERALS {
            return self.write_flash(address, width, value);
        }
        self.spend(self.memories.timing.apb_cycles);
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
        if self.memories.stolen != 0 || self.now >= self.schedule.earliest() {
            self.serve_events();
        }
    }
}

impl<B: Board> Bus for Chip<B> {
    #[inline(always)]
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        if !self.memories.is_sram(address) {
            return self.fetch_elsewhere(address, Width::Word);
        }
        self.spend(self.memories.timing.sram_cycles);
        Ok(self.memories.sram.word(address))
    }

    #[inline(always)]
    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        if !self.memories.is_sram(address) {
            let word = self.fetch_elsewhere(address, Width::Halfword)?;
            return Ok(word as u16);
        }
        self.spend(self.memories.timing.sram_cycles);
        Ok(self.memories.sram.halfword(address))
    }

    #[inline(always)]
    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        if misaligned(address, width) {
            let access = AbortedAccess::Read;
            return Err(self.abort(AbortCause::Misaligned, access, width, address));
        }
        if !self.memories.is_sram(address) {
            return self.read_elsewhere(address, width);
        }
        self.spend(self.memories.timing.sram_cycles);
        Ok(match width {
            Width::Word => self.memories.sram.word(address),
            Width::Halfword => u32::from(self.memories.sram.halfword(address)),
            Width::Byte => u32::from(self.memories.sram.byte(address)),
        })
    }

    #[inline(always)]
    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        if misaligned(address, width) {
            let access = AbortedAccess::Write;
            return Err(self.abort(AbortCause::Misaligned, access, width, address));
        }
        if !self.memories.is_sram(address) {
            return self.write_elsewhere(address, width, value);
        }
        self.spend(self.memories.timing.sram_cycles);
        self.memories.sram.write(self.now, address, width, value);
        Ok(())
    }

    #[inline(always)]
    fn internal(&mut self, count: u32) {
        self.spend(u64::from(count));
    }

    #[inline(always)]
    fn irq(&self) -> bool {
        self.now >= self.peripherals.aic.irq_seen_at()
    }

    #[inline(always)]
    fn fiq(&self) -> bool {
        self.now >= self.peripherals.aic.fiq_seen_at()
    }
}
