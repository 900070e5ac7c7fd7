// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Calls of a debugger by the program (Arm, "Semihosting for AArch32 and AArch64").

use crate::support::arm::Program;
use virtual_brick::{StopReason, VirtualBrick};

const CALL: u32 = 0xEF12_3456;
const BLOCK: u32 = 0x0020_8000;
const TEXT: u32 = 0x0020_8100;
const RESULT: u32 = 0x0020_8200;
const SECOND: u64 = 48_054_858;

/// A call in ARM state whose answer is stored at [`RESULT`].
fn called(operation: u32, parameter: u32, block: &[u32], text: &[u8]) -> VirtualBrick {
    let mut program = Program::new();
    program.load(0, operation).load(1, parameter).raw(CALL);
    program.load(1, RESULT).str(0, 1, 0).stop();
    let mut brick = crate::support::brick(&program);
    let words: Vec<u8> = block.iter().flat_map(|word| word.to_le_bytes()).collect();
    brick.write_memory(BLOCK, &words).unwrap();
    brick.write_memory(TEXT, text).unwrap();
    brick.set_semihosting(true);
    brick.run_until(10_000);
    brick
}

fn word(brick: &VirtualBrick, address: u32) -> u32 {
    let bytes = brick.read_memory(address, 4).unwrap();
    u32::from_le_bytes(bytes.try_into().unwrap())
}

fn said(brick: &VirtualBrick) -> String {
    String::from_utf8(brick.console_since(0).to_vec()).unwrap()
}

#[test]
fn text_is_written_as_letter_string_and_block() {
    assert_eq!(said(&called(0x03, TEXT, &[], b"xy")), "x");
    assert_eq!(said(&called(0x04, TEXT, &[], b"hello\0rest")), "hello");
    let brick = called(0x05, BLOCK, &[2, TEXT, 4], b"blocks");
    assert_eq!((said(&brick).as_str(), word(&brick, RESULT)), ("bloc", 0));
    assert_eq!(brick.console_bytes(), 4);
    assert_eq!(brick.console_since(3), b"c");
}

#[test]
fn a_call_in_thumb_state_is_served_too() {
    // movs r0, #4; ldr r1, =TEXT; swi 0xAB; b .
    let words = [0x4901_2004, 0xE7FE_DFAB, TEXT];
    let elf = crate::support::elf::ElfBuilder::new(crate::support::RAM | 1)
        .words(crate::support::RAM, &words)
        .function("start", crate::support::RAM | 1);
    let mut brick = VirtualBrick::new(&crate::support::vehicle(), &elf.build()).unwrap();
    brick.write_memory(TEXT, b"thumb\0").unwrap();
    brick.set_semihosting(true);
    brick.run_until(10_000);
    assert_eq!(said(&brick), "thumb");
    assert!(brick.processor().thumb());
}

#[test]
fn the_console_opens_as_tt_and_has_nothing_to_read() {
    for (mode, handle) in [(0, 1), (4, 2), (8, 3)] {
        let brick = called(0x01, BLOCK, &[TEXT, mode, 3], b":tt\0");
        assert_eq!(word(&brick, RESULT), handle);
    }
    let refused = called(0x01, BLOCK, &[TEXT, 4, 6], b"/etc/x\0");
    assert_eq!(word(&refused, RESULT), u32::MAX);
    assert_eq!(word(&called(0x06, BLOCK, &[1, TEXT, 9], b""), RESULT), 9);
    assert_eq!(word(&called(0x07, 0, &[], b""), RESULT), u32::MAX);
    assert_eq!(word(&called(0x09, BLOCK, &[2], b""), RESULT), 1);
    assert_eq!(word(&called(0x08, BLOCK, &[u32::MAX], b""), RESULT), 1);
    assert_eq!(word(&called(0x02, BLOCK, &[2], b""), RESULT), 0);
    assert_eq!(word(&called(0x02, BLOCK, &[9], b""), RESULT), u32::MAX);
}

