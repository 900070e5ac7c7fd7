// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM state: single, halfword, multiple transfers and swaps.

use super::program::{Program, DATA, START};
use arm7tdmi::{psr, Mode};

const WORDS: [u32; 4] = [0x8765_43F1, 0x1111_1111, 0x2222_2222, 0x3333_3333];

fn load(opcode: u32, offset: u32) -> u32 {
    let program = Program::arm(&[opcode]).with_words(DATA, &WORDS);
    program.with(4, DATA + offset).after(1).register(0)
}

#[test]
fn a_word_from_an_unaligned_address_arrives_rotated() {
    assert_eq!(load(0xE594_0000, 0), 0x8765_43F1);
    assert_eq!(load(0xE594_0000, 1), 0xF187_6543);
    assert_eq!(load(0xE594_0000, 3), 0x6543_F187);
}

#[test]
fn halfwords_and_bytes_extend_with_zero_or_sign() {
    assert_eq!(load(0xE5D4_0000, 0), 0xF1); // ldrb
    assert_eq!(load(0xE1D4_00B0, 2), 0x8765); // ldrh
    assert_eq!(load(0xE1D4_00D0, 0), 0xFFFF_FFF1); // ldrsb
    assert_eq!(load(0xE1D4_00F0, 2), 0xFFFF_8765); // ldrsh
}

#[test]
fn halfwords_from_odd_addresses_arrive_rotated_or_as_their_upper_byte() {
    assert_eq!(load(0xE1D4_00B0, 1), 0xF100_0043);
    assert_eq!(load(0xE1D4_00F0, 3), 0xFFFF_FF87);
}

#[test]
fn indexing_before_and_after_moves_the_base_as_asked() {
    let after = |opcode| {
        let program = Program::arm(&[opcode]).with_words(DATA, &WORDS).after(1);
        (program.register(0), program.register(4))
    };
    assert_eq!(after(0xE594_0004), (WORDS[1], DATA)); // ldr r0, [r4, #4]
    assert_eq!(after(0xE494_0004), (WORDS[0], DATA + 4)); // ldr r0, [r4], #4
    assert_eq!(after(0xE5B4_0004), (WORDS[1], DATA + 4)); // ldr r0, [r4, #4]!
    assert_eq!(after(0xE4B4_0004), (WORDS[0], DATA + 4)); // ldrt r0, [r4], #4
    assert_eq!(after(0xE1F4_00B4), (0x1111, DATA + 4)); // ldrh r0, [r4, #4]!
}

#[test]
fn a_loaded_base_wins_over_write_back() {
    let program = Program::arm(&[0xE494_4004])
        .with_words(DATA, &WORDS)
        .after(1);
    assert_eq!(program.register(4), WORDS[0]); // ldr r4, [r4], #4
}

#[test]
fn stores_write_their_width_only() {
    let stored = |opcode, offset| {
        let program = Program::arm(&[opcode]).with_words(DATA, &[0]);
        let program = program.with(0, 0xAABB_CCDD).with(4, DATA + offset);
        program.after(1).memory.word(DATA)
    };
    assert_eq!(stored(0xE5C4_0000, 1), 0x0000_DD00); // strb
    assert_eq!(stored(0xE1C4_00B0, 3), 0xCCDD_0000); // strh to an odd address
    assert_eq!(stored(0xE584_0000, 2), 0xAABB_CCDD); // str to an unaligned address
}

#[test]
fn a_scaled_register_offset_subtracts() {
    let program = Program::arm(&[0xE764_0101]); // strb r0, [r4, -r1, lsl #2]!
    let program = program.with(0, 0x55).with(1, 2).with(4, DATA + 8).after(1);
    assert_eq!(program.memory.word(DATA), 0x55);
    assert_eq!(program.register(4), DATA);
}

#[test]
fn a_stored_r15_is_12_bytes_ahead() {
    let program = Program::arm(&[0xE584_F000]).after(1); // str pc, [r4]
    assert_eq!(program.memory.word(DATA), START + 12);
    let program = Program::arm(&[0xE884_8000]).after(1); // stmia r4, {pc}
    assert_eq!(program.memory.word(DATA), START + 12);
}

