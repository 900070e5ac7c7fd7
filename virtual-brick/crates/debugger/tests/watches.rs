// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Watchpoints on memory of any size, on registers of peripherals, and on what the data controller
//! writes.

use crate::gdb::talk;
use crate::support::arm::Program;
use debugger::DebugTarget;

const MEMORY: u32 = 0x0020_8000;
const SET_OUTPUT: u32 = 0xFFFF_F430;
const DEBUG_UNIT: u32 = 0xFFFF_F200;

fn target(program: &Program) -> DebugTarget {
    DebugTarget::new(crate::support::brick(program))
}

/// What the server says on GDB's console in one of the replies.
fn said(reply: &str) -> String {
    let digits = reply.strip_prefix('O').unwrap();
    let bytes = (0..digits.len()).step_by(2);
    let text = bytes.map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap());
    String::from_utf8(text.collect()).unwrap()
}

/// Everything on the console, and the other replies.
fn split(replies: Vec<String>) -> (String, Vec<String>) {
    let speech = |reply: &String| reply.starts_with('O') && reply != "OK";
    let (console, others): (Vec<_>, Vec<_>) = replies.into_iter().partition(speech);
    (console.iter().map(|reply| said(reply)).collect(), others)
}

fn program_counter(reply: &str) -> u32 {
    u32::from_str_radix(reply, 16).unwrap().swap_bytes()
}

/// Writes 0x20 and then 0x40 to the same register, then reads it. The program counter after each.
fn output() -> (Program, [usize; 3]) {
    let mut program = Program::new();
    program.load(1, SET_OUTPUT).load(0, 0x20).str(0, 1, 0);
    let first = program.here();
    program.load(0, 0x40).str(0, 1, 0);
    let second = program.here();
    program.ldr(0, 1, 0);
    let read = program.here();
    program.stop();
    (program, [first, second, read])
}

fn address(position: usize) -> u32 {
    crate::support::RAM + 4 * position as u32
}

#[test]
fn a_write_of_a_register_that_cannot_be_read_back_stops_with_a_signal_and_the_value() {
    let (program, [first, second, _]) = output();
    let watch = "Z2,fffff430,4";
    let replies = talk(
        &mut target(&program),
        &[
            watch, "vCont;c", "pf", "vCont;c", "pf", "bc", "pf", "bc", "pf",
        ],
    );
    let (console, replies) = split(replies);
    assert!(replies[1].starts_with("T1e"), "{replies:?}");
    let places: Vec<_> = [2, 4, 6, 8].map(|at| program_counter(&replies[at])).into();
    let stores = [address(first) - 4, address(second) - 4];
    assert_eq!(
        places,
        [address(first), address(second), stores[1], stores[0]]
    );
    assert_eq!(console.matches("awatch stops at reads too").count(), 1);
    let written = |value| format!("the program writes 0x{value:08x} to 0xfffff430");
    assert_eq!(console.matches(&written(0x20)).count(), 2);
    assert_eq!(console.matches(&written(0x40)).count(), 2);
}

#[test]
fn reads_and_accesses_of_a_register_stop_before_the_instruction() {
    let (program, [first, _, read]) = output();
    for (watch, kind, stop, line) in [
        ("Z3,fffff430,4", "rwatch:", address(read) - 4, "reads"),
        ("Z4,fffff430,4", "awatch:", address(first) - 4, "writes"),
    ] {
        let (console, replies) = split(talk(&mut target(&program), &[watch, "vCont;c", "pf"]));
        assert!(replies[1].contains(kind), "{replies:?}");
        assert_eq!(program_counter(&replies[2]), stop);
        assert!(console.contains(line), "{console}");
    }
}

#[test]
fn exactly_the_watched_bytes_stop_whatever_their_number_and_address() {
    // strb r0, [r1, #k] for each k
    let mut program = Program::new();
    program.load(1, MEMORY).load(0, 0x5A);
    let begin = program.here();
    for byte in 0..16 {
        program.raw(0xE5C1_0000 | byte);
    }
    program.stop();
    for (offset, length) in [
        (0, 1),
        (3, 1),
        (2, 2),
        (1, 2),
        (0, 4),
        (2, 4),
        (0, 8),
        (5, 8),
    ] {
        let mut target = target(&program);
        let at = MEMORY + offset;
        let (insert, remove) = (format!("Z2,{at:x},{length}"), format!("z2,{at:x},{length}"));
        for byte in offset..offset + length {
            let replies = talk(
                &mut target,
                &[&insert, "vCont;c", "pf", &remove, "vCont;s:1"],
            );
            assert!(replies[1].contains("watch:"), "{replies:?}");
            let store = address(begin + byte as usize);
            assert_eq!(program_counter(&replies[2]), store, "{offset} {length}");
        }
        let replies = talk(&mut target, &[&insert, "vCont;c"]);
        assert!(!replies[1].contains("watch:"), "{replies:?}");
    }
}

#[test]
fn a_store_to_an_address_between_words_stops_at_the_word_that_it_changes() {
    let mut program = Program::new();
    program.load(1, MEMORY + 2).load(0, 0x5A).str(0, 1, 0);
    let after = program.here();
    program.stop();
    for (watch, stops) in [("Z4,208000,1", true), ("Z4,208004,1", false)] {
        let replies = talk(&mut target(&program), &[watch, "vCont;c", "pf"]);
        assert_eq!(replies[1].contains("watch:"), stops, "{replies:?}");
        if stops {
            assert_eq!(program_counter(&replies[2]), address(after) - 4);
        }
    }
}

/// The debug unit sends itself a character, which the data controller stores. The processor goes
/// on, or sleeps until the transfer ends.
fn transfer(sleeps: bool) -> Program {
    let mut program = Program::new();
    program
        .poke(DEBUG_UNIT + 0x20, 1)
        .poke(DEBUG_UNIT + 0x04, 2 << 14 | 4 << 9)
        .poke(DEBUG_UNIT, 1 << 6 | 1 << 4)
        .poke(DEBUG_UNIT + 0x100, MEMORY)
        .poke(DEBUG_UNIT + 0x104, 1)
        .poke(DEBUG_UNIT + 0x120, 1)
        .poke(DEBUG_UNIT + 0x08, 1 << 3)
        .poke(0xFFFF_F120, 1 << 1)
        .poke(DEBUG_UNIT + 0x1C, 0x5A);
    if sleeps {
        program.poke(0xFFFF_FC04, 1);
    }
    program.delay(1000).stop();
    program
}

#[test]
fn writes_of_the_data_controller_stop_forwards_and_backwards() {
    for sleeps in [false, true] {
        let mut target = target(&transfer(sleeps));
        let forwards = ["Z2,208000,1", "vCont;c"];
        let (console, replies) = split(talk(&mut target, &forwards));
        assert!(replies[1].contains("watch:"), "{sleeps} {replies:?}");
        assert!(console.contains("by the peripheral data controller"));
        let time = target.monitor("time");
        // GDB makes the step at which a watchpoint is reported.
        assert_eq!(talk(&mut target, &["vCont;s:1", "m208000,1"])[1], "5a");
        target.run_to(50_000);
        let backwards = ["Z2,208000,1", "bc", "z2,208000,1", "m208000,1"];
        let (_, replies) = split(talk(&mut target, &backwards));
        assert!(replies[1].contains("watch:"), "{sleeps} {replies:?}");
        assert_eq!(replies[3], "5a");
        if sleeps {
            assert_eq!(target.monitor("time"), time);
        }
        assert_eq!(talk(&mut target, &["bs", "m208000,1"])[1], "00");
    }
}
