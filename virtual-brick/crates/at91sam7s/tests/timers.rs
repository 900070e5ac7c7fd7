// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timer counters: waveform and capture modes.
use crate::common::{cold_chip, read, run_to, running_chip, try_write, write, TestChip, PIOA, TC0};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::board::PinLevels;
use at91sam7s::FaultKind;

registers! {
    TC0; CCR = 0x00, CMR = 0x04, CV = 0x10, RA = 0x14, RB = 0x18, RC = 0x1C, SR = 0x20,
    IER = 0x24,
}
const CLKEN: u32 = 1;
const CLKDIS: u32 = 2;
const SWTRG: u32 = 4;
const WAVE: u32 = 1 << 15;
const AUTOMATIC: u32 = 2 << 13;
const CPCSTOP: u32 = 1 << 6;
const CPCDIS: u32 = 1 << 7;
const COVFS: u32 = 1 << 0;
const CPAS: u32 = 1 << 2;
const CPCS: u32 = 1 << 4;
const LDRAS: u32 = 1 << 5;
const LDRBS: u32 = 1 << 6;
const LOVRS: u32 = 1 << 1;
const ETRGS: u32 = 1 << 7;
const CLKSTA: u32 = 1 << 16;

/// Start with a software trigger; returns the cycle at which the counter becomes 0.
fn start(chip: &mut TestChip, divider: u64) -> u64 {
    write(chip, CCR, CLKEN | SWTRG);
    chip.now() / divider * divider + divider
}

/// Status read so that the access takes effect exactly at `at`.
fn status_at(chip: &mut TestChip, at: u64) -> u32 {
    run_to(chip, at - 2);
    read(chip, SR)
}

fn value_at(chip: &mut TestChip, at: u64) -> u32 {
    run_to(chip, at - 2);
    read(chip, CV)
}

#[test]
fn the_counter_steps_at_multiples_of_the_divider() {
    for (select, divider) in [(0u32, 2u64), (1, 8), (2, 32), (3, 128), (4, 1024)] {
        let mut chip = running_chip();
        write(&mut chip, CMR, WAVE | select);
        let zero = start(&mut chip, divider);
        let first = (zero + 10).max(zero + divider);
        let steps = |at: u64| ((at - zero) / divider) as u32;
        assert_eq!(value_at(&mut chip, first), steps(first));
        let later = zero + 100 * divider;
        assert_eq!(value_at(&mut chip, later - 1), 99);
        assert_eq!(value_at(&mut chip, later + 1), 100);
    }
}

#[test]
fn a_trigger_takes_effect_at_the_next_clock_edge() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | 4);
    let zero = start(&mut chip, 1024);
    assert_eq!(value_at(&mut chip, zero + 5 * 1024 + 8), 5);
    write(&mut chip, CCR, SWTRG);
    assert_eq!(read(&mut chip, CV), 5);
    assert_eq!(value_at(&mut chip, zero + 6 * 1024 + 4), 0);
}

#[test]
fn an_alarm_stops_at_rc_and_comes_once() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | CPCSTOP);
    write(&mut chip, RC, 1000);
    let zero = start(&mut chip, 2);
    assert_eq!(status_at(&mut chip, zero + 1999) & CPCS, 0);
    run_to(&mut chip, zero + 2000);
    assert_eq!(read(&mut chip, SR) & (CPCS | CLKSTA), CPCS | CLKSTA);
    assert_eq!(read(&mut chip, SR) & CPCS, 0, "status clears on reading");
    run_to(&mut chip, zero + 300_000);
    assert_eq!(read(&mut chip, SR) & CPCS, 0);
    assert_eq!(read(&mut chip, CV), 1000);
    let zero = start(&mut chip, 2);
    assert_eq!(
        status_at(&mut chip, zero + 2000) & CPCS,
        CPCS,
        "a trigger starts it again"
    );
}

#[test]
fn an_alarm_may_disable_the_clock() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | CPCDIS);
    write(&mut chip, RC, 50);
    let zero = start(&mut chip, 2);
    assert_eq!(status_at(&mut chip, zero + 99) & CLKSTA, CLKSTA);
    assert_eq!(status_at(&mut chip, zero + 102) & (CPCS | CLKSTA), CPCS);
    write(&mut chip, CCR, SWTRG);
    chip.internal(300);
    assert_eq!(
        read(&mut chip, SR) & CPCS,
        0,
        "no trigger while the clock is disabled"
    );
    let zero = start(&mut chip, 2);
    assert_eq!(status_at(&mut chip, zero + 102) & CPCS, CPCS);
}

