// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Advanced interrupt controller and the path to the core.
use crate::common::{chip_events, read, run_to, running_chip, write, TestChip, AIC, PIT, TC0, TWI};
use arm7tdmi::bus::Bus;
use at91sam7s::board::{ChipEvent, PinLevels};

registers! {
    AIC; IVR = 0x100, FVR = 0x104, ISR = 0x108, IPR = 0x10C, CISR = 0x114, IECR = 0x120,
    IDCR = 0x124, ICCR = 0x128, ISCR = 0x12C, EOICR = 0x130, SPU = 0x134, DCR = 0x138,
}
const EDGE: u32 = 1 << 5;

/// Enable a source with vector 0x1000 + source.
fn enable(chip: &mut TestChip, source: u32, mode: u32) {
    write(chip, AIC + 4 * source, mode);
    write(chip, AIC + 0x80 + 4 * source, 0x1000 + source);
    write(chip, IECR, 1 << source);
}

/// Raise an edge source by software and wait until the core sees nIRQ.
fn raise(chip: &mut TestChip, source: u32) {
    write(chip, ISCR, 1 << source);
    chip.internal(8);
}

/// A PIT interrupt due exactly at the returned cycle.
fn arm_interval_timer(chip: &mut TestChip) -> u64 {
    write(chip, PIT, 0x0300_0000 | 9);
    chip.now() + 160
}

fn first_seen(chip: &mut TestChip, event: u64) -> u64 {
    run_to(chip, event - 1);
    while !chip.irq() {
        chip.internal(1);
        assert!(chip.now() < event + 100);
    }
    chip.now() - event
}

#[test]
fn an_internal_level_source_reaches_the_core_after_three_plus_three_cycles() {
    let mut chip = running_chip();
    enable(&mut chip, 1, 0);
    let event = arm_interval_timer(&mut chip);
    assert_eq!(first_seen(&mut chip, event), 6);
}

#[test]
fn an_internal_edge_source_reaches_the_core_after_four_plus_three_cycles() {
    let mut chip = running_chip();
    enable(&mut chip, 1, EDGE);
    let event = arm_interval_timer(&mut chip);
    assert_eq!(first_seen(&mut chip, event), 7);
}

#[test]
fn an_edge_source_enabled_by_a_store_is_taken_after_the_next_instructions() {
    let mut chip = running_chip();
    enable(&mut chip, 9, EDGE | 7);
    write(&mut chip, TWI, 4);
    write(&mut chip, TWI + 0x24, 0x104);
    let stored = chip.now();
    while !chip.irq() {
        chip.internal(1);
    }
    assert_eq!(chip.now() - stored, 7);
}

#[test]
fn a_higher_priority_is_served_first_then_the_lower_source_number() {
    let mut chip = running_chip();
    enable(&mut chip, 20, EDGE | 3);
    enable(&mut chip, 21, EDGE | 5);
    enable(&mut chip, 22, EDGE | 5);
    write(&mut chip, ISCR, 7 << 20);
    chip.internal(8);
    assert_eq!(read(&mut chip, IPR) & 7 << 20, 7 << 20);
    for source in [21, 22, 20] {
        assert_eq!(read(&mut chip, IVR), 0x1000 + source);
        assert_eq!(read(&mut chip, ISR), source);
        write(&mut chip, EOICR, 0);
    }
    assert_eq!(read(&mut chip, ISR), 0);
}

#[test]
fn only_a_strictly_higher_priority_interrupts_a_handler() {
    let mut chip = running_chip();
    for (source, priority) in [(20, 2), (21, 2), (22, 3)] {
        enable(&mut chip, source, EDGE | priority);
    }
    raise(&mut chip, 20);
    assert!(chip.irq());
    assert_eq!(read(&mut chip, IVR), 0x1000 + 20);
    raise(&mut chip, 21);
    assert!(!chip.irq(), "equal priority waits");
    raise(&mut chip, 22);
    assert!(chip.irq(), "higher priority nests");
    assert_eq!(read(&mut chip, IVR), 0x1000 + 22);
    assert!(!chip.irq());
    write(&mut chip, EOICR, 0);
    assert_eq!(read(&mut chip, ISR), 20);
    chip.internal(4);
    assert!(!chip.irq());
    write(&mut chip, EOICR, 0);
    chip.internal(4);
    assert!(
        chip.irq(),
        "the waiting source comes when the level is free"
    );
    assert_eq!(read(&mut chip, IVR), 0x1000 + 21);
}

