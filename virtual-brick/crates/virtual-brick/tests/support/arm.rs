// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A few ARM instructions by hand (ARM7TDMI data sheet, DDI 0029E, chapter 4).

pub const EQ: u32 = 0;
pub const NE: u32 = 1;
pub const CC: u32 = 3;
pub const ALWAYS: u32 = 14;

/// A program with its literals behind it.
#[derive(Clone, Default)]
pub struct Program {
    code: Vec<u32>,
    literals: Vec<(usize, u32)>,
}

impl Program {
    pub fn new() -> Self {
        Self::default()
    }

    /// Index of the next instruction, to branch to.
    pub fn here(&self) -> usize {
        self.code.len()
    }

    pub fn raw(&mut self, word: u32) -> &mut Self {
        self.code.push(word);
        self
    }

    /// LDR register, =value
    pub fn load(&mut self, register: u32, value: u32) -> &mut Self {
        self.literals.push((self.code.len(), value));
        self.raw(0xE59F_0000 | register << 12)
    }

    /// STR register, [base, #offset]
    pub fn str(&mut self, register: u32, base: u32, offset: u32) -> &mut Self {
        self.raw(0xE580_0000 | base << 16 | register << 12 | offset)
    }

    /// LDR register, [base, #offset]
    pub fn ldr(&mut self, register: u32, base: u32, offset: u32) -> &mut Self {
        self.raw(0xE590_0000 | base << 16 | register << 12 | offset)
    }

    /// Store a value at an address; changes r0 and r1.
    pub fn poke(&mut self, address: u32, value: u32) -> &mut Self {
        self.load(0, value).load(1, address).str(0, 1, 0)
    }

    /// TST register, #mask (8 bits)
    pub fn tst(&mut self, register: u32, mask: u32) -> &mut Self {
        self.raw(0xE310_0000 | register << 16 | mask)
    }

    /// CMP left, right
    pub fn cmp(&mut self, left: u32, right: u32) -> &mut Self {
        self.raw(0xE150_0000 | left << 16 | right)
    }

    /// SUBS register, register, #amount (8 bits)
    pub fn subs(&mut self, register: u32, amount: u32) -> &mut Self {
        self.raw(0xE250_0000 | register << 16 | register << 12 | amount)
    }

    /// ADD register, register, #amount (8 bits)
    pub fn add(&mut self, register: u32, amount: u32) -> &mut Self {
        self.raw(0xE280_0000 | register << 16 | register << 12 | amount)
    }

    /// B<condition> to an instruction already written.
    pub fn branch(&mut self, condition: u32, target: usize) -> &mut Self {
        let offset = target.wrapping_sub(self.code.len() + 2) as u32;
        self.raw(condition << 28 | 0x0A00_0000 | offset & 0x00FF_FFFF)
    }

    /// MSR CPSR_c, #bits
    pub fn status(&mut self, bits: u32) -> &mut Self {
        self.raw(0xE321_F000 | bits)
    }

    /// B . : loop for ever
    pub fn stop(&mut self) -> &mut Self {
        let here = self.here();
        self.branch(ALWAYS, here)
    }

    /// Wait until the register at `address` has a bit of `mask` (8 bits) set; changes r0 and r1.
    pub fn wait(&mut self, address: u32, mask: u32) -> &mut Self {
        self.load(1, address);
        let again = self.here();
        self.ldr(0, 1, 0).tst(0, mask).branch(EQ, again)
    }

    /// Wait about 4 cycles times `count`; changes r0.
    pub fn delay(&mut self, count: u32) -> &mut Self {
        self.load(0, count);
        let again = self.here();
        self.subs(0, 1).branch(NE, again)
    }

    pub fn words(&self) -> Vec<u32> {
        let mut words = self.code.clone();
        for (index, value) in &self.literals {
            let offset = 4 * (words.len() - index - 2) as u32;
            assert!(offset < 4096);
            words[*index] |= offset;
            words.push(*value);
        }
        words
    }
}
