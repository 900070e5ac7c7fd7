// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip as the bus of a real core: vectored interrupts, idle processor.

use crate::common::{chip_events, running_chip, write, TestChip, AIC, MC, PIT, PMC, SRAM};
use arm7tdmi::Cpu;
use at91sam7s::board::ChipEvent;

const MAIN: u32 = 0x0020_2000;
const HANDLER: u32 = 0x0020_2100;
/// `LDR pc, [pc, #-0xF20]`: reads the vector of the interrupt controller.
const VECTOR: u32 = 0xE51F_FF20;
/// Clears the interval timer, counts in r6, ends the interrupt, returns.
const HANDLER_CODE: [u32; 4] = [0xE594_1000, 0xE286_6001, 0xE585_1000, 0xE25E_F004];
const BRANCH_TO_SELF: u32 = 0xEAFF_FFFE;
/// `STR r2, [r3]` then a branch back to it: stops the processor again and again.
const STOP_LOOP: [u32; 2] = [0xE583_2000, 0xEAFF_FFFD];
/// Supervisor mode, ARM state, FIQ masked, IRQ enabled.
const OPEN: u32 = 0x53;

/// A core in the given main loop, the interval timer interrupting every 1000 ticks.
fn machine(main: &[u32]) -> (Cpu, TestChip, u64) {
    let mut chip = running_chip();
    write(&mut chip, MC, 1);
    let bytes = |code: &[u32]| {
        code.iter()
            .flat_map(|w| w.to_le_bytes())
            .collect::<Vec<_>>()
    };
    chip.load(SRAM + 0x18, &bytes(&[VECTOR])).unwrap();
    chip.load(HANDLER, &bytes(&HANDLER_CODE)).unwrap();
    chip.load(MAIN, &bytes(main)).unwrap();
    let mut cpu = Cpu::new();
    cpu.set_pc(MAIN);
    cpu.set_cpsr(OPEN);
    for (number, value) in [(2, 1), (3, PMC + 4), (4, PIT + 8), (5, AIC + 0x130)] {
        cpu.set_register(number, value);
    }
    write(&mut chip, AIC + 4, 1 << 5 | 3);
    write(&mut chip, AIC + 0x84, HANDLER);
    write(&mut chip, AIC + 0x120, 1 << 1);
    write(&mut chip, PIT, 0x0300_0000 | 999);
    let epoch = chip.now();
    (cpu, chip, epoch)
}

fn run(cpu: &mut Cpu, chip: &mut TestChip, until: u64) {
    while chip.now() < until {
        assert!(chip.fault().is_none());
        if chip.processor_stopped() {
            chip.skip_to_next_event(until);
        } else {
            cpu.step(chip);
        }
    }
}

/// Cycles from each end of period to the read of its vector.
fn latencies(chip: &TestChip, epoch: u64) -> Vec<u64> {
    let entered = chip_events(chip)
        .into_iter()
        .filter_map(|(at, event)| match event {
            ChipEvent::InterruptEntered { source: 1 } => Some(at - epoch),
            _ => None,
        });
    entered
        .enumerate()
        .map(|(n, at)| at - 16_000 * (n as u64 + 1))
        .collect()
}

#[test]
fn every_period_reaches_its_handler_within_one_branch_of_the_same_latency() {
    let (mut cpu, mut chip, epoch) = machine(&[BRANCH_TO_SELF]);
    run(&mut cpu, &mut chip, epoch + 100 * 16_000 + 100);
    assert_eq!(cpu.register(6), 100);
    // Controller 4, synchroniser 3, rest of a branch up to 2, entry 3, opcode 1, vector 2.
    let latencies = latencies(&chip, epoch);
    assert_eq!(latencies.len(), 100);
    assert!(
        latencies.iter().all(|cycles| (13..=15).contains(cycles)),
        "{latencies:?}"
    );
}

#[test]
fn a_stopped_processor_has_one_latency_for_all_periods() {
    let (mut cpu, mut chip, epoch) = machine(&STOP_LOOP);
    run(&mut cpu, &mut chip, epoch + 100 * 16_000 + 100);
    assert_eq!(cpu.register(6), 100);
    let latencies = latencies(&chip, epoch);
    assert_eq!(latencies.len(), 100);
    assert!(
        latencies.iter().all(|cycles| *cycles == latencies[0]),
        "{latencies:?}"
    );
    let stops = chip_events(&chip);
    let stopped = |(_, event): &&(u64, ChipEvent)| *event == ChipEvent::ProcessorStopped;
    assert!(stops.iter().filter(stopped).count() >= 100);
}