#[test]
fn the_features_are_a_file() {
    let name = b":semihosting-features\0";
    let mut program = Program::new();
    program.load(0, 1).load(1, BLOCK).raw(CALL);
    program.load(1, BLOCK + 16).str(0, 1, 0);
    for operation in [0x0C, 0x06] {
        program.load(0, operation).load(1, BLOCK + 16).raw(CALL);
        program.load(1, RESULT + 4 * operation).str(0, 1, 0);
    }
    program.stop();
    let mut brick = crate::support::brick(&program);
    let block = [TEXT, 0, 21, 0, 0, TEXT + 64, 8];
    let words: Vec<u8> = block.iter().flat_map(|word| word.to_le_bytes()).collect();
    brick.write_memory(BLOCK, &words).unwrap();
    brick.write_memory(TEXT, name).unwrap();
    brick.set_semihosting(true);
    brick.run_until(10_000);
    assert_eq!(word(&brick, RESULT + 4 * 0x0C), 5);
    assert_eq!(word(&brick, RESULT + 4 * 0x06), 3);
    assert_eq!(brick.read_memory(TEXT + 64, 5).unwrap(), b"SHFB\x03");
}

#[test]
fn time_is_that_of_the_brick() {
    let mut program = Program::new();
    program.delay(2 * SECOND as u32 / 4);
    for operation in [0x10, 0x11, 0x31] {
        program.load(0, operation).raw(CALL);
        program.load(1, RESULT + 4 * operation).str(0, 1, 0);
    }
    program.load(0, 0x30).load(1, BLOCK).raw(CALL).stop();
    let mut brick = crate::support::brick(&program);
    brick.set_semihosting(true);
    brick.run_until(3 * SECOND);
    let hundredths = word(&brick, RESULT + 4 * 0x10);
    assert!((195..=205).contains(&hundredths), "{hundredths}");
    assert_eq!(word(&brick, RESULT + 4 * 0x11), hundredths / 100);
    assert_eq!(word(&brick, RESULT + 4 * 0x31), 48_054_857);
    let ticks = word(&brick, BLOCK);
    assert!(ticks.abs_diff(hundredths * 480_548) < 1_000_000, "{ticks}");
    assert_eq!(word(&brick, BLOCK + 4), 0);
}

#[test]
fn an_exit_ends_the_run_with_its_code_and_another_reason_is_a_fault() {
    let brick = called(0x18, 0x2_0026, &[], b"");
    assert_eq!(brick.ended().unwrap().reason, StopReason::Halted);
    let brick = called(0x20, BLOCK, &[0x2_0026, 7], b"");
    assert!(brick.ended().unwrap().message.contains("code 7"));
    let brick = called(0x18, 0x2_0023, &[], b"");
    assert_eq!(brick.ended().unwrap().reason, StopReason::Fault);
    assert!(brick.ended().unwrap().message.contains("0x20023"));
}

#[test]
fn unsupported_operations_return_minus_one() {
    for operation in [0x0D, 0x0E, 0x0F, 0x12, 0x17, 0x99] {
        assert_eq!(word(&called(operation, BLOCK, &[], b""), RESULT), u32::MAX);
    }
    // A block outside all memory, and a text that never ends within it.
    assert_eq!(word(&called(0x05, 0x0040_0000, &[], b""), RESULT), u32::MAX);
    assert_eq!(word(&called(0x04, 0xFFFF_FFFF, &[], b""), RESULT), u32::MAX);
}

#[test]
fn other_software_interrupts_and_those_without_a_debugger_go_to_their_vector() {
    for (code, debugged) in [(0xEF00_0001, true), (CALL, false)] {
        let mut program = Program::new();
        program.load(0, 4).load(1, TEXT).raw(code).stop();
        let mut brick = crate::support::brick(&program);
        brick.set_semihosting(debugged);
        brick.run_until(100_000);
        assert!(brick.console_since(0).is_empty());
        let message = brick.ended().unwrap().message.clone();
        assert!(message.contains("software interrupt"), "{message}");
    }
}

#[test]
fn the_program_goes_on_in_its_mode_and_a_checkpoint_holds_what_was_said() {
    let mut program = Program::new();
    program.status(0x1F).load(1, TEXT);
    let again = program.here();
    program.load(0, 4).raw(CALL).delay(1000).branch(14, again);
    let mut brick = crate::support::brick(&program);
    brick.write_memory(TEXT, b"again \0").unwrap();
    brick.set_semihosting(true);
    brick.run_until(20_000);
    let checkpoint = brick.checkpoint();
    let early = said(&brick);
    brick.run_until(100_000);
    let late = said(&brick);
    assert!(late.starts_with(&early) && late.len() > early.len());
    assert_eq!(brick.processor().cpsr() & 0x1F, 0x1F);
    brick.go_back(&checkpoint).unwrap();
    assert_eq!(said(&brick), early);
    brick.run_until(100_000);
    assert_eq!(said(&brick), late);
}
