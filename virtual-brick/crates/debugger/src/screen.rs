// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The display as text: read with the letters that the image itself draws, or as blocks.

use virtual_brick::VirtualBrick;

const COLUMNS: usize = 100;
const ROWS: usize = 64;
/// Drivers, package `NXT.Fonts`: letters from ' ' to '~', five columns each, the lowest bit on
/// top, in cells of 6 x 8 pixels from column 2 on.
const FONT: &str = "nxt__fonts__shapes";
const FIRST_LETTER: u8 = b' ';
const LETTERS: usize = 95;
const WIDTH: usize = 5;
const CELL_WIDTH: usize = 6;
const CELL_HEIGHT: usize = 8;
const MARGIN: usize = 2;
const CELLS: usize = 16;
const BLOCKS: [char; 4] = [' ', '▀', '▄', '█'];

/// The text when every cell holds a letter, the picture otherwise.
pub(crate) fn show(brick: &VirtualBrick) -> String {
    let pixels = brick.lcd();
    let font = brick
        .image()
        .symbols()
        .get(FONT)
        .and_then(|symbol| brick.read_memory(symbol.address, WIDTH * LETTERS).ok());
    font.and_then(|font| text(&pixels, &font))
        .unwrap_or_else(|| picture(&pixels))
}

fn dark(pixels: &[u8], column: usize, row: usize) -> bool {
    pixels.get(row * COLUMNS + column).is_some_and(|p| *p != 0)
}

fn text(pixels: &[u8], font: &[u8]) -> Option<String> {
    let mut lines = String::new();
    for top in (0..ROWS).step_by(CELL_HEIGHT) {
        let mut line = String::new();
        for cell in 0..CELLS {
            let left = MARGIN + cell * CELL_WIDTH;
            let shape: Vec<u8> = (left..left + WIDTH)
                .map(|column| {
                    (0..CELL_HEIGHT)
                        .map(|row| u8::from(dark(pixels, column, top + row)) << row)
                        .sum()
                })
                .collect();
            let letter = font.chunks_exact(WIDTH).position(|known| known == shape)?;
            line.push(char::from(FIRST_LETTER + u8::try_from(letter).ok()?));
        }
        lines.push_str(&format!("|{line}|\n"));
    }
    Some(lines)
}

/// Two rows of pixels in one line.
fn picture(pixels: &[u8]) -> String {
    let mut lines = String::new();
    for row in (0..ROWS).step_by(2) {
        let block = |column| {
            let upper = usize::from(dark(pixels, column, row));
            let lower = usize::from(dark(pixels, column, row + 1));
            BLOCKS[upper + 2 * lower]
        };
        let line: String = (0..COLUMNS).map(block).collect();
        lines.push_str(line.trim_end());
        lines.push('\n');
    }
    lines
}
