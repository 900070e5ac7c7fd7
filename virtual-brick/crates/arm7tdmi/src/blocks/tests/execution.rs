// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What one run of blocks executes, and where it stops.

use super::machine::{
    assert_as_reference, branch, program, run_until, CLOCK, CONSTANT, DEVICE, LATCH, NOP, START,
};
use crate::blocks::Blocks;
use crate::instruction::ALWAYS;
use crate::psr;

const COUNT: u32 = 0xE282_2001; // add r2, r2, #1

#[test]
fn only_the_part_of_a_block_that_ends_before_the_event_runs() {
    let opcodes = [
        COUNT,
        COUNT,
        COUNT,
        COUNT,
        branch(ALWAYS, START + 16, START),
    ];
    let (mut cpu, mut machine) = program(&opcodes);
    machine.event = machine.now + 3;
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
    assert!(run.ran);
    assert_eq!((cpu.register(2), machine.now), (3, machine.event));
    assert_as_reference(&opcodes, &cpu, &machine);
}

#[test]
fn an_idle_loop_passes_in_whole_iterations() {
    let opcodes = [branch(ALWAYS, START, START)];
    let (mut cpu, mut machine) = program(&opcodes);
    machine.event = machine.now + 3_000_001;
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
    // With interrupts masked, the reference engine sees that the program has ended.
    assert!(!run.ran);
    cpu.set_cpsr(0x1F);
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
    assert!(run.branched_to_itself);
    assert!(machine.event - machine.now < 3);
}

#[test]
fn a_loop_that_polls_a_register_passes_at_once_only_if_it_reads_the_same() {
    let opcodes = [
        0xE591_0000,                 // ldr r0, [r1]
        0xE150_0003,                 // cmp r0, r3
        branch(3, START + 8, START), // blo
        COUNT,
        branch(ALWAYS, START + 16, START),
    ];
    for (register, polls) in [(CLOCK, 1_000..2_000), (CONSTANT, 1..4)] {
        let (mut cpu, mut machine) = program(&opcodes);
        cpu.set_register(1, register);
        cpu.set_register(3, 9_000);
        machine.event = machine.now + 10_000;
        let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
        assert_eq!(run.accessed, None);
        assert!(polls.contains(&machine.polls.get()), "{:?}", machine.polls);
        assert!(machine.event - machine.now < 10);
        let (mut reference, mut bus) = program(&opcodes);
        reference.set_register(1, register);
        reference.set_register(3, 9_000);
        while bus.now < machine.now {
            reference.step(&mut bus);
        }
        assert_eq!((&reference, bus.now), (&cpu, machine.now));
    }
}

#[test]
fn a_block_goes_on_behind_a_write_of_a_register_that_moves_no_event() {
    let opcodes = [
        COUNT,
        0xE481_2000, // str r2, [r1], #0
        COUNT,
        branch(ALWAYS, START + 12, START),
    ];
    let (mut cpu, mut machine) = program(&opcodes);
    cpu.set_register(1, LATCH);
    machine.event = machine.now + 12;
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
    let (mut reference, mut bus) = program(&opcodes);
    reference.set_register(1, LATCH);
    while bus.now < machine.now {
        reference.step(&mut bus);
    }
    assert_eq!((run.accessed, cpu.register(2)), (None, 4));
    assert_eq!((&reference, bus.now), (&cpu, machine.now));
    assert_eq!((bus.latched, bus.latched.0), (machine.latched, 3));
}

#[test]
fn the_bus_knows_the_time_of_an_access_that_it_makes() {
    let opcodes = [COUNT, 0xE591_0000, COUNT, branch(ALWAYS, START + 12, START)]; // ldr r0, [r1]
    let (mut cpu, mut machine) = program(&opcodes);
    cpu.set_register(1, DEVICE);
    let start = machine.now;
    let limit = start + 5;
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), limit, 1);
    assert_eq!(u64::from(cpu.register(0)), start + 3);
    assert_eq!(run.accessed, None, "the block behind the access ran, too");
    assert_eq!(cpu.register(2), 2);
}

#[test]
fn an_access_that_brings_an_event_near_ends_the_run() {
    let opcodes = [0xE581_0000, COUNT, NOP, branch(ALWAYS, START + 12, START)]; // str r0, [r1]
    let (mut cpu, mut machine) = program(&opcodes);
    cpu.set_register(1, DEVICE);
    cpu.set_register(0, machine.now as u32);
    let run = cpu.run_blocks(&mut machine, &mut Blocks::default(), u64::MAX, 1);
    assert_eq!((run.accessed, cpu.register(2)), (Some(START), 0));
}

