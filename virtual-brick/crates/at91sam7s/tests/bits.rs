// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Every bit of every register: kept, refused with a fault, or without effect.
//!
//! The rows are written from the register descriptions of the datasheet (6175M), apart from the
//! tables of the peripherals.

use crate::common::{
    read, running_chip, try_write, write, TestChip, ADC, AIC, MC, PIOA, PIT, PMC, SPI, TC0, TWI,
};
use crate::registers::modelled;
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::FaultKind;

const UDP: u32 = 0xFFFB_0000;
const USART0: u32 = 0xFFFC_0000;
const USART1: u32 = 0xFFFC_4000;
const PWMC: u32 = 0xFFFC_C000;
const SSC: u32 = 0xFFFD_4000;
const DBGU: u32 = 0xFFFF_F200;
const RSTC: u32 = 0xFFFF_FD00;
const RTT: u32 = 0xFFFF_FD20;
const WDT: u32 = 0xFFFF_FD40;
const VREG: u32 = 0xFFFF_FD60;
const KEY: u32 = 0xA5 << 24;
const ALL: u32 = u32::MAX;

/// What becomes of the bits that are written to one register.
#[derive(Clone, Debug)]
struct Row {
    register: u32,
    /// Register in which the `kept` bits appear; none when nothing is to be seen.
    shown: Option<u32>,
    kept: u32,
    refused: u32,
    /// Bits that go with each bit that is tried: a key, a mode.
    with: u32,
    before: Vec<(u32, u32)>,
    /// The bits that are written are cleared in `shown`.
    clears: bool,
}

impl Row {
    fn refusing(self, refused: u32) -> Self {
        Self { refused, ..self }
    }

    fn with(self, with: u32) -> Self {
        Self { with, ..self }
    }

    fn after(mut self, register: u32, value: u32) -> Self {
        self.before.push((register, value));
        self
    }
}

/// Bits that can be read where they were written.
fn stored(register: u32, kept: u32) -> Row {
    sets(register, register, kept)
}

fn sets(register: u32, shown: u32, kept: u32) -> Row {
    Row {
        shown: Some(shown),
        kept,
        ..command(register)
    }
}

/// A register that sets bits in the third, and one that clears them.
fn pair(set: u32, clear: u32, shown: u32, kept: u32) -> [Row; 2] {
    let clearing = Row {
        clears: true,
        ..sets(clear, shown, kept).after(set, kept)
    };
    [sets(set, shown, kept), clearing]
}

/// A register whose bits are commands or are only read.
fn command(register: u32) -> Row {
    Row {
        register,
        shown: None,
        kept: 0,
        refused: 0,
        with: 0,
        before: Vec::new(),
        clears: false,
    }
}

fn commands(base: u32, offsets: impl IntoIterator<Item = u32>) -> Vec<Row> {
    let row = |offset| command(base + offset);
    offsets.into_iter().map(row).collect()
}

fn each(first: u32, last: u32) -> impl Iterator<Item = u32> {
    (first..=last).step_by(4)
}

/// A next counter goes to the present counter while that is 0.
fn data_controller(base: u32) -> Vec<Row> {
    let pointers = [0x100, 0x108, 0x110, 0x118].map(|offset| stored(base + offset, ALL));
    let counts = [0x104, 0x10C].map(|offset| stored(base + offset, 0xFFFF));
    let next = [0x114, 0x11C].map(|offset| sets(base + offset, base + offset - 0x10, 0xFFFF));
    let control = commands(base, [0x120, 0x124]);
    [&pointers[..], &counts, &next, &control].concat()
}

fn timer(base: u32) -> Vec<Row> {
    const WAVE: u32 = 1 << 15;
    let external = 1 << 4 | 1 << 5;
    let mut rows = commands(base, [0x00, 0x10, 0x20]);
    rows.extend(pair(base + 0x24, base + 0x28, base + 0x2C, 0xFF));
    rows.extend([
        command(base + 0x2C),
        stored(base + 0x04, 0x000F_C7CF).refusing(external),
        stored(base + 0x04, ALL & !external)
            .with(WAVE)
            .refusing(external),
        stored(base + 0x14, 0xFFFF).after(base + 0x04, WAVE),
        stored(base + 0x18, 0xFFFF).after(base + 0x04, WAVE),
        stored(base + 0x1C, 0xFFFF),
    ]);
    rows
}

