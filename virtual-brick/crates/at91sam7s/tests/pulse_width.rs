// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Pulse width modulation controller: periods and their interrupts.
use crate::common::{read, run_to, running_chip, try_write, write, TestChip, AIC};
use arm7tdmi::bus::Width;

const PWMC: u32 = 0xFFFC_C000;
registers! {
    PWMC; MR = 0x00, ENA = 0x04, DIS = 0x08, SR = 0x0C, IER = 0x10, ISR = 0x1C, CMR0 = 0x200,
    CDTY0 = 0x204, CPRD0 = 0x208, CCNT0 = 0x20C, CUPD0 = 0x210,
}
const CALG: u32 = 1 << 8;
const CPD: u32 = 1 << 10;

/// Channel 0 with a period of 32 clocks of MCK/64, enabled: 2048 cycles.
fn counting_chip(mode: u32) -> (TestChip, u64) {
    let mut chip = running_chip();
    for (register, value) in [(MR, 0x601), (CMR0, 6 | mode), (CPRD0, 32), (ENA, 1)] {
        write(&mut chip, register, value);
    }
    let start = chip.now();
    (chip, start)
}

#[test]
fn each_period_sets_the_flag_once_and_reading_clears_it() {
    let (mut chip, start) = counting_chip(0);
    assert_eq!(read(&mut chip, SR), 1);
    run_to(&mut chip, start + 2045);
    assert_eq!(read(&mut chip, ISR), 0);
    for period in 1..4 {
        run_to(&mut chip, start + 2048 * period);
        assert_eq!(read(&mut chip, ISR), 1, "period {period}");
        assert_eq!(read(&mut chip, ISR), 0, "period {period}");
    }
}

#[test]
fn the_end_of_a_period_interrupts() {
    let (mut chip, start) = counting_chip(0);
    write(&mut chip, IER, 1);
    run_to(&mut chip, start + 2040);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 1 << 10, 0);
    run_to(&mut chip, start + 2060);
    assert_ne!(read(&mut chip, AIC + 0x10C) & 1 << 10, 0);
    read(&mut chip, ISR);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 1 << 10, 0);
}

#[test]
fn a_centre_aligned_period_counts_up_and_down() {
    let (mut chip, start) = counting_chip(CALG);
    for (cycles, count) in [(640, 10), (2048, 32), (2048 + 640, 22), (4096 + 64, 1)] {
        run_to(&mut chip, start + cycles);
        assert_eq!(read(&mut chip, CCNT0), count, "at {cycles}");
    }
    assert_eq!(read(&mut chip, ISR), 1);
}

#[test]
fn a_new_period_counts_from_the_end_of_the_running_one() {
    let (mut chip, start) = counting_chip(CPD);
    write(&mut chip, CUPD0, 8);
    assert_eq!(read(&mut chip, CPRD0), 32);
    run_to(&mut chip, start + 2048);
    assert_eq!(read(&mut chip, CPRD0), 8);
    read(&mut chip, ISR);
    run_to(&mut chip, start + 2048 + 500);
    assert_eq!(read(&mut chip, ISR), 0);
    run_to(&mut chip, start + 2048 + 512);
    assert_eq!(read(&mut chip, ISR), 1);
}

#[test]
fn a_new_duty_cycle_counts_from_the_end_of_the_running_period() {
    let (mut chip, start) = counting_chip(0);
    write(&mut chip, CUPD0, 5);
    assert_eq!(read(&mut chip, CDTY0), 0);
    run_to(&mut chip, start + 2048);
    assert_eq!(read(&mut chip, CDTY0), 5);
    assert_eq!(read(&mut chip, CPRD0), 32);
}

#[test]
fn a_linear_divider_clocks_a_channel() {
    let mut chip = running_chip();
    for (register, value) in [(MR, 2 << 24 | 5 << 16), (CMR0, 12), (CPRD0, 10), (ENA, 1)] {
        write(&mut chip, register, value);
    }
    let start = chip.now();
    run_to(&mut chip, start + 197);
    assert_eq!(read(&mut chip, ISR), 0);
    run_to(&mut chip, start + 200);
    assert_eq!(read(&mut chip, ISR), 1, "10 times 5 times 4 cycles");
}

#[test]
fn a_disabled_channel_stands_still_and_starts_again_from_zero() {
    let (mut chip, start) = counting_chip(0);
    run_to(&mut chip, start + 1000);
    write(&mut chip, DIS, 1);
    run_to(&mut chip, start + 5000);
    assert_eq!(read(&mut chip, ISR), 0);
    write(&mut chip, ENA, 1);
    let again = chip.now();
    run_to(&mut chip, again + 2040);
    assert_eq!(read(&mut chip, ISR), 0);
    run_to(&mut chip, again + 2048);
    assert_eq!(read(&mut chip, ISR), 1);
}

#[test]
fn a_period_written_past_the_update_register_is_a_fault() {
    let (mut chip, _) = counting_chip(0);
    assert!(try_write(&mut chip, CPRD0, Width::Word, 64).is_err());
    assert!(chip
        .fault()
        .unwrap()
        .to_string()
        .starts_with("PWMC: writing CPRD"));
}
