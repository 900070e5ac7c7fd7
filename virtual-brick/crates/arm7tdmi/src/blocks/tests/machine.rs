// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A machine with RAM at address 0 and a device behind it; every access takes one cycle.

use std::cell::Cell;

use crate::blocks::{BlockBus, Blocks, BusAccess, CodePlace, PlainRead, PlainWords, RamView};
use crate::{Abort, Bus, Cpu, Cycle, Width};

const WORDS: usize = 0x400;
/// Reads give the time of the access; writes set the next event.
pub const DEVICE: u32 = 0x1000;
/// Reads give the time, or a constant, and change nothing.
pub const CLOCK: u32 = 0x2000;
pub const CONSTANT: u32 = 0x3000;
/// Writes do nothing but to be kept.
pub const LATCH: u32 = 0x4000;
/// Address of a program's first instruction; the pipeline has been filled when it runs.
pub const START: u32 = 4;
pub const NOP: u32 = 0xE1A0_8008;

#[derive(Clone)]
pub struct Machine {
    pub words: Vec<u32>,
    pub marks: Vec<u8>,
    changes: Vec<u32>,
    pub now: u64,
    pub event: u64,
    pub epoch: u32,
    /// Reads of registers.
    pub polls: Cell<u32>,
    /// What the latch got last, and when.
    pub latched: (u32, u64),
}

/// B from one address to another, under a condition.
pub fn branch(condition: u32, from: u32, to: u32) -> u32 {
    let offset = to.wrapping_sub(from + 8) >> 2 & 0xFF_FFFF;
    condition << 28 | 0x0A00_0000 | offset
}

/// A core in front of the program's first instruction, and its machine.
pub fn program(opcodes: &[u32]) -> (Cpu, Machine) {
    let mut words = vec![NOP; WORDS];
    words[1..=opcodes.len()].copy_from_slice(opcodes);
    let mut machine = Machine {
        words,
        marks: vec![0; WORDS],
        changes: Vec::new(),
        now: 0,
        event: u64::MAX,
        epoch: 0,
        polls: Cell::new(0),
        latched: (0, 0),
    };
    let mut cpu = Cpu::new();
    cpu.set_pc(0);
    cpu.step(&mut machine);
    (cpu, machine)
}

/// A store through the bus.
pub fn store(machine: &mut Machine, address: u32, value: u32) {
    let stored = machine.write(address, Width::Word, value, Cycle::Nonsequential);
    assert_eq!(stored, Ok(()));
}

/// Runs blocks, and single steps between them, up to an instant.
pub fn run_until(cpu: &mut Cpu, machine: &mut Machine, blocks: &mut Blocks<Machine>, end: u64) {
    while machine.now < end {
        if !cpu.run_blocks(machine, blocks, end, 1).ran {
            cpu.step(machine);
        }
        for _ in 0..blocks.steps_of_reference() {
            if machine.now < end {
                cpu.step(machine);
            }
        }
    }
}

/// The reference engine reaches the same state of core and memory at the same instant.
pub fn assert_as_reference(opcodes: &[u32], cpu: &Cpu, machine: &Machine) {
    let (mut reference, mut bus) = program(opcodes);
    while bus.now < machine.now {
        reference.step(&mut bus);
    }
    assert_eq!((bus.now, &bus.words), (machine.now, &machine.words));
    assert_eq!(&reference, cpu);
}

impl Machine {
    fn aligned(address: u32, width: Width) -> bool {
        match width {
            Width::Byte => true,
            Width::Halfword => address & 1 == 0,
            Width::Word => address & 3 == 0,
        }
    }

    fn index(&self, address: u32, width: Width) -> Option<usize> {
        let index = address as usize / 4;
        (Self::aligned(address, width) && index < WORDS).then_some(index)
    }

    /// The bytes of an access within their word, as a shift and a mask.
    fn lane(address: u32, width: Width) -> (u32, u32) {
        match width {
            Width::Byte => (8 * (address & 3), 0xFF),
            Width::Halfword => (8 * (address & 2), 0xFFFF),
            Width::Word => (0, u32::MAX),
        }
    }

    fn value(&self, index: usize, address: u32, width: Width) -> u32 {
        let (shift, mask) = Self::lane(address, width);
        self.words[index] >> shift & mask
    }

    fn set_value(&mut self, index: usize, address: u32, width: Width, value: u32) {
        let (shift, mask) = Self::lane(address, width);
        let word = &mut self.words[index];
        *word = *word & !(mask << shift) | (value & mask) << shift;
    }

    fn words_at(&self, address: u32, count: u32) -> Option<std::ops::Range<usize>> {
        let start = self.index(address, Width::Word)?;
        let end = start + count as usize;
        (end <= WORDS).then_some(start..end)
    }
}

