// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reset, undefined instructions, software interrupts and aborts.

use super::program::{Program, DATA, START};
use crate::support::memory::Memory;
use arm7tdmi::{psr, Cpu, Exception, Mode, Step};

/// Beyond the end of the memory: every access is aborted.
const NOWHERE: u32 = 0x10_0000;

/// Steps once and checks what every exception entry has in common.
fn enter(program: &mut Program, exception: Exception) {
    let before = program.cpu.cpsr();
    assert_eq!(program.step(), Step::Exception(exception));
    assert_eq!(program.cpu.mode(), Some(exception.mode()));
    assert_eq!(program.cpu.spsr(), Some(before));
    assert_eq!(program.cpu.next_instruction_address(), exception.vector());
    assert!(!program.cpu.thumb());
    assert_ne!(program.cpu.cpsr() & psr::I, 0);
}

#[test]
fn reset_returns_to_the_vector_and_keeps_the_interrupted_state() {
    let mut program = Program::arm(&[]).in_mode(Mode::System);
    let before = program.cpu.cpsr();
    program.cpu.reset();
    assert_eq!(program.cpu.mode(), Some(Mode::Supervisor));
    assert_eq!(program.register(15), 0);
    assert_eq!(program.register(14), START);
    assert_eq!(program.cpu.spsr(), Some(before));
}

#[test]
fn a_software_interrupt_returns_behind_itself() {
    let mut program = Program::arm(&[0xEF00_0005]).in_mode(Mode::User);
    enter(&mut program, Exception::SoftwareInterrupt);
    assert_eq!(program.register(14), START + 4);
    let mut program = Program::thumb(&[0xDF05]).in_mode(Mode::System);
    enter(&mut program, Exception::SoftwareInterrupt);
    assert_eq!(program.register(14), START + 2);
}

#[test]
fn a_software_interrupt_leaves_the_fast_interrupt_mask_alone() {
    let mut program = Program::arm(&[0xEF00_0005]);
    program.cpu.set_cpsr(Mode::User.bits());
    enter(&mut program, Exception::SoftwareInterrupt);
    assert_eq!(program.cpu.cpsr() & psr::F, 0);
}

#[test]
fn encodings_without_meaning_and_coprocessor_instructions_are_undefined() {
    for opcode in [
        0xE600_0010, // the undefined instruction of the manual
        0xEE00_0F10, // mcr p15
        0xEE10_0F10, // mrc p15
        0xEE00_0000, // cdp
        0xED90_0000, // ldc
        0xE12F_FF31, // blx of later architectures
        0xE16F_0F11, // clz of later architectures
        0xE1C4_00D0, // ldrd of later architectures
    ] {
        let mut program = Program::arm(&[opcode]);
        enter(&mut program, Exception::UndefinedInstruction);
        assert_eq!(program.register(14), START + 4, "{opcode:#X}");
    }
    for opcode in [0xDE00, 0xE800, 0xB600, 0xBE00] {
        let mut program = Program::thumb(&[opcode]);
        enter(&mut program, Exception::UndefinedInstruction);
        assert_eq!(program.register(14), START + 2, "{opcode:#X}");
    }
}

#[test]
fn an_aborted_load_keeps_its_destination_and_writes_its_base_back() {
    let mut program = Program::arm(&[0xE494_0004]).with(4, NOWHERE).with(0, 5);
    enter(&mut program, Exception::DataAbort); // ldr r0, [r4], #4
    assert_eq!(program.register(14), START + 8);
    assert_eq!(program.register(0), 5);
    assert_eq!(program.register(4), NOWHERE + 4);
    assert_eq!(program.memory.cycles, 3 + 3);
}

#[test]
fn an_aborted_store_in_thumb_state_returns_8_bytes_behind_itself() {
    let mut program = Program::thumb(&[0x6020]).with(4, NOWHERE);
    enter(&mut program, Exception::DataAbort);
    assert_eq!(program.register(14), START + 8);
    assert_eq!(program.memory.cycles, 2 + 3);
}

#[test]
fn an_aborted_multiple_load_stops_writing_and_restores_its_base() {
    let last_word = 0xFFFC;
    let mut program = Program::arm(&[0xE8B4_003A]).with_words(last_word, &[7]);
    program = program.with(4, last_word).with(3, 33).with(5, 55);
    enter(&mut program, Exception::DataAbort); // ldmia r4!, {r1, r3, r4, r5}
    assert_eq!(program.register(1), 7);
    assert_eq!(program.register(3), 33);
    assert_eq!(program.register(4), last_word + 16);
    assert_eq!(program.register(5), 55);
}

/// ARM7TDMI data sheet, 4.11.8: the base is restored even when the list has loaded it already.
#[test]
fn an_aborted_multiple_load_restores_a_base_that_it_has_loaded() {
    let last_word = 0xFFFC;
    for (opcode, base) in [(0xE8B4_0030, last_word + 8), (0xE894_0030, last_word)] {
        let mut program = Program::arm(&[opcode]).with_words(last_word, &[7]);
        program = program.with(4, last_word).with(5, 55);
        enter(&mut program, Exception::DataAbort); // ldmia r4, {r4, r5}, with and without r4!
        assert_eq!(program.register(4), base, "{opcode:#X}");
        assert_eq!(program.register(5), 55);
    }
}

#[test]
fn an_aborted_swap_writes_nothing() {
    let mut program = Program::arm(&[0xE104_0091]).with(4, NOWHERE).with(0, 5);
    enter(&mut program, Exception::DataAbort);
    assert_eq!(program.register(0), 5);
}

#[test]
fn an_aborted_fetch_is_an_exception_only_when_its_opcode_would_execute() {
    // The program jumps away from the last word of memory, with two aborted fetches behind it.
    let last_word = 0xFFFC;
    let memory = Memory::with_arm(last_word, &[0xE1A0_F004]); // mov pc, r4
    let mut cpu = Cpu::new();
    cpu.set_register(4, START);
    cpu.set_pc(last_word);
    let mut program = Program { cpu, memory };
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START + 4);
}

#[test]
fn an_aborted_opcode_that_would_execute_enters_abort_mode() {
    let mut program = Program::arm(&[0xE1A0_F004]).with(4, NOWHERE).after(1);
    enter(&mut program, Exception::PrefetchAbort);
    assert_eq!(program.register(14), NOWHERE + 4);
}

#[test]
fn an_abort_behind_a_good_opcode_waits_for_its_turn() {
    let last_word = 0xFFFC;
    let mut program = Program::arm(&[0xE1A0_F004]).with(4, last_word).after(1);
    assert_eq!(program.step(), Step::Instruction);
    enter(&mut program, Exception::PrefetchAbort);
    assert_eq!(program.register(14), last_word + 4 + 4);
}

#[test]
fn subs_pc_lr_returns_from_an_abort_to_the_same_instruction() {
    let handler = 0xE25E_F008; // subs pc, lr, #8
    let mut program = Program::arm(&[0xE594_0000]).with(4, NOWHERE);
    program = program.with_words(Exception::DataAbort.vector(), &[handler]);
    let before = program.cpu.cpsr();
    enter(&mut program, Exception::DataAbort);
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START);
    assert_eq!(program.cpu.cpsr(), before);
    let program = program.with(4, DATA).with_words(DATA, &[3]).after(1);
    assert_eq!(program.register(0), 3);
}