fn timers() -> Vec<Row> {
    let mut rows: Vec<Row> = [0x00, 0x40, 0x80].map(|n| timer(TC0 + n)).concat();
    rows.extend([command(TC0 + 0xC0), stored(TC0 + 0xC4, 0x3F)]);
    rows
}

/// The control registers of endpoints keep the settings and TXPKTRDY; type 1 is isochronous.
fn usb_port() -> Vec<Row> {
    let clock = |row: Row| row.after(PMC, 1 << 7);
    let control = each(0x30, 0x3C).map(|offset| stored(UDP + offset, 0x86B0).refusing(1 << 8));
    let mut rows: Vec<Row> = control.collect();
    rows.extend(pair(UDP + 0x10, UDP + 0x14, UDP + 0x18, 0x2B0F));
    rows.extend(commands(UDP, [0x00, 0x18, 0x1C, 0x20]));
    rows.extend(commands(UDP, each(0x50, 0x5C)));
    rows.extend([
        stored(UDP + 0x04, 0x13).refusing(1 << 2),
        stored(UDP + 0x08, 0x17F),
        stored(UDP + 0x28, 0xF),
        stored(UDP + 0x74, 1 << 8),
    ]);
    rows.into_iter().map(clock).collect()
}

fn two_wire() -> Vec<Row> {
    let mut rows = commands(TWI, [0x00, 0x20, 0x2C, 0x30, 0x34]);
    rows.extend(pair(TWI + 0x24, TWI + 0x28, TWI + 0x2C, 0x1C7));
    rows.extend([
        stored(TWI + 0x04, 0x007F_1300),
        stored(TWI + 0x0C, 0x00FF_FFFF),
        stored(TWI + 0x10, 0x0007_FFFF),
    ]);
    rows
}

fn usart(base: u32) -> Vec<Row> {
    let modes = 1 << 2 | 1 << 3 | 1 << 5 | 1 << 8 | 1 << 14 | 1 << 18;
    let mut rows = data_controller(base);
    rows.extend(commands(base, [0x10, 0x14, 0x18, 0x1C, 0x44]));
    rows.extend(pair(base + 0x08, base + 0x0C, base + 0x10, 0x000F_3FFF));
    rows.extend([
        command(base).refusing(1 << 9 | 1 << 12),
        stored(base + 0x04, 0x173F_FFFF & !modes).refusing(modes),
        stored(base + 0x20, 0x0007_FFFF),
        stored(base + 0x24, 0xFFFF),
        stored(base + 0x28, 0xFF),
        stored(base + 0x40, 0x7FF).after(base + 0x40, 0),
        stored(base + 0x4C, 0xFF),
    ]);
    rows
}

fn debug_unit() -> Vec<Row> {
    let mut rows = data_controller(DBGU);
    rows.extend(commands(DBGU, [0x00, 0x10, 0x14, 0x18, 0x1C, 0x40, 0x44]));
    let channel = 3 << 30;
    let masks = pair(DBGU + 0x08, DBGU + 0x0C, DBGU + 0x10, 0x1AFB);
    let [enable, disable] = masks;
    rows.extend([
        enable.refusing(channel),
        disable,
        stored(DBGU + 0x04, 0x8E00).refusing(1 << 14),
        stored(DBGU + 0x20, 0xFFFF),
        stored(DBGU + 0x48, 1),
    ]);
    rows
}

fn pulse_width() -> Vec<Row> {
    let mut rows = commands(PWMC, [0x0C, 0x18, 0x1C]);
    rows.extend(pair(PWMC + 0x04, PWMC + 0x08, PWMC + 0x0C, 0xF));
    rows.extend(pair(PWMC + 0x10, PWMC + 0x14, PWMC + 0x18, 0xF));
    rows.push(stored(PWMC, 0x0FFF_0FFF));
    for channel in (0..4).map(|n| PWMC + 0x200 + 0x20 * n) {
        rows.extend(commands(channel, [0x0C, 0x10]));
        rows.extend([
            stored(channel, 0x70F),
            stored(channel + 0x04, 0x000F_FFFF),
            stored(channel + 0x08, 0x000F_FFFF),
        ]);
    }
    rows
}

