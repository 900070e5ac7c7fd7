// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Synchronous serial controller: the sound line.
use crate::common::{
    bus_log, read, run_to, running_chip, try_write, write, Seen, TestChip, PIOA, SRAM,
};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::board::SoundBits;
use at91sam7s::FaultKind;

const SSC: u32 = 0xFFFD_4000;
registers! {
    SSC; CR = 0x00, CMR = 0x04, TCMR = 0x18, TFMR = 0x1C, THR = 0x24, SR = 0x40, IER = 0x44,
    TNPR = 0x118, TNCR = 0x11C, TPR = 0x108, TCR = 0x10C, PTCR = 0x120,
}
const TXRDY: u32 = 1;
const TXEMPTY: u32 = 2;
const ENDTX: u32 = 4;
const TXSYN: u32 = 1 << 10;
const MSBF: u32 = 1 << 7;

/// 32-bit words, highest bit first, `divider` half bit times, PA17 given to the controller.
fn sound_chip(divider: u32) -> TestChip {
    let mut chip = running_chip();
    write(&mut chip, PIOA + 0x70, 1 << 17);
    write(&mut chip, PIOA + 0x04, 1 << 17);
    write(&mut chip, CR, 1 << 15);
    write(&mut chip, CMR, divider);
    write(&mut chip, TCMR, 4);
    write(&mut chip, TFMR, 31 | 7 << 8 | MSBF);
    write(&mut chip, CR, 1 << 8);
    chip.board_mut().log.clear();
    chip
}

fn sounds(chip: &TestChip, start: u64) -> Vec<(u64, u32)> {
    let bits = |(at, seen)| match seen {
        Seen::Sound(SoundBits { bits, .. }) => (at, bits),
        other => panic!("{other:?}"),
    };
    bus_log(chip, start).into_iter().map(bits).collect()
}

#[test]
fn a_word_lasts_its_bits_at_twice_the_divider_each() {
    let mut chip = sound_chip(10);
    assert_eq!(read(&mut chip, SR), 0x0001_00CF);
    write(&mut chip, THR, 0xF0F0_1234);
    let start = chip.now();
    assert_eq!(read(&mut chip, SR) & 3, TXRDY);
    run_to(&mut chip, start + 32 * 20 + 1);
    let expected = SoundBits {
        bits: 0xF0F0_1234,
        count: 32,
        bit_cycles: 20,
    };
    assert_eq!(bus_log(&chip, start), [(640, Seen::Sound(expected))]);
    assert_eq!(read(&mut chip, SR) & 3, TXRDY | TXEMPTY);
}

#[test]
fn words_of_two_buffers_follow_each_other_without_a_gap() {
    let mut chip = sound_chip(4);
    for (at, word) in (0..).zip([1u32, 2, 3, 4]) {
        chip.load(SRAM + 4 * at, &word.to_le_bytes()).unwrap();
    }
    write(&mut chip, TPR, SRAM);
    write(&mut chip, TCR, 2);
    write(&mut chip, TNPR, SRAM + 8);
    write(&mut chip, TNCR, 2);
    write(&mut chip, PTCR, 1 << 8);
    let start = chip.now() - 2;
    run_to(&mut chip, start + 5 * 256);
    let expected = [(256, 1), (512, 2), (768, 3), (1024, 4)];
    assert_eq!(sounds(&chip, start), expected);
}

#[test]
fn the_end_of_a_buffer_interrupts_while_the_last_words_are_shifted() {
    let mut chip = sound_chip(4);
    write(&mut chip, IER, ENDTX);
    write(&mut chip, TNPR, SRAM);
    write(&mut chip, TNCR, 3);
    write(&mut chip, PTCR, 1 << 8);
    let start = chip.now();
    let pending = |chip: &mut TestChip| read(chip, 0xFFFF_F10C) & 1 << 8 != 0;
    chip.internal(100);
    assert!(!pending(&mut chip));
    run_to(&mut chip, start + 270);
    assert!(pending(&mut chip), "one word shifts, the last one waits");
    assert_eq!(read(&mut chip, SR) & (ENDTX | TXEMPTY), ENDTX);
}

#[test]
fn the_lowest_bit_leaves_first_unless_the_highest_is_chosen() {
    let mut chip = sound_chip(4);
    write(&mut chip, TFMR, 7);
    write(&mut chip, THR, 0x0000_AB01);
    let start = chip.now();
    run_to(&mut chip, start + 100);
    let expected = SoundBits {
        bits: 0x80,
        count: 8,
        bit_cycles: 8,
    };
    assert_eq!(bus_log(&chip, start), [(64, Seen::Sound(expected))]);
}

/// DATNB + 1 words to a frame, chapter "Transmit Frame Mode Register".
#[test]
fn a_frame_begins_with_the_first_of_its_words() {
    let mut chip = sound_chip(4);
    write(&mut chip, TFMR, 31 | 2 << 8 | MSBF);
    let begins: Vec<bool> = (0..7)
        .map(|word| {
            write(&mut chip, THR, word);
            let begun = read(&mut chip, SR) & TXSYN != 0;
            let now = chip.now();
            run_to(&mut chip, now + 300);
            begun
        })
        .collect();
    assert_eq!(begins, [true, false, false, true, false, false, true]);
}

#[test]
fn a_pin_taken_back_mutes_the_line() {
    let mut chip = sound_chip(4);
    write(&mut chip, PIOA, 1 << 17);
    write(&mut chip, THR, 0xFFFF_FFFF);
    let now = chip.now();
    run_to(&mut chip, now + 300);
    assert_eq!(sounds(&chip, 0), []);
    assert_eq!(
        read(&mut chip, SR) & TXEMPTY,
        TXEMPTY,
        "the controller shifts all the same"
    );
}

#[test]
fn an_unsupported_transmitter_feature_is_a_fault() {
    for (register, value, feature) in [
        (CR, 1, "reception"),
        (TCMR, 1, "a transmit clock from RK or TK"),
        (TCMR, 7 << 8, "a transmit start other than continuous"),
        (TFMR, 1 << 23, "frame synchronisation data"),
    ] {
        let mut chip = sound_chip(4);
        assert!(try_write(&mut chip, register, Width::Word, value).is_err());
        let kind = FaultKind::FeatureNotModelled {
            peripheral: "SSC",
            feature,
        };
        assert_eq!(chip.fault().unwrap().kind, kind);
    }
}
