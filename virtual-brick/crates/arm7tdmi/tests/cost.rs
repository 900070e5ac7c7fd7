// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The statically stated cycles against those that the core makes.

use crate::support::counts::Counts;
use crate::support::{archive, single_step::Class, single_step::VectorBus};
use arm7tdmi::{psr, Cpu, Instruction};
use std::path::Path;

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

fn hash(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x7FEB_352D);
    let x = (x ^ x >> 15).wrapping_mul(0x846C_A68B);
    x ^ x >> 16
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
    let mut bus = VectorBus::new(opcode, ORIGIN);
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
