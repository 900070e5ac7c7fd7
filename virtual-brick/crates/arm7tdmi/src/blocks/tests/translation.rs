// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where blocks end, what they cost and cover.

use super::machine::{branch, program, Machine, NOP, START};
use crate::blocks::block::Block;
use crate::blocks::bus::BlockBus;
use crate::blocks::translate::{build, read_source, translate};
use crate::instruction::ALWAYS;

const EQ: u32 = 0;

fn block(opcodes: &[u32]) -> (Block<Machine>, Machine) {
    let (_, mut machine) = program(opcodes);
    let place = machine.code_place(START).unwrap();
    (translate(&mut machine, START, place).unwrap(), machine)
}

fn live_flags(opcodes: &[u32]) -> Vec<bool> {
    let (_, machine) = program(opcodes);
    let place = machine.code_place(START).unwrap();
    build(&machine, &read_source(&machine, START, place)).live_flags
}

#[test]
fn a_block_ends_with_its_branch_and_counts_the_refill() {
    let (block, _) = block(&[NOP, NOP, branch(ALWAYS, START + 8, START)]);
    assert_eq!((block.ops.len(), block.halfwords), (3, 6));
    assert_eq!(block.worst_cycles, 3 + 2);
}

#[test]
fn a_block_continues_behind_a_conditional_branch() {
    let (block, _) = block(&[
        branch(EQ, START, START + 8),
        branch(ALWAYS, START + 4, START),
    ]);
    assert_eq!(block.halfwords, 4);
}

#[test]
fn a_long_sequence_is_divided() {
    let (block, _) = block(&[NOP; 40]);
    assert_eq!(block.halfwords, 2 * 32);
    // One more operation leads to the next block.
    assert_eq!(block.ops.len(), 32 + 1);
}

#[test]
fn the_worst_case_of_a_multiplication_is_its_longest() {
    let mla = 0xE023_2190; // mla r3, r0, r1, r2
    let (block, _) = block(&[mla, branch(ALWAYS, START + 4, START)]);
    assert_eq!(block.worst_cycles, (1 + 4 + 1) + (1 + 2));
}

#[test]
fn a_store_near_the_end_marks_the_opcodes_fetched_ahead() {
    let store = 0xE581_0000; // str r0, [r1]
    let end = branch(ALWAYS, START + 4, START);
    let (without, machine) = block(&[NOP, end]);
    assert_eq!(
        (without.halfwords, &machine.marks[..6]),
        (4, &[0, 1, 1, 0, 0, 0][..])
    );
    let (with, machine) = block(&[store, end]);
    assert_eq!(
        (with.halfwords, &machine.marks[..6]),
        (8, &[0, 1, 1, 1, 1, 0][..])
    );
}

#[test]
fn flags_are_live_only_where_they_are_observed() {
    let (adds, adcs, movs) = (0xE290_0001, 0xE2B0_0001, 0xE1B0_0001);
    let end = branch(ALWAYS, START + 8, START);
    assert_eq!(live_flags(&[adds, adds, end]), [false, true, false]);
    assert_eq!(live_flags(&[adds, adcs, end]), [true, true, false]);
    // MOVS without a shift keeps C and V.
    assert_eq!(live_flags(&[adds, movs, end]), [true, true, false]);
}

#[test]
fn a_loop_that_only_waits_is_idempotent() {
    let (load, compare) = (0xE591_0000, 0xE350_0000); // ldr r0, [r1]; cmp r0, #0
    let back = branch(EQ, START + 8, START);
    let end = branch(ALWAYS, START + 12, START);
    assert!(block(&[branch(ALWAYS, START, START)]).0.is_idempotent);
    assert!(block(&[load, compare, back, end]).0.is_idempotent);
    let (count, store) = (0xE282_2001, 0xE582_0000); // add r2, r2, #1; str r0, [r2]
    for not_idle in [count, store] {
        assert!(
            !block(&[load, not_idle, branch(ALWAYS, START + 8, START)])
                .0
                .is_idempotent
        );
    }
}
