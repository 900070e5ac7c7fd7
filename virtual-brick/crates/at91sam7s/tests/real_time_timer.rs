// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Real-time timer: prescaler, counter, alarm.

use crate::common::{read, run_to, running_chip, slow, write, TestChip, AIC};

const RTT: u32 = 0xFFFF_FD20;

fn system_pending(chip: &mut TestChip) -> bool {
    read(chip, AIC + 0x10C) & 1 << 1 != 0
}

#[test]
fn the_real_time_timer_counts_periods_of_its_divider_and_interrupts_at_each() {
    let mut chip = running_chip();
    write(&mut chip, RTT, 1 << 18 | 1 << 17 | 0x20);
    let start = chip.now();
    for step in 1..4 {
        run_to(&mut chip, start + slow(32 * step) - 10);
        assert!(!system_pending(&mut chip), "step {step}");
        run_to(&mut chip, start + slow(32 * step) + 10);
        assert!(system_pending(&mut chip), "step {step}");
        assert_eq!(read(&mut chip, RTT + 8), step as u32);
        assert_eq!(read(&mut chip, RTT + 12), 2, "an increment");
        assert!(!system_pending(&mut chip), "reading the status clears it");
    }
}

#[test]
fn the_real_time_timers_alarm_interrupts_and_a_restart_begins_at_zero() {
    let mut chip = running_chip();
    write(&mut chip, RTT + 4, 4);
    write(&mut chip, RTT, 1 << 18 | 1 << 16 | 0x10);
    let start = chip.now();
    run_to(&mut chip, start + slow(16 * 5) - 10);
    assert!(!system_pending(&mut chip));
    run_to(&mut chip, start + slow(16 * 5) + 10);
    assert!(system_pending(&mut chip));
    assert_eq!(read(&mut chip, RTT + 12), 3, "increment and alarm");
    write(&mut chip, RTT, 1 << 18 | 0x10);
    assert_eq!(read(&mut chip, RTT + 8), 0);
}

/// AT91SAM7S datasheet, chapter 14, RTT_MR.RTPRES: 0 stands for 2^16 periods of the slow clock.
#[test]
fn a_prescaler_of_zero_divides_the_slow_clock_by_65536() {
    let mut chip = running_chip();
    write(&mut chip, RTT, 1 << 18 | 1 << 17);
    let start = chip.now();
    assert_eq!(read(&mut chip, RTT) & 0xFFFF, 0, "it reads as written");
    for step in 1..3 {
        run_to(&mut chip, start + slow(65_536 * step) - 10);
        assert!(!system_pending(&mut chip), "step {step}");
        run_to(&mut chip, start + slow(65_536 * step) + 10);
        assert!(system_pending(&mut chip), "step {step}");
        assert_eq!(read(&mut chip, RTT + 8), step as u32);
        assert_eq!(read(&mut chip, RTT + 12), 2, "an increment");
    }
}

/// AT91SAM7S datasheet, chapter 14, RTT_MR.RTTRST: reloads and restarts the divider and clears the
/// counter. Without it a store of the same prescaler changes neither.
#[test]
fn a_restart_of_the_real_time_timer_begins_a_whole_period() {
    for restarts in [false, true] {
        let mut chip = running_chip();
        write(&mut chip, RTT, 1 << 18 | 0x20);
        let start = chip.now();
        run_to(&mut chip, start + slow(32 + 24));
        assert_eq!(read(&mut chip, RTT + 8), 1);
        write(&mut chip, RTT, u32::from(restarts) << 18 | 0x20);
        let (from, counted) = if restarts {
            (chip.now(), 0)
        } else {
            (start + slow(32), 1)
        };
        run_to(&mut chip, from + slow(32) - 10);
        assert_eq!(read(&mut chip, RTT + 8), counted, "restarts: {restarts}");
        run_to(&mut chip, from + slow(32) + 10);
        assert_eq!(
            read(&mut chip, RTT + 8),
            counted + 1,
            "restarts: {restarts}"
        );
    }
}

/// AT91SAM7S datasheet, chapter 14, RTT_MR.RTPRES: a new prescaler begins a period of its own; the
/// counter goes on from where it is.
#[test]
fn another_prescaler_keeps_the_count_and_begins_a_period_of_its_length() {
    let mut chip = running_chip();
    write(&mut chip, RTT, 1 << 18 | 0x20);
    let start = chip.now();
    run_to(&mut chip, start + slow(3 * 32 + 8));
    write(&mut chip, RTT, 0x40);
    let changed = chip.now();
    assert_eq!(read(&mut chip, RTT + 8), 3);
    run_to(&mut chip, changed + slow(64) - 10);
    assert_eq!(read(&mut chip, RTT + 8), 3);
    run_to(&mut chip, changed + slow(64) + 10);
    assert_eq!(read(&mut chip, RTT + 8), 4);
    run_to(&mut chip, changed + slow(128) + 10);
    assert_eq!(read(&mut chip, RTT + 8), 5);
}
