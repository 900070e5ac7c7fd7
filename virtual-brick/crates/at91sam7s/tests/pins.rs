// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Parallel input/output controller against a board that drives pins.
use crate::common::{cold_chip, read, run_to, running_chip, write, Seen, TestChip, AIC, PIOA, PMC};
use arm7tdmi::bus::Bus;
use arm7tdmi::BlockBus;
use at91sam7s::board::{Board, PinLevels};

registers! {
    PIOA; PDR = 0x04, OER = 0x10, ODR = 0x14, IFER = 0x20, SODR = 0x30, CODR = 0x34,
    ODSR = 0x38, PDSR = 0x3C, IER = 0x40, ISR = 0x4C, MDER = 0x50, PPUDR = 0x60, PPUER = 0x64,
    PUSR = 0x68, BSR = 0x74, ABSR = 0x78, OWER = 0xA0,
}

fn drive(chip: &mut TestChip, driven: u32, level: u32) {
    chip.board_mut().levels = PinLevels { driven, level };
    chip.internal(1);
}

#[test]
fn after_power_on_every_pin_is_an_input_pulled_up() {
    let mut chip = running_chip();
    assert_eq!(read(&mut chip, ISR), 0);
    assert_eq!(read(&mut chip, PDSR), 0xFFFF_FFFF);
    assert_eq!(
        read(&mut chip, PUSR),
        0,
        "a set bit means that the pull-up is off"
    );
    let mut cold = cold_chip();
    let outputs: Vec<_> = cold.board_mut().log.clone();
    assert_eq!(
        outputs,
        [(
            0,
            Seen::Pins {
                driven: 0,
                level: 0
            }
        )]
    );
}

#[test]
fn an_output_reaches_the_board_at_the_cycle_of_the_store() {
    let mut chip = running_chip();
    write(&mut chip, SODR, 1 << 12);
    assert!(chip.board().log.is_empty(), "not an output yet");
    write(&mut chip, OER, 1 << 12);
    let high = chip.now();
    write(&mut chip, CODR, 1 << 12);
    let low = chip.now();
    write(&mut chip, ODR, 1 << 12);
    let pins = |driven, level| Seen::Pins { driven, level };
    assert_eq!(
        chip.board().log,
        [
            (high, pins(1 << 12, 1 << 12)),
            (low, pins(1 << 12, 0)),
            (chip.now(), pins(0, 0))
        ]
    );
}

#[test]
fn an_open_drain_pin_is_the_wired_and_of_chip_and_board() {
    let mut chip = running_chip();
    let pins = 3 << 3;
    drive(&mut chip, pins, pins);
    write(&mut chip, MDER, pins);
    write(&mut chip, SODR, pins);
    write(&mut chip, OER, pins);
    assert_eq!(read(&mut chip, PDSR) & pins, pins);
    drive(&mut chip, pins, 1 << 4);
    assert_eq!(
        read(&mut chip, PDSR) & pins,
        1 << 4,
        "the board pulls PA3 low"
    );
    write(&mut chip, CODR, 1 << 4);
    assert_eq!(read(&mut chip, PDSR) & pins, 0, "the chip pulls PA4 low");
}

#[test]
fn a_pin_without_driver_and_pull_up_keeps_its_level() {
    let mut chip = running_chip();
    write(&mut chip, PPUDR, 1 << 26);
    drive(&mut chip, 1 << 26, 0);
    drive(&mut chip, 0, 0);
    assert_eq!(read(&mut chip, PDSR) & 1 << 26, 0);
    write(&mut chip, PPUER, 1 << 26);
    assert_eq!(read(&mut chip, PDSR) & 1 << 26, 1 << 26);
}

#[test]
fn the_output_register_is_writable_only_where_enabled() {
    let mut chip = running_chip();
    write(&mut chip, OWER, 0xF0);
    write(&mut chip, ODSR, 0xFFFF);
    assert_eq!(read(&mut chip, ODSR), 0xF0);
}

#[test]
fn a_pin_given_to_a_peripheral_is_no_longer_driven_by_the_output_register() {
    let mut chip = running_chip();
    write(&mut chip, OER, 1 << 10);
    write(&mut chip, BSR, 1 << 10);
    assert_eq!(read(&mut chip, ABSR), 1 << 10);
    chip.board_mut().log.clear();
    write(&mut chip, PDR, 1 << 10);
    assert_eq!(
        chip.board().log,
        [(
            chip.now(),
            Seen::Pins {
                driven: 0,
                level: 0
            }
        )]
    );
}

#[test]
fn both_edges_set_the_status_which_clears_on_reading() {
    let mut chip = running_chip();
    write(&mut chip, IER, 1 << 15);
    drive(&mut chip, 1 << 15, 1 << 15);
    let _ = read(&mut chip, ISR);
    drive(&mut chip, 1 << 15, 0);
    assert_eq!(read(&mut chip, ISR), 1 << 15);
    assert_eq!(read(&mut chip, ISR), 0);
    drive(&mut chip, 1 << 15, 1 << 15);
    assert_eq!(read(&mut chip, ISR), 1 << 15);
}

