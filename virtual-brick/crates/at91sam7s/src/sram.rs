// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! 64 KiB of static memory, kept as words, with write watches for an outside observer.

use arm7tdmi::bus::Width;

use crate::board::Cycles;

const WORDS: usize = 0x4000;

/// A write to a watched word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WatchHit {
    /// When the write took effect.
    pub at_cycles: Cycles,
    /// Address of the word, as given to `watch_word` modulo the SRAM window.
    pub address: u32,
    /// The whole word after the write.
    pub value: u32,
}

/// Static memory at 0x0020_0000, repeated through its 1 MiB window.
#[derive(Clone, Debug)]
pub(crate) struct Sram {
    words: Box<[u32; WORDS]>,
    watched: Box<[u64; WORDS / 64]>,
    hits: Vec<WatchHit>,
}

#[inline(always)]
const fn index(address: u32) -> usize {
    ((address >> 2) & 0x3FFF) as usize
}

impl Sram {
    pub(crate) fn new() -> Self {
        Self {
            words: Box::new([0; WORDS]),
            watched: Box::new([0; WORDS / 64]),
            hits: Vec::new(),
        }
    }

    #[inline(always)]
    pub(crate) fn word(&self, address: u32) -> u32 {
        self.words[index(address)]
    }

    #[inline(always)]
    pub(crate) fn halfword(&self, address: u32) -> u16 {
        (self.word(address) >> ((address & 2) * 8)) as u16
    }

    #[inline(always)]
    pub(crate) fn byte(&self, address: u32) -> u8 {
        (self.word(address) >> ((address & 3) * 8)) as u8
    }

    #[inline(always)]
    pub(crate) fn write(&mut self, now: Cycles, address: u32, width: Width, value: u32) {
        let slot = index(address);
        let word = match width {
            Width::Word => value,
            Width::Halfword => merge(self.words[slot], value, 0xFFFF, (address & 2) * 8),
            Width::Byte => merge(self.words[slot], value, 0xFF, (address & 3) * 8),
        };
        self.words[slot] = word;
        if self.watched[slot / 64] >> (slot % 64) & 1 != 0 {
            self.hits.push(WatchHit {
                at_cycles: now,
                address: 0x0020_0000 + 4 * slot as u32,
                value: word,
            });
        }
    }

    /// Write without time and without watches.
    pub(crate) fn load_byte(&mut self, address: u32, value: u8) {
        let slot = index(address);
        self.words[slot] = merge(self.words[slot], u32::from(value), 0xFF, (address & 3) * 8);
    }

    pub(crate) fn watch(&mut self, address: u32) {
        let slot = index(address);
        self.watched[slot / 64] |= 1 << (slot % 64);
    }

    #[inline(always)]
    pub(crate) fn has_hits(&self) -> bool {
        !self.hits.is_empty()
    }

    pub(crate) fn take_hits(&mut self) -> Vec<WatchHit> {
        std::mem::take(&mut self.hits)
    }
}

#[inline(always)]
const fn merge(word: u32, value: u32, mask: u32, shift: u32) -> u32 {
    (word & !(mask << shift)) | ((value & mask) << shift)
}
