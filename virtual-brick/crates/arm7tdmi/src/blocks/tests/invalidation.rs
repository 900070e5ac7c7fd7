// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Which blocks are invalid after a change of memory.

use super::machine::{assert_as_reference, branch, program, run_until, store, START};
use crate::blocks::Blocks;
use crate::instruction::ALWAYS;

const COUNT: u32 = 0xE282_2001; // add r2, r2, #1
const SECOND: u32 = START + 12;

/// Two blocks that lead to each other.
fn opcodes() -> [u32; 5] {
    let (to_second, to_first) = (
        branch(ALWAYS, START + 8, SECOND),
        branch(ALWAYS, SECOND + 4, START),
    );
    [COUNT, COUNT, to_second, COUNT, to_first]
}

#[test]
fn a_store_to_code_invalidates_only_the_blocks_that_cover_it() {
    let (mut cpu, mut machine) = program(&opcodes());
    let mut blocks = Blocks::default();
    run_until(&mut cpu, &mut machine, &mut blocks, 100);
    let first = blocks.find(&machine, START).unwrap();
    assert!(blocks.find(&machine, SECOND).is_some());
    // The same opcode again is a change, too.
    store(&mut machine, SECOND, COUNT);
    blocks.update(&mut machine);
    assert_eq!(blocks.find(&machine, SECOND), None);
    assert_eq!(blocks.find(&machine, START), Some(first));
}

#[test]
fn the_run_continues_with_the_changed_code() {
    let opcodes = [
        0xE59F_000C, // ldr r0, [pc, #12]: the last word
        0xE58F_0000, // str r0, [pc]: two instructions ahead, already fetched
        COUNT,
        COUNT,
        branch(ALWAYS, START + 16, START),
        0xE282_2010, // add r2, r2, #16
    ];
    let (mut cpu, mut machine) = program(&opcodes);
    run_until(&mut cpu, &mut machine, &mut Blocks::default(), 200);
    assert_as_reference(&opcodes, &cpu, &machine);
    assert!(cpu.register(2) > 16);
}

#[test]
fn a_new_epoch_invalidates_all_blocks() {
    let (mut cpu, mut machine) = program(&opcodes());
    let mut blocks = Blocks::default();
    run_until(&mut cpu, &mut machine, &mut blocks, 100);
    machine.epoch += 1;
    blocks.update(&mut machine);
    assert!(blocks.blocks.is_empty());
}

#[test]
fn epochs_that_change_all_the_time_leave_the_run_to_single_steps() {
    let (mut cpu, mut machine) = program(&opcodes());
    let mut blocks = Blocks::default();
    let (mut runs, mut alone) = (0, 0);
    let steps = 20_000;
    for _ in 0..steps {
        machine.epoch += 1;
        let limit = machine.now + 20;
        let asked = alone == 0;
        let ran = asked && cpu.run_blocks(&mut machine, &mut blocks, limit, 1).ran;
        alone = if asked {
            blocks.steps_of_reference()
        } else {
            alone - 1
        };
        if ran {
            runs += 1;
        } else {
            cpu.step(&mut machine);
        }
    }
    assert!(runs > 0 && runs < steps / 10, "{runs} of {steps}");
    assert_as_reference(&opcodes(), &cpu, &machine);
}