/// Cycles from an edge on PA26 at an exact cycle to nIRQ as the core sees it.
fn edge_latency(filtered: bool) -> u64 {
    let mut chip = running_chip();
    write(&mut chip, AIC + 0x120, 1 << 2);
    write(&mut chip, IER, 1 << 26);
    if filtered {
        write(&mut chip, IFER, 1 << 26);
    }
    drive(&mut chip, 1 << 26, 0);
    let _ = read(&mut chip, ISR);
    let edge = chip.now() + 500;
    let high = PinLevels {
        driven: 1 << 26,
        level: 1 << 26,
    };
    chip.board_mut().pins = [(edge, high)].into();
    run_to(&mut chip, edge - 1);
    assert!(!chip.irq());
    while !chip.irq() {
        chip.internal(1);
        assert!(chip.now() < edge + 50);
    }
    chip.now() - edge
}

#[test]
fn a_pin_edge_interrupts_after_the_input_stage_and_the_controller() {
    assert_eq!(edge_latency(false), 1 + 3 + 3);
    assert_eq!(edge_latency(true), 1 + 1 + 3 + 3);
}

#[test]
fn edges_of_several_pins_are_all_seen_at_their_cycles() {
    let mut chip = running_chip();
    let pins = 1 << 0 | 1 << 15 | 1 << 26;
    drive(&mut chip, pins, 0);
    let _ = read(&mut chip, ISR);
    let start = chip.now() + 10;
    let level = |level| PinLevels {
        driven: pins,
        level,
    };
    chip.board_mut().pins = [
        (start, level(1)),
        (start + 1, level(1 | 1 << 15)),
        (start + 9, level(1 << 26)),
    ]
    .into();
    run_to(&mut chip, start + 3);
    assert_eq!(read(&mut chip, PDSR) & pins, 1 | 1 << 15);
    run_to(&mut chip, start + 20);
    assert_eq!(read(&mut chip, ISR) & pins, pins);
    assert_eq!(read(&mut chip, PDSR) & pins, 1 << 26);
    assert_eq!(chip.board().next_event(), u64::MAX);
}

#[test]
fn without_its_clock_the_controller_does_not_see_pins() {
    let mut chip = running_chip();
    write(&mut chip, PMC + 0x14, 1 << 2);
    let _ = read(&mut chip, ISR);
    drive(&mut chip, 1 << 20, 0);
    assert_eq!(read(&mut chip, PDSR) & 1 << 20, 1 << 20);
    assert_eq!(read(&mut chip, ISR), 0);
    write(&mut chip, PMC + 0x10, 1 << 2);
    assert_eq!(read(&mut chip, PDSR) & 1 << 20, 0);
    assert_eq!(read(&mut chip, ISR), 0, "starting the clock is not an edge");
}

#[test]
fn levels_are_written_amid_a_block_only_where_nothing_follows_the_pin() {
    // Pin, pins that the board follows, pins with an interrupt, and whether it is written.
    let cases = [
        (5, 0, 0, true),
        (5, 1 << 6, 1 << 6, true),
        (5, 1 << 5, 0, false),
        (5, 0, 1 << 5, false),
        (0, 0, 0, false),  // TIOA0
        (8, 0, 0, false),  // CTS0
        (19, 0, 0, false), // FIQ
    ];
    for (pin, followed, interrupts, written) in cases {
        let mut chip = running_chip();
        write(&mut chip, CODR, 1 << pin);
        write(&mut chip, OER, 1 << pin);
        write(&mut chip, IER, interrupts);
        read(&mut chip, ISR);
        chip.board_mut().log.clear();
        chip.board_mut().followed = Some(followed);
        let before = chip.now();
        assert_eq!(chip.register_write(SODR, 1 << pin, 7), written, "{pin}");
        let (driven, level) = (1 << pin, 1 << pin);
        let at = before + 7 + u64::from(chip.register_cycles());
        let seen = written.then_some((at, Seen::Pins { driven, level }));
        assert_eq!(chip.board().log, Vec::from_iter(seen));
        assert_eq!(chip.now(), before);
        let level = u32::from(written) << pin;
        assert_eq!(read(&mut chip, PDSR) & 1 << pin, level, "{pin}");
        assert_eq!(read(&mut chip, ISR) & 1 << pin, level, "{pin}");
    }
}

#[test]
fn amid_a_block_a_level_is_read_back_and_an_input_keeps_its_own() {
    let mut chip = running_chip();
    chip.board_mut().followed = Some(0);
    write(&mut chip, CODR, 3 << 5);
    write(&mut chip, OER, 1 << 5);
    drive(&mut chip, 1 << 6, 0);
    assert!(chip.register_write(SODR, 3 << 5, 1));
    let seen = chip
        .register_read(PDSR, 2)
        .map(|(levels, _)| levels & 3 << 5);
    assert_eq!(seen, Some(1 << 5));
    let (driven, level) = (1 << 5, 1 << 5);
    let last = chip.board().log.last().map(|entry| entry.1.clone());
    assert_eq!(last, Some(Seen::Pins { driven, level }));
}

#[test]
fn amid_a_block_a_line_that_others_drive_too_is_not_written() {
    let mut chip = running_chip();
    chip.board_mut().followed = Some(0);
    write(&mut chip, OER, 1 << 5);
    write(&mut chip, MDER, 1 << 5);
    assert!(!chip.register_write(SODR, 1 << 5, 1));
}
