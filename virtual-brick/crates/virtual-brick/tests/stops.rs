// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! How runs end: the instant, faults with a sentence, loops that nothing leaves.

use crate::support::arm::{Program, ALWAYS};
use crate::support::{brick, image, vehicle, RAM};
use virtual_brick::{Stop, StopReason, VirtualBrick};

const LIMIT: u64 = 1_000_000;
const REMAP: u32 = 0xFFFF_FF00;
const UNDEFINED: u32 = 0xE7FF_FFFF;

fn run(build: impl FnOnce(&mut Program)) -> Stop {
    let mut program = Program::new();
    build(&mut program);
    brick(&program).run_until(LIMIT)
}

/// Handlers of all exceptions loop, in remapped RAM.
fn set_vectors(program: &mut Program, word: u32) {
    for vector in 0..8 {
        program.poke(0x0020_0000 + 4 * vector, word);
    }
    program.poke(REMAP, 1);
}

fn assert_fault(stop: &Stop, words: &[&str]) {
    assert_eq!(stop.reason, StopReason::Fault, "{}", stop.message);
    words
        .iter()
        .for_each(|word| assert!(stop.message.contains(word), "{}", stop.message));
    assert!(stop.at_cycles < 1_000, "{stop:?}");
}

#[test]
fn a_loop_with_interrupts_masked_is_a_halt() {
    let stop = run(|program| {
        program.raw(0xE1A0_0000).stop();
    });
    assert_eq!(stop.reason, StopReason::Halted);
    assert_eq!(
        stop.message,
        "the processor loops at 0x00202004 (start + 0x4) with interrupts masked"
    );
    assert!(stop.at_cycles < 100);
}

#[test]
fn a_loop_with_interrupts_enabled_waits_for_them() {
    let stop = run(|program| {
        program.status(0x13).stop();
    });
    assert_eq!(stop.reason, StopReason::Reached);
    assert!((LIMIT..LIMIT + 4).contains(&stop.at_cycles));
}

#[test]
fn a_loop_of_several_instructions_with_interrupts_masked_is_a_halt() {
    let stop = run(|program| {
        program.raw(0xE1A0_0000).branch(ALWAYS, 0);
    });
    assert_eq!(stop.reason, StopReason::Halted);
    let words = "the processor loops around 0x0020200";
    assert!(stop.message.starts_with(words), "{}", stop.message);
}

#[test]
fn a_loop_that_something_can_leave_goes_on() {
    let interruptible = run(|program| {
        program.status(0x13).raw(0xE1A0_0000).branch(ALWAYS, 1);
    });
    assert_eq!(interruptible.reason, StopReason::Reached);
    let counting = run(|program| {
        let again = program.here();
        program.add(0, 1).branch(ALWAYS, again);
    });
    assert_eq!(counting.reason, StopReason::Reached);
    let polling = run(|program| {
        // The interval timer's image register changes.
        program.load(1, 0xFFFF_FD3C);
        let again = program.here();
        program.ldr(0, 1, 0).branch(ALWAYS, again);
    });
    assert_eq!(polling.reason, StopReason::Reached);
}

#[test]
fn an_undefined_instruction_without_handler_is_a_fault() {
    let unset_ram = run(|program| {
        program.poke(REMAP, 1).raw(UNDEFINED);
    });
    let words = [
        "undefined instruction at 0x0020200C (start + 0xC)",
        "0x00000004",
        "0x00000000",
    ];
    assert_fault(&unset_ram, &words);
    let erased_flash = run(|program| {
        program.raw(UNDEFINED);
    });
    assert_fault(
        &erased_flash,
        &["undefined instruction at 0x00202000 (start)", "0xFFFFFFFF"],
    );
}

