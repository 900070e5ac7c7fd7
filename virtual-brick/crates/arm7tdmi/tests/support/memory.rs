// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A memory of 64 KB that answers in one cycle, for programs of the tests.

use arm7tdmi::{Abort, Bus, Cycle, Width};

const SIZE: usize = 0x1_0000;

/// Memory from address 0; accesses beyond its end are aborted. Counts cycles.
pub struct Memory {
    bytes: Box<[u8; SIZE]>,
    pub cycles: u64,
    pub irq: bool,
    pub fiq: bool,
}

impl Memory {
    pub fn new() -> Self {
        Self {
            bytes: Box::new([0; SIZE]),
            cycles: 0,
            irq: false,
            fiq: false,
        }
    }

    /// A memory with ARM opcodes from `address` on.
    pub fn with_arm(address: u32, opcodes: &[u32]) -> Self {
        let mut memory = Self::new();
        memory.put_words(address, opcodes);
        memory
    }

    /// A memory with Thumb opcodes from `address` on.
    pub fn with_thumb(address: u32, opcodes: &[u16]) -> Self {
        let mut memory = Self::new();
        let content = opcodes.iter().flat_map(|opcode| opcode.to_le_bytes());
        memory.put_bytes(address, content);
        memory
    }

    pub fn put_words(&mut self, address: u32, words: &[u32]) {
        self.put_bytes(address, words.iter().flat_map(|word| word.to_le_bytes()));
    }

    fn put_bytes(&mut self, address: u32, content: impl Iterator<Item = u8>) {
        for (place, byte) in self.bytes[address as usize..].iter_mut().zip(content) {
            *place = byte;
        }
    }

    pub fn word(&self, address: u32) -> u32 {
        self.load(address & !3).map_or(0, u32::from_le_bytes)
    }

    #[inline(always)]
    fn load<const N: usize>(&self, address: u32) -> Result<[u8; N], Abort> {
        let start = address as usize;
        let found = self.bytes.get(start..start + N).ok_or(Abort)?;
        found.first_chunk().copied().ok_or(Abort)
    }

    #[inline(always)]
    fn store<const N: usize>(&mut self, address: u32, content: [u8; N]) -> Result<(), Abort> {
        let start = address as usize;
        let found = self.bytes.get_mut(start..start + N).ok_or(Abort)?;
        found.copy_from_slice(&content);
        Ok(())
    }
}

impl Bus for Memory {
    #[inline(always)]
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        self.cycles += 1;
        Ok(u32::from_le_bytes(self.load(address & !3)?))
    }

    #[inline(always)]
    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        self.cycles += 1;
        Ok(u16::from_le_bytes(self.load(address & !1)?))
    }

    #[inline(always)]
    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        self.cycles += 1;
        Ok(match width {
            Width::Byte => u32::from(self.load::<1>(address)?[0]),
            Width::Halfword => u32::from(u16::from_le_bytes(self.load(address & !1)?)),
            Width::Word => u32::from_le_bytes(self.load(address & !3)?),
        })
    }

    #[inline(always)]
    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        self.cycles += 1;
        match width {
            Width::Byte => self.store(address, [value as u8]),
            Width::Halfword => self.store(address & !1, (value as u16).to_le_bytes()),
            Width::Word => self.store(address & !3, value.to_le_bytes()),
        }
    }

    #[inline(always)]
    fn internal(&mut self, count: u32) {
        self.cycles += u64::from(count);
    }

    #[inline(always)]
    fn irq(&self) -> bool {
        self.irq
    }

    #[inline(always)]
    fn fiq(&self) -> bool {
        self.fiq
    }
}