impl Bus for Machine {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        self.now += 1;
        self.words.get(address as usize / 4).copied().ok_or(Abort)
    }

    fn fetch_halfword(&mut self, address: u32, cycle: Cycle) -> Result<u16, Abort> {
        let word = self.fetch_word(address, cycle)?;
        Ok((word >> (8 * (address & 2))) as u16)
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        self.now += 1;
        let index = address as usize / 4;
        Ok(if index < WORDS {
            self.value(index, address, width)
        } else if address == CONSTANT {
            0
        } else {
            self.now as u32
        })
    }

    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        self.now += 1;
        let index = address as usize / 4;
        if address == LATCH {
            self.latched = (value, self.now);
            return Ok(());
        }
        if index >= WORDS {
            self.event = u64::from(value);
            return Ok(());
        }
        self.set_value(index, address, width, value);
        if std::mem::take(&mut self.marks[index]) != 0 {
            self.changes.push(2 * index as u32);
        }
        Ok(())
    }

    fn internal(&mut self, count: u32) {
        self.now += u64::from(count);
    }
}

impl BlockBus for Machine {
    const CODE_HALFWORDS: u32 = 2 * WORDS as u32;

    fn code_place(&self, address: u32) -> Option<CodePlace> {
        let halfword = address / 2;
        let place = CodePlace {
            halfword,
            memory: 0,
        };
        (halfword < Self::CODE_HALFWORDS).then_some(place)
    }

    fn target_place(&self, address: u32) -> Option<CodePlace> {
        self.code_place(address)
    }

    fn can_enter(&self, _address: u32) -> bool {
        true
    }

    fn code_word(&self, address: u32) -> u32 {
        self.words[address as usize / 4]
    }

    fn code_epoch(&self) -> u32 {
        self.epoch
    }

    fn mark_code(&mut self, address: u32) {
        self.marks[address as usize / 4] = 1;
    }

    fn next_code_change(&mut self) -> Option<u32> {
        self.changes.pop()
    }

    fn sequential_fetch_cycles(&self, _address: u32, _width: Width) -> u32 {
        1
    }

    fn refill_cycles(&self, _sequence: u32, _target: u32, _width: Width) -> u32 {
        2
    }

    fn in_sequence(&self, _address: u32) -> bool {
        true
    }

    fn continue_at(&mut self, _address: u32) {}

    fn access_cycles_max(&self) -> u32 {
        1
    }

    fn ram_cycles(&self) -> u32 {
        1
    }

    fn ram_read(&self, address: u32, width: Width) -> Option<u32> {
        let index = self.index(address, width)?;
        Some(self.value(index, address, width))
    }

    fn ram_write(&mut self, address: u32, width: Width, value: u32) -> bool {
        let index = self.index(address, width);
        let plain = index.filter(|&index| self.marks[index] == 0);
        plain
            .map(|index| self.set_value(index, address, width, value))
            .is_some()
    }

    fn plain_read(&self, address: u32, width: Width) -> Option<PlainRead> {
        let value = self.ram_read(address, width)?;
        Some(PlainRead { value, cycles: 1 })
    }

    fn register_cycles(&self) -> u32 {
        1
    }

    fn register_read(&self, address: u32, after_cycles: u32) -> Option<(u32, bool)> {
        let value = match address {
            CLOCK => self.now as u32 + after_cycles + 1,
            CONSTANT => 0,
            _ => return None,
        };
        self.polls.set(self.polls.get() + 1);
        Some((value, address == CONSTANT))
    }

    fn register_write(&mut self, address: u32, value: u32, after_cycles: u32) -> bool {
        if address == LATCH {
            self.latched = (value, self.now + u64::from(after_cycles) + 1);
        }
        address == LATCH
    }

    fn plain_words(&self, address: u32, count: u32) -> Option<PlainWords<&[u32]>> {
        let words = &self.words[self.words_at(address, count)?];
        Some(PlainWords { words, cycles: 1 })
    }

    fn plain_words_mut(&mut self, address: u32, count: u32) -> Option<PlainWords<&mut [u32]>> {
        let range = self.words_at(address, count)?;
        let marked = self.marks[range.clone()].iter().any(|&mark| mark != 0);
        let words = &mut self.words[range];
        (!marked).then_some(PlainWords { words, cycles: 1 })
    }

    fn access_between(&self, address: u32, width: Width, _: bool, _: u32) -> BusAccess {
        if address >= DEVICE && Self::aligned(address, width) {
            BusAccess::KeepsMemory
        } else {
            BusAccess::Refused
        }
    }

    fn code_window(&self, _memory: u8) -> (u32, u32) {
        (0, Self::CODE_HALFWORDS - 1)
    }

    fn ram_view(&mut self) -> Option<RamView<'_>> {
        Some(RamView {
            address: 0,
            words: &mut self.words,
            marks: &self.marks,
        })
    }

    fn needs_attention(&self) -> bool {
        false
    }

    fn cycles_until_event(&self, limit: u64, _irq: bool, _fiq: bool) -> u32 {
        limit.min(self.event).saturating_sub(self.now) as u32
    }

    fn pass(&mut self, cycles: u32) {
        self.now += u64::from(cycles);
    }
}