#[test]
fn the_alarm_interrupt_reaches_the_core_six_cycles_after_the_compare() {
    let mut chip = running_chip();
    write(&mut chip, 0xFFFF_F120, 1 << 12);
    write(&mut chip, CMR, WAVE | CPCSTOP);
    write(&mut chip, RC, 400);
    write(&mut chip, IER, CPCS);
    let zero = start(&mut chip, 2);
    run_to(&mut chip, zero + 800 + 5);
    assert!(!chip.irq());
    run_to(&mut chip, zero + 800 + 6);
    assert!(chip.irq());
}

#[test]
fn with_automatic_trigger_the_period_is_rc() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | AUTOMATIC | 1);
    write(&mut chip, RC, 25);
    let zero = start(&mut chip, 8);
    for period in 1..=5 {
        let end = zero + period * 200;
        assert_eq!(status_at(&mut chip, end - 1) & CPCS, 0);
        assert_eq!(status_at(&mut chip, end + 2) & (CPCS | COVFS), CPCS);
        assert_eq!(value_at(&mut chip, end + 4), 0);
    }
}

#[test]
fn without_automatic_trigger_the_counter_overflows_after_65536_clocks() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE);
    write(&mut chip, RC, 10);
    let zero = start(&mut chip, 2);
    let end = zero + 2 * 0x1_0000;
    assert_eq!(status_at(&mut chip, end - 1) & (COVFS | CPCS), CPCS);
    assert_eq!(value_at(&mut chip, end + 2), 1);
    assert_eq!(read(&mut chip, SR) & COVFS, COVFS);
}

#[test]
fn a_compare_value_behind_the_counter_waits_for_the_next_round() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE);
    write(&mut chip, RC, 0xFFFF);
    let zero = start(&mut chip, 2);
    run_to(&mut chip, zero + 1000);
    write(&mut chip, RC, 100);
    assert_eq!(status_at(&mut chip, zero + 2 * 0x1_0000) & CPCS, 0);
    assert_eq!(
        status_at(&mut chip, zero + 2 * (0x1_0000 + 100)) & CPCS,
        CPCS
    );
}

#[test]
fn up_and_down_counting_turns_at_rc_and_at_zero() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | 3 << 13);
    write(&mut chip, RC, 100);
    write(&mut chip, RA, 40);
    let zero = start(&mut chip, 2);
    assert_eq!(value_at(&mut chip, zero + 180), 90);
    assert_eq!(status_at(&mut chip, zero + 199) & (CPAS | CPCS), CPAS);
    assert_eq!(value_at(&mut chip, zero + 230), 85);
    assert_eq!(status_at(&mut chip, zero + 240) & (CPAS | CPCS), CPCS);
    assert_eq!(
        status_at(&mut chip, zero + 330) & CPAS,
        CPAS,
        "RA again on the way down"
    );
    assert_eq!(value_at(&mut chip, zero + 430), 15);
}

#[test]
fn up_and_down_counting_may_use_the_full_range() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | 1 << 13);
    let zero = start(&mut chip, 2);
    assert_eq!(value_at(&mut chip, zero + 2 * 0xFFFF), 0xFFFF);
    assert_eq!(value_at(&mut chip, zero + 2 * 0xFFFF + 20), 0xFFFF - 10);
    assert_eq!(read(&mut chip, SR) & COVFS, 0);
}

#[test]
fn compares_drive_the_output_pins() {
    let mut chip = running_chip();
    // RA sets, RC clears TIOA; the trigger clears it.
    write(
        &mut chip,
        CMR,
        WAVE | AUTOMATIC | 1 << 10 | 1 << 16 | 2 << 18 | 2 << 22 | 3 << 26,
    );
    write(&mut chip, RA, 30);
    write(&mut chip, RC, 50);
    write(&mut chip, PIOA + 0x74, 3);
    write(&mut chip, PIOA + 0x04, 3);
    chip.board_mut().log.clear();
    let zero = start(&mut chip, 2);
    run_to(&mut chip, zero + 250);
    let pins: Vec<_> = chip
        .board()
        .log
        .iter()
        .filter_map(|(at, seen)| match seen {
            crate::common::Seen::Pins { driven: 3, level } => Some((at - zero, *level)),
            _ => None,
        })
        .collect();
    assert_eq!(pins, [(60, 1), (100, 2), (160, 3), (200, 0)]);
    assert_eq!(read(&mut chip, PIOA + 0x3C) & 3, 0);
}

