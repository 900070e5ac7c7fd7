// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip as the bus of decoded blocks: code in SRAM and flash, plain accesses to them.

use arm7tdmi::bus::Width;
use arm7tdmi::{BlockBus, BusAccess, CodePlace, PlainRead, PlainWords, RamView};

use crate::board::{Board, Cycles};
use crate::chip::bus::PERIPHERALS;
use crate::chip::Chip;
use crate::memory::flash::FLASH_BYTES;
use crate::memory::{is_flash, lane, misaligned, SRAM_WINDOW, WINDOW_BITS};
use crate::peripherals::{decode, AIC_BASE, AIC_BITS, PIOA_BASE};
use crate::pins::pio::Pio;

const SRAM: u8 = 0;
const FLASH: u8 = 1;
const SRAM_HALFWORDS: u32 = 0x8000;
const FLASH_HALFWORDS: u32 = FLASH_BYTES as u32 / 2;
/// Arrivals at the exception vectors below this address are looked at.
const VECTORS_END: u32 = 0x20;
/// Contents of memory that was never written: RAM and erased flash.
const UNSET: [u32; 2] = [0, u32::MAX];
/// Registers of reset controller, timers of the system, watchdog and memory controller begin here.
const RESET_CONTROLLER: u32 = 0xFFFF_FD00;
/// Registers of the data controller in each peripheral that has them.
const PDC_FIRST: u32 = 0x100;
const PDC_LAST: u32 = 0x124;
/// Longest stretch asked for at once.
const QUIET_CYCLES_MAX: Cycles = 1 << 30;

impl<B: Board> Chip<B> {
    fn flash_ready(&self) -> bool {
        self.memories.flash.ready_at() <= self.now
    }

    /// As [`Chip::polled`], by address.
    #[inline(never)]
    fn polled_at(&self, address: u32, at: Cycles) -> Option<(u32, bool)> {
        let (peripheral, offset) = decode(address).ok()?;
        self.polled(peripheral, offset, at)
    }

    #[inline(always)]
    fn end_of_register_access(&self, after_cycles: u32) -> Cycles {
        let cycles = Cycles::from(after_cycles) + self.memories.timing.apb_cycles;
        self.now + cycles * self.ratio
    }

    #[inline(always)]
    fn sram_cycles(&self) -> u32 {
        self.memories.timing.sram_cycles as u32
    }
}

/// A write there can change the memory map or flash, reset the chip or start a transfer to memory.
const fn changes_memory(address: u32) -> bool {
    let offset = address & 0x3FFF;
    address >= RESET_CONTROLLER || (offset >= PDC_FIRST && offset <= PDC_LAST)
}

impl<B: Board> BlockBus for Chip<B> {
    const CODE_HALFWORDS: u32 = SRAM_HALFWORDS + FLASH_HALFWORDS;

    #[inline(always)]
    fn code_place(&self, address: u32) -> Option<CodePlace> {
        if self.memories.is_sram(address) {
            Some(CodePlace {
                halfword: address / 2 % SRAM_HALFWORDS,
                memory: SRAM,
            })
        } else if is_flash(address) {
            Some(CodePlace {
                halfword: SRAM_HALFWORDS + address / 2 % FLASH_HALFWORDS,
                memory: FLASH,
            })
        } else {
            None
        }
    }

    #[inline(always)]
    fn target_place(&self, address: u32) -> Option<CodePlace> {
        if address < VECTORS_END {
            None
        } else {
            self.code_place(address)
        }
    }

    /// What happens at a vector that was never set is looked at step by step.
    #[inline(always)]
    fn can_enter(&self, address: u32) -> bool {
        address >= VECTORS_END || !UNSET.contains(&self.code_word(address & !3))
    }

    fn observes_arrival(&self, address: u32) -> bool {
        self.observed_arrivals.binary_search(&address).is_ok()
    }

    #[inline(always)]
    fn code_word(&self, address: u32) -> u32 {
        self.memories.word(address)
    }

    #[inline]
    fn code_epoch(&self) -> u32 {
        self.memories.flash.epoch()
    }

    fn mark_code(&mut self, address: u32) {
        if self.memories.is_sram(address) {
            self.memories.sram.mark_code(address);
        }
    }

    #[inline]
    fn next_code_change(&mut self) -> Option<u32> {
        self.memories.sram.next_code_change().map(|word| 2 * word)
    }

    fn sequential_fetch_cycles(&self, address: u32, width: Width) -> u32 {
        if self.memories.is_sram(address) {
            self.sram_cycles()
        } else {
            self.memories.flash.sequential_cycles(address, width) as u32
        }
    }

    #[inline]
    fn refill_cycles(&self, sequence: u32, target: u32, width: Width) -> u32 {
        if self.memories.is_sram(target) {
            2 * self.sram_cycles()
        } else {
            self.memories.flash.refill_cycles(sequence, target, width) as u32
        }
    }

    #[inline(always)]
    fn in_sequence(&self, address: u32) -> bool {
        self.memories.is_sram(address)
            || self.flash_ready() && self.memories.flash.in_sequence(address)
    }

    #[inline(always)]
    fn continue_at(&mut self, address: u32) {
        if !self.memories.is_sram(address) {
            self.memories.flash.continue_at(address);
        }
    }

