// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The display under the command sequences of the known programs.

use crate::common::{milliseconds, Rig};
use at91sam7s::board::Board;
use nxt::{BoardEventKind, BoardFault, Picture, COLUMNS, ROWS};

const SELECT: u32 = 1 << 10;
const A0: u32 = 1 << 12;

/// How a program reaches the display.
#[derive(Clone, Copy, PartialEq)]
enum Wiring {
    /// PA10 belongs to the SPI as a select line.
    SelectLine,
    /// PA10 is an output that stays low.
    HeldLow,
}

struct Lcd {
    rig: Rig,
    wiring: Wiring,
    /// Cycles from one byte to the next.
    byte_cycles: u64,
}

impl Lcd {
    fn new(wiring: Wiring) -> Self {
        let byte_cycles = match wiring {
            Wiring::SelectLine => 192,
            Wiring::HeldLow => 960,
        };
        Self {
            rig: Rig::running("{}", "{}"),
            wiring,
            byte_cycles,
        }
    }

    fn send(&mut self, data: bool, bytes: &[u8]) {
        let level = if data { A0 } else { 0 };
        let (driven, selected) = match self.wiring {
            Wiring::SelectLine => (A0, SELECT),
            Wiring::HeldLow => (A0 | SELECT, 0),
        };
        self.rig.outputs(driven, level);
        for &byte in bytes {
            self.rig.run(self.byte_cycles);
            self.rig
                .board
                .spi_frame(self.rig.now, selected, u16::from(byte), 8);
        }
    }

    fn command(&mut self, bytes: &[u8]) {
        self.send(false, bytes);
    }

    fn pause(&mut self, time: u64) {
        self.rig.run(milliseconds(time));
    }

    fn picture(&self) -> Picture {
        self.rig.board.display().picture()
    }

    fn pictures_reported(&mut self) -> Vec<u64> {
        let events = self.rig.events().into_iter();
        events
            .filter_map(|(_, kind)| match kind {
                BoardEventKind::DisplayChanged(digest) => Some(digest),
                _ => None,
            })
            .collect()
    }
}

/// A frame buffer: byte (page, column) of a picture without symmetry.
fn pattern(page: usize, column: usize) -> u8 {
    ((page * 41 + column * 7 + column * column / 3) % 251) as u8
}

fn page(page: usize) -> Vec<u8> {
    (0..COLUMNS).map(|column| pattern(page, column)).collect()
}

fn expect_pattern(picture: &Picture) {
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let wanted = pattern(row / 8, column) >> (row % 8) & 1 != 0;
            assert_eq!(
                picture.pixel(column, row),
                wanted,
                "column {column}, row {row}"
            );
        }
    }
}

#[test]
fn lego_sequence_sets_up_and_addresses_each_page_at_every_refresh() {
    let mut lcd = Lcd::new(Wiring::SelectLine);
    for _ in 0..3 {
        lcd.command(&[
            0xEB, 0x2F, 0xA4, 0xA6, 0x40, 0x81, 0x5A, 0xC4, 0x27, 0x29, 0xA0, 0x88, 0x23, 0xAF,
        ]);
        for number in 0..8 {
            lcd.pause(1);
            lcd.command(&[0xB0 + number, 0x10, 0x00]);
            lcd.pause(1);
            lcd.send(true, &page(usize::from(number)));
        }
        expect_pattern(&lcd.picture());
    }
    assert_eq!(lcd.rig.board.display().contrast(), 0x5A);
    lcd.pause(30);
    let reported = lcd.pictures_reported();
    assert_eq!(reported.last(), Some(&lcd.picture().digest()));
}

#[test]
fn lejos_sequence_relies_on_wrapping_132_columns_after_reset() {
    let mut lcd = Lcd::new(Wiring::SelectLine);
    lcd.pause(20);
    lcd.command(&[0xE2]);
    lcd.pause(20);
    lcd.command(&[0x81, 0x60, 0xC4]);
    lcd.command(&[0xAE, 0x81, 0x60, 0xAF]);
    for _ in 0..3 {
        for number in 0..8 {
            lcd.send(true, &page(number));
            lcd.send(true, &[0xAA; 32]);
        }
        expect_pattern(&lcd.picture());
    }
}

#[test]
fn nxos_and_pybricks_sequence_refreshes_without_ever_addressing_again() {
    let mut lcd = Lcd::new(Wiring::HeldLow);
    lcd.pause(20);
    lcd.command(&[0xE2]);
    lcd.pause(20);
    lcd.command(&[0x23, 0xEB, 0x81, 0x5C, 0x89, 0xC4, 0x00, 0x10, 0xB0, 0xAF]);
    for _ in 0..3 {
        for number in 0..8 {
            lcd.send(true, &page(number));
            let first = page(number)[..32].to_vec();
            lcd.send(true, &first);
        }
        expect_pattern(&lcd.picture());
    }
    lcd.command(&[0xE2]);
    assert_eq!(lcd.picture().rows, [0; ROWS]);
}

