// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flash memory and its controller (AT91SAM7S datasheet, 6175M, chapter 19).
//!
//! 1024 pages of 256 bytes in 16 lock regions. Writes to flash addresses fill a page latch; the
//! write-page command programs it. Times: page 6 ms with erase, 3 ms without; whole plane 15 ms;
//! lock bits and general purpose bits 3 ms (chapter 37, flash characteristics).

use arm7tdmi::bus::Width;

use crate::clock::{microseconds_cycles, Cycles, NEVER};
use crate::fault::{not_modelled, Access};
use crate::memory::interrupted_programming::{Programming, PAGE_WORDS};
use crate::timing::{CodeBufferLoss, TimingProfile};

pub(crate) const FLASH_BYTES: usize = 0x4_0000;
const WORDS: usize = FLASH_BYTES / 4;

const FRDY: u32 = 1 << 0;
const LOCKE: u32 = 1 << 2;
const PROGE: u32 = 1 << 3;
const NEBP: u32 = 1 << 7;
const FMR_MASK: u32 = 0x00FF_038D;
const WAIT_STATES: u32 = 3 << 8;

/// Cycles of each kind of access under the present wait states.
#[derive(Clone, Copy, Debug)]
struct Costs {
    first: Cycles,
    arm: Cycles,
    thumb: Cycles,
    thumb_boundary: Cycles,
    data: Cycles,
}

/// Flash array, page latch, prefetch buffer and controller registers.
#[derive(Clone, Debug)]
pub(crate) struct Flash {
    words: Vec<u32>,
    latch: [u32; PAGE_WORDS],
    mode: u32,
    errors: u32,
    lock_bits: u32,
    general_purpose_bits: u32,
    security: bool,
    ready_at: Cycles,
    /// The page that is being programmed until `ready_at`.
    programming: Option<Programming>,
    next_fetch: u32,
    odd_target: bool,
    /// What empties the code buffer, and whether that happened since the last fetch, which ended at
    /// `fetched_at`.
    loss: CodeBufferLoss,
    lost: bool,
    fetched_at: Cycles,
    costs: Costs,
    odd_target_cycles: Cycles,
    /// Changes with the contents and the costs.
    epoch: u32,
}

impl Flash {
    pub(crate) fn new(timing: &TimingProfile) -> Self {
        let mut flash = Self {
            words: vec![0xFFFF_FFFF; WORDS],
            latch: [0xFFFF_FFFF; PAGE_WORDS],
            mode: 0,
            errors: 0,
            lock_bits: 0,
            general_purpose_bits: 0,
            security: false,
            ready_at: 0,
            programming: None,
            next_fetch: 1,
            odd_target: false,
            loss: timing.code_buffer_loss,
            lost: false,
            fetched_at: 0,
            costs: Costs {
                first: 1,
                arm: 1,
                thumb: 1,
                thumb_boundary: 1,
                data: 1,
            },
            odd_target_cycles: timing.thumb_odd_target_cycles,
            epoch: 0,
        };
        flash.set_costs(timing);
        flash
    }

    /// Registers back to their reset values; the array and its non-volatile bits stay.
    pub(crate) fn reset(&mut self, timing: &TimingProfile) {
        self.mode = 0;
        self.errors = 0;
        self.latch = [0xFFFF_FFFF; PAGE_WORDS];
        self.next_fetch = 1;
        self.set_costs(timing);
    }

    fn set_costs(&mut self, timing: &TimingProfile) {
        self.epoch = self.epoch.wrapping_add(1);
        let waits = Cycles::from(self.mode >> 8 & 3);
        let thumb = timing.flash_sequential_thumb.cycles(waits);
        self.costs = Costs {
            first: timing.flash_first.cycles(waits),
            arm: timing.flash_sequential_arm.cycles(waits),
            thumb,
            thumb_boundary: if waits > 1 {
                timing.flash_first.cycles(waits)
            } else {
                thumb
            },
            data: timing.flash_data.cycles(waits),
        };
        self.odd_target_cycles = if waits > 0 {
            timing.thumb_odd_target_cycles
        } else {
            0
        };
    }

    #[inline(always)]
    pub(crate) fn word(&self, address: u32) -> u32 {
        self.words[(address as usize >> 2) % WORDS]
    }

    /// Words up to the end of the array at most.
    #[inline(always)]
    pub(crate) fn words(&self, address: u32, count: u32) -> Option<&[u32]> {
        let first = (address as usize >> 2) % WORDS;
        self.words.get(first..first + count as usize)
    }

