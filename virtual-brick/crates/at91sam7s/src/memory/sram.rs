// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! 64 KiB of static memory, kept as words, with write watches for an outside observer and marks on
//! words that were decoded as code.

use arm7tdmi::bus::Width;

use crate::clock::Cycles;

const WORDS: usize = 0x4000;
/// More than one multiple transfer reaches.
const LINE_WORDS: usize = 16;
const WATCHED: u8 = 1 << 0;
const CODE: u8 = 1 << 1;

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
    /// Per word: the bits below.
    marks: Box<[u8; WORDS]>,
    /// Per line of words: one of them has or had a mark.
    lines: Box<[bool; WORDS / LINE_WORDS]>,
    hits: Vec<WatchHit>,
    code_changes: Vec<u32>,
}

#[inline(always)]
const fn index(address: u32) -> usize {
    ((address >> 2) & 0x3FFF) as usize
}

impl Sram {
    pub(crate) fn new() -> Self {
        Self {
            words: Box::new([0; WORDS]),
            marks: Box::new([0; WORDS]),
            lines: Box::new([false; WORDS / LINE_WORDS]),
            hits: Vec::new(),
            code_changes: Vec::new(),
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
        if self.marks[slot] != 0 {
            self.marked_written(now, slot);
        }
    }

    #[cold]
    fn marked_written(&mut self, now: Cycles, slot: usize) {
        if self.marks[slot] & WATCHED != 0 {
            self.hits.push(WatchHit {
                at_cycles: now,
                address: 0x0020_0000 + 4 * slot as u32,
                value: self.words[slot],
            });
        }
        self.code_changed(slot);
    }

    fn code_changed(&mut self, slot: usize) {
        if self.marks[slot] & CODE != 0 {
            self.marks[slot] &= !CODE;
            self.code_changes.push(slot as u32);
        }
    }

    /// Write, unless somebody wants to know of it; true when written.
    #[inline(always)]
    pub(crate) fn write_unmarked(&mut self, address: u32, width: Width, value: u32) -> bool {
        let slot = index(address);
        if self.marks[slot] != 0 {
            return false;
        }
        self.words[slot] = match width {
            Width::Word => value,
            Width::Halfword => merge(self.words[slot], value, 0xFFFF, (address & 2) * 8),
            Width::Byte => merge(self.words[slot], value, 0xFF, (address & 3) * 8),
        };
        true
    }

    /// Words up to the end of the memory at most.
    #[inline(always)]
    pub(crate) fn words(&self, address: u32, count: u32) -> Option<&[u32]> {
        let first = index(address);
        self.words.get(first..first + count as usize)
    }

    /// All words, and whether somebody wants to know of a write of each.
    #[inline(always)]
    pub(crate) fn all(&mut self) -> (&mut [u32], &[u8]) {
        (&mut self.words[..], &self.marks[..])
    }

    /// Words to write, unless somebody wants to know of it.
    #[inline(always)]
    pub(crate) fn unmarked_words(&mut self, address: u32, count: u32) -> Option<&mut [u32]> {
        let first = index(address);
        let range = first..first + count as usize;
        let last = (range.end - 1) / LINE_WORDS;
        let marked = self.lines[first / LINE_WORDS] || *self.lines.get(last)?;
        let free = !marked || self.marks.get(range.clone())?.iter().all(|m| *m == 0);
        if free {
            self.words.get_mut(range)
        } else {
            None
        }
    }

    /// Tell the next change of a word, which was decoded as code.
    pub(crate) fn mark_code(&mut self, address: u32) {
        self.mark(index(address), CODE);
    }

    /// The word was decoded as code.
    pub(crate) fn is_code(&self, address: u32) -> bool {
        self.marks[index(address)] & CODE != 0
    }

    /// Number of a word that was decoded as code and changed.
    #[inline]
    pub(crate) fn next_code_change(&mut self) -> Option<u32> {
        self.code_changes.pop()
    }

    /// Write without time and without watches.
    pub(crate) fn load_byte(&mut self, address: u32, value: u8) {
        let slot = index(address);
        self.words[slot] = merge(self.words[slot], u32::from(value), 0xFF, (address & 3) * 8);
        self.code_changed(slot);
    }

    pub(crate) fn watch(&mut self, address: u32) {
        self.mark(index(address), WATCHED);
    }

    fn mark(&mut self, slot: usize, mark: u8) {
        self.marks[slot] |= mark;
        self.lines[slot / LINE_WORDS] = true;
    }

    #[inline(always)]
    pub(crate) fn has_hits(&self) -> bool {
        !self.hits.is_empty()
    }

    pub(crate) fn take_hits(&mut self, taken: &mut Vec<WatchHit>) {
        taken.clear();
        std::mem::swap(&mut self.hits, taken);
    }
}

#[inline(always)]
const fn merge(word: u32, value: u32, mask: u32, shift: u32) -> u32 {
    (word & !(mask << shift)) | ((value & mask) << shift)
}
