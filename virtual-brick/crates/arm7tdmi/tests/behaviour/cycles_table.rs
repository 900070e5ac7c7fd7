// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycle totals of the instruction classes (ARM DDI 0029E, chapter 10) without wait states.

use crate::program::{Program, DATA};
use arm7tdmi::psr;

/// Runs one instruction with r4 = `DATA`, where a code address is stored.
fn arm(opcode: u32) -> u64 {
    let program = Program::arm(&[opcode]).with_words(DATA, &[0x200, 0x200]);
    program.cycles(1)
}

fn thumb(opcode: u16) -> u64 {
    Program::thumb(&[opcode]).with(13, DATA).cycles(1)
}

#[test]
fn data_processing_takes_one_cycle_more_for_a_register_shift_and_two_more_to_write_r15() {
    assert_eq!(arm(0xE0A1_0002), 1); // adc r0, r1, r2
    assert_eq!(arm(0xE1A0_0211), 2); // mov r0, r1, lsl r2
    assert_eq!(arm(0xE1A0_F004), 3); // mov pc, r4
    assert_eq!(arm(0xE1A0_F214), 4); // mov pc, r4, lsl r2
    assert_eq!(arm(0xE351_F000), 1); // cmp r1, #0 with the r15 field of the P variant
}

#[test]
fn status_register_transfers_take_one_cycle() {
    assert_eq!(arm(0xE10F_0000), 1); // mrs r0, cpsr
    assert_eq!(arm(0xE128_F000), 1); // msr cpsr_f, r0
}

#[test]
fn loads_to_r15_take_two_cycles_more() {
    assert_eq!(arm(0xE594_F000), 5); // ldr pc, [r4]
    assert_eq!(arm(0xE894_8001), 6); // ldmia r4, {r0, pc}
    assert_eq!(Program::thumb(&[0xBD01]).with(13, DATA).cycles(1), 6); // pop {r0, pc}
}

#[test]
fn swaps_take_four_cycles() {
    assert_eq!(arm(0xE104_0091), 4); // swp r0, r1, [r4]
    assert_eq!(arm(0xE144_0091), 4); // swpb r0, r1, [r4]
}

#[test]
fn branches_and_software_interrupts_take_three_cycles() {
    for opcode in [0xEA00_0000, 0xEB00_0002, 0xE12F_FF14, 0xEF00_0005] {
        assert_eq!(arm(opcode), 3, "{opcode:#010X}");
    }
    for opcode in [0xE000, 0x4720, 0xDF05, 0x44A7, 0x46A7] {
        assert_eq!(thumb(opcode), 3, "{opcode:#06X}");
    }
}

#[test]
fn a_failed_condition_takes_one_cycle_whatever_the_instruction() {
    for opcode in [
        0x01A0_0001,
        0x0894_00FF,
        0x0A00_0000,
        0x0F00_0000,
        0x0E00_0F10,
    ] {
        assert_eq!(arm(opcode), 1, "{opcode:#010X}");
    }
}

#[test]
fn conditional_thumb_branches_take_three_cycles_taken_and_one_not_taken() {
    let equal = || Program::thumb(&[0xD002]); // beq
    assert_eq!(equal().with_flags(psr::Z).cycles(1), 3);
    assert_eq!(equal().with_flags(0).cycles(1), 1);
}

#[test]
fn the_two_halves_of_a_thumb_call_take_one_and_three_cycles() {
    assert_eq!(thumb(0xF000), 1);
    assert_eq!(Program::thumb(&[0xF000, 0xF806]).cycles(2), 4);
}

#[test]
fn thumb_register_shifts_take_two_cycles_and_constant_shifts_one() {
    assert_eq!(thumb(0x4088), 2); // lsls r0, r1
    assert_eq!(thumb(0x0808), 1); // lsrs r0, r1, #32
}

#[test]
fn thumb_stack_transfers_cost_what_their_arm_equivalents_cost() {
    assert_eq!(thumb(0xB501), 3); // push {r0, lr}
    assert_eq!(thumb(0xBC03), 4); // pop {r0, r1}
    assert_eq!(thumb(0x9802), 3); // ldr r0, [sp, #8]
    assert_eq!(thumb(0x9002), 2); // str r0, [sp, #8]
    assert_eq!(thumb(0x4802), 3); // ldr r0, [pc, #8]
    assert_eq!(thumb(0xA002), 1); // add r0, pc, #8
    assert_eq!(thumb(0xB084), 1); // sub sp, #16
}

#[test]
fn undefined_and_coprocessor_instructions_take_four_cycles() {
    assert_eq!(arm(0xE600_0010), 4);
    assert_eq!(arm(0xEE00_0F10), 4); // mcr p15
    assert_eq!(thumb(0xDE00), 4);
}