#[test]
fn gnat_sequence_with_its_odd_byte_84_shows_pages_that_are_addressed() {
    let mut lcd = Lcd::new(Wiring::HeldLow);
    lcd.command(&[0xE2]);
    lcd.pause(20);
    lcd.command(&[0xEB, 0x81, 0x60, 0x84, 0xC4, 0x40, 0xAF]);
    for number in 0..8 {
        lcd.command(&[0xB0 + number, 0x10, 0x00]);
        lcd.send(true, &page(usize::from(number)));
    }
    expect_pattern(&lcd.picture());
    let faults = lcd.rig.events().into_iter();
    assert_eq!(
        faults
            .filter(|(_, k)| matches!(k, BoardEventKind::Fault(_)))
            .count(),
        0
    );
}

#[test]
fn nxtosek_sequence_shows_the_picture() {
    let mut lcd = Lcd::new(Wiring::SelectLine);
    lcd.command(&[0xE2, 0x23, 0xEB, 0x81, 0x60, 0x89, 0xC4, 0xAF]);
    for number in 0..8 {
        lcd.send(true, &page(number));
        lcd.send(true, &[0; 32]);
    }
    expect_pattern(&lcd.picture());
}

/// A display that is on, upright, with the pattern in its RAM.
fn shown() -> Lcd {
    let mut lcd = Lcd::new(Wiring::SelectLine);
    lcd.command(&[0xE2, 0xC4, 0xAF]);
    for number in 0..8 {
        lcd.send(true, &page(number));
        lcd.send(true, &[0; 32]);
    }
    lcd
}

#[test]
fn without_wrapping_the_last_column_takes_all_further_bytes() {
    let mut lcd = shown();
    lcd.command(&[0x88, 0xB2, 0x10, 0x00]);
    lcd.send(true, &[0x0F; 300]);
    for row in 16..24 {
        assert!((0..COLUMNS).all(|column| lcd.picture().pixel(column, row) == (row < 20)));
    }
    assert_eq!(lcd.picture().pixel(0, 24), pattern(3, 0) & 1 != 0);
}

#[test]
fn page_first_order_fills_columns_downwards_and_upwards() {
    for (control, first_page) in [(0x8B, 0xB0), (0x8F, 0xB7)] {
        let mut lcd = shown();
        lcd.command(&[control, first_page, 0x10, 0x00]);
        let order: Vec<usize> = if control == 0x8B {
            (0..8).collect()
        } else {
            (0..8).rev().collect()
        };
        for column in 0..COLUMNS {
            let bytes: Vec<u8> = order.iter().map(|page| pattern(*page, column)).collect();
            lcd.send(true, &bytes);
        }
        expect_pattern(&lcd.picture());
    }
}

#[test]
fn display_off_all_on_and_inverse_change_the_glass_but_not_the_memory() {
    let mut lcd = shown();
    lcd.command(&[0xAE]);
    assert_eq!(lcd.picture().rows, [0; ROWS]);
    lcd.command(&[0xAF, 0xA5]);
    assert_eq!(lcd.picture().rows, [(1_u128 << COLUMNS) - 1; ROWS]);
    lcd.command(&[0xA4, 0xA7]);
    let inverse = lcd.picture();
    lcd.command(&[0xA6]);
    expect_pattern(&lcd.picture());
    for (bits, other) in inverse.rows.iter().zip(lcd.picture().rows) {
        assert_eq!(bits ^ other, (1 << COLUMNS) - 1);
    }
}

#[test]
fn the_start_line_scrolls_and_the_mapping_mirrors() {
    let mut lcd = shown();
    let upright = lcd.picture();
    lcd.command(&[0x40 + 5]);
    for row in 0..ROWS {
        assert_eq!(lcd.picture().rows[row], upright.rows[(row + 5) % ROWS]);
    }
    lcd.command(&[0x40, 0xC0]);
    for row in 0..ROWS {
        assert_eq!(lcd.picture().rows[row], upright.rows[ROWS - 1 - row]);
    }
    lcd.command(&[0xC6, 0xB0, 0x10 + 2, 0x00]);
    lcd.send(true, &[0xFF]);
    assert!(lcd.picture().pixel(131 - 32, 0));
}

#[test]
fn every_command_is_taken_and_the_electrical_ones_change_no_pixel() {
    let electrical = (0x20..=0x2F).chain(0xA0..=0xA3).chain(0xE8..=0xEB);
    for byte in electrical.chain([0xE3, 0x84, 0x85, 0x86, 0x87]) {
        let mut lcd = shown();
        lcd.command(&[byte]);
        expect_pattern(&lcd.picture());
    }
    // The byte after the contrast command is its value, whatever it looks like.
    let mut lcd = shown();
    lcd.command(&[0x81, 0xAE]);
    expect_pattern(&lcd.picture());
    let others = (0x00..=0x1F).chain(0x40..=0x7F).chain(0x88..=0x8F);
    let others = others.chain(0xA4..=0xA7).chain(0xAE..=0xC7);
    let others = others.chain([0xE2, 0xEE, 0xEF]);
    for byte in others {
        let mut lcd = shown();
        lcd.rig.events();
        lcd.command(&[byte]);
        let kinds: Vec<_> = lcd.rig.events().into_iter().map(|(_, kind)| kind).collect();
        let fault = kinds
            .iter()
            .any(|kind| matches!(kind, BoardEventKind::Fault(_)));
        assert!(!fault, "{byte:#04X}: {kinds:?}");
    }
}

