// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Stacks that overflow are noticed from outside, to the byte and by every engine.

use crate::support::arm::Program;
use crate::support::{image, VEHICLE};
use virtual_brick::{Configuration, VirtualBrick};

const RUNNING: u32 = 0x0020_8000;
const FIRST: u32 = 0x0020_8004;
const BLOCK: u32 = 0x0020_8100;
const LAYOUT: u32 = 0x0020_A100;
const STACK: u32 = 0x0020_8800;
const STACK_BYTES: u32 = 512;
const OFFSETS: [u32; 9] = [0, 4, 8, 12, 16, 20, 24, 32, 36];
const STACK_POINTER: u32 = 13;
const PUSH_FOUR: u32 = 0xE92D_000F;
const POP_FOUR: u32 = 0xE8BD_000F;
const TAKE_256: u32 = 0xE24D_DC01;
const GIVE_256: u32 = 0xE28D_DC01;

/// A thread that runs these instructions with so many bytes of its stack left, on each engine.
fn overflows(left: u32, instructions: &[u32]) -> Vec<String> {
    let mut program = Program::new();
    for (address, value) in [
        (BLOCK + 12, 5),
        (BLOCK + 32, STACK),
        (BLOCK + 36, STACK_BYTES),
        (FIRST, BLOCK),
        (BLOCK + 20, 1),
        (RUNNING, BLOCK),
    ] {
        program.poke(address, value);
    }
    program.status(0x1F).load(STACK_POINTER, STACK + left);
    for &instruction in instructions {
        program.raw(instruction);
    }
    program.stop();
    let mut layout = vec![1, 40];
    layout.extend(OFFSETS);
    let elf = image(&program)
        .words(LAYOUT, &layout)
        .object("tasks__control_task", BLOCK, 600)
        .object("ravenbrick_running_thread", RUNNING, 4)
        .object("ravenbrick_first_thread", FIRST, 4)
        .object("ravenbrick_thread_layout", LAYOUT, 44)
        .build();
    let run = |engine: &str| {
        let with_engine = VEHICLE.replacen('{', &format!("{{\"engine\": \"{engine}\","), 1);
        let configuration = Configuration::from_json(&with_engine).unwrap();
        let mut brick = VirtualBrick::new(&configuration, &elf).unwrap();
        brick.run_until(20_000);
        brick.stack_overflows()
    };
    let found = run("fast");
    assert_eq!(found, run("blocks"));
    assert_eq!(found, run("reference"));
    found
}

fn only(found: &[String]) -> &str {
    assert_eq!(found.len(), 1, "{found:?}");
    &found[0]
}

#[test]
fn a_stack_that_is_used_to_its_last_byte_does_not_overflow() {
    let exactly = overflows(16, &[PUSH_FOUR, POP_FOUR]);
    assert!(exactly.is_empty(), "{exactly:?}");
    let large = overflows(256, &[TAKE_256, GIVE_256]);
    assert!(large.is_empty(), "{large:?}");
}

#[test]
fn words_below_the_stack_are_counted() {
    let found = overflows(8, &[PUSH_FOUR, PUSH_FOUR, POP_FOUR, POP_FOUR]);
    let sentence = only(&found);
    let words = "task control_task needs 24 bytes more than its stack of 512 bytes has";
    assert!(sentence.contains(words), "{sentence}");
    assert!(sentence.ends_with("(more than 536)"), "{sentence}");
}

#[test]
fn a_large_frame_overflows_without_a_write() {
    let found = overflows(200, &[TAKE_256, GIVE_256]);
    assert!(
        only(&found).contains("control_task needs 56 bytes more"),
        "{found:?}"
    );
}

/// As when threads are changed: a stack pointer may be elsewhere for a moment.
#[test]
fn a_stack_pointer_that_is_set_below_the_stack_is_no_overflow() {
    let below = 0xE24D_0F87; // sub r0, sp, #540
    let (mov, back) = (0xE1A0_D000, 0xE280_DF87); // mov sp, r0; add sp, r0, #540
    let found = overflows(STACK_BYTES, &[below, mov, back]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn a_stack_that_is_too_deep_at_the_end_may_become_deeper() {
    let found = overflows(8, &[PUSH_FOUR]);
    assert!(
        only(&found).contains("needs at least 8 bytes more"),
        "{found:?}"
    );
}
