// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Texts of the display, read with the letters that the image itself draws.

use measures::Screen;
use trace::{Event, EventKind};
use virtual_brick::VirtualBrick;

/// The native run looks at the display in slices of 5 ms, whose last cycles are rounded up.
const SLICES_PER_SECOND: u64 = 200;
/// A slice ends at the first boundary of an instruction after its last cycle.
const OVERRUN_CYCLES: u64 = 100;
/// Drivers, package NXT.Fonts: letters from ' ' to '~', five columns each, the lowest bit on top,
/// in cells of 6 x 8 pixels from column 2 on.
const FONT_SYMBOL: &str = "nxt__fonts__shapes";
const LETTERS: usize = 95;
const WIDTH: usize = 5;
const CELL_WIDTH: usize = 6;
const CELL_HEIGHT: usize = 8;
const MARGIN: usize = 2;
const COLUMNS: usize = 16;
const LCD_WIDTH: usize = 100;

/// What the display showed at the ends of slices.
#[derive(Debug, Default)]
pub struct Displays {
    seen: Vec<Screen>,
    version: Option<u64>,
}

impl Displays {
    /// The next instant to look at the display.
    pub fn next_cycles(brick: &VirtualBrick) -> u64 {
        let (cycles, seconds) = virtual_brick::CLOCK_HZ;
        let slices = brick.cycles() * seconds * SLICES_PER_SECOND / cycles;
        ((slices + 1) * cycles).div_ceil(seconds * SLICES_PER_SECOND)
    }

    /// Look at the display.
    pub fn look(&mut self, brick: &VirtualBrick) {
        let version = Some(brick.lcd_version());
        if self.version != version {
            self.version = version;
            self.seen.push(Screen {
                at_cycles: brick.cycles(),
                text: text(brick),
            });
        }
    }

    /// Text after each whole picture: from the event that ends its transfer on.
    pub fn screens(&self, brick: &VirtualBrick) -> Vec<Screen> {
        let events = brick.trace().events();
        let changed = |event: &Event| event.kind == EventKind::DisplayChanged;
        let mut screens: Vec<Screen> = Vec::new();
        for event in events.iter().filter(changed) {
            let at_cycles = event.at_cycles;
            let end = self.end_of_slice(at_cycles);
            let before = self.seen.partition_point(|seen| seen.at_cycles <= end);
            let Some(shown) = self.seen[..before].last() else {
                continue;
            };
            if screens.last().is_none_or(|last| last.text != shown.text) {
                screens.push(Screen {
                    at_cycles,
                    text: shown.text.clone(),
                });
            }
        }
        screens
    }

    /// When the display was next looked at after an instant.
    fn end_of_slice(&self, at_cycles: u64) -> u64 {
        let (cycles, seconds) = virtual_brick::CLOCK_HZ;
        let slice = (at_cycles * seconds * SLICES_PER_SECOND).div_ceil(cycles);
        let end = (slice * cycles).div_ceil(seconds * SLICES_PER_SECOND);
        end.max(at_cycles) + OVERRUN_CYCLES
    }
}

/// Eight lines without trailing blanks; a cell that holds no letter reads '?'. None where the
/// image has no letters.
fn text(brick: &VirtualBrick) -> Vec<String> {
    let font = brick.image().symbols().find(FONT_SYMBOL).ok();
    let font = font.and_then(|font| brick.read_memory(font.address, WIDTH * LETTERS).ok());
    let Some(font) = font else {
        return Vec::new();
    };
    let pixels = brick.lcd();
    let bands = pixels.chunks_exact(LCD_WIDTH * CELL_HEIGHT);
    bands.map(|band| line(band, &font)).collect()
}

fn line(band: &[u8], font: &[u8]) -> String {
    let column = |x: usize| {
        let bits = (0..CELL_HEIGHT).map(|y| (band[y * LCD_WIDTH + x] & 1) << y);
        bits.fold(0, |column, bit| column | bit)
    };
    let letter = |cell: usize| {
        let first = MARGIN + CELL_WIDTH * cell;
        let drawn: [u8; WIDTH] = std::array::from_fn(|x| column(first + x));
        let place = font.chunks_exact(WIDTH).rposition(|shape| shape == drawn);
        place.map_or('?', |place| char::from(b' ' + place as u8))
    };
    let line: String = (0..COLUMNS).map(letter).collect();
    line.trim_end().to_owned()
}