fn sound() -> Vec<Row> {
    let clock = 3 | 3 << 6 | 0xF << 8 | 0xFF << 16;
    let frame = 7 << 20 | 1 << 23;
    let mut rows = data_controller(SSC);
    rows.extend(commands(SSC, [0x20, 0x24, 0x30, 0x40, 0x4C]));
    rows.extend(pair(SSC + 0x44, SSC + 0x48, SSC + 0x4C, 0xFFF));
    rows.extend([
        command(SSC).refusing(1),
        stored(SSC + 0x04, 0xFFF),
        stored(SSC + 0x10, 0xFFFF_1FFF),
        stored(SSC + 0x14, 0x017F_0FBF),
        stored(SSC + 0x18, 0xFFFF_0FFF & !clock).refusing(clock),
        stored(SSC + 0x1C, 0x01FF_0FBF & !frame).refusing(frame),
        stored(SSC + 0x34, 0xFFFF),
        stored(SSC + 0x38, 0xFFFF),
        stored(SSC + 0x3C, 0xFFFF),
    ]);
    rows
}

/// A hardware trigger is refused together with a source that the chip has no line for.
fn converter() -> Vec<Row> {
    let mut rows = commands(ADC, [0x00, 0x18, 0x1C, 0x20, 0x2C]);
    rows.extend(commands(ADC, each(0x30, 0x4C)));
    rows.extend(pair(ADC + 0x10, ADC + 0x14, ADC + 0x18, 0xFF));
    rows.extend(pair(ADC + 0x24, ADC + 0x28, ADC + 0x2C, 0x000F_FFFF));
    rows.push(stored(ADC + 0x04, 0x0F1F_FF3F));
    rows.push(stored(ADC + 0x04, 0x0F1F_FF37).with(1).refusing(1 << 3));
    rows
}

fn display_port() -> Vec<Row> {
    let mut rows = data_controller(SPI);
    rows.extend(commands(SPI, [0x00, 0x08, 0x0C, 0x10, 0x1C]));
    rows.extend(pair(SPI + 0x14, SPI + 0x18, SPI + 0x1C, 0x3FF));
    rows.push(stored(SPI + 0x04, 0xFF0F_009B).refusing(1 << 2));
    rows.extend(each(0x30, 0x3C).map(|offset| stored(SPI + offset, 0xFFFF_FFFB)));
    rows
}

fn interrupt_controller() -> Vec<Row> {
    let mut rows = commands(AIC, each(0x100, 0x114));
    rows.extend(commands(AIC, [0x128, 0x12C, 0x130, 0x148]));
    rows.extend(each(0x00, 0x7C).map(|offset| stored(AIC + offset, 0x67)));
    rows.extend(each(0x80, 0xFC).map(|offset| stored(AIC + offset, ALL)));
    rows.extend(pair(AIC + 0x120, AIC + 0x124, AIC + 0x110, ALL));
    rows.extend(pair(AIC + 0x140, AIC + 0x144, AIC + 0x148, ALL & !1));
    rows.extend([stored(AIC + 0x134, ALL), stored(AIC + 0x138, 3)]);
    rows
}

fn pins() -> Vec<Row> {
    let triples = [
        (0x10, 0x14),
        (0x20, 0x24),
        (0x30, 0x34),
        (0x40, 0x44),
        (0x50, 0x54),
    ];
    let same = triples.into_iter().flat_map(|(set, clear)| {
        let shown = PIOA + clear + 4;
        pair(PIOA + set, PIOA + clear, shown, ALL)
    });
    let mut rows: Vec<Row> = same.collect();
    for (set, clear) in [(0x04, 0x00), (0x64, 0x60)] {
        // All pins begin with the PIO controller and pulled up.
        let [first, second] = pair(PIOA + clear, PIOA + set, PIOA + clear.max(set) + 4, ALL);
        rows.extend([first.after(PIOA + set, ALL), second]);
    }
    rows.extend(pair(PIOA + 0x74, PIOA + 0x70, PIOA + 0x78, ALL));
    rows.extend(pair(PIOA + 0xA0, PIOA + 0xA4, PIOA + 0xA8, ALL));
    rows.push(stored(PIOA + 0x38, ALL).after(PIOA + 0xA0, ALL));
    rows.extend(commands(
        PIOA,
        [0x08, 0x18, 0x28, 0x3C, 0x48, 0x4C, 0x58, 0x68, 0x78, 0xA8],
    ));
    rows
}

