// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The state of the core as its users read and write it.

use super::program::{Program, START};
use arm7tdmi::{psr, Cpu, Mode, TimingProfile};

#[test]
fn a_new_core_is_in_the_reset_state() {
    let cpu = Cpu::new();
    assert_eq!(cpu.mode(), Some(Mode::Supervisor));
    assert_eq!(cpu.cpsr(), psr::I | psr::F | 0x13);
    assert_eq!(cpu.registers(), [0; 16]);
    assert_eq!(cpu.profile(), TimingProfile::default());
    assert_eq!(cpu, Cpu::default());
}

#[test]
fn each_mode_has_its_own_stack_pointer_and_link_register() {
    let mut cpu = Cpu::new();
    let modes = [
        Mode::Fiq,
        Mode::Irq,
        Mode::Supervisor,
        Mode::Abort,
        Mode::Undefined,
        Mode::System,
    ];
    for (index, mode) in modes.into_iter().enumerate() {
        cpu.set_cpsr(mode.bits());
        cpu.set_register(13, 100 + index as u32);
        cpu.set_register(14, 200 + index as u32);
    }
    for (index, mode) in modes.into_iter().enumerate() {
        assert_eq!(cpu.banked_register(mode, 13), 100 + index as u32);
        cpu.set_cpsr(mode.bits());
        assert_eq!(cpu.register(14), 200 + index as u32);
    }
    assert_eq!(
        cpu.banked_register(Mode::User, 13),
        cpu.banked_register(Mode::System, 13)
    );
}

#[test]
fn fast_interrupt_mode_has_its_own_r8_to_r12() {
    let mut cpu = Cpu::new();
    cpu.set_register(8, 1);
    cpu.set_banked_register(Mode::Fiq, 8, 2);
    assert_eq!(cpu.register(8), 1);
    cpu.set_cpsr(Mode::Fiq.bits());
    assert_eq!(cpu.register(8), 2);
    assert_eq!(cpu.banked_register(Mode::User, 8), 1);
    cpu.set_register(7, 3);
    assert_eq!(cpu.banked_register(Mode::User, 7), 3);
}

#[test]
fn saved_status_registers_exist_in_exception_modes_only() {
    let mut cpu = Cpu::new();
    cpu.set_spsr_of(Mode::Irq, 0xFFFF_FFFF);
    assert_eq!(cpu.spsr_of(Mode::Irq), Some(psr::IMPLEMENTED));
    assert_eq!(cpu.spsr_of(Mode::System), None);
    assert_eq!(cpu.spsr(), Some(0));
    cpu.set_cpsr(Mode::User.bits());
    assert_eq!(cpu.spsr(), None);
}

#[test]
fn equal_states_reached_on_different_ways_compare_equal() {
    let mut visited = Cpu::new();
    for mode in [Mode::Fiq, Mode::Irq, Mode::User, Mode::Supervisor] {
        visited.set_cpsr(psr::I | psr::F | mode.bits());
    }
    assert_eq!(visited, Cpu::new());
}

#[test]
fn r15_reads_as_the_address_of_the_next_instruction() {
    let program = Program::arm(&[0xE1A0_8008]);
    assert_eq!(program.register(15), START);
    let program = program.after(1);
    assert_eq!(program.register(15), START + 4);
    assert_eq!(program.cpu.registers()[15], START + 4);
    assert_eq!(Program::thumb(&[0x46C0]).after(1).register(15), START + 2);
}

#[test]
fn changing_the_state_bit_from_outside_keeps_the_next_address() {
    let mut cpu = Cpu::new();
    cpu.set_register(15, 0x200);
    cpu.set_cpsr(cpu.cpsr() | psr::T);
    assert_eq!(cpu.next_instruction_address(), 0x200);
    cpu.set_pc(0x203);
    assert_eq!(cpu.next_instruction_address(), 0x202);
}

#[test]
fn a_clone_continues_exactly_as_the_original() {
    let program = Program::arm(&[0xE281_1001, 0xEAFF_FFFD]).after(3); // add r1; b back
    let mut copy = program.cpu.clone();
    let mut memory = crate::support::memory::Memory::with_arm(START, &[0xE281_1001, 0xEAFF_FFFD]);
    let original = program.after(5);
    for _ in 0..5 {
        let _ = copy.step(&mut memory);
    }
    assert_eq!(copy, original.cpu);
}