    fn access_cycles_max(&self) -> u32 {
        self.sram_cycles()
            .max(self.memories.flash.most_cycles() as u32)
            .max(self.register_cycles())
    }

    fn ram_cycles(&self) -> u32 {
        self.sram_cycles()
    }

    #[inline(always)]
    fn ram_read(&self, address: u32, width: Width) -> Option<u32> {
        self.memories
            .is_aligned_sram(address, width)
            .then(|| lane(self.memories.sram.word(address), address, width))
    }

    #[inline(always)]
    fn ram_write(&mut self, address: u32, width: Width, value: u32) -> bool {
        self.memories.is_aligned_sram(address, width)
            && self.memories.sram.write_unmarked(address, width, value)
    }

    #[inline]
    fn plain_read(&self, address: u32, width: Width) -> Option<PlainRead> {
        if address >= PERIPHERALS {
            return None;
        }
        if let Some(value) = self.ram_read(address, width) {
            let cycles = self.sram_cycles();
            return Some(PlainRead { value, cycles });
        }
        let plain = !misaligned(address, width)
            && !self.memories.is_sram(address)
            && is_flash(address)
            && self.flash_ready();
        plain.then(|| PlainRead {
            value: lane(self.memories.flash.word(address), address, width),
            cycles: self.memories.flash.data_cycles() as u32,
        })
    }

    #[inline(always)]
    fn register_cycles(&self) -> u32 {
        self.memories.timing.apb_cycles as u32
    }

    #[inline(always)]
    fn register_read(&self, address: u32, after_cycles: u32) -> Option<(u32, bool)> {
        if address >> AIC_BITS == AIC_BASE >> AIC_BITS {
            return None;
        }
        self.polled_at(address, self.end_of_register_access(after_cycles))
    }

    #[inline(always)]
    fn register_write(&mut self, address: u32, value: u32, after_cycles: u32) -> bool {
        let offset = address.wrapping_sub(PIOA_BASE);
        let at = self.end_of_register_access(after_cycles);
        Pio::sets_levels(offset) && self.write_unfollowed(offset, value, at)
    }

    #[inline]
    fn plain_words(&self, address: u32, count: u32) -> Option<PlainWords<&[u32]>> {
        if misaligned(address, Width::Word) {
            return None;
        }
        if self.memories.is_sram(address) {
            let cycles = self.sram_cycles();
            let words = self.memories.sram.words(address, count)?;
            return Some(PlainWords { words, cycles });
        }
        if !is_flash(address) || !self.flash_ready() {
            return None;
        }
        let cycles = self.memories.flash.data_cycles() as u32;
        let words = self.memories.flash.words(address, count)?;
        Some(PlainWords { words, cycles })
    }

    #[inline]
    fn plain_words_mut(&mut self, address: u32, count: u32) -> Option<PlainWords<&mut [u32]>> {
        if misaligned(address, Width::Word) || !self.memories.is_sram(address) {
            return None;
        }
        let cycles = self.sram_cycles();
        let words = self.memories.sram.unmarked_words(address, count)?;
        Some(PlainWords { words, cycles })
    }

    #[inline(always)]
    fn access_between(
        &self,
        address: u32,
        width: Width,
        write: bool,
        after_cycles: u32,
    ) -> BusAccess {
        if misaligned(address, width) {
            return BusAccess::Refused;
        }
        let keeps_memory = if address >= PERIPHERALS {
            !(write && changes_memory(address))
        } else if self.memories.is_sram(address) && !self.memories.sram.is_code(address) {
            true
        } else {
            return BusAccess::Refused;
        };
        let ends = Cycles::from(after_cycles) + self.memories.timing.apb_cycles + 1;
        let uneventful = self.now + ends * self.ratio < self.schedule.earliest();
        if keeps_memory && uneventful && !self.data_controller_may_write {
            BusAccess::KeepsMemory
        } else {
            BusAccess::ChangesMemory
        }
    }

    fn code_window(&self, memory: u8) -> (u32, u32) {
        if memory == SRAM {
            (0, SRAM_HALFWORDS - 1)
        } else {
            (SRAM_HALFWORDS, FLASH_HALFWORDS - 1)
        }
    }

    #[inline]
    fn ram_view(&mut self) -> Option<RamView<'_>> {
        let (words, marks) = self.memories.sram.all();
        Some(RamView {
            address: SRAM_WINDOW << WINDOW_BITS,
            words,
            marks,
        })
    }

    fn needs_attention(&self) -> bool {
        self.stopped
            || self.reset.is_some()
            || self.fault.is_some()
            || self.memories.sram.has_hits()
            || self.board.wants_attention()
    }

    #[inline]
    fn cycles_until_event(&self, limit: Cycles, irq: bool, fiq: bool) -> u32 {
        let mut horizon = self.schedule.earliest().min(limit);
        if irq {
            horizon = horizon.min(self.peripherals.aic.irq_seen_at());
        }
        if fiq {
            horizon = horizon.min(self.peripherals.aic.fiq_seen_at());
        }
        if horizon <= self.now {
            return 0;
        }
        let quiet = horizon - self.now - 1;
        let cycles = if self.ratio == 1 {
            quiet
        } else {
            quiet / self.ratio
        };
        cycles.min(QUIET_CYCLES_MAX) as u32
    }

    #[inline]
    fn pass(&mut self, cycles: u32) {
        self.now += Cycles::from(cycles) * self.ratio;
    }
}
