// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM state: data processing, status registers, multiplications, branches.

use super::program::{Program, DATA, START};
use arm7tdmi::{psr, Mode};

const C: u32 = psr::C;
const N: u32 = psr::N;
const V: u32 = psr::V;
const Z: u32 = psr::Z;

/// r0 and the flags after one instruction on r1 and r2.
fn result(opcode: u32, flags: u32, r1: u32, r2: u32) -> (u32, u32) {
    let program = Program::arm(&[opcode]).with_flags(flags);
    let program = program.with(1, r1).with(2, r2).after(1);
    (program.register(0), program.flags())
}

#[test]
fn carry_takes_part_in_adc_sbc_and_rsc() {
    assert_eq!(result(0xE0A1_0002, C, 1, 2), (4, C)); // adc r0, r1, r2
    assert_eq!(result(0xE0A1_0002, 0, 1, 2), (3, 0));
    assert_eq!(result(0xE0D1_0002, C, 5, 5), (0, Z | C)); // sbcs r0, r1, r2
    assert_eq!(result(0xE0D1_0002, 0, 5, 5), (!0, N));
    assert_eq!(result(0xE0F1_0002, 0, 1, 5), (3, C)); // rscs r0, r1, r2
}

#[test]
fn subtraction_sets_carry_when_it_does_not_borrow() {
    assert_eq!(result(0xE271_0000, 0, 0, 0), (0, Z | C)); // rsbs r0, r1, #0
    assert_eq!(result(0xE271_0000, 0, 1, 0), (!0, N));
    assert_eq!(result(0xE271_0000, 0, 1 << 31, 0), (1 << 31, N | V));
}

#[test]
fn an_adder_without_s_keeps_the_flags_even_with_a_shift() {
    let adc_shifted = 0xE0A1_0102; // adc r0, r1, r2, lsl #2
    assert_eq!(result(adc_shifted, C, 1, 0x4000_0001), (6, C));
}

#[test]
fn logical_operations_take_the_carry_of_the_shifter_and_keep_overflow() {
    assert_eq!(result(0xE1F0_01A1, V, 0b100, 0), (!0, N | C | V)); // mvns r0, r1, lsr #3
    assert_eq!(result(0xE191_0062, C, 1, 2), (0x8000_0001, N)); // orrs r0, r1, r2, rrx
    assert_eq!(result(0xE311_020F, 0, N, 0), (0, N | C)); // tst r1, #0xF0000000
    assert_eq!(result(0xE311_0001, C, 0, 0), (0, Z | C)); // tst r1, #1: not rotated
}

#[test]
fn comparisons_write_flags_only() {
    assert_eq!(result(0xE131_0002, 0, 7, 7), (0, Z)); // teq r1, r2
    assert_eq!(result(0xE171_0002, 0, 1, !0), (0, Z | C)); // cmn r1, r2
    assert_eq!(result(0xE151_0002, 0, 1, 2), (0, N)); // cmp r1, r2
}

#[test]
fn every_condition_follows_the_flags() {
    let passes = |condition: u32, flags: u32| {
        let opcode = (condition << 28) | 0x03A0_0001; // mov r0, #1 under the condition
        result(opcode, flags, 0, 0).0 == 1
    };
    for (condition, holds, fails) in [
        (0x0, Z, 0),
        (0x2, C, 0),
        (0x4, N, 0),
        (0x6, V, 0),
        (0x8, C, C | Z),
        (0xA, N | V, N),
        (0xC, N | V, N | V | Z),
    ] {
        assert!(passes(condition, holds), "condition {condition:X}");
        assert!(!passes(condition, fails), "condition {condition:X}");
        assert!(
            !passes(condition + 1, holds),
            "condition {:X}",
            condition + 1
        );
        assert!(
            passes(condition + 1, fails),
            "condition {:X}",
            condition + 1
        );
    }
    assert!(passes(0xE, 0));
    assert!(!passes(0xF, N | Z | C | V));
}

#[test]
fn r15_reads_8_bytes_ahead_and_12_with_a_register_shift() {
    assert_eq!(Program::arm(&[0xE28F_0000]).after(1).register(0), START + 8); // add r0, pc, #0
    let shifted = Program::arm(&[0xE08F_0211]); // add r0, pc, r1, lsl r2
    assert_eq!(shifted.after(1).register(0), START + 12);
}