    /// Cycles of an opcode fetch that begins at `now`.
    #[inline]
    pub(crate) fn fetch_cycles(&mut self, now: Cycles, address: u32, width: Width) -> Cycles {
        let gap = self.loss == CodeBufferLoss::Gap && now != self.fetched_at;
        let empty = std::mem::take(&mut self.lost) || gap;
        match width {
            Width::Word => self.fetch_word_cycles(address & !3, empty),
            _ => self.fetch_halfword_cycles(address & !1, empty),
        }
    }

    /// When the fetch that began ends.
    #[inline]
    pub(crate) fn fetch_ends(&mut self, at: Cycles) {
        self.fetched_at = at;
    }

    /// A fetch is sequential when it continues the last one; with an empty buffer it costs as
    /// after a branch.
    #[inline]
    fn fetch_word_cycles(&mut self, address: u32, empty: bool) -> Cycles {
        let sequential = self.next_fetch == address;
        self.next_fetch = address.wrapping_add(4);
        self.odd_target = false;
        if sequential && !empty {
            self.costs.arm
        } else {
            self.costs.first
        }
    }

    #[inline]
    fn fetch_halfword_cycles(&mut self, address: u32, empty: bool) -> Cycles {
        let sequential = self.next_fetch == address;
        self.next_fetch = address.wrapping_add(2);
        if !sequential || empty {
            self.odd_target = !sequential && address & 2 != 0;
            return self.costs.first;
        }
        let late = if self.odd_target {
            self.odd_target_cycles
        } else {
            0
        };
        self.odd_target = false;
        let regular = if address & 2 == 0 {
            self.costs.thumb_boundary
        } else {
            self.costs.thumb
        };
        regular + late
    }

    /// Changes with everything that code decoded from flash depends on.
    #[inline(always)]
    pub(crate) fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Another memory appears where code may have been decoded.
    pub(crate) fn remapped(&mut self) {
        self.epoch = self.epoch.wrapping_add(1);
    }

    /// A fetch at `address` would be sequential and cost what the table says.
    pub(crate) fn in_sequence(&self, address: u32) -> bool {
        self.next_fetch == address && !self.odd_target
    }

    /// Sequential fetches were made up to `address`.
    pub(crate) fn continue_at(&mut self, address: u32) {
        self.next_fetch = address;
    }

    /// Cycles of a sequential fetch without what a branch left behind.
    pub(crate) fn sequential_cycles(&self, address: u32, width: Width) -> Cycles {
        match width {
            Width::Word => self.costs.arm,
            _ if address & 2 == 0 => self.costs.thumb_boundary,
            _ => self.costs.thumb,
        }
    }

    /// Cycles of the two fetches after a branch, when one at `sequence` would be sequential.
    pub(crate) fn refill_cycles(&self, sequence: u32, target: u32, width: Width) -> Cycles {
        let size = if width == Width::Word { 4 } else { 2 };
        let second = self.sequential_cycles(target.wrapping_add(size), width);
        if sequence == target {
            return self.sequential_cycles(target, width) + second;
        }
        let late = if width != Width::Word && target & 2 != 0 {
            self.odd_target_cycles
        } else {
            0
        };
        self.costs.first + second + late
    }

    /// No fetch or read costs more.
    pub(crate) fn most_cycles(&self) -> Cycles {
        let Costs {
            first,
            arm,
            thumb,
            thumb_boundary,
            data,
        } = self.costs;
        let regular = first.max(arm).max(thumb).max(thumb_boundary).max(data);
        regular + self.odd_target_cycles
    }

    /// Cycles of a data access.
    #[inline]
    pub(crate) fn data_cycles(&self) -> Cycles {
        self.costs.data
    }

    /// Data is read through the bus.
    #[inline]
    pub(crate) fn data_was_read(&mut self) {
        self.lost = self.loss == CodeBufferLoss::FlashData;
    }

    /// When the running command ends; an access before that waits.
    #[inline]
    pub(crate) fn ready_at(&self) -> Cycles {
        self.ready_at
    }

    pub(crate) fn load_byte(&mut self, address: u32, value: u8) {
        let slot = (address as usize >> 2) % WORDS;
        let shift = (address & 3) * 8;
        self.epoch = self.epoch.wrapping_add(1);
        self.words[slot] = (self.words[slot] & !(0xFF << shift)) | (u32::from(value) << shift);
    }

    /// A 32-bit write to a flash address: fills the page latch.
    pub(crate) fn write_latch(&mut self, address: u32, value: u32) {
        self.latch[(address as usize >> 2) % PAGE_WORDS] &= value;
    }

    pub(crate) fn mode(&self) -> u32 {
        self.mode
    }