/// AT91SAM7S datasheet, 33.5.12: of compares at the same value, RC has the higher priority.
#[test]
fn where_ra_and_rc_are_equal_the_effect_of_rc_counts() {
    let mut chip = running_chip();
    // RA clears, RC sets TIOA.
    write(&mut chip, CMR, WAVE | AUTOMATIC | 2 << 16 | 1 << 18);
    write(&mut chip, RA, 50);
    write(&mut chip, RC, 50);
    write(&mut chip, PIOA + 0x74, 1);
    write(&mut chip, PIOA + 0x04, 1);
    let zero = start(&mut chip, 2);
    run_to(&mut chip, zero + 110);
    assert_eq!(read(&mut chip, PIOA + 0x3C) & 1, 1);
}

/// Reads of its interrupt mask bring one of two equal channels up to date every few cycles.
#[test]
fn a_timer_that_is_left_alone_does_the_same_as_one_that_is_looked_at() {
    let mut drawn = 1u32;
    for case in 0..400 {
        let mut draw = |bits: u32| {
            drawn = drawn.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            drawn >> (32 - bits)
        };
        let stops = if case % 8 == 0 { draw(2) << 6 } else { 0 };
        let capture = if case % 5 == 0 { WAVE } else { 0 };
        let mode = (WAVE | stops | 1 << 10 | draw(2) << 13 | draw(16) << 16) ^ capture;
        let bits = if case % 16 == 0 { 16 } else { 5 };
        let values = [RA, RB, RC].map(|register| (register, draw(bits)));
        let again = if case % 4 == 0 { SWTRG } else { 0 };
        let (mask, length) = (
            draw(5),
            300 + u64::from(draw(8)) * if bits == 16 { 2_000 } else { 10 },
        );
        let chips = [false, true].map(|is_watched| {
            let mut chip = running_chip();
            for (register, value) in [(CMR, mode), (IER, mask), (PIOA + 0x74, 3), (PIOA + 4, 3)] {
                write(&mut chip, register, value);
            }
            write(&mut chip, 0xFFFF_F120, 1 << 12);
            values
                .iter()
                .for_each(|&(register, value)| write(&mut chip, register, value));
            let end = start(&mut chip, 2) + length;
            for until in [end - length / 3, end] {
                while is_watched && chip.now() + 8 < until {
                    read(&mut chip, IER + 8);
                    chip.internal(3);
                }
                run_to(&mut chip, until);
                if until < end {
                    write(&mut chip, CCR, again);
                }
            }
            let irq = chip.irq();
            let shown = (read(&mut chip, SR), read(&mut chip, CV), irq);
            (shown, chip.board().log.clone())
        });
        assert_eq!(chips[0], chips[1], "case {case}: {mode:#x}, {values:?}");
    }
}

#[test]
fn a_wave_of_which_nothing_shows_is_no_event() {
    let mut chip = running_chip();
    // RA sets, RC clears TIOA; the counter never steps onto RA.
    write(&mut chip, CMR, WAVE | AUTOMATIC | 1 << 16 | 2 << 18);
    write(&mut chip, RC, 3);
    let zero = start(&mut chip, 2);
    run_to(&mut chip, zero + 20);
    let end = zero + 6_000_000_000 + 2;
    chip.skip_to_next_event(end);
    assert_eq!(chip.now(), end);
    assert_eq!(value_at(&mut chip, end + 2), 2);
    assert_eq!(read(&mut chip, SR) & CPCS, CPCS);
    // The status that was read is set again.
    chip.internal(6);
    assert_eq!(read(&mut chip, SR) & CPCS, CPCS);
}

#[test]
fn disabling_and_enabling_the_clock_keeps_the_value() {
    let mut chip = running_chip();
    write(&mut chip, CMR, WAVE | 1);
    let zero = start(&mut chip, 8);
    run_to(&mut chip, zero + 403);
    write(&mut chip, CCR, CLKDIS);
    chip.internal(500);
    assert_eq!(read(&mut chip, CV), 50);
    write(&mut chip, CCR, CLKEN);
    chip.internal(80);
    assert_eq!(read(&mut chip, CV), 60);
}

