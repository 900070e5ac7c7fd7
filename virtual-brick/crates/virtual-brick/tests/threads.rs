// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Threads observed through the whole machine: a program that writes the watched words as a
//! run-time does, with the interval timer as its clock.

use crate::support::arm::{Program, ALWAYS};
use crate::support::elf::ElfBuilder;
use crate::support::{image, vehicle, RAM, VEHICLE};
use trace::{EventKind, NameSpace, IDLE};
use virtual_brick::{Configuration, StopReason, VirtualBrick};

const RUNNING: u32 = 0x0020_8000;
const FIRST: u32 = 0x0020_8004;
const BLOCK: u32 = 0x0020_8100;
const NAME: u32 = 0x0020_A000;
const LAYOUT: u32 = 0x0020_A100;
const STACK: u32 = 0x0020_8800;
const PIT_MR: u32 = 0xFFFF_FD30;
const MC_RCR: u32 = 0xFFFF_FF00;
const OFFSETS: [u32; 9] = [0, 4, 8, 12, 16, 20, 24, 32, 36];
const PRIORITY: u32 = BLOCK + 12;
const STATE: u32 = BLOCK + 20;
const WAKE: u32 = BLOCK + 24;

fn brick(version: u32) -> VirtualBrick {
    named_brick(version, 7)
}

fn named_brick(version: u32, name_length: u32) -> VirtualBrick {
    VirtualBrick::new(&vehicle(), &elf(version, name_length).build()).unwrap()
}

fn elf(version: u32, name_length: u32) -> ElfBuilder {
    elf_after(Program::new(), version, name_length)
}

/// The program behind another one.
fn elf_after(program: Program, version: u32, name_length: u32) -> ElfBuilder {
    elf_leaving(program, version, name_length, 1)
}

/// The same; the thread goes on for so many turns of a loop after it has said that it waits.
fn elf_leaving(mut program: Program, version: u32, name_length: u32, turns: u32) -> ElfBuilder {
    program.poke(PIT_MR, 0x010F_FFFF);
    for (address, value) in [
        (BLOCK + 4, NAME),
        (BLOCK + 8, name_length),
        (PRIORITY, 5),
        (BLOCK + 32, STACK),
        (BLOCK + 36, 64),
        (STACK + 40, 1),
        (FIRST, BLOCK),
        (STATE, 1),
        (RUNNING, BLOCK),
        (WAKE, 70),
        (STATE, 2),
    ] {
        program.poke(address, value);
    }
    program.delay(turns).poke(RUNNING, 0).poke(STATE, 1);
    let here = program.here();
    program.status(0x13).branch(ALWAYS, here);
    let mut layout = vec![version, 40];
    layout.extend(OFFSETS);
    image(&program)
        .segment(NAME, b"control\0")
        .words(LAYOUT, &layout)
        .object("tasks__control_task", BLOCK - 8, 60)
        .object("ravenbrick_running_thread", RUNNING, 4)
        .object("ravenbrick_first_thread", FIRST, 4)
        .object("ravenbrick_thread_layout", LAYOUT, 44)
}

#[test]
fn states_jobs_and_the_running_thread_become_events() {
    let mut brick = brick(1);
    assert_eq!(brick.threads_unobserved(), None);
    brick.run_until(2_000);
    let events: Vec<_> = brick.trace().events().iter().collect();
    let kinds: Vec<_> = events.iter().map(|e| (e.kind, e.subject)).collect();
    let expected = [
        (EventKind::ThreadState, 0),
        (EventKind::Release, 0),
        (EventKind::ThreadRunning, 0),
        (EventKind::ThreadState, 0),
        (EventKind::Completion, 0),
        (EventKind::ThreadRunning, IDLE),
        (EventKind::ThreadState, 0),
        (EventKind::Release, 0),
    ];
    assert_eq!(kinds, expected);
    assert_eq!(events[4].value, events[1].at_cycles as i64);
    assert_eq!(brick.trace().names().all(NameSpace::Thread), ["control"]);
    assert!(events
        .windows(2)
        .all(|pair| pair[0].at_cycles <= pair[1].at_cycles));
}

#[test]
fn the_nominal_release_counts_from_the_start_of_the_interval_timer() {
    let mut brick = brick(1);
    brick.run_until(2_000);
    let events: Vec<_> = brick.trace().events().iter().collect();
    let nominal = events[7].value as u64;
    // 70 units are 160 cycles; the timer starts with the third store of the program.
    let started = nominal - 160;
    assert!((5..40).contains(&started), "{started}");
}

#[test]
fn threads_are_reported_with_their_stack_use() {
    let mut brick = brick(1);
    brick.run_until(2_000);
    let threads = brick.threads();
    assert_eq!(threads.len(), 1);
    let thread = &threads[0];
    assert_eq!(
        (thread.name.as_str(), thread.base_priority, thread.state),
        ("control", 5, 1)
    );
    assert_eq!(
        (thread.stack_base, thread.stack_size, thread.stack_used),
        (STACK, 64, 24)
    );
    assert_eq!(thread.address, BLOCK);
}

#[test]
fn a_layout_of_another_version_is_refused_and_stated() {
    let mut brick = brick(2);
    assert!(brick
        .threads_unobserved()
        .unwrap()
        .contains("version 2, expected 1"));
    brick.run_until(2_000);
    assert!(brick.trace().events().is_empty());
    assert!(brick.threads().is_empty());
}