#[test]
fn eight_levels_nest() {
    let mut chip = running_chip();
    for level in 0..8 {
        enable(&mut chip, 20 + level, EDGE | level);
        raise(&mut chip, 20 + level);
        assert!(chip.irq(), "level {level}");
        assert_eq!(read(&mut chip, IVR), 0x1000 + 20 + level);
    }
    for level in (0..8).rev() {
        assert_eq!(read(&mut chip, ISR), 20 + level);
        write(&mut chip, EOICR, 0);
    }
    assert_eq!(read(&mut chip, ISR), 0);
}

#[test]
fn in_protect_mode_reading_the_vector_changes_nothing_and_writing_it_takes_the_interrupt() {
    let mut chip = running_chip();
    write(&mut chip, DCR, 1);
    enable(&mut chip, 20, EDGE | 4);
    raise(&mut chip, 20);
    assert_eq!(read(&mut chip, IVR), 0x1000 + 20);
    assert_eq!(read(&mut chip, IVR), 0x1000 + 20);
    assert!(chip.irq());
    assert_eq!(read(&mut chip, ISR), 0);
    assert!(chip_events(&chip).is_empty());
    write(&mut chip, IVR, 0);
    let entered = chip.now();
    assert!(!chip.irq());
    assert_eq!(read(&mut chip, ISR), 20);
    assert_eq!(read(&mut chip, IPR) & 1 << 20, 0);
    write(&mut chip, EOICR, 0);
    let left = chip.now();
    assert_eq!(
        chip_events(&chip),
        [
            (entered, ChipEvent::InterruptEntered { source: 20 }),
            (left, ChipEvent::InterruptLeft)
        ]
    );
}

#[test]
fn the_interrupt_taken_in_protect_mode_is_the_one_whose_vector_was_read() {
    let mut chip = running_chip();
    write(&mut chip, DCR, 1);
    enable(&mut chip, 20, EDGE | 1);
    enable(&mut chip, 21, EDGE | 6);
    raise(&mut chip, 20);
    assert_eq!(read(&mut chip, IVR), 0x1000 + 20);
    raise(&mut chip, 21);
    write(&mut chip, IVR, 0);
    assert_eq!(read(&mut chip, ISR), 20);
    chip.internal(4);
    assert!(chip.irq(), "the higher source nests at once");
    assert_eq!(read(&mut chip, IVR), 0x1000 + 21);
}

#[test]
fn a_vector_read_without_a_pending_source_is_spurious() {
    let mut chip = running_chip();
    write(&mut chip, SPU, 0x5555);
    enable(&mut chip, 20, EDGE | 1);
    assert_eq!(read(&mut chip, IVR), 0x5555);
    write(&mut chip, EOICR, 0);
    raise(&mut chip, 20);
    assert_eq!(
        read(&mut chip, IVR),
        0x1000 + 20,
        "the stack is balanced again"
    );
    let entered = ChipEvent::InterruptEntered { source: 20 };
    assert_eq!(chip_events(&chip), [(chip.now(), entered)]);
}

#[test]
fn a_level_source_stays_pending_until_its_cause_is_gone() {
    let mut chip = running_chip();
    enable(&mut chip, 1, 3);
    let event = arm_interval_timer(&mut chip);
    run_to(&mut chip, event + 8);
    assert_eq!(read(&mut chip, IVR), 0x1001);
    write(&mut chip, EOICR, 0);
    chip.internal(4);
    assert!(chip.irq(), "not acknowledged at its source");
    assert_eq!(read(&mut chip, PIT + 8) >> 20, 1);
    assert!(!chip.irq());
}

