// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Clocks, interval timer, watchdog, resets, stopped processor.

use crate::common::{
    chip_events, cold_chip, read, run_to, running_chip, slow, try_write, wait_for, write, TestChip,
    AIC, MC, PCER, PIOA, PIT, PMC, SRAM, TC0,
};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::board::ChipEvent;
use at91sam7s::ResetCause;

const PIVR: u32 = PIT + 8;
const PIIR: u32 = PIT + 12;
const PMC_SR: u32 = PMC + 0x68;
const MOR: u32 = PMC + 0x20;
const PLLR: u32 = PMC + 0x2C;
const MCKR: u32 = PMC + 0x30;
const SCDR: u32 = PMC + 0x04;
const RSTC: u32 = 0xFFFF_FD00;
const WDT: u32 = 0xFFFF_FD40;
/// 128 slow clock periods times 4096: 16 s.
const SIXTEEN_SECONDS: u64 = 768_877_714;

fn image_at(chip: &mut TestChip, at: u64) -> u32 {
    run_to(chip, at - 2);
    read(chip, PIIR)
}

#[test]
fn the_interval_timer_counts_sixteenths_from_the_enabling_store() {
    let mut chip = running_chip();
    write(&mut chip, PIT, 0x010F_FFFF);
    let start = chip.now();
    assert_eq!(
        chip_events(&chip),
        [(start, ChipEvent::IntervalTimerStarted)]
    );
    assert_eq!(image_at(&mut chip, start + 15), 0);
    assert_eq!(image_at(&mut chip, start + 17), 1);
    assert_eq!(image_at(&mut chip, start + 16_000), 1000);
    assert_eq!(
        image_at(&mut chip, start + (1 << 24)),
        1 << 20,
        "one 32-bit counter"
    );
}

#[test]
fn reading_the_value_clears_the_period_count_and_the_flag() {
    let mut chip = running_chip();
    write(&mut chip, PIT, 0x0100_0000 | 2999);
    let start = chip.now();
    assert_eq!(image_at(&mut chip, start + 47_999), 2999);
    assert_eq!(image_at(&mut chip, start + 3 * 48_000 + 33), 3 << 20 | 2);
    assert_eq!(read(&mut chip, PIT + 4), 1);
    assert_eq!(read(&mut chip, PIVR), 3 << 20 | 2);
    assert_eq!(read(&mut chip, PIT + 4), 0);
    assert_eq!(read(&mut chip, PIIR) >> 20, 0);
}

#[test]
fn the_period_count_wraps_after_4096_periods() {
    let mut chip = running_chip();
    write(&mut chip, PIT, 0x0100_0000);
    let start = chip.now();
    assert_eq!(image_at(&mut chip, start + 16 * 5000), (5000 - 4096) << 20);
}

#[test]
fn a_disabled_interval_timer_stops_at_the_end_of_its_period() {
    let mut chip = running_chip();
    write(&mut chip, PIT, 0x0100_0000 | 99);
    let start = chip.now();
    run_to(&mut chip, start + 800);
    write(&mut chip, PIT, 99);
    assert_eq!(image_at(&mut chip, start + 1599), 99);
    assert_eq!(image_at(&mut chip, start + 5000), 1 << 20);
    assert_eq!(read(&mut chip, PIVR), 1 << 20);
    write(&mut chip, PIT, 0x0100_0000 | 99);
    let again = chip.now();
    assert_eq!(image_at(&mut chip, again + 33), 2);
}

#[test]
fn the_interval_timer_interrupts_once_per_acknowledged_period() {
    let mut chip = running_chip();
    write(&mut chip, AIC + 4, 1 << 5);
    write(&mut chip, AIC + 0x120, 1 << 1);
    write(&mut chip, PIT, 0x0300_0000 | 999);
    let start = chip.now();
    for period in 1..=3 {
        run_to(&mut chip, start + period * 16_000 + 6);
        assert!(!chip.irq(), "period {period}");
        chip.internal(1);
        assert!(chip.irq(), "period {period}");
        let _ = read(&mut chip, AIC + 0x100);
        let _ = read(&mut chip, PIVR);
        write(&mut chip, AIC + 0x130, 0);
    }
}

#[test]
fn the_clock_sequence_of_a_flash_program_reaches_full_speed() {
    let mut chip = cold_chip();
    let slow = |chip: &mut TestChip| {
        let before = chip.now();
        chip.internal(1);
        chip.now() - before
    };
    assert_eq!(slow(&mut chip), 1466, "one period of the slow clock");
    write(&mut chip, MOR, 0x0601);
    let start = chip.now();
    wait_for(&mut chip, PMC_SR, 1 << 0);
    assert!(
        (70_392..74_000).contains(&(chip.now() - start)),
        "48 slow clocks"
    );
    write(&mut chip, PLLR, 0x1048_1C0E);
    wait_for(&mut chip, PMC_SR, 1 << 2);
    write(&mut chip, MCKR, 4);
    wait_for(&mut chip, PMC_SR, 1 << 3);
    write(&mut chip, MCKR, 7);
    wait_for(&mut chip, PMC_SR, 1 << 3);
    assert_eq!(slow(&mut chip), 1);
    assert!(chip.fault().is_none());
}