#[test]
fn an_image_without_the_symbols_is_stated() {
    let mut program = Program::new();
    program.stop();
    let brick = VirtualBrick::new(&vehicle(), &image(&program).build()).unwrap();
    let reason = brick.threads_unobserved().unwrap();
    assert!(reason.contains("ravenbrick_running_thread"), "{reason}");
    assert_eq!(brick.image().entry(), RAM);
}

#[test]
fn a_thread_without_a_name_has_that_of_the_object_that_holds_it() {
    let mut brick = named_brick(1, 0);
    brick.run_until(2_000);
    assert_eq!(
        brick.trace().names().all(NameSpace::Thread),
        ["control_task"]
    );
    assert_eq!(brick.threads()[0].name, "control_task");
}

/// Runs with guarded threads, the program being a function of this name.
fn guarded_stop(function: &str) -> (StopReason, String) {
    guarded_stop_of(elf(1, 7).symbol(function, RAM, 0x400, true, true))
}

fn guarded_stop_of(elf: ElfBuilder) -> (StopReason, String) {
    let mut brick = guarded(elf);
    let stop = brick.run_until(2_000);
    (stop.reason, stop.message)
}

fn guarded(elf: ElfBuilder) -> VirtualBrick {
    let fields = VEHICLE.replacen('{', r#"{"guards_threads": true, "#, 1);
    let configuration = Configuration::from_json(&fields).unwrap();
    VirtualBrick::new(&configuration, &elf.build()).unwrap()
}

/// `Split` of Ada's library writes where its caller says.
#[test]
fn a_function_of_the_library_that_is_no_part_of_the_kernel_may_not_write_them() {
    for function in ["ada__real_time__split", "system__arith_64__scaled_divide64"] {
        assert_eq!(guarded_stop(function).0, StopReason::Fault, "{function}");
    }
}

#[test]
fn code_that_replaces_a_function_of_the_run_time_may_not_write_them() {
    const STORE: u32 = 0xE581_0000;
    const STORE_AND_ADD_0: u32 = 0xE481_0000;
    let mut brick = guarded(elf(1, 7).symbol("ravenbrick_switch", RAM, 0x400, true, true));
    let code = brick.read_memory(RAM, 0x100).unwrap();
    let words = code
        .chunks(4)
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()));
    let places: Vec<u32> = (RAM..)
        .step_by(4)
        .zip(words)
        .filter(|w| w.1 == STORE)
        .map(|w| w.0)
        .collect();
    assert!(places.len() > 10);
    for place in places {
        brick
            .write_memory(place, &STORE_AND_ADD_0.to_le_bytes())
            .unwrap();
    }
    assert_eq!(brick.run_until(2_000).reason, StopReason::Fault);
}

/// Whoever writes it: what has jumped into the run-time looks like the run-time.
#[test]
fn a_thread_that_waits_may_not_run_on() {
    let stop = |turns, until_cycles| {
        let elf = elf_leaving(Program::new(), 1, 7, turns);
        let mut brick = guarded(elf.symbol("ravenbrick_switch", RAM, 0x400, true, true));
        brick.run_until(until_cycles)
    };
    assert_eq!(stop(1_000, 100_000).reason, StopReason::Reached);
    for until_cycles in [60_000, 1_000_000] {
        let stopped = stop(100_000, until_cycles);
        assert_eq!(stopped.reason, StopReason::Fault);
        assert!(stopped.message.contains("'control' waits and runs on"));
        assert!(stopped.at_cycles < 60_000);
    }
}

#[test]
fn only_the_run_time_may_write_guarded_words_of_threads() {
    for function in ["ravenbrick_switch", "system__tasking__create"] {
        assert_eq!(guarded_stop(function).0, StopReason::Reached, "{function}");
    }
    let (reason, message) = guarded_stop("tasks__control_taskTKB");
    assert_eq!(reason, StopReason::Fault);
    assert!(
        message.contains("writes what only the run-time writes"),
        "{message}"
    );
    assert!(message.contains("(start + 0x"), "{message}");
}

/// The image has the copied vectors and behind them a function of the run-time elsewhere; the
/// program remaps the RAM and goes on at address 0.
#[test]
fn a_program_that_runs_where_the_ram_appears_again_is_not_taken_for_the_run_time() {
    const VECTORS: u32 = 0x0020_6000;
    let again = || {
        let mut program = Program::new();
        program.poke(MC_RCR, 1);
        let behind = RAM - 0x0020_0000 + 4 * (program.here() as u32 + 2);
        program.load(0, behind).raw(0xE12F_FF10); // bx r0
        elf_after(program, 1, 7)
            .symbol("ravenbrick_vectors", VECTORS, 0x20, true, true)
            .symbol("ravenbrick_vectors_end", VECTORS + 0x20, 0, false, true)
            .symbol("ravenbrick_behind", VECTORS + 0x20, 0x1000, true, true)
    };
    let run_time = again().symbol("ravenbrick_switch", RAM, 0x400, true, true);
    assert_eq!(guarded_stop_of(run_time).0, StopReason::Reached);
    let own = again().symbol("tasks__control_taskTKB", RAM, 0x400, true, true);
    let (reason, message) = guarded_stop_of(own);
    assert_eq!(reason, StopReason::Fault);
    assert!(
        message.contains("writes what only the run-time writes"),
        "{message}"
    );
}
