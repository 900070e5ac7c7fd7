// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The display: UC1601 controller with 132 x 65 pixels of RAM, 100 x 64 of them on the glass.

use crate::event::BoardFault;

/// Columns of the picture.
pub const COLUMNS: usize = 100;
/// Rows of the picture.
pub const ROWS: usize = 64;

const RAM_COLUMNS: usize = 132;
/// Pages of eight rows in which the page address wraps.
const PAGES: usize = 8;
/// The ninth page holds the row of icons, which the glass does not have.
const RAM_PAGES: usize = 9;
const LINES: usize = 64;

/// Bits of the RAM address control.
const WRAP: u8 = 1;
const PAGE_FIRST: u8 = 2;
const PAGE_DOWN: u8 = 4;
/// Bits of the mapping control.
const MIRROR_X: u8 = 1;
const MIRROR_Y: u8 = 2;

/// Lines of the glass that the controller drives, from its first.
const LAST_LINE: u8 = 63;

const FNV_OFFSET: u64 = 0xCBF2_9CE4_8422_2325;
const FNV_PRIME: u64 = 0x0000_0100_0000_01B3;

/// A command whose value is the next byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PendingValue {
    Contrast,
    /// Advanced program control: without effect on the picture.
    Advanced,
    LineEnd,
    PartStart,
    PartEnd,
}

/// What the glass shows: bit `c` of a row is column `c` from the left, set when dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Rows from the top.
    pub rows: [u128; ROWS],
}

impl Picture {
    /// Whether the pixel is dark; false outside the glass.
    #[must_use]
    pub fn pixel(&self, column: usize, row: usize) -> bool {
        column < COLUMNS
            && self
                .rows
                .get(row)
                .is_some_and(|bits| bits >> column & 1 != 0)
    }

    /// One byte per pixel, 0 or 1, row by row from the top: 64 rows of 100.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let row = |bits: u128| (0..COLUMNS).map(move |column| (bits >> column & 1) as u8);
        self.rows.iter().flat_map(|&bits| row(bits)).collect()
    }

    /// 64-bit FNV-1a over the rows, each as 16 bytes, low byte first.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let bytes = self.rows.iter().flat_map(|row| row.to_le_bytes());
        bytes.fold(FNV_OFFSET, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME)
        })
    }
}

/// The controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Display {
    ram: [[u8; RAM_COLUMNS]; RAM_PAGES],
    column: usize,
    page: usize,
    start_line: usize,
    address_control: u8,
    mapping: u8,
    contrast: u8,
    enabled: bool,
    inverse: bool,
    all_on: bool,
    version: u64,
    /// Column to which the end of the cursor-update mode returns.
    cursor: Option<usize>,
    awaited: Option<PendingValue>,
    /// Last line that is driven, and the first and last of a part, if only a part is.
    line_end: u8,
    part: (u8, u8),
    in_part: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self::new()
    }
}

