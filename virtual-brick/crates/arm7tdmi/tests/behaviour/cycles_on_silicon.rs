// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycle counts that were measured on an ARM7TDMI with a 32-bit memory without wait states: the
//! internal RAM columns of the published timing results of the mGBA test suite.

use super::program::Program;

const LDR: u32 = 0xE594_0000; // ldr r0, [r4]
const LDRH: u32 = 0xE1D4_00B0; // ldrh r0, [r4]
const STR: u32 = 0xE584_0000; // str r0, [r4]
const STRH: u32 = 0xE1C4_00B0; // strh r0, [r4]
const NOP: u32 = 0xE1A0_8008; // mov r8, r8
const LDM_1: u32 = 0xE894_0001; // ldmia r4, {r0}
const LDM_2: u32 = 0xE894_0003; // ldmia r4, {r0, r1}
const LDM_6: u32 = 0xE894_006F; // ldmia r4, {r0-r3, r5, r6}
const STM_1: u32 = 0xE884_0001; // stmia r4, {r0}
const STM_2: u32 = 0xE884_0003; // stmia r4, {r0, r1}
const STM_6: u32 = 0xE884_006F; // stmia r4, {r0-r3, r5, r6}

fn arm(opcodes: &[u32]) -> u64 {
    Program::arm(opcodes).cycles(opcodes.len())
}

fn thumb(opcodes: &[u16]) -> u64 {
    Program::thumb(opcodes).cycles(opcodes.len())
}

#[test]
fn single_instructions_take_the_measured_cycles_in_arm_state() {
    for (opcode, cycles) in [
        (NOP, 1),
        (LDR, 3),
        (LDRH, 3),
        (STR, 2),
        (STRH, 2),
        (LDM_1, 3),
        (LDM_2, 4),
        (LDM_6, 8),
        (STM_1, 2),
        (STM_2, 3),
        (STM_6, 7),
    ] {
        assert_eq!(arm(&[opcode]), cycles, "{opcode:#010X}");
    }
}

#[test]
fn single_instructions_take_the_measured_cycles_in_thumb_state() {
    for (opcode, cycles) in [
        (0x46C0, 1), // mov r8, r8
        (0x6820, 3), // ldr r0, [r4]
        (0x8820, 3), // ldrh r0, [r4]
        (0x6020, 2), // str r0, [r4]
        (0x8020, 2), // strh r0, [r4]
        (0xCC01, 3), // ldmia r4!, {r0}
        (0xCC03, 4), // ldmia r4!, {r0, r1}
        (0xCC6F, 8), // ldmia r4!, {r0-r3, r5, r6}
        (0xC401, 2), // stmia r4!, {r0}
        (0xC403, 3), // stmia r4!, {r0, r1}
        (0xC46F, 7), // stmia r4!, {r0-r3, r5, r6}
    ] {
        assert_eq!(thumb(&[opcode]), cycles, "{opcode:#06X}");
    }
}

#[test]
fn pairs_take_the_measured_cycles() {
    for (pair, cycles) in [
        ([LDR, NOP], 4),
        ([LDR, LDR], 6),
        ([LDR, STR], 5),
        ([STR, STR], 4),
        ([LDM_1, LDM_1], 6),
        ([LDM_2, LDM_2], 8),
        ([LDM_6, LDM_6], 16),
    ] {
        assert_eq!(arm(&pair), cycles, "{pair:X?}");
    }
    assert_eq!(thumb(&[0x6820, 0x46C0]), 4);
    assert_eq!(thumb(&[0x6020, 0x6020]), 4);
}

#[test]
fn a_branch_over_one_instruction_and_the_next_one_take_4_cycles() {
    let branch = 0xEA00_0000; // b .+8
    assert_eq!(Program::arm(&[branch, NOP, NOP]).cycles(2), 4);
    assert_eq!(Program::thumb(&[0xE000, 0x46C0, 0x46C0]).cycles(2), 4);
}

#[test]
fn a_loop_of_16_rounds_takes_80_cycles() {
    let arm_loop = [
        0xE3A0_0010, // mov r0, #16
        0xE3A0_1000, // mov r1, #0
        0xE281_1001, // add r1, r1, #1
        0xE151_0000, // cmp r1, r0
        0x1AFF_FFFC, // bne back to add
    ];
    let thumb_loop = [
        0x2010, // movs r0, #16
        0x2100, // movs r1, #0
        0x3101, // adds r1, #1
        0x4281, // cmp r1, r0
        0xD1FC, // bne back to adds
    ];
    assert_eq!(Program::arm(&arm_loop).cycles(2 + 16 * 3), 80);
    assert_eq!(Program::thumb(&thumb_loop).cycles(2 + 16 * 3), 80);
}

fn multiplication(opcode: u32, multiplier: u32) -> u64 {
    Program::arm(&[opcode])
        .with(1, 3)
        .with(2, multiplier)
        .cycles(1)
}

const ENDS_EARLY_WHEN_SIGNED: [(u32, u64); 8] = [
    (0, 1),
    (0x78, 1),
    (0xFFFF_FF00, 1),
    (0xFFFF_FFFF, 1),
    (0x5678, 2),
    (0xFFFF_0000, 2),
    (0x0034_5678, 3),
    (0x1234_5678, 4),
];

#[test]
fn signed_multiplications_end_early_on_zeros_and_on_ones() {
    for (multiplier, m) in ENDS_EARLY_WHEN_SIGNED.into_iter().chain([(0xFF00_0000, 3)]) {
        // mul and mla r0, r1, r2; smull and smlal r0, r3, r1, r2
        assert_eq!(
            multiplication(0xE000_0291, multiplier),
            m + 1,
            "mul {multiplier:#X}"
        );
        assert_eq!(
            multiplication(0xE020_3291, multiplier),
            m + 2,
            "mla {multiplier:#X}"
        );
        assert_eq!(
            multiplication(0xE0C3_0291, multiplier),
            m + 2,
            "smull {multiplier:#X}"
        );
        assert_eq!(
            multiplication(0xE0E3_0291, multiplier),
            m + 3,
            "smlal {multiplier:#X}"
        );
    }
}

#[test]
fn unsigned_multiplications_end_early_on_zeros_only() {
    for (multiplier, cycles) in [
        (0, 3),
        (0x78, 3),
        (0x5678, 4),
        (0x0034_5678, 5),
        (0x1234_5678, 6),
        (0xFF00_0000, 6),
        (0xFFFF_0000, 6),
        (0xFFFF_FF00, 6),
        (0xFFFF_FFFF, 6),
    ] {
        // umull and umlal r0, r3, r1, r2
        assert_eq!(
            multiplication(0xE083_0291, multiplier),
            cycles,
            "umull {multiplier:#X}"
        );
        assert_eq!(
            multiplication(0xE0A3_0291, multiplier),
            cycles + 1,
            "umlal {multiplier:#X}"
        );
    }
}

#[test]
fn thumb_multiplication_takes_its_multiplier_from_the_old_destination() {
    for (multiplier, m) in ENDS_EARLY_WHEN_SIGNED {
        let program = Program::thumb(&[0x4348]); // muls r0, r1
        assert_eq!(program.with(0, multiplier).with(1, !0).cycles(1), m + 1);
    }
}