    pub(crate) fn set_mode(&mut self, value: u32, timing: &TimingProfile) {
        let changed = (self.mode ^ value) & WAIT_STATES != 0;
        self.mode = value & FMR_MASK;
        if changed {
            self.set_costs(timing);
        }
    }

    /// `MC_FSR` as software reads it; the error flags clear.
    pub(crate) fn read_status(&mut self, now: Cycles) -> u32 {
        let value = self.status(now);
        self.errors = 0;
        value
    }

    fn status(&self, now: Cycles) -> u32 {
        (u32::from(now >= self.ready_at) * FRDY)
            | self.errors
            | u32::from(self.security) << 4
            | self.general_purpose_bits << 8
            | self.lock_bits << 16
    }

    pub(crate) fn interrupt(&self, now: Cycles) -> bool {
        self.status(now) & self.mode & (FRDY | LOCKE | PROGE) != 0
    }

    /// End of the running command when its interrupt is wanted.
    pub(crate) fn next_event(&self, now: Cycles) -> Cycles {
        if self.mode & FRDY != 0 && self.ready_at > now {
            self.ready_at
        } else {
            NEVER
        }
    }

    /// `MC_FCR`: key 0x5A, page or bit number, command.
    pub(crate) fn command(&mut self, now: Cycles, value: u32) -> Access {
        let page = value >> 8 & 0x3FF;
        if value >> 24 != 0x5A || now < self.ready_at {
            self.errors |= PROGE;
            return Ok(());
        }
        self.programming = None;
        let busy_us = match value & 0xF {
            1 => self.write_page(now, page),
            2 => self.set_lock(page, true),
            3 => {
                let busy = self.write_page(now, page);
                busy + self.set_lock(page, true)
            }
            4 => self.set_lock(page, false),
            8 => self.erase_all(),
            0xB => self.set_general_purpose_bit(page, true),
            0xD => self.set_general_purpose_bit(page, false),
            0xF => return not_modelled("MC (flash controller)", "setting the security bit"),
            _ => {
                self.errors |= PROGE;
                0
            }
        };
        self.ready_at = now + microseconds_cycles(busy_us);
        Ok(())
    }

    fn write_page(&mut self, now: Cycles, page: u32) -> u64 {
        if self.lock_bits >> (page / 64) & 1 != 0 {
            self.errors |= LOCKE;
            return 0;
        }
        self.epoch = self.epoch.wrapping_add(1);
        let keep = self.mode & NEBP != 0;
        let start = page as usize * PAGE_WORDS;
        let mut before = [0; PAGE_WORDS];
        before.copy_from_slice(&self.words[start..start + PAGE_WORDS]);
        self.programming = Some(Programming {
            page,
            before,
            since: now,
            erases: !keep,
        });
        for (cell, new) in self.words[start..start + PAGE_WORDS]
            .iter_mut()
            .zip(self.latch)
        {
            *cell = if keep { *cell & new } else { new };
        }
        self.latch = [0xFFFF_FFFF; PAGE_WORDS];
        if keep {
            3_000
        } else {
            6_000
        }
    }

    /// The supply fails: what was being programmed stays as far as it got.
    pub(crate) fn interrupt_programming(&mut self, now: Cycles) {
        let Some(programming) = self.programming.take() else {
            return;
        };
        if now < self.ready_at {
            let start = programming.page as usize * PAGE_WORDS;
            let page = &mut self.words[start..start + PAGE_WORDS];
            programming.interrupt(page, now, self.ready_at);
            self.ready_at = now;
            self.epoch = self.epoch.wrapping_add(1);
        }
    }

    /// A general purpose bit, 0 or 1.
    pub(crate) fn general_purpose_bit(&self, number: u32) -> bool {
        self.general_purpose_bits >> number & 1 != 0
    }

    fn set_lock(&mut self, page: u32, locked: bool) -> u64 {
        let bit = 1 << (page / 64);
        if locked {
            self.lock_bits |= bit;
        } else {
            self.lock_bits &= !bit;
        }
        3_000
    }

    fn set_general_purpose_bit(&mut self, number: u32, on: bool) -> u64 {
        if number > 1 {
            self.errors |= PROGE;
            return 0;
        }
        if on {
            self.general_purpose_bits |= 1 << number;
        } else {
            self.general_purpose_bits &= !(1 << number);
        }
        3_000
    }

    fn erase_all(&mut self) -> u64 {
        if self.lock_bits != 0 {
            self.errors |= LOCKE;
            return 0;
        }
        self.epoch = self.epoch.wrapping_add(1);
        self.words.fill(0xFFFF_FFFF);
        15_000
    }
}