/// The datasheet gives no figure for MCKRDY; 16 cycles are assumed.
#[test]
fn a_switch_of_the_master_clock_is_ready_sixteen_cycles_later() {
    let mut chip = running_chip();
    write(&mut chip, MCKR, 7);
    let written = chip.now();
    run_to(&mut chip, written + 10);
    assert_eq!(read(&mut chip, PMC_SR) & 1 << 3, 0);
    run_to(&mut chip, written + 16);
    assert_eq!(read(&mut chip, PMC_SR) & 1 << 3, 1 << 3);
}

#[test]
fn the_main_clock_is_charged_in_whole_cycles() {
    let mut chip = running_chip();
    write(&mut chip, MCKR, 1);
    let before = chip.now();
    chip.internal(10);
    assert_eq!(chip.now() - before, 30, "48.05 / 18.432 MHz rounds to 3");
}

#[test]
fn a_master_clock_faster_than_the_time_base_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_write(&mut chip, MCKR, Width::Word, 3).is_err());
    assert!(chip
        .fault()
        .unwrap()
        .to_string()
        .contains("master clock above 48.06 MHz"));
}

#[test]
fn the_main_clock_frequency_is_measured() {
    let mut chip = running_chip();
    assert_eq!(read(&mut chip, PMC + 0x24), 1 << 16 | 9000);
}

/// A TC0 alarm `cycles` from now, level interrupt enabled in the AIC.
fn alarm(chip: &mut TestChip, half_cycles: u32) -> u64 {
    write(chip, AIC + 0x120, 1 << 12);
    write(chip, TC0 + 4, 1 << 15 | 1 << 6);
    write(chip, TC0 + 0x1C, half_cycles);
    write(chip, TC0 + 0x24, 1 << 4);
    write(chip, TC0, 5);
    chip.now() / 2 * 2 + 2 + 2 * u64::from(half_cycles)
}

#[test]
fn a_stopped_processor_wakes_when_an_interrupt_is_asserted() {
    let mut chip = running_chip();
    let event = alarm(&mut chip, 5000);
    write(&mut chip, SCDR, 1);
    let stopped = chip.now();
    assert!(chip.processor_stopped());
    let mut steps = 0;
    while chip.processor_stopped() {
        chip.skip_to_next_event(u64::MAX);
        steps += 1;
    }
    assert!(steps <= 3, "idle time is skipped");
    assert_eq!(chip.now(), event + 3);
    assert!(!chip.irq());
    chip.internal(3);
    assert!(chip.irq());
    assert_eq!(
        chip_events(&chip),
        [
            (stopped, ChipEvent::ProcessorStopped),
            (event + 3, ChipEvent::ProcessorResumed)
        ]
    );
    assert_eq!(read(&mut chip, PMC + 8) & 1, 1);
}

#[test]
fn skipping_stops_at_the_limit() {
    let mut chip = running_chip();
    let event = alarm(&mut chip, 5000);
    write(&mut chip, SCDR, 1);
    let limit = chip.now() + 100;
    chip.skip_to_next_event(limit);
    assert_eq!(chip.now(), limit);
    assert!(chip.processor_stopped() && limit < event);
}

#[test]
fn a_disabled_interrupt_does_not_wake_the_processor_but_the_general_mask_does_not_prevent_it() {
    let mut chip = running_chip();
    let event = alarm(&mut chip, 100);
    write(&mut chip, AIC + 0x124, 1 << 12);
    write(&mut chip, SCDR, 1);
    chip.skip_to_next_event(event + 1000);
    chip.skip_to_next_event(event + 1000);
    assert!(chip.processor_stopped());
    let mut chip = running_chip();
    alarm(&mut chip, 100);
    write(&mut chip, AIC + 0x138, 2);
    write(&mut chip, SCDR, 1);
    chip.skip_to_next_event(u64::MAX);
    chip.skip_to_next_event(u64::MAX);
    assert!(!chip.processor_stopped());
    chip.internal(10);
    assert!(!chip.irq());
}

#[test]
fn the_processor_does_not_stop_while_an_interrupt_is_asserted() {
    let mut chip = running_chip();
    let event = alarm(&mut chip, 10);
    run_to(&mut chip, event + 10);
    write(&mut chip, SCDR, 1);
    assert!(!chip.processor_stopped());
    assert!(chip_events(&chip).is_empty());
}