impl Display {
    /// State after power-on. The RAM, undefined on real hardware, is empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ram: [[0; RAM_COLUMNS]; RAM_PAGES],
            column: 0,
            page: 0,
            start_line: 0,
            address_control: WRAP,
            mapping: 0,
            contrast: 0xC0,
            enabled: false,
            inverse: false,
            all_on: false,
            version: 0,
            cursor: None,
            awaited: None,
            line_end: LAST_LINE,
            part: (0, LAST_LINE),
            in_part: false,
        }
    }

    /// Potentiometer setting, 0 to 255. The picture does not depend on it.
    #[must_use]
    pub const fn contrast(&self) -> u8 {
        self.contrast
    }

    /// What the glass shows.
    #[must_use]
    pub fn picture(&self) -> Picture {
        let mut picture = Picture { rows: [0; ROWS] };
        if self.enabled {
            for (row, bits) in picture.rows.iter_mut().enumerate() {
                *bits = self.row(row);
            }
        }
        picture
    }

    /// A row of the glass. It is upright when the row order is mirrored: the glass is mounted so.
    fn row(&self, row: usize) -> u128 {
        let common = if self.mapping & MIRROR_Y == 0 {
            LINES - 1 - row
        } else {
            row
        };
        if !self.drives(common) {
            return 0;
        }
        if self.all_on {
            return (1 << COLUMNS) - 1;
        }
        let line = (common + self.start_line) % LINES;
        let page = &self.ram[line / 8];
        let bits = page[..COLUMNS].iter().rev().fold(0_u128, |bits, byte| {
            bits << 1 | u128::from(byte >> (line % 8) & 1)
        });
        if self.inverse {
            bits ^ ((1 << COLUMNS) - 1)
        } else {
            bits
        }
    }

    /// A line that is not driven stays clear.
    fn drives(&self, common: usize) -> bool {
        let (first, last) = self.part;
        let in_part = !self.in_part || (usize::from(first)..=usize::from(last)).contains(&common);
        common <= usize::from(self.line_end) && in_part
    }

    /// Grows with each byte that the controller gets: while it stays, so does the picture.
    #[must_use]
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// A byte of pixels, the least significant uppermost. Beyond the RAM it is lost.
    pub(crate) fn write_data(&mut self, byte: u8) {
        self.version += 1;
        if self.column >= RAM_COLUMNS {
            return;
        }
        let mirrored = self.mapping & MIRROR_X != 0;
        let column = if mirrored {
            RAM_COLUMNS - 1 - self.column
        } else {
            self.column
        };
        self.ram[self.page][column] = byte;
        self.advance_address();
    }

    fn advance_address(&mut self) {
        let wrap = self.address_control & WRAP != 0;
        if self.address_control & PAGE_FIRST == 0 {
            if self.column + 1 < RAM_COLUMNS {
                self.column += 1;
            } else if wrap {
                self.column = 0;
                self.page = self.next_page();
            }
            return;
        }
        let down = self.address_control & PAGE_DOWN != 0;
        let at_end = if down {
            self.page == 0
        } else {
            self.page + 1 >= PAGES
        };
        if !at_end {
            self.page = self.next_page();
        } else if wrap {
            self.page = self.next_page();
            self.column = (self.column + 1) % RAM_COLUMNS;
        }
    }

    const fn next_page(&self) -> usize {
        match (self.address_control & PAGE_DOWN == 0, self.page) {
            (true, page) if page + 1 < PAGES => page + 1,
            (true, _) => 0,
            (false, 0) => PAGES - 1,
            (false, page) => page - 1,
        }
    }

    /// A command byte, or the value of the command before it.
    pub(crate) fn write_command(&mut self, byte: u8) -> Result<(), BoardFault> {
        self.version += 1;
        if let Some(awaited) = self.awaited.take() {
            self.set(awaited, byte);
            return Ok(());
        }
        let low = usize::from(byte & 0x0F);
        match byte {
            0x00..=0x0F => self.column = self.column & 0xF0 | low,
            0x10..=0x1F => self.column = self.column & 0x0F | low << 4,
            0x30 | 0x31 => self.awaited = Some(PendingValue::Advanced),
            0x40..=0x7F => self.start_line = usize::from(byte & 0x3F),
            0x81 => self.awaited = Some(PendingValue::Contrast),
            0x84 | 0x85 => self.in_part = byte & 1 != 0,
            0x88..=0x8F => self.address_control = byte & 7,
            0xA4 | 0xA5 => self.all_on = byte & 1 != 0,
            0xA6 | 0xA7 => self.inverse = byte & 1 != 0,
            0xAE | 0xAF => self.enabled = byte & 1 != 0,
            0xB0..=0xBF => self.page = low.min(RAM_PAGES - 1),
            0xC0..=0xC7 => self.mapping = byte >> 1 & 3,
            0xE2 => self.reset(),
            0xEE => self.end_cursor_update(),
            0xEF => self.cursor = Some(self.column),
            0xF1 => self.awaited = Some(PendingValue::LineEnd),
            0xF2 => self.awaited = Some(PendingValue::PartStart),
            0xF3 => self.awaited = Some(PendingValue::PartEnd),
            _ if is_electrical(byte) => {}
            _ => return Err(BoardFault::DisplayCommand { byte }),
        }
        Ok(())
    }

    fn set(&mut self, awaited: PendingValue, value: u8) {
        match awaited {
            PendingValue::Contrast => self.contrast = value,
            PendingValue::Advanced => {}
            PendingValue::LineEnd => self.line_end = value & 0x7F,
            PendingValue::PartStart => self.part.0 = value & 0x7F,
            PendingValue::PartEnd => self.part.1 = value & 0x7F,
        }
    }

    fn end_cursor_update(&mut self) {
        if let Some(column) = self.cursor.take() {
            self.column = column;
        }
    }

    /// Registers as after power-on; the RAM keeps its content.
    fn reset(&mut self) {
        *self = Self {
            ram: self.ram,
            ..Self::new()
        };
    }
}

/// Commands without effect on the picture: multiplex rate, temperature compensation, panel
/// loading, pump (2x), reserved 86 and 87, frame rate, no operation, bias. The controller's test
/// commands (E4 to E7) are not among them: what they do is not published.
const fn is_electrical(byte: u8) -> bool {
    matches!(byte, 0x20..=0x2F | 0x86..=0x87 | 0xA0..=0xA3 | 0xE3 | 0xE8..=0xEB)
}
