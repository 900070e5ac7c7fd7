// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A supply that fails: brown-out detector, reset, pages of the flash left half done.

use crate::common::{read, run_to, running_chip, wait_for, write, TestChip, MC};
use at91sam7s::ResetCause;

const FCR: u32 = MC + 0x64;
const FSR: u32 = MC + 0x68;
const RSTC_SR: u32 = 0xFFFF_FD04;
const PAGE: u32 = 0x0010_0000 + 256 * 992;
const WRITE_992: u32 = 0x5A00_0001 | 992 << 8;
const SET_BIT: u32 = 0x5A00_000B;
const MILLISECOND: u64 = 48_055;

fn set_bit(chip: &mut TestChip, number: u32) {
    write(chip, FCR, SET_BIT | number << 8);
    wait_for(chip, FSR, 1);
}

/// Fill the page with a word, and wait until it is there.
fn program(chip: &mut TestChip, word: u32) {
    begin(chip, word);
    let now = chip.now();
    run_to(chip, now + 7 * MILLISECOND);
    assert_eq!(read(chip, FSR) & 1, 1);
}

fn begin(chip: &mut TestChip, word: u32) {
    (0..64).for_each(|n| write(chip, PAGE + 4 * n, word));
    write(chip, FCR, WRITE_992);
}

fn page(chip: &TestChip) -> Vec<u32> {
    let bytes = chip.peek(PAGE, 256).unwrap();
    let words = bytes.chunks(4);
    words
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}

fn set_supply(chip: &mut TestChip, low: bool) {
    chip.board_mut().supply_low = low;
    let now = chip.now();
    run_to(chip, now + 1);
}

#[test]
fn the_detector_holds_the_chip_in_reset_until_the_supply_is_back() {
    let mut chip = running_chip();
    set_bit(&mut chip, 0);
    set_bit(&mut chip, 1);
    set_supply(&mut chip, true);
    assert!(chip.processor_stopped());
    assert_eq!(chip.take_reset(), None);
    for _ in 0..20 {
        chip.skip_to_next_event(chip.now() + 1000 * MILLISECOND);
        assert!(chip.processor_stopped(), "the watchdog does not wake it");
    }
    chip.board_mut().supply_low = false;
    chip.skip_to_next_event(chip.now() + MILLISECOND);
    assert_eq!(chip.take_reset(), Some(ResetCause::BrownOut));
    assert!(!chip.processor_stopped());
    assert_eq!(read(&mut chip, RSTC_SR) >> 8 & 7, 5);
}

#[test]
fn without_its_reset_the_detector_only_sets_its_flag() {
    let mut chip = running_chip();
    set_supply(&mut chip, true);
    assert_eq!(read(&mut chip, RSTC_SR) & 2, 0, "it is off");
    set_supply(&mut chip, false);
    set_bit(&mut chip, 0);
    set_supply(&mut chip, true);
    assert!(!chip.processor_stopped());
    assert_eq!(read(&mut chip, RSTC_SR) & 2, 2);
    assert_eq!(read(&mut chip, RSTC_SR) & 2, 0, "reading clears it");
}

#[test]
fn a_page_is_left_as_far_as_it_was_erased_or_programmed() {
    for (after_us, erased) in [
        (10, false),
        (1500, false),
        (2990, false),
        (3500, true),
        (5900, true),
    ] {
        let mut chip = running_chip();
        program(&mut chip, 0x0F0F_0F0F);
        begin(&mut chip, 0x3333_3333);
        let now = chip.now();
        run_to(&mut chip, now + after_us * MILLISECOND / 1000);
        set_supply(&mut chip, true);
        let allowed: u32 = if erased { 0x3333_3333 } else { 0x0F0F_0F0F };
        let zeros: u32 = page(&chip).iter().map(|word| word.count_zeros()).sum();
        assert!(
            page(&chip).iter().all(|word| word & allowed == allowed),
            "{after_us} us"
        );
        let share = f64::from(zeros) / 1024.0;
        let expected = (after_us as f64 / 3000.0 - 1.0).abs();
        assert!((share - expected).abs() < 0.06, "{after_us} us: {share}");
        assert_eq!(read(&mut chip, FSR) & 1, 1);
    }
}

/// Every cell has its own speed: which ones are reached is a draw for each page, always the same.
#[test]
fn pages_interrupted_at_the_same_cycle_differ_in_their_cells() {
    let left = |number: u32| {
        let mut chip = running_chip();
        let page = 0x0010_0000 + 256 * number;
        (0..64).for_each(|n| write(&mut chip, page + 4 * n, 0));
        write(&mut chip, FCR, 0x5A00_0001 | number << 8);
        let now = chip.now();
        run_to(&mut chip, now + 4 * MILLISECOND);
        set_supply(&mut chip, true);
        chip.peek(page, 256).unwrap().to_vec()
    };
    assert_eq!(left(992), left(992));
    assert_ne!(left(992), left(993));
}

#[test]
fn a_finished_page_stays_and_a_low_supply_programs_nothing() {
    let mut chip = running_chip();
    program(&mut chip, 0x0F0F_0F0F);
    set_supply(&mut chip, true);
    assert_eq!(page(&chip), [0x0F0F_0F0F; 64]);
    program(&mut chip, 0x3333_3333);
    assert_eq!(page(&chip), [0x0F0F_0F0F; 64]);
    set_supply(&mut chip, false);
    program(&mut chip, 0x3333_3333);
    assert_eq!(page(&chip), [0x3333_3333; 64]);
}

#[test]
fn a_lost_supply_interrupts_programming_too() {
    let mut chip = running_chip();
    program(&mut chip, 0);
    begin(&mut chip, 0);
    let now = chip.now();
    run_to(&mut chip, now + 3 * MILLISECOND);
    chip.board_mut().dead = true;
    let now = chip.now();
    run_to(&mut chip, now + 1);
    assert_eq!(page(&chip), [0xFFFF_FFFF; 64]);
}