#[test]
fn lines_beyond_the_end_or_outside_a_part_stay_clear_whatever_is_shown() {
    let mut lcd = shown();
    let upright = lcd.picture();
    let driven = |lcd: &Lcd, first: usize, last: usize| {
        for (row, bits) in lcd.picture().rows.into_iter().enumerate() {
            let wanted = if (first..=last).contains(&row) {
                upright.rows[row]
            } else {
                0
            };
            assert_eq!(bits, wanted, "row {row}");
        }
    };
    lcd.command(&[0xF1, 39]);
    driven(&lcd, 0, 39);
    lcd.command(&[0xF2, 8, 0xF3, 15]);
    driven(&lcd, 0, 39);
    lcd.command(&[0x85]);
    driven(&lcd, 8, 15);
    lcd.command(&[0xA5]);
    let dark = lcd.picture().rows.into_iter().filter(|bits| *bits != 0);
    assert_eq!(dark.count(), 8);
    lcd.command(&[0xA4, 0x84, 0xF1, 63, 0x30, 0xAE, 0x31, 0xE2]);
    driven(&lcd, 0, 63);
}

#[test]
fn cursor_update_mode_returns_to_the_column_where_it_began() {
    let mut lcd = shown();
    lcd.command(&[0xB0, 0x10, 0x07, 0xEF]);
    lcd.send(true, &[0xFF, 0x00]);
    lcd.command(&[0xEE]);
    lcd.send(true, &[0x81]);
    let column: Vec<bool> = (0..8).map(|row| lcd.picture().pixel(7, row)).collect();
    assert_eq!(
        column,
        [true, false, false, false, false, false, false, true]
    );
}

#[test]
fn the_icon_page_does_not_appear_on_the_glass() {
    let mut lcd = shown();
    lcd.command(&[0xB8, 0x10, 0x00]);
    lcd.send(true, &[0xFF; 132]);
    expect_pattern(&lcd.picture());
    lcd.send(true, &page(0));
    expect_pattern(&lcd.picture());
}

#[test]
fn frames_for_another_select_line_or_with_pa10_high_do_not_reach_the_display() {
    let mut lcd = shown();
    let before = lcd.picture();
    lcd.rig.outputs(A0, A0);
    for selected in [0, !SELECT] {
        lcd.rig.board.spi_frame(lcd.rig.now, selected, 0x3C, 8);
    }
    lcd.rig.outputs(A0 | SELECT, A0 | SELECT);
    lcd.rig.board.spi_frame(lcd.rig.now, 0, 0x3C, 8);
    assert_eq!(lcd.picture(), before);
}

#[test]
fn unknown_commands_and_frame_lengths_are_reported() {
    let mut lcd = shown();
    lcd.pause(30);
    lcd.rig.events();
    lcd.command(&[0xF5]);
    lcd.rig.board.spi_frame(lcd.rig.now, SELECT, 0x101, 9);
    let kinds: Vec<_> = lcd.rig.events().into_iter().map(|(_, kind)| kind).collect();
    assert_eq!(
        kinds,
        [
            BoardEventKind::Fault(BoardFault::DisplayCommand { byte: 0xF5 }),
            BoardEventKind::Fault(BoardFault::DisplayFrame { bits: 9 }),
        ]
    );
}

#[test]
fn a_refresh_reports_one_change_and_an_equal_refresh_none() {
    let mut lcd = shown();
    lcd.pause(30);
    let digest = lcd.picture().digest();
    assert_eq!(lcd.pictures_reported(), [digest]);
    for number in 0..8 {
        lcd.send(true, &page(number));
        lcd.send(true, &[0; 32]);
    }
    lcd.pause(30);
    assert!(lcd.pictures_reported().is_empty());
    lcd.send(true, &[!pattern(0, 0)]);
    lcd.pause(30);
    let changed = lcd.pictures_reported();
    assert_eq!(changed, [lcd.picture().digest()]);
    assert_ne!(changed, [digest]);
}

#[test]
fn the_picture_is_given_as_one_byte_per_pixel() {
    let bytes = shown().picture().to_bytes();
    assert_eq!(bytes.len(), ROWS * COLUMNS);
    for (index, byte) in bytes.into_iter().enumerate() {
        let (row, column) = (index / COLUMNS, index % COLUMNS);
        assert_eq!(byte, pattern(row / 8, column) >> (row % 8) & 1);
    }
}