#[test]
fn a_load_to_r15_stays_in_arm_state() {
    let program = Program::arm(&[0xE594_F000])
        .with_words(DATA, &[0x203])
        .after(1);
    assert_eq!(program.register(15), 0x200);
    assert!(!program.cpu.thumb());
}

#[test]
fn the_four_addressing_modes_of_multiple_stores_place_the_lowest_register_lowest() {
    let stored = |opcode, first| {
        let program = Program::arm(&[opcode]).with(0, 10).with(1, 11).after(1);
        assert_eq!(program.memory.word(first), 10, "{opcode:#X}");
        assert_eq!(program.memory.word(first + 4), 11, "{opcode:#X}");
        program.register(4)
    };
    assert_eq!(stored(0xE8A4_0003, DATA), DATA + 8); // stmia r4!
    assert_eq!(stored(0xE9A4_0003, DATA + 4), DATA + 8); // stmib r4!
    assert_eq!(stored(0xE824_0003, DATA - 4), DATA - 8); // stmda r4!
    assert_eq!(stored(0xE924_0003, DATA - 8), DATA - 8); // stmdb r4!
}

#[test]
fn a_base_in_the_list_is_stored_old_when_first_and_new_otherwise() {
    let first = Program::arm(&[0xE8A4_0030]).after(1); // stmia r4!, {r4, r5}
    assert_eq!(first.memory.word(DATA), DATA);
    let second = Program::arm(&[0xE8A4_0018]).after(1); // stmia r4!, {r3, r4}
    assert_eq!(second.memory.word(DATA + 4), DATA + 8);
}

#[test]
fn a_base_in_the_list_of_a_multiple_load_takes_the_loaded_value() {
    let program = Program::arm(&[0xE8B4_0018])
        .with_words(DATA, &WORDS)
        .after(1);
    assert_eq!(program.register(4), WORDS[1]); // ldmia r4!, {r3, r4}
}

#[test]
fn an_empty_list_transfers_r15_and_moves_the_base_by_64() {
    let program = Program::arm(&[0xE8A4_0000]).after(1); // stmia r4!, {}
    assert_eq!(program.memory.word(DATA), START + 12);
    assert_eq!(program.register(4), DATA + 0x40);
    let program = Program::arm(&[0xE8B4_0000])
        .with_words(DATA, &[0x200])
        .after(1);
    assert_eq!(program.register(15), 0x200);
    assert_eq!(program.register(4), DATA + 0x40);
}

#[test]
fn the_user_bank_can_be_loaded_and_stored_from_other_modes() {
    let program = Program::arm(&[0xE8D4_6000])
        .with_words(DATA, &WORDS)
        .with(13, 7);
    let program = program.after(1); // ldmia r4, {r13, r14}^
    assert_eq!(program.register(13), 7);
    assert_eq!(program.cpu.banked_register(Mode::User, 13), WORDS[0]);
    let mut program = Program::arm(&[0xE944_6000]); // stmdb r4, {r13, r14}^
    program.cpu.set_banked_register(Mode::User, 14, 99);
    assert_eq!(program.after(1).memory.word(DATA - 4), 99);
}

#[test]
fn a_multiple_load_of_r15_with_s_returns_to_the_saved_state() {
    let mut program = Program::arm(&[0xE8D4_8001]).with_words(DATA, &[5, 0x202]);
    program.cpu.set_spsr_of(Mode::Supervisor, psr::T | 0x1F);
    let program = program.after(1); // ldmia r4, {r0, pc}^
    assert_eq!(program.cpu.cpsr(), psr::T | 0x1F);
    assert_eq!(program.register(15), 0x202);
    assert_eq!(program.register(0), 5);
}

#[test]
fn a_swap_exchanges_register_and_memory() {
    let program = Program::arm(&[0xE104_0091])
        .with_words(DATA, &WORDS)
        .with(1, 77);
    let program = program.after(1); // swp r0, r1, [r4]
    assert_eq!(program.register(0), WORDS[0]);
    assert_eq!(program.memory.word(DATA), 77);
    let program = Program::arm(&[0xE144_0091])
        .with_words(DATA, &WORDS)
        .with(1, 0x177);
    let program = program.after(1); // swpb r0, r1, [r4]
    assert_eq!(program.register(0), 0xF1);
    assert_eq!(program.memory.word(DATA), 0x8765_4377);
}