#[test]
fn an_undefined_instruction_whose_handler_loops_is_a_fault() {
    let stop = run(|program| {
        set_vectors(program, 0xEAFF_FFFE);
        program.raw(UNDEFINED);
    });
    assert_fault(
        &stop,
        &[
            "undefined instruction at 0x0020206C",
            "handler loops at 0x00000004",
        ],
    );
}

#[test]
fn a_handler_that_is_undefined_itself_is_a_fault() {
    let stop = run(|program| {
        set_vectors(program, UNDEFINED);
        program.raw(UNDEFINED);
    });
    assert_fault(&stop, &["undefined instruction at 0x00000004"]);
}

#[test]
fn an_access_without_memory_and_handler_is_a_fault() {
    let stop = run(|program| {
        program.poke(REMAP, 1).load(1, 0x8000_0000).ldr(0, 1, 0);
    });
    assert_fault(
        &stop,
        &["data abort", "at 0x00202010 (start + 0x10)", "0x00000010"],
    );
}

#[test]
fn a_jump_out_of_memory_is_a_fault() {
    let stop = run(|program| {
        program.poke(REMAP, 1).load(15, 0x8000_0000);
    });
    assert_fault(&stop, &["prefetch abort", "at 0x80000000"]);
}

#[test]
fn a_jump_to_address_zero_without_vectors_is_a_fault() {
    let stop = run(|program| {
        program.poke(REMAP, 1).load(15, 0);
    });
    assert_fault(
        &stop,
        &["jump from 0x0020200C (start + 0xC)", "vector 0x00000000"],
    );
}

#[test]
fn a_software_interrupt_without_handler_is_a_fault() {
    let stop = run(|program| {
        program.raw(0xEF00_0000);
    });
    assert_fault(&stop, &["software interrupt", "vector 0x00000008"]);
}

#[test]
fn an_access_to_an_unmodelled_register_is_a_fault_that_names_register_and_instruction() {
    let stop = run(|program| {
        program.poke(0xFFFF_A000, 1);
    });
    assert_fault(&stop, &["0xffffa000", "0x00202008 (start + 0x8)"]);
}

#[test]
fn a_run_that_ended_stays_ended() {
    let mut program = Program::new();
    program.stop();
    let mut brick = brick(&program);
    let stop = brick.run_until(LIMIT);
    assert_eq!(brick.run_until(2 * LIMIT), stop);
    assert_eq!(brick.cycles(), stop.at_cycles);
}

#[test]
fn a_full_trace_ends_the_run() {
    let mut configuration = vehicle();
    configuration.trace_limits.signal_values = 100;
    let mut program = Program::new();
    program.status(0x13).stop();
    let mut brick = VirtualBrick::new(&configuration, &image(&program).build()).unwrap();
    let stop = brick.run_until(100 * LIMIT);
    assert_eq!(stop.reason, StopReason::TraceFull);
    assert!(
        stop.message.contains("trace_limits.signal_values"),
        "{}",
        stop.message
    );
}

#[test]
fn a_thumb_entry_starts_in_thumb_state() {
    let elf = crate::support::elf::ElfBuilder::new(RAM | 1)
        .words(RAM, &[0xE7FE_E7FE])
        .build();
    let mut brick = VirtualBrick::new(&vehicle(), &elf).unwrap();
    assert_eq!(brick.run_until(LIMIT).reason, StopReason::Halted);
    assert!(brick.processor().thumb());
}

#[test]
fn a_flash_image_starts_at_power_on_with_the_slow_clock() {
    let flash = 0x0010_0000;
    let elf = crate::support::elf::ElfBuilder::new(flash)
        .words(flash, &[0xE1A0_0000, 0xEAFF_FFFE])
        .build();
    let mut brick = VirtualBrick::new(&vehicle(), &elf).unwrap();
    let stop = brick.run_until(LIMIT);
    assert_eq!(stop.reason, StopReason::Halted);
    assert_eq!(brick.processor().next_instruction_address(), 4);
    assert!(stop.at_cycles > 5 * 48_054_857 / 32_768);
}