#[test]
fn a_synchronous_trigger_starts_all_enabled_channels_together() {
    let mut chip = running_chip();
    for n in 0..3 {
        write(&mut chip, CMR + 0x40 * n, WAVE | 2);
        write(&mut chip, CCR + 0x40 * n, CLKEN);
    }
    write(&mut chip, TC0 + 0xC0, 1);
    chip.internal(3200);
    let values: Vec<_> = (0..3).map(|n| read(&mut chip, CV + 0x40 * n)).collect();
    assert!(
        values.iter().all(|value| value.abs_diff(99) <= 1),
        "{values:?}"
    );
}

/// Let the board play levels of PA0 (TIOA0) from the given offsets to now on.
fn play_line_a(chip: &mut TestChip, script: &[(u64, bool)]) -> u64 {
    let now = chip.now() + 100;
    let pins = script.iter().map(|(at, level)| {
        (
            now + at,
            PinLevels {
                driven: 1,
                level: (*level).into(),
            },
        )
    });
    let pins = pins.collect();
    chip.board_mut().pins = pins;
    now
}

#[test]
fn a_pin_edge_triggers_and_the_level_is_readable() {
    let mut chip = running_chip();
    chip.board_mut().levels = PinLevels {
        driven: 1,
        level: 0,
    };
    // MCK/1024, both edges of TIOA trigger, RA loads on the rising edge; enabled but not started.
    write(&mut chip, CMR, 4 | 3 << 8 | 1 << 10 | 1 << 16);
    write(&mut chip, IER, ETRGS);
    write(&mut chip, CCR, CLKEN);
    let origin = play_line_a(&mut chip, &[(0, true), (3000, false)]);
    run_to(&mut chip, origin - 3);
    assert_eq!(read(&mut chip, SR) & (ETRGS | 1 << 17), 0);
    run_to(&mut chip, origin + 10);
    assert_eq!(
        read(&mut chip, SR) & (ETRGS | LDRAS | 1 << 17),
        ETRGS | LDRAS | 1 << 17
    );
    run_to(&mut chip, origin + 3000);
    assert_eq!(read(&mut chip, SR) & (ETRGS | LDRAS | 1 << 17), ETRGS);
}

#[test]
fn capture_measures_a_pulse_and_reports_an_overrun() {
    let mut chip = running_chip();
    chip.board_mut().levels = PinLevels {
        driven: 1,
        level: 0,
    };
    // MCK/2, RA on rising, RB on falling edges.
    write(&mut chip, CMR, 1 << 16 | 2 << 18);
    write(&mut chip, CCR, CLKEN | SWTRG);
    let origin = play_line_a(
        &mut chip,
        &[(0, true), (600, false), (1000, true), (1400, false)],
    );
    run_to(&mut chip, origin + 700);
    assert_eq!(read(&mut chip, SR) & (LDRAS | LDRBS | LOVRS), LDRAS | LDRBS);
    assert_eq!(read(&mut chip, RB) - read(&mut chip, RA), 300);
    run_to(&mut chip, origin + 1500);
    assert_eq!(read(&mut chip, RB) - read(&mut chip, RA), 200);
    let origin = play_line_a(
        &mut chip,
        &[(0, true), (10, false), (20, true), (30, false)],
    );
    run_to(&mut chip, origin + 50);
    assert_eq!(read(&mut chip, SR) & LOVRS, LOVRS);
}

#[test]
fn capture_may_stop_the_counter_at_the_second_load() {
    let mut chip = running_chip();
    chip.board_mut().levels = PinLevels {
        driven: 1,
        level: 0,
    };
    write(&mut chip, CMR, 1 << 6 | 1 << 16 | 2 << 18);
    write(&mut chip, CCR, CLKEN | SWTRG);
    let origin = play_line_a(&mut chip, &[(0, true), (600, false)]);
    run_to(&mut chip, origin + 2000);
    assert_eq!(read(&mut chip, CV), read(&mut chip, RB));
}

#[test]
fn starting_without_the_peripheral_clock_is_a_fault() {
    let mut chip = cold_chip();
    chip.enter_as_boot_monitor();
    assert!(try_write(&mut chip, CCR, Width::Word, CLKEN).is_err());
    let text = chip.fault().unwrap().to_string();
    assert!(text.starts_with("TC0 was started while its clock is off: set bit 12 of PMC_PCER"));
}

#[test]
fn an_external_clock_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_write(&mut chip, CMR + 0x40, Width::Word, WAVE | 5).is_err());
    assert!(matches!(
        chip.fault().unwrap().kind,
        FaultKind::FeatureNotModelled {
            peripheral: "TC1",
            ..
        }
    ));
}