#[test]
fn the_watchdog_runs_from_power_on_and_resets_after_sixteen_seconds() {
    let mut chip = cold_chip();
    write(&mut chip, SRAM, 0x1234);
    write(&mut chip, PCER, 1 << 2);
    write(&mut chip, PIOA + 0x10, 1);
    while chip.now() < SIXTEEN_SECONDS - 2000 {
        chip.skip_to_next_event(SIXTEEN_SECONDS - 2000);
    }
    assert_eq!(chip.take_reset(), None);
    chip.internal(2);
    assert_eq!(chip.take_reset(), Some(ResetCause::Watchdog));
    assert_eq!(chip.take_reset(), None);
    assert_eq!(read(&mut chip, RSTC + 4) >> 8 & 7, 2);
    assert_eq!(read(&mut chip, PIOA + 0x18), 0, "peripherals are reset");
    assert_eq!(read(&mut chip, SRAM), 0x1234, "memory is kept");
}

#[test]
fn the_watchdog_mode_is_written_once() {
    let mut chip = cold_chip();
    write(&mut chip, WDT + 4, 0x8000);
    write(&mut chip, WDT + 4, 0x3FFF_2FFF);
    assert_eq!(read(&mut chip, WDT + 4), 0x8000);
    chip.skip_to_next_event(2 * SIXTEEN_SECONDS);
    chip.skip_to_next_event(2 * SIXTEEN_SECONDS);
    assert_eq!(chip.take_reset(), None);
}

#[test]
fn the_watchdog_halts_with_the_processor_when_its_mode_says_so() {
    for (halts, mode) in [(true, 0x2FFF_2003), (false, 0x0FFF_2003)] {
        let mut chip = cold_chip();
        write(&mut chip, WDT + 4, mode);
        write(&mut chip, SCDR, 1);
        for _ in 0..3 {
            chip.skip_to_next_event(10_000_000);
        }
        assert_eq!(chip.take_reset().is_none(), halts);
        assert_eq!(chip.processor_stopped(), halts);
    }
}

/// From power-on to full speed; the mode of the watchdog is still to be written.
fn full_speed_chip() -> TestChip {
    let mut chip = cold_chip();
    let steps = [
        (MOR, 0x0601, 1),
        (PLLR, 0x1048_1C0E, 1 << 2),
        (MCKR, 4, 1 << 3),
        (MCKR, 7, 1 << 3),
    ];
    for (register, value, ready) in steps {
        write(&mut chip, register, value);
        wait_for(&mut chip, PMC_SR, ready);
    }
    chip
}

/// Stop the processor; an alarm wakes it after `cycles`.
fn sleep(chip: &mut TestChip, cycles: u32) {
    write(chip, PCER, 1 << 12);
    read(chip, TC0 + 0x20);
    let event = alarm(chip, cycles / 2);
    write(chip, SCDR, 1);
    while chip.processor_stopped() {
        chip.skip_to_next_event(u64::MAX);
    }
    assert!(chip.now() >= event);
}

/// AT91SAM7S datasheet, 16.3: with WDIDLEHLT the counter stands still while the processor does,
/// so the window of allowed restarts opens later by the time in which it stood still.
#[test]
fn the_window_of_a_halted_watchdog_opens_later_by_the_halt() {
    for (halts, status) in [(true, 2), (false, 0)] {
        let mut chip = full_speed_chip();
        // Period 8 units of 187,714 cycles; a restart is allowed in the last 4 of them.
        write(&mut chip, WDT + 4, u32::from(halts) << 29 | 3 << 16 | 7);
        for _ in 0..7 {
            sleep(&mut chip, 120_000);
        }
        write(&mut chip, WDT, 0xA500_0001);
        assert_eq!(read(&mut chip, WDT + 8), status, "halts: {halts}");
    }
}

#[test]
fn a_disabled_watchdog_stays_quiet_through_any_sleep() {
    let mut chip = full_speed_chip();
    write(&mut chip, WDT + 4, 1 << 29 | 1 << 15 | 1 << 13 | 7);
    sleep(&mut chip, 100_000);
    let end = chip.now() + 2 * SIXTEEN_SECONDS;
    while chip.now() < end {
        chip.skip_to_next_event(end);
    }
    assert_eq!(chip.take_reset(), None);
    assert_eq!(read(&mut chip, WDT + 8), 0);
}

#[test]
fn the_end_of_a_flash_command_interrupts() {
    let mut chip = running_chip();
    write(&mut chip, AIC + 0x120, 1 << 1);
    write(&mut chip, MC + 0x64, 0x5A00_0002);
    write(&mut chip, MC + 0x60, 0x0048_0101);
    assert!(!chip.irq());
    let ends = 8 + chip.now();
    write(&mut chip, SCDR, 1);
    while chip.processor_stopped() {
        chip.skip_to_next_event(u64::MAX);
    }
    let took = chip.now() - ends;
    assert!((144_140..144_180).contains(&took), "3 ms: {took}");
}

