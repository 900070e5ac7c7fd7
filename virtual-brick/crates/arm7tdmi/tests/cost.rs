// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The statically stated cycles against those that the core makes.

#![allow(clippy::expect_used, clippy::panic)]

mod support;

use arm7tdmi::{psr, Abort, Bus, Cpu, Cycle, Instruction, Width};
use std::path::Path;
use support::{archive, counts::Counts, single_step::Class};

const ARCHIVE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../../verification/processor/arm7tdmi-single-step.tar.xz"
);
const ENCODINGS: u32 = 400_000;
const ORIGIN: u32 = 0x2000;

#[test]
fn all_vectors_have_the_stated_cycles() {
    let members = archive::read(Path::new(ARCHIVE)).expect("the archive is readable");
    let mut case_count = 0;
    for member in members {
        let class = Class::parse(&member.name, &member.content).expect("the class is readable");
        for record in &class.records {
            case_count += 1;
            record
                .check_cost(&class)
                .unwrap_or_else(|difference| panic!("{}: {difference}", class.name));
        }
    }
    assert_eq!(case_count, 37 * 400);
}

/// Counts cycles; any address answers, the data with a hash of the address.
struct CountingBus {
    opcode: u32,
    fills_left: u32,
    counts: Counts,
    next_random: u32,
}

fn hash(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x7FEB_352D);
    let x = (x ^ x >> 15).wrapping_mul(0x846C_A68B);
    x ^ x >> 16
}

impl CountingBus {
    fn new(opcode: u32) -> Self {
        Self {
            opcode,
            fills_left: 2,
            counts: Counts::default(),
            next_random: opcode,
        }
    }

    fn fetch(&mut self, cycle: Cycle) -> u32 {
        if self.fills_left > 0 {
            self.fills_left -= 1;
        } else {
            self.counts.count_code(cycle);
        }
        self.opcode
    }
}

impl Bus for CountingBus {
    fn fetch_word(&mut self, _address: u32, cycle: Cycle) -> Result<u32, Abort> {
        Ok(self.fetch(cycle))
    }

    fn fetch_halfword(&mut self, _address: u32, cycle: Cycle) -> Result<u16, Abort> {
        Ok(self.fetch(cycle) as u16)
    }

    fn read(&mut self, address: u32, _width: Width, cycle: Cycle) -> Result<u32, Abort> {
        self.counts.count_data(cycle);
        self.next_random = hash(self.next_random ^ address);
        Ok(self.next_random)
    }

    fn write(&mut self, _: u32, _: Width, _: u32, cycle: Cycle) -> Result<(), Abort> {
        self.counts.count_data(cycle);
        Ok(())
    }

    fn internal(&mut self, count: u32) {
        self.counts.internal += count;
    }

    fn irq(&self) -> bool {
        false
    }

    fn fiq(&self) -> bool {
        false
    }
}

/// Registers get random values of random magnitude, so that multiplications end at each stage.
fn random_cpu(seed: u32, thumb: bool) -> Cpu {
    let mut cpu = Cpu::new();
    let state = if thumb { psr::T } else { 0 };
    cpu.set_cpsr((hash(seed) & 0xF000_0000) | state | 0xD3);
    for number in 0..15 {
        let bits = hash(seed.wrapping_add(number + 1));
        let value = bits as i32 >> (hash(bits) & 31);
        cpu.set_register(number, value as u32);
    }
    cpu.set_pc(ORIGIN);
    cpu
}

fn check(opcode: u32, seed: u32, thumb: bool) {
    let instruction = if thumb {
        Instruction::thumb(opcode as u16)
    } else {
        Instruction::arm(opcode)
    };
    let mut cpu = random_cpu(seed, thumb);
    let stated = Counts::stated(&instruction, &cpu);
    let mut bus = CountingBus::new(opcode);
    let _ = cpu.step(&mut bus);
    assert_eq!(bus.counts, stated, "{opcode:#010X} {instruction:X?}");
}

#[test]
fn random_arm_encodings_cost_what_is_stated() {
    for index in 0..ENCODINGS {
        check(hash(index), index, false);
        check(hash(index) | 0xE000_0000, index, false);
    }
}

#[test]
fn every_thumb_encoding_costs_what_is_stated() {
    for opcode in 0..0x1_0000 {
        for round in 0..4 {
            check(opcode, hash(opcode) ^ round, true);
        }
    }
}