fn clocks() -> Vec<Row> {
    let slow = |row: Row| row.after(PMC + 0x30, 0);
    let mut rows = commands(PMC, [0x08, 0x18, 0x24, 0x68, 0x6C]);
    rows.extend(pair(PMC, PMC + 0x04, PMC + 0x08, 0x780));
    let [on, off] = pair(PMC + 0x10, PMC + 0x14, PMC + 0x18, 0x7FF4);
    rows.extend([on.after(PMC + 0x14, ALL), off]);
    rows.extend(pair(PMC + 0x60, PMC + 0x64, PMC + 0x6C, 0x70D));
    rows.extend([
        slow(stored(PMC + 0x20, 0xFF01).refusing(1 << 1)).after(PMC + 0x20, 0),
        slow(stored(PMC + 0x2C, 0x37FF_FFFF)).after(PMC + 0x2C, 0),
        stored(PMC + 0x30, 0x1F).with(1 << 2),
    ]);
    rows.extend(each(0x40, 0x48).map(|offset| stored(PMC + offset, 0x1F)));
    rows
}

fn resets_and_timers() -> Vec<Row> {
    vec![
        command(RSTC).with(KEY),
        command(RSTC + 0x04),
        stored(RSTC + 0x08, 0x0001_0F11).with(KEY),
        stored(RTT, 0x0003_FFFF).after(RTT, 0),
        stored(RTT + 0x04, ALL).after(RTT + 0x04, 0),
        command(RTT + 0x08),
        command(RTT + 0x0C),
        stored(PIT, 0x030F_FFFF).after(PIT, 0),
        command(PIT + 0x04),
        command(PIT + 0x08),
        command(PIT + 0x0C),
        command(WDT).with(KEY),
        // The boot monitor has used up the one write of the mode register.
        command(WDT + 0x04),
        command(WDT + 0x08),
        stored(VREG, 1),
    ]
}

fn memory_controller() -> Vec<Row> {
    let mut rows = commands(MC, [0x00, 0x04, 0x08, 0x64, 0x68]);
    rows.push(stored(MC + 0x60, 0x00FF_038D).after(MC + 0x60, 0));
    rows.push(command(MC + 0x64).with(0x5A << 24));
    rows
}

fn rows() -> Vec<Row> {
    [
        timers(),
        usb_port(),
        two_wire(),
        usart(USART0),
        usart(USART1),
        debug_unit(),
        pulse_width(),
        sound(),
        converter(),
        display_port(),
        interrupt_controller(),
        pins(),
        clocks(),
        resets_and_timers(),
        memory_controller(),
    ]
    .concat()
}

/// A chip on which the row's other registers are written.
fn prepared(row: &Row) -> TestChip {
    let mut chip = running_chip();
    for (register, value) in &row.before {
        write(&mut chip, *register, *value);
        chip.internal(10);
    }
    chip
}

/// What the row's register shows after it was written, long after a write could cross clocks.
fn shown_after(row: &Row, value: u32) -> u32 {
    let mut chip = prepared(row);
    write(&mut chip, row.register, value);
    chip.internal(10);
    assert!(chip.fault().is_none(), "{:#010x}", row.register);
    row.shown.map_or(0, |register| read(&mut chip, register))
}

#[test]
fn every_bit_of_every_register_is_kept_refused_or_without_effect() {
    for row in rows() {
        let base = if row.clears {
            let mut chip = prepared(&row);
            row.shown.map_or(0, |register| read(&mut chip, register))
        } else {
            shown_after(&row, row.with)
        };
        for bit in (0..32).map(|number| 1u32 << number) {
            let place = format!("bit {bit:#010x} of {:#010x}", row.register);
            if row.refused & bit != 0 {
                let mut chip = prepared(&row);
                let refused = try_write(&mut chip, row.register, Width::Word, row.with | bit);
                assert!(refused.is_err(), "{place} is not refused");
                let kind = chip.fault().unwrap().kind;
                let named = matches!(kind, FaultKind::FeatureNotModelled { .. });
                assert!(named, "{place}: {kind:?}");
                continue;
            }
            let kept = bit & row.kept;
            let expected = if row.clears {
                base & !kept
            } else {
                base | kept
            };
            assert_eq!(shown_after(&row, row.with | bit), expected, "{place}");
        }
    }
}

#[test]
fn the_bits_of_every_modelled_register_are_tried() {
    let tried: Vec<u32> = rows().into_iter().map(|row| row.register).collect();
    for register in modelled().into_keys() {
        assert!(tried.contains(&register), "{register:#010x}");
    }
}
