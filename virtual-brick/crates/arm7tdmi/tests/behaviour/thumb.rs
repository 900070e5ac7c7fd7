// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Thumb state.

use super::program::{Program, DATA, START};
use arm7tdmi::psr;

const C: u32 = psr::C;
const N: u32 = psr::N;
const Z: u32 = psr::Z;

/// r0 and the flags after one instruction on r0 and r1.
fn result(opcode: u16, flags: u32, r0: u32, r1: u32) -> (u32, u32) {
    let program = Program::thumb(&[opcode]).with_flags(flags);
    let program = program.with(0, r0).with(1, r1).after(1);
    (program.register(0), program.flags())
}

#[test]
fn shifts_by_constant_32_are_encoded_as_zero() {
    assert_eq!(result(0x0808, 0, 5, 1 << 31), (0, Z | C)); // lsrs r0, r1, #32
    assert_eq!(result(0x1008, 0, 5, 1 << 31), (!0, N | C)); // asrs r0, r1, #32
    assert_eq!(result(0x0008, C, 5, 1), (1, C)); // lsls r0, r1, #0
}

#[test]
fn arithmetic_sets_all_flags() {
    assert_eq!(result(0x4248, 0, 0, 1), (!0, N)); // negs r0, r1
    assert_eq!(result(0x4148, C, !0, 0), (0, Z | C)); // adcs r0, r1
    assert_eq!(result(0x4288, 0, 3, 3), (3, Z | C)); // cmp r0, r1
    assert_eq!(result(0x42C8, 0, 1, !0), (1, Z | C)); // cmn r0, r1
    assert_eq!(result(0x4188, 0, 5, 4), (0, Z | C)); // sbcs r0, r1
}

#[test]
fn eight_bit_constants_are_unsigned() {
    assert_eq!(result(0x20FF, C, 0, 0), (0xFF, C)); // movs r0, #255
    assert_eq!(result(0x38FF, 0, 0xFF, 0), (0, Z | C)); // subs r0, #255
    assert_eq!(result(0x28FF, 0, 0, 0), (0, N)); // cmp r0, #255
}

#[test]
fn logical_operations_keep_carry() {
    assert_eq!(result(0x43C8, C, 0, !0), (0, Z | C)); // mvns r0, r1
    assert_eq!(result(0x4208, C, 1, 2), (1, Z | C)); // tst r0, r1
    assert_eq!(result(0x4388, 0, 7, 5), (2, 0)); // bics r0, r1
}

#[test]
fn high_register_operations_leave_flags_alone_and_branch_through_r15() {
    let program = Program::thumb(&[0x44A7])
        .with(4, 0x11)
        .with_flags(C)
        .after(1); // add pc, r4
    assert_eq!(program.register(15), START + 4 + 0x10);
    assert_eq!(program.flags(), C);
    assert!(program.cpu.thumb());
}

#[test]
fn bx_pc_leaves_thumb_state_at_the_next_word() {
    let program = Program::thumb(&[0x4778, 0x46C0]).after(1);
    assert!(!program.cpu.thumb());
    assert_eq!(program.register(15), START + 4);
}

#[test]
fn pc_relative_addresses_are_aligned_to_words() {
    let program = Program::thumb(&[0x46C0, 0x4801]).with_words(START + 8, &[42]);
    assert_eq!(program.after(2).register(0), 42); // ldr r0, [pc, #4] at START + 2
    let program = Program::thumb(&[0x46C0, 0xA002]); // add r0, pc, #8 at START + 2
    assert_eq!(program.after(2).register(0), START + 4 + 8);
}

#[test]
fn push_and_pop_are_mirrored_and_return() {
    let program = Program::thumb(&[0xB501, 0xBD02]); // push {r0, lr}; pop {r1, pc}
    let program = program.with(0, 9).with(13, DATA).with(14, 0x301).after(2);
    assert_eq!(program.register(1), 9);
    assert_eq!(program.register(13), DATA);
    assert_eq!(program.register(15), 0x300);
    assert!(program.cpu.thumb());
}

#[test]
fn an_empty_register_list_transfers_r15() {
    let program = Program::thumb(&[0xC400]).after(1); // stmia r4!, {}
    assert_eq!(program.memory.word(DATA), START + 6);
    assert_eq!(program.register(4), DATA + 0x40);
}

#[test]
fn the_halves_of_a_call_work_apart() {
    let program = Program::thumb(&[0xF7FF]).after(1); // upper half, negative offset
    assert_eq!(program.register(14), (START + 4).wrapping_sub(0x1000));
    let program = Program::thumb(&[0xF802]).with(14, 0x200).after(1); // lower half
    assert_eq!(program.register(15), 0x204);
    assert_eq!(program.register(14), (START + 2) | 1);
}

#[test]
fn conditional_branches_reach_backwards() {
    let program = Program::thumb(&[0x46C0, 0xD1FD]).with_flags(0).after(2); // bne START
    assert_eq!(program.register(15), START);
}

#[test]
fn loads_and_stores_of_all_widths_use_their_scaled_offsets() {
    let loaded = |opcode| {
        let program = Program::thumb(&[opcode]).with_words(DATA, &[0x8182_8384, 0xF5F6_F7F8]);
        program.with(2, 4).after(1).register(0)
    };
    assert_eq!(loaded(0x6860), 0xF5F6_F7F8); // ldr r0, [r4, #4]
    assert_eq!(loaded(0x7860), 0x83); // ldrb r0, [r4, #1]
    assert_eq!(loaded(0x8860), 0x8182); // ldrh r0, [r4, #2]
    assert_eq!(loaded(0x56A0), 0xFFFF_FFF8); // ldrsb r0, [r4, r2]
    assert_eq!(loaded(0x5EA0), 0xFFFF_F7F8); // ldrsh r0, [r4, r2]
    let program = Program::thumb(&[0x8060]).with(0, 0x1_2345); // strh r0, [r4, #2]
    assert_eq!(program.after(1).memory.word(DATA), 0x2345_0000);
}

#[test]
fn the_stack_pointer_moves_by_words() {
    let program = Program::thumb(&[0xB084, 0xB001]).with(13, DATA).after(2);
    assert_eq!(program.register(13), DATA - 12); // sub sp, #16; add sp, #4
}
