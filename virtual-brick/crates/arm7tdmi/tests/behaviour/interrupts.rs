// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Interrupts: recognition, priority, masks, return.

use super::program::{Program, START};
use arm7tdmi::{psr, Cpu, Exception, Mode, Step, TimingProfile};

const NOP: u32 = 0xE1A0_8008;
const RETURN: u32 = 0xE25E_F004; // subs pc, lr, #4
const ENABLE: u32 = 0xE321_F01F; // msr cpsr_c, #0x1F: system mode, interrupts enabled
const DISABLE: u32 = 0xE321_F0DF; // msr cpsr_c, #0xDF: system mode, interrupts disabled
const IRQ: Step = Step::Exception(Exception::Irq);
const FIQ: Step = Step::Exception(Exception::Fiq);

/// System mode with interrupts enabled or disabled and a handler that returns at once.
fn program(opcodes: &[u32], masks: u32) -> Program {
    let mut program = Program::arm(opcodes).with_words(Exception::Irq.vector(), &[RETURN; 2]);
    program.cpu.set_cpsr(Mode::System.bits() | masks);
    program
}

#[test]
fn an_interrupt_takes_3_cycles_and_returns_to_the_next_instruction() {
    let mut program = program(&[NOP; 4], 0).after(1);
    program.memory.irq = true;
    program.memory.cycles = 0;
    assert_eq!(program.step(), IRQ);
    assert_eq!(program.memory.cycles, 3);
    assert_eq!(program.cpu.mode(), Some(Mode::Irq));
    assert_eq!(program.register(14), START + 4 + 4);
    assert_eq!(program.register(15), 0x18);
    program.memory.irq = false;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START + 4);
    assert_eq!(program.cpu.cpsr(), Mode::System.bits());
}

#[test]
fn an_interrupt_in_thumb_state_returns_with_the_same_instruction() {
    let mut program = Program::thumb(&[0x46C0; 4])
        .with_words(0x18, &[RETURN])
        .after(1);
    program.cpu.set_cpsr(psr::T | Mode::System.bits());
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    assert_eq!(program.register(14), START + 2 + 4);
    program.memory.irq = false;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START + 2);
    assert!(program.cpu.thumb());
}

#[test]
fn an_interrupt_can_land_between_the_halves_of_a_thumb_call() {
    let mut program = Program::thumb(&[0xF000, 0xF806]).with_words(0x18, &[RETURN]);
    program.cpu.set_cpsr(psr::T | Mode::System.bits());
    program = program.after(1);
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    program.memory.irq = false;
    let program = program.after(2);
    assert_eq!(program.register(15), START + 4 + 12);
    assert_eq!(program.register(14), (START + 4) | 1);
}

#[test]
fn masked_interrupts_wait() {
    let mut program = program(&[NOP; 4], psr::I | psr::F);
    program.memory.irq = true;
    program.memory.fiq = true;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START + 4);
}

#[test]
fn a_fast_interrupt_goes_first_and_disables_both() {
    let mut program = program(&[NOP; 4], 0);
    program.memory.irq = true;
    program.memory.fiq = true;
    assert_eq!(program.step(), FIQ);
    assert_eq!(program.cpu.cpsr(), psr::I | psr::F | Mode::Fiq.bits());
    assert_eq!(program.cpu.next_instruction_address(), 0x1C);
    assert_eq!(program.step(), Step::Instruction);
}

#[test]
fn a_fast_interrupt_is_taken_inside_an_interrupt_handler() {
    let mut program = program(&[NOP; 4], 0);
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    program.memory.fiq = true;
    assert_eq!(program.step(), FIQ);
    assert_eq!(program.register(14), 0x18 + 4);
}

#[test]
fn one_more_instruction_runs_after_msr_enables_interrupts() {
    let mut program = program(&[ENABLE, NOP, NOP], psr::I | psr::F);
    program.memory.irq = true;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), IRQ);
    assert_eq!(program.register(14), START + 8 + 4);
}

#[test]
fn an_interrupt_pending_while_msr_disables_it_is_still_taken_once() {
    let mut program = program(&[DISABLE, NOP, NOP], 0);
    assert_eq!(program.step(), Step::Instruction);
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    assert_eq!(
        program.cpu.spsr(),
        Some(psr::I | psr::F | Mode::System.bits())
    );
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.register(15), START + 8);
}

#[test]
fn without_the_delay_msr_acts_on_the_next_boundary() {
    let mut cpu = Cpu::with_profile(TimingProfile {
        mask_change_delayed: false,
        ..TimingProfile::default()
    });
    cpu.set_pc(START);
    let mut program = Program {
        cpu,
        ..program(&[ENABLE, NOP], 0)
    };
    program.memory.irq = true;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), IRQ);
}

#[test]
fn a_return_that_enables_interrupts_acts_on_the_next_boundary() {
    let mut program = program(&[NOP; 4], 0);
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), IRQ);
    assert_eq!(program.register(14), START + 4);
}

#[test]
fn interrupts_go_before_an_aborted_opcode() {
    let mut program = program(&[0xE1A0_F004], 0).with(4, 0x10_0000).after(1); // mov pc, r4
    program.memory.irq = true;
    assert_eq!(program.step(), IRQ);
    program.memory.irq = false;
    assert_eq!(program.step(), Step::Instruction);
    assert_eq!(program.step(), Step::Exception(Exception::PrefetchAbort));
    assert_eq!(program.register(14), 0x10_0000 + 4);
}