#[test]
fn a_block_goes_on_behind_an_access_unless_something_is_due_in_its_rest() {
    for event in 1..=255 {
        let opcodes = [
            0xE3A0_1A01,         // mov r1, #0x1000
            0xE3A0_0000 | event, // mov r0, #event
            0xE581_0000,         // str r0, [r1]
            COUNT,
            0xE591_3000, // ldr r3, [r1]
            COUNT,
            branch(ALWAYS, START + 24, START),
        ];
        let (mut cpu, mut machine) = program(&opcodes);
        let (stored, end) = (machine.now + 4, machine.now + 15);
        let mut blocks = Blocks::default();
        cpu.run_blocks(&mut machine, &mut blocks, end, 1);
        assert!(machine.now <= stored.max(event.into()), "event at {event}");
        assert_as_reference(&opcodes, &cpu, &machine);
        if u64::from(event) >= end {
            assert_eq!((cpu.register(2), blocks.blocks.len()), (2, 1));
        }
    }
}

#[test]
fn a_block_that_is_refused_again_and_again_is_rarely_tried() {
    let (mut cpu, mut machine) = program(&[0xEF00_0000]); // swi
    let mut blocks = Blocks::default();
    for _ in 0..4 {
        assert!(!cpu.run_blocks(&mut machine, &mut blocks, u64::MAX, 1).ran);
        assert_eq!(blocks.entries, blocks.blocks[0].refusals.into());
    }
    cpu.run_blocks(&mut machine, &mut blocks, u64::MAX, 1);
    assert_eq!(blocks.entries, 4);
}

#[test]
fn a_difference_in_the_program_counter_restores_the_status_only_if_it_sets_flags() {
    for (difference, flags) in [(0xE24E_F008, 0), (0xE25E_F008, 0xF)] {
        let opcodes = [
            0xE10F_0000, // mrs r0, cpsr
            0xE380_020F, // orr r0, r0, #0xF0000000
            0xE169_F000, // msr spsr_fc, r0
            0xE28F_E010, // add lr, pc, #16
            difference,  // sub or subs pc, lr, #8
            COUNT,
            COUNT,
        ];
        let (mut cpu, mut machine) = program(&opcodes);
        let before = cpu.cpsr();
        let end = machine.now + 20;
        run_until(&mut cpu, &mut machine, &mut Blocks::default(), end);
        assert_eq!(cpu.cpsr(), before | flags << 28);
        assert_eq!(cpu.register(2), 0, "both additions are jumped over");
        assert_as_reference(&opcodes, &cpu, &machine);
    }
}

#[test]
fn operands_and_addresses_from_the_program_counter_do_as_in_single_steps() {
    for opcode in [
        0xE28F_0004, // add r0, pc, #4
        0x028F_0004, // addeq r0, pc, #4
        0x01A0_000F, // moveq r0, pc
        0x11A0_000F, // movne r0, pc
        0xE51F_0008, // ldr r0, [pc, #-8]
        0xE79F_0001, // ldr r0, [pc, r1]
        0xE71F_0001, // ldr r0, [pc, -r1]
        0xE79F_0121, // ldr r0, [pc, r1, lsr #2]
        0xE49F_0004, // ldr r0, [pc], #4
        0xE5BF_0004, // ldr r0, [pc, #4]!
        0xE41F_0008, // ldr r0, [pc], #-8
    ] {
        let opcodes = [
            0xE3A0_1008, // mov r1, #8
            0xE131_0001, // teq r1, r1
            opcode,
            COUNT,
            COUNT,
            COUNT,
            branch(ALWAYS, START + 24, START),
        ];
        let (mut cpu, mut machine) = program(&opcodes);
        let end = machine.now + 60;
        run_until(&mut cpu, &mut machine, &mut Blocks::default(), end);
        assert!(
            cpu.register(2) > 3,
            "{opcode:#010X} does not leave the loop"
        );
        assert_as_reference(&opcodes, &cpu, &machine);
    }
}

#[test]
fn a_thumb_function_with_a_frame_returns_in_thumb_state() {
    let opcodes = [
        0xE3A0_DC09, // mov sp, #0x900
        0xE28F_E005, // add lr, pc, #5: the Thumb code below
        0xE12F_FF1E, // bx lr
        NOP,
        0xB506_3201, // adds r2, #1; push {r1, r2, lr}
        0x4804_B084, // sub sp, #16; ldr r0, [pc, #16]
        0xBD06_B004, // add sp, #16; pop {r1, r2, pc}
        NOP,
        NOP,
        NOP,
        0x1234_5678,
    ];
    let (mut cpu, mut machine) = program(&opcodes);
    let end = machine.now + 200;
    run_until(&mut cpu, &mut machine, &mut Blocks::default(), end);
    assert_eq!(cpu.register(0), 0x1234_5678);
    assert!(cpu.register(2) > 3 && cpu.cpsr() & psr::T != 0);
    assert_as_reference(&opcodes, &cpu, &machine);
}