#[test]
fn a_clock_ready_flag_interrupts() {
    let mut chip = cold_chip();
    write(&mut chip, AIC + 0x120, 1 << 1);
    write(&mut chip, PMC + 0x60, 1);
    write(&mut chip, MOR, 0x0601);
    let written = chip.now();
    write(&mut chip, SCDR, 1);
    while chip.processor_stopped() {
        chip.skip_to_next_event(u64::MAX);
    }
    assert_eq!(chip.now(), written + 70_392 + 3);
}

#[test]
fn restarting_the_watchdog_needs_the_key() {
    let mut chip = cold_chip();
    // One unit of 128 slow clocks: 187 714 cycles; any restart is allowed.
    write(&mut chip, WDT + 4, 0x0FFF_2003);
    let start = chip.now();
    let period = 4 * 128 * 48_054_857 / 32_768;
    chip.skip_to_next_event(start + period / 2);
    write(&mut chip, WDT, 0xA500_0001);
    let restarted = chip.now();
    write(&mut chip, WDT, 0x0000_0001);
    chip.skip_to_next_event(restarted + period - 3000);
    assert_eq!(chip.take_reset(), None);
    chip.skip_to_next_event(restarted + period + 3000);
    assert_eq!(chip.take_reset(), Some(ResetCause::Watchdog));
}

#[test]
fn a_watchdog_restart_before_its_window_is_an_error() {
    let mut chip = cold_chip();
    // Reset disabled, interrupt enabled, window: the last quarter of the period.
    write(&mut chip, WDT + 4, 1 << 16 | 1 << 12 | 7);
    write(&mut chip, WDT, 0xA500_0001);
    chip.internal(1);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 2, 2);
    assert_eq!(read(&mut chip, WDT + 8), 2);
    assert_eq!(read(&mut chip, WDT + 8), 0);
    assert_eq!(chip.take_reset(), None);
}

#[test]
fn software_resets_processor_and_peripherals_with_the_key_only() {
    let mut chip = running_chip();
    write(&mut chip, MC, 1);
    write(&mut chip, RSTC, 0x0000_0005);
    assert_eq!(chip.take_reset(), None);
    write(&mut chip, RSTC, 0xA500_0005);
    assert_eq!(chip.take_reset(), Some(ResetCause::Software));
    write(&mut chip, SRAM, 3);
    assert_ne!(read(&mut chip, 0), 3, "the remap is undone");
    assert_eq!(read(&mut chip, RSTC + 4), 1 << 16 | 3 << 8);
    assert_eq!(read(&mut chip, MCKR), 0, "back on the slow clock");
}

#[test]
fn a_reset_of_the_peripherals_alone_is_not_reported_as_the_last_reset() {
    let mut chip = running_chip();
    write(&mut chip, RSTC, 0xA500_0004);
    assert_eq!(chip.take_reset(), None);
    assert_eq!(read(&mut chip, RSTC + 4), 1 << 16);
}

#[test]
fn a_pulse_on_the_reset_pin_lasts_as_long_as_the_mode_says_and_resets_nothing() {
    let mut chip = running_chip();
    // ERSTL = 1: four slow clock periods. URSTIEN without URSTEN: the edge interrupts.
    write(&mut chip, RSTC + 8, 0xA500_0110);
    write(&mut chip, RSTC, 0xA500_0008);
    let start = chip.now();
    chip.internal(10);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 2, 2);
    assert_eq!(
        read(&mut chip, RSTC + 4),
        1 << 17 | 1,
        "SRCMP, URSTS, pin low"
    );
    assert_eq!(read(&mut chip, AIC + 0x10C) & 2, 0);
    run_to(&mut chip, start + slow(4) - 3);
    assert_eq!(read(&mut chip, RSTC + 4), 1 << 17);
    assert_eq!(read(&mut chip, RSTC + 4), 1 << 16, "the pin is high again");
    assert_eq!(chip.take_reset(), None);
}

#[test]
fn the_boot_monitor_leaves_the_watchdog_mode_used_up_and_full_speed() {
    let mut chip = cold_chip();
    chip.enter_as_boot_monitor();
    write(&mut chip, WDT + 4, 0x3FFF_2FFF);
    assert_eq!(read(&mut chip, WDT + 4), 0x8000);
    assert_eq!(read(&mut chip, MCKR), 7);
    assert_eq!(read(&mut chip, PMC_SR) & 0xD, 0xD);
    assert_eq!(chip.now(), 8, "full speed: four accesses of two cycles");
}
