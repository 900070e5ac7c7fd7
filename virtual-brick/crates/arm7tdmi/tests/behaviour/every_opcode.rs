// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Every encoding, with or without meaning, from unfriendly register values.

use super::program::Program;
use arm7tdmi::Mode;

/// The highest and lowest cycle counts any instruction can take: a skipped one, and a load of
/// sixteen registers that is aborted.
const CYCLES: std::ops::RangeInclusive<u64> = 1..=21;

const MODES: [Mode; 4] = [Mode::User, Mode::Fiq, Mode::Supervisor, Mode::System];

/// Registers at the edges of memory and of the number range.
fn unfriendly(program: Program, mode: Mode) -> Program {
    (0..15).fold(program.in_mode(mode), |program, number| {
        let value = [0, 0xFFFD, 0xFFFF_FFFF, 0x8000_0001, 0x21][number as usize % 5];
        program.with(number, value)
    })
}

fn assert_steps_consistently(program: Program, opcode: u32) {
    let mut program = program;
    let _ = program.step();
    let cycles = program.memory.cycles;
    assert!(CYCLES.contains(&cycles), "{opcode:#X}: {cycles} cycles");
    let alignment = if program.cpu.thumb() { 2 } else { 4 };
    assert_eq!(program.register(15) % alignment, 0, "{opcode:#X}");
}

#[test]
fn every_thumb_opcode_leaves_a_consistent_state() {
    for opcode in 0..=0xFFFF {
        let mode = MODES[opcode as usize % MODES.len()];
        let program = unfriendly(Program::thumb(&[opcode]), mode);
        assert_steps_consistently(program, u32::from(opcode));
    }
}

#[test]
fn every_arm_opcode_pattern_leaves_a_consistent_state() {
    for pattern in 0..4096u32 {
        let decoded = ((pattern & 0xFF0) << 16) | ((pattern & 0xF) << 4);
        for others in [
            0x0000_0000,
            0x000F_FF0F,
            0x0001_2304,
            0x000F_8001,
            0x0001_F10E,
        ] {
            let opcode = 0xE000_0000 | decoded | others;
            let mode = MODES[pattern as usize % MODES.len()];
            assert_steps_consistently(unfriendly(Program::arm(&[opcode]), mode), opcode);
        }
    }
}