#[test]
fn branch_with_link_keeps_the_address_of_the_following_instruction() {
    let program = Program::arm(&[0xEB00_0002]).after(1);
    assert_eq!(program.register(15), START + 16);
    assert_eq!(program.register(14), START + 4);
}

#[test]
fn a_branch_reaches_backwards() {
    let program = Program::arm(&[0xE1A0_8008, 0xEAFF_FFFD]).after(2);
    assert_eq!(program.register(15), START);
}

#[test]
fn branch_and_exchange_takes_the_state_from_bit_0() {
    let program = Program::arm(&[0xE12F_FF14]).with(4, 0x301).after(1);
    assert!(program.cpu.thumb());
    assert_eq!(program.register(15), 0x300);
}

#[test]
fn a_move_to_r15_with_s_returns_to_the_saved_state() {
    let mut program = Program::arm(&[0xE1B0_F00E]).with(14, 0x300); // movs pc, lr
    program.cpu.set_spsr_of(Mode::Supervisor, psr::T | Z | 0x1F);
    let program = program.after(1);
    assert_eq!(program.cpu.cpsr(), psr::T | Z | 0x1F);
    assert_eq!(program.register(15), 0x300);
}

#[test]
fn status_registers_move_to_and_from_registers() {
    let program = Program::arm(&[0xE10F_0000]).with_flags(N | C).after(1); // mrs r0, cpsr
    assert_eq!(program.register(0), program.cpu.cpsr());
    let program = Program::arm(&[0xE169_F000, 0xE14F_1000]); // msr spsr_fc, r0; mrs r1, spsr
    let program = program.with(0, !0).after(2);
    assert_eq!(program.register(1), psr::IMPLEMENTED);
}

#[test]
fn msr_writes_only_the_selected_fields() {
    let program = Program::arm(&[0xE128_F000]).with(0, !0).after(1); // msr cpsr_f, r0
    assert_eq!(program.cpu.cpsr(), N | Z | C | V | psr::I | psr::F | 0x13);
    let program = Program::arm(&[0xE121_F000]).with(0, 0xF000_001F).after(1); // msr cpsr_c, r0
    assert_eq!(program.cpu.cpsr(), 0x1F);
}

#[test]
fn user_mode_changes_flags_only() {
    let program = Program::arm(&[0xE129_F000])
        .in_mode(Mode::User)
        .with(0, N | 0x13);
    let program = program.after(1);
    assert_eq!(program.cpu.mode(), Some(Mode::User));
    assert_eq!(program.flags(), N);
}

#[test]
fn long_multiplications_respect_the_sign_and_accumulate() {
    let run = |opcode, r1, r2| {
        let program = Program::arm(&[opcode]).with(1, r1).with(2, r2);
        let program = program.with(0, 1).with(3, 0).after(1);
        (u64::from(program.register(3)) << 32) | u64::from(program.register(0))
    };
    assert_eq!(run(0xE083_0291, !0, !0), 0xFFFF_FFFE_0000_0001); // umull
    assert_eq!(run(0xE0C3_0291, !0, !0), 1); // smull
    assert_eq!(run(0xE0A3_0291, !0, !0), 0xFFFF_FFFE_0000_0002); // umlal
    assert_eq!(run(0xE0E3_0291, !0, 2), !0); // smlal
}

#[test]
fn multiply_accumulate_sets_n_and_z_from_its_result() {
    let program = Program::arm(&[0xE030_3291]); // mlas r0, r1, r2, r3
    let program = program
        .with(1, 3)
        .with(2, 5)
        .with(3, 15u32.wrapping_neg())
        .after(1);
    assert_eq!(program.register(0), 0);
    assert_eq!(program.flags() & (N | Z), Z);
}

#[test]
fn the_data_register_keeps_its_start_value_when_a_condition_fails() {
    let program = Program::arm(&[0x0894_00FF]).with_flags(0).after(1); // ldmeqia r4
    assert_eq!(program.register(4), DATA);
    assert_eq!(program.register(15), START + 4);
}
