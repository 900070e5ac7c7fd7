// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Analogue to digital converter.
use crate::common::{
    read, run_to, running_chip, try_write, wait_for, write, TestChip, ADC, AIC, TC0,
};
use arm7tdmi::bus::Width;

registers! {
    ADC; CR = 0x00, MR = 0x04, CHER = 0x10, SR = 0x1C, LCDR = 0x20, IER = 0x24, CDR = 0x30,
}
const DRDY: u32 = 1 << 16;
const GOVRE: u32 = 1 << 17;

/// 4.8 MHz converter clock, start-up 12, sample and hold 2; inputs 100, 101, ...
fn converter_chip(channels: u32) -> TestChip {
    let mut chip = running_chip();
    chip.board_mut().analogue = std::array::from_fn(|n| 100 + n as u16);
    write(&mut chip, MR, 0x020C_0400);
    write(&mut chip, CHER, channels);
    chip
}

#[test]
fn the_first_conversion_pays_start_up_and_the_next_does_not() {
    let mut chip = converter_chip(1 << 6);
    for expected in [8 * 13 * 10 + 130, 130] {
        write(&mut chip, CR, 2);
        let start = chip.now();
        wait_for(&mut chip, SR, 1 << 6);
        let took = chip.now() - start;
        assert!(
            (expected..expected + 3).contains(&took),
            "{took} for {expected}"
        );
        assert_eq!(read(&mut chip, CDR + 24), 106);
    }
}

#[test]
fn enabled_channels_are_converted_in_ascending_order() {
    let mut chip = converter_chip(1 << 6 | 1 << 4);
    write(&mut chip, CR, 2);
    let status = wait_for(&mut chip, SR, 0xFF);
    assert_eq!(status & 0xFF, 1 << 4);
    assert_eq!(read(&mut chip, LCDR), 104);
    wait_for(&mut chip, SR, 1 << 6);
    assert_eq!(read(&mut chip, LCDR), 106);
    assert_eq!(read(&mut chip, CDR + 16), 104);
}

#[test]
fn reading_the_data_clears_the_flags() {
    let mut chip = converter_chip(1 << 1);
    write(&mut chip, CR, 2);
    let status = wait_for(&mut chip, SR, 2);
    assert_eq!(status, 0x000C_0000 | DRDY | 2);
    assert_eq!(read(&mut chip, CDR + 4), 101);
    assert_eq!(read(&mut chip, SR), 0x000C_0000 | DRDY);
    assert_eq!(read(&mut chip, LCDR), 101);
    assert_eq!(read(&mut chip, SR), 0x000C_0000);
}

#[test]
fn unread_data_is_overrun() {
    let mut chip = converter_chip(1 << 1);
    for _ in 0..2 {
        write(&mut chip, CR, 2);
        let now = chip.now();
        run_to(&mut chip, now + 2000);
    }
    assert_eq!(read(&mut chip, SR), 0x000C_0000 | GOVRE | DRDY | 1 << 9 | 2);
    assert_eq!(read(&mut chip, SR) & (GOVRE | 1 << 9), 0);
}

#[test]
fn low_resolution_gives_eight_bits() {
    let mut chip = converter_chip(1);
    chip.board_mut().analogue[0] = 1023;
    write(&mut chip, MR, 0x020C_0410);
    write(&mut chip, CR, 2);
    wait_for(&mut chip, SR, 1);
    assert_eq!(read(&mut chip, CDR), 255);
}

#[test]
fn end_of_conversion_interrupts() {
    let mut chip = converter_chip(1 << 3);
    write(&mut chip, IER, 1 << 3);
    write(&mut chip, CR, 2);
    wait_for(&mut chip, SR, 1 << 3);
    wait_for(&mut chip, AIC + 0x10C, 1 << 4);
}

/// Timer channel 1 as a square wave of `period_cycles` on TIOA1, which rises in mid-period.
fn square_wave(chip: &mut TestChip, period_cycles: u32) {
    let channel = TC0 + 0x40;
    write(chip, channel + 0x04, 1 << 15 | 1 << 14 | 2 << 18 | 1 << 16);
    write(chip, channel + 0x14, period_cycles / 4);
    write(chip, channel + 0x1C, period_cycles / 2);
    write(chip, channel, 5);
}

#[test]
fn each_rising_edge_of_tioa1_converts_all_enabled_channels_once() {
    let mut chip = converter_chip(1 << 1 | 1 << 3);
    write(&mut chip, MR, 0x020C_0403);
    square_wave(&mut chip, 4000);
    let mut results = 0;
    for _ in 0..5 {
        assert_eq!(read(&mut chip, SR) & 0xFF, 0);
        wait_for(&mut chip, SR, 1 << 3);
        assert_eq!(read(&mut chip, CDR + 4), 101);
        assert_eq!(read(&mut chip, CDR + 12), 103);
        results += 1;
    }
    assert_eq!(results, 5);
    let took = chip.now();
    assert!((18_000..24_000).contains(&took), "5 periods in {took}");
}

#[test]
fn a_timer_that_is_not_selected_triggers_nothing() {
    let mut chip = converter_chip(1 << 1);
    write(&mut chip, MR, 0x020C_0405);
    square_wave(&mut chip, 4000);
    let now = chip.now();
    run_to(&mut chip, now + 20_000);
    assert_eq!(read(&mut chip, SR) & 0xFF, 0);
}

#[test]
fn a_trigger_from_the_pin_is_a_fault() {
    let mut chip = converter_chip(1);
    assert!(try_write(&mut chip, MR, Width::Word, 6 << 1 | 1).is_err());
    assert!(chip
        .fault()
        .unwrap()
        .to_string()
        .starts_with("ADC: a hardware trigger other than TIOA0 to TIOA2"));
}
