// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! LDM and STM in RAM: one check, then all accesses.

use arm7tdmi::instruction::BlockTransfer;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::entry_table::AfterStore;
use crate::function::Function;
use crate::transfer::of_memory;

/// Can the code make it?
pub(crate) const fn is_supported(block: &BlockTransfer) -> bool {
    let odd = block.size_bytes != 4 * block.list.count_ones();
    let stores_pc = !block.load && block.list >> 15 != 0;
    !odd && !stores_pc && !block.status && block.base != 15
}

/// A multiple transfer whose words are in RAM.
pub(crate) struct Words {
    /// Address of the first in the host's memory.
    start: Value,
    /// Its index in RAM.
    word: Value,
    /// The base afterwards.
    moved: Option<Value>,
}

impl Function<'_> {
    /// The words in RAM; takes a side exit if they are elsewhere.
    pub fn block_words(&mut self, block: &BlockTransfer) -> Words {
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
        let first = lowest.wrapping_add(first).wrapping_sub(self.ram.address);
        let first = self.constant(first);
        let offset = self.ins().iadd(base, first);
        // The rotation brings the low bits of a misaligned address to the top.
        let word = self.ins().rotr_imm(offset, 2);
        let last = self.constant((self.ram.bytes - block.size_bytes) / 4);
        let above = IntCC::UnsignedGreaterThan;
        let outside = self.ins().icmp(above, word, last);
        self.exit_if(outside);
        let moved = block.write_back.then(|| self.ins().iadd(base, distance));
        Words {
            start: self.behind(self.arguments.words, offset),
            word,
            moved,
        }
    }

    /// The word that r15 receives.
    pub fn last_word(&mut self, block: &BlockTransfer, words: &Words) -> Value {
        let offset = block.size_bytes as i32 - 4;
        self.ins()
            .load(types::I32, of_memory(), words.start, offset)
    }

    /// Loads the registers below r15.
    pub fn load_words(&mut self, block: &BlockTransfer, words: &Words) {
        self.known.pending += 1 + block.list.count_ones() * self.ram.cycles;
        if let Some(moved) = words.moved {
            self.set(block.base, moved);
        }
        let listed = (0..15).filter(|register| block.list >> register & 1 != 0);
        for (index, register) in listed.enumerate() {
            let offset = 4 * index as i32;
            let ins = self.ins();
            let value = ins.load(types::I32, of_memory(), words.start, offset);
            self.set(register, value);
        }
    }

    /// STM.
    pub fn store_words(&mut self, block: &BlockTransfer) {
        let words = self.block_words(block);
        let count = block.list.count_ones();
        self.exit_if_marked(&words, count);
        let listed = (0..15).filter(|register| block.list >> register & 1 != 0);
        for (index, register) in listed.enumerate() {
            let value = self.get(register);
            let ins = self.ins();
            ins.store(of_memory(), value, words.start, 4 * index as i32);
            if let (0, Some(moved)) = (index, words.moved) {
                self.set(block.base, moved);
            }
        }
        self.known.pending += count * self.ram.cycles;
        self.known.after_store = AfterStore::At(self.position.address);
    }

    /// Takes a side exit if one of the words is marked.
    fn exit_if_marked(&mut self, words: &Words, count: u32) {
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
            let marks = self.ins().load(kind, flags, start, offset as i32);
            let marks = if size == 8 {
                marks
            } else {
                self.ins().uextend(types::I64, marks)
            };
            any = Some(match any {
                Some(others) => self.ins().bor(others, marks),
                None => marks,
            });
            offset += size;
        }
        if let Some(any) = any {
            self.exit_if(any);
        }
    }
}
