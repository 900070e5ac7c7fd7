// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! LDM and STM in RAM: one check, then all accesses.

use arm7tdmi::instruction::BlockTransfer;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::function::Function;
use crate::table::AfterStore;
use crate::transfer::{of_memory, Ram};

/// Is it one that the code makes?
pub(crate) const fn is_plain(block: &BlockTransfer) -> bool {
    let odd = block.size_bytes != 4 * block.list.count_ones();
    let stores_pc = !block.load && block.list >> 15 != 0;
    !odd && !stores_pc && !block.status && block.base != 15
}

/// A multiple transfer whose words are in RAM.
pub(crate) struct Words {
    /// Address of the first in the host's memory.
    start: Value,
    /// Its number.
    word: Value,
    /// The base afterwards.
    moved: Option<Value>,
}

impl Function<'_> {
    /// Where the words are; leaves the code if they are not in RAM.
    pub fn block_words(&mut self, block: &BlockTransfer, ram: Ram) -> Words {
        let base = self.get(block.base);
        let distance = self.constant(if block.up {
            block.size_bytes
        } else {
            block.size_bytes.wrapping_neg()
        });
        let lowest = if block.up {
            0
        } else {
            block.size_bytes.wrapping_neg()
        };
        let first = if block.before == block.up { 4 } else { 0 };
        let first = lowest.wrapping_add(first).wrapping_sub(ram.address);
        let first = self.constant(first);
        let offset = self.builder.ins().iadd(base, first);
        // Bits that a word's address has not are at the top behind this.
        let word = self.builder.ins().rotr_imm(offset, 2);
        let last = self.constant((ram.bytes - block.size_bytes) / 4);
        let above = IntCC::UnsignedGreaterThan;
        let outside = self.builder.ins().icmp(above, word, last);
        self.leave_if(outside);
        let moved = block
            .write_back
            .then(|| self.builder.ins().iadd(base, distance));
        Words {
            start: self.behind(self.arguments.words, offset),
            word,
            moved,
        }
    }

    /// The word that r15 receives.
    pub fn last_word(&mut self, block: &BlockTransfer, words: &Words) -> Value {
        let offset = block.size_bytes as i32 - 4;
        self.builder
            .ins()
            .load(types::I32, of_memory(), words.start, offset)
    }

    /// Loads the registers below r15.
    pub fn load_words(&mut self, block: &BlockTransfer, words: &Words, ram: Ram) {
        self.known.pending += 1 + block.list.count_ones() * ram.cycles;
        if let Some(moved) = words.moved {
            self.set(block.base, moved);
        }
        let listed = (0..15).filter(|register| block.list >> register & 1 != 0);
        for (index, register) in listed.enumerate() {
            let offset = 4 * index as i32;
            let ins = self.builder.ins();
            let value = ins.load(types::I32, of_memory(), words.start, offset);
            self.set(register, value);
        }
    }

    /// STM.
    pub fn store_words(&mut self, block: &BlockTransfer, ram: Ram) {
        let words = self.block_words(block, ram);
        let count = block.list.count_ones();
        self.leave_if_marked(&words, count);
        let listed = (0..15).filter(|register| block.list >> register & 1 != 0);
        for (index, register) in listed.enumerate() {
            let value = self.get(register);
            let ins = self.builder.ins();
            ins.store(of_memory(), value, words.start, 4 * index as i32);
            if let (0, Some(moved)) = (index, words.moved) {
                self.set(block.base, moved);
            }
        }
        self.known.pending += count * ram.cycles;
        self.known.after_store = AfterStore::At(self.position.address);
    }

    /// Leaves the code if one of the words is marked.
    fn leave_if_marked(&mut self, words: &Words, count: u32) {
        let start = self.behind(self.arguments.marks, words.word);
        let mut any: Option<Value> = None;
        let mut offset = 0;
        while offset < count {
            let (size, kind) = match count - offset {
                8.. => (8, types::I64),
                4.. => (4, types::I32),
                2.. => (2, types::I16),
                _ => (1, types::I8),
            };
            let flags = of_memory();
            let marks = self.builder.ins().load(kind, flags, start, offset as i32);
            let marks = if size == 8 {
                marks
            } else {
                self.builder.ins().uextend(types::I64, marks)
            };
            any = Some(match any {
                Some(others) => self.builder.ins().bor(others, marks),
                None => marks,
            });
            offset += size;
        }
        if let Some(any) = any {
            self.leave_if(any);
        }
    }
}