/// AT91SAM7S datasheet (6175M), peripheral identifiers and multiplexing of the pins: FIQ is PA19
/// and source 0, IRQ0 is PA20 and source 30, IRQ1 is PA30 and source 31.
#[test]
fn each_external_interrupt_has_its_pin_and_its_source() {
    const RISING: u32 = 3 << 5;
    let external = 1 << 0 | 1 << 30 | 1 << 31;
    let mut chip = running_chip();
    for source in [0, 30, 31] {
        enable(&mut chip, source, RISING);
    }
    write(&mut chip, ICCR, external);
    for pin in 0..32 {
        for level in [0, u32::MAX] {
            let driven = 1 << pin;
            chip.board_mut().levels = PinLevels { driven, level };
            chip.internal(10);
        }
        let expected = match pin {
            19 => 1 << 0,
            20 => 1 << 30,
            30 => 1 << 31,
            _ => 0,
        };
        assert_eq!(read(&mut chip, IPR) & external, expected, "PA{pin}");
        write(&mut chip, ICCR, external);
    }
}

#[test]
fn software_sets_and_clears_edge_sources_only() {
    let mut chip = running_chip();
    enable(&mut chip, 20, EDGE);
    enable(&mut chip, 21, 0);
    enable(&mut chip, 22, EDGE);
    write(&mut chip, ISCR, 3 << 20);
    chip.internal(8);
    assert_eq!(read(&mut chip, IPR) & 7 << 20, 1 << 20);
    assert_eq!(read(&mut chip, CISR), 2);
    write(&mut chip, ICCR, 1 << 20);
    assert!(!chip.irq());
    assert_eq!(read(&mut chip, CISR), 0);
}

#[test]
fn a_line_that_is_active_when_its_source_becomes_edge_triggered_is_an_edge_once() {
    let mut chip = running_chip();
    let due = arm_interval_timer(&mut chip);
    run_to(&mut chip, due + 10);
    enable(&mut chip, 1, EDGE);
    chip.internal(8);
    assert_eq!(read(&mut chip, IPR), 1 << 1);
    write(&mut chip, ICCR, 1 << 1);
    write(&mut chip, AIC + 4, EDGE | 3);
    chip.internal(8);
    assert_eq!(read(&mut chip, IPR), 0, "another priority is no edge");
}

#[test]
fn a_disabled_source_is_remembered_and_comes_when_it_is_enabled() {
    let mut chip = running_chip();
    enable(&mut chip, 20, EDGE);
    write(&mut chip, IDCR, 1 << 20);
    raise(&mut chip, 20);
    assert!(!chip.irq());
    write(&mut chip, IECR, 1 << 20);
    let enabled = chip.now();
    while !chip.irq() {
        chip.internal(1);
    }
    assert_eq!(chip.now() - enabled, 3);
}

#[test]
fn the_general_mask_hides_interrupts_from_the_core() {
    let mut chip = running_chip();
    enable(&mut chip, 20, EDGE);
    write(&mut chip, DCR, 2);
    raise(&mut chip, 20);
    assert!(!chip.irq());
    write(&mut chip, DCR, 0);
    chip.internal(3);
    assert!(chip.irq());
}

#[test]
fn a_fast_forced_source_asserts_the_fast_interrupt() {
    let mut chip = running_chip();
    write(&mut chip, AIC + 0x80, 0x2000);
    enable(&mut chip, 12, 5);
    write(&mut chip, AIC + 0x140, 1 << 12);
    assert_eq!(read(&mut chip, AIC + 0x148), 1 << 12);
    write(&mut chip, TC0 + 4, 1 << 15);
    write(&mut chip, TC0 + 0x1C, 20);
    write(&mut chip, TC0 + 0x24, 1 << 4);
    write(&mut chip, TC0, 5);
    chip.internal(100);
    assert!(chip.fiq());
    assert!(!chip.irq());
    assert_eq!(read(&mut chip, FVR), 0x2000);
    write(&mut chip, AIC + 0x144, 1 << 12);
    assert!(!chip.fiq());
    chip.internal(3);
    assert!(chip.irq());
}
