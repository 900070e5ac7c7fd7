// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random loops of ARM and Thumb instructions: blocks end in the state of single steps.

use super::machine::{branch, program, run_until, Machine, START};
use crate::blocks::Blocks;
use crate::instruction::ALWAYS;
use crate::{psr, Cpu};

/// Where loads and stores go: their base register is never a destination.
const DATA: u32 = 0x800;
const CYCLES: u64 = 3_000;

/// Xorshift (Marsaglia 2003).
struct Random(u32);

impl Random {
    fn below(&mut self, limit: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 3) % limit
    }

    fn bits(&mut self, count: u32) -> u32 {
        self.below(1 << count)
    }

    /// Small, large and negative numbers.
    fn value(&mut self) -> u32 {
        let word = self.bits(16) << 16 | self.bits(16);
        match self.below(4) {
            0 => word & 0x3F,
            1 => !(word & 0x3F),
            2 => 1 << (word & 31),
            _ => word,
        }
    }
}

/// A data operation with any of the three forms of its second operand.
fn data(random: &mut Random, first: u32, destination: u32) -> u32 {
    let operation = random.bits(4);
    let compares = operation >> 2 == 2;
    let flags = u32::from(compares) | random.bits(1);
    let operand = match random.below(3) {
        0 => 1 << 25 | random.bits(12),
        1 => random.bits(7) << 5 | random.below(11),
        _ => random.below(10) << 8 | random.bits(2) << 5 | 1 << 4 | random.below(11),
    };
    operation << 21 | flags << 20 | first | destination | operand
}

/// MUL, MLA or a long multiplication; destination and first factor differ (ARM DDI 0029G, 4.7.1).
fn product(random: &mut Random) -> u32 {
    let factors = random.below(11) << 8 | 0x90;
    if random.below(2) == 0 {
        let (destination, added) = (5 + random.below(5), random.below(10));
        destination << 16 | random.bits(2) << 20 | added << 12 | factors | random.below(5)
    } else {
        1 << 23 | random.bits(2) << 21 | random.bits(1) << 20 | 1 << 16 | 2 << 12 | factors | 3
    }
}

/// A load or a store with r10 as the base, without write-back.
fn transfer(random: &mut Random, destination: u32) -> u32 {
    let loads = random.bits(1) << 20;
    match random.below(3) {
        0 => {
            let offset = [random.bits(8), random.bits(6) << 2][random.below(2) as usize];
            0x0580_0000 | random.bits(1) << 22 | loads | 10 << 16 | destination | offset
        }
        1 => {
            let (loads, kind) = [(0, 1), (1, 1), (1, 2), (1, 3)][random.below(4) as usize];
            let offset = random.bits(4) << 8 | random.bits(3) << 1;
            0x01C0_0090 | loads << 20 | kind << 5 | 10 << 16 | destination | offset
        }
        _ => 0x0880_0000 | random.bits(1) << 24 | loads | 10 << 16 | (1 + random.below(0x3FF)),
    }
}

/// An ARM instruction without a branch; r10 is the base, r0 to r9 are destinations.
fn arm(random: &mut Random) -> u32 {
    let always = random.below(3) != 0;
    let condition = if always { ALWAYS } else { random.below(15) };
    let (first, destination) = (random.below(11) << 16, random.below(10) << 12);
    let opcode = match random.below(10) {
        0..=3 => data(random, first, destination),
        4 | 5 => product(random),
        6..=8 => transfer(random, destination),
        _ => [0x010F_0000 | destination, 0x0128_F000 | random.below(10)][random.below(2) as usize],
    };
    condition << 28 | opcode
}

/// A Thumb instruction without a branch; r7 and r13 are bases, r0 to r6 are destinations.
fn thumb(random: &mut Random) -> u32 {
    let (destination, source) = (random.below(7), random.bits(3) << 3);
    match random.below(9) {
        0 => random.below(3) << 11 | random.bits(5) << 6 | source | destination,
        1 => 0x1800 | random.bits(5) << 6 | source | destination,
        2 => 0x2000 | random.bits(2) << 11 | destination << 8 | random.bits(8),
        3 | 4 => 0x4000 | random.bits(4) << 6 | source | destination,
        5 => 0x4400 | random.below(3) << 8 | random.bits(3) << 3 | destination,
        6 => 0x6000 | random.bits(2) << 11 | random.bits(5) << 6 | 7 << 3 | destination,
        7 => [
            0x8000 | random.bits(1) << 11 | random.bits(5) << 6 | 7 << 3 | destination,
            0x9000 | random.bits(1) << 11 | destination << 8 | random.bits(6),
        ][random.below(2) as usize],
        _ => [
            0xA000 | random.bits(1) << 11 | destination << 8 | random.bits(8),
            0x5000 | random.bits(3) << 9 | 6 << 6 | 7 << 3 | random.below(6),
        ][random.below(2) as usize],
    }
}

/// The same registers and data for both engines.
fn start(opcodes: &[u32], seed: u32) -> (Cpu, Machine) {
    let (mut cpu, mut machine) = program(opcodes);
    let mut random = Random(seed | 1);
    for number in 0..13 {
        cpu.set_register(number, random.value());
    }
    for number in [7, 10, 13] {
        cpu.set_register(number, DATA);
    }
    for word in &mut machine.words[DATA as usize / 4..] {
        *word = random.value();
    }
    (cpu, machine)
}

fn assert_equal_on_both(opcodes: &[u32], seed: u32) {
    let (mut cpu, mut machine) = start(opcodes, seed);
    run_until(&mut cpu, &mut machine, &mut Blocks::default(), CYCLES);
    let (mut reference, mut bus) = start(opcodes, seed);
    while bus.now < machine.now {
        reference.step(&mut bus);
    }
    assert_eq!(bus.now, machine.now, "seed {seed}: {opcodes:#010X?}");
    assert_eq!(bus.words, machine.words, "seed {seed}: {opcodes:#010X?}");
    assert_eq!(reference, cpu, "seed {seed}: {opcodes:#010X?}");
}

#[test]
fn random_arm_instructions_in_blocks_do_as_in_single_steps() {
    for seed in 1..400_u32 {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9));
        let mut opcodes: Vec<u32> = (0..20).map(|_| arm(&mut random)).collect();
        opcodes.push(branch(ALWAYS, START + 80, START));
        assert_equal_on_both(&opcodes, seed);
    }
}

#[test]
fn random_thumb_instructions_in_blocks_do_as_in_single_steps() {
    for seed in 1..400_u32 {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9));
        let mut halfwords: Vec<u32> = (0..39).map(|_| thumb(&mut random)).collect();
        halfwords.push(0xE000 | (0x7FF & 0u32.wrapping_sub(39 + 2)));
        let mut opcodes = vec![0xE28F_C001, 0xE12F_FF1C]; // add r12, pc, #1; bx r12
        opcodes.extend(halfwords.chunks(2).map(|pair| pair[1] << 16 | pair[0]));
        assert_equal_on_both(&opcodes, seed);
        let (mut cpu, mut machine) = start(&opcodes, seed);
        run_until(&mut cpu, &mut machine, &mut Blocks::default(), CYCLES);
        assert_ne!(cpu.cpsr() & psr::T, 0, "the loop stays in Thumb state");
    }
}
