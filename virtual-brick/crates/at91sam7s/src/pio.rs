// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Parallel input/output controller A (AT91SAM7S datasheet, 6175M, chapter 27).
//!
//! Peripheral inputs always follow the pin; the A/B choice affects outputs only. Pins that
//! nothing drives and nothing pulls keep their last level. The glitch filter lets through every
//! pulse of at least one master clock cycle, which is the shortest that the model can show.

use crate::board::{PinLevels, PinOutputs};
use crate::fault::{Access, FaultKind};

/// Lines that on-chip peripherals drive onto pins given to them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PeripheralLines {
    pub(crate) driven: u32,
    pub(crate) level: u32,
}

/// Registers and sampled levels.
#[derive(Clone, Debug)]
pub(crate) struct Pio {
    pio_control: u32,
    output: u32,
    filter: u32,
    data: u32,
    levels: u32,
    mask: u32,
    changes: u32,
    multi_drive: u32,
    pull_up: u32,
    select_b: u32,
    write_enable: u32,
    /// Levels on the pins, whether or not the controller is clocked.
    pins: u32,
}

impl Pio {
    pub(crate) fn new() -> Self {
        Self {
            pio_control: 0xFFFF_FFFF,
            output: 0,
            filter: 0,
            data: 0,
            levels: 0,
            mask: 0,
            changes: 0,
            multi_drive: 0,
            pull_up: 0xFFFF_FFFF,
            select_b: 0,
            write_enable: 0,
            pins: 0,
        }
    }

    /// The pin belongs to peripheral A.
    pub(crate) fn is_peripheral_a(&self, pin: u32) -> bool {
        (self.pio_control | self.select_b) >> pin & 1 == 0
    }

    /// Those of the pins `a` that belong to peripheral A, and those of `b` that belong to B.
    pub(crate) fn given_to_peripherals(&self, a: u32, b: u32) -> u32 {
        !self.pio_control & (!self.select_b & a | self.select_b & b)
    }

    pub(crate) fn filtered(&self, pins: u32) -> bool {
        self.filter & pins != 0
    }

    pub(crate) fn pins(&self) -> u32 {
        self.pins
    }

    /// What the chip drives, given what its peripherals drive on their A and B lines.
    pub(crate) fn outputs(&self, lines_a: PeripheralLines, lines_b: PeripheralLines) -> PinOutputs {
        let own = self.pio_control & self.output & !(self.multi_drive & self.data);
        let a = !self.pio_control & !self.select_b & lines_a.driven;
        let b = !self.pio_control & self.select_b & lines_b.driven;
        PinOutputs {
            driven: own | a | b,
            level: (own & self.data) | (a & lines_a.level) | (b & lines_b.level),
            pull_up: self.pull_up,
        }
    }

    /// Levels that chip and board make together.
    fn joined(&self, outputs: PinOutputs, board: PinLevels) -> u32 {
        let chip = outputs.driven & outputs.level;
        let free = !outputs.driven;
        let outside = free & board.driven & board.level;
        let floating = free & !board.driven;
        let pulled = floating & outputs.pull_up;
        let kept = floating & !outputs.pull_up & self.pins;
        chip | outside | pulled | kept
    }

    /// [`Self::sample`] would find nothing new.
    pub(crate) fn settled(&self, outputs: PinOutputs, board: PinLevels, clocked: bool) -> bool {
        let pins = self.joined(outputs, board);
        pins == self.pins && (!clocked || pins == self.levels)
    }

    /// Work out the pin levels; returns the pins that changed and those that changed and are
    /// seen by a clocked controller.
    pub(crate) fn sample(
        &mut self,
        outputs: PinOutputs,
        board: PinLevels,
        clocked: bool,
    ) -> (u32, u32) {
        let pins = self.joined(outputs, board);
        let changed = pins ^ self.pins;
        self.pins = pins;
        if !clocked {
            return (changed, 0);
        }
        let seen = self.levels ^ pins;
        self.levels = pins;
        self.changes |= seen;
        (changed, seen)
    }

    /// The controller's clock came on: it sees the present levels without counting them as changes.
    pub(crate) fn clock_started(&mut self) {
        self.levels = self.pins;
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.changes & self.mask != 0
    }

    pub(crate) fn mask(&self) -> u32 {
        self.mask
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x08 => self.pio_control,
            0x18 => self.output,
            0x28 => self.filter,
            0x38 => self.data,
            0x3C => self.levels,
            0x48 => self.mask,
            0x4C => std::mem::take(&mut self.changes),
            0x58 => self.multi_drive,
            0x68 => !self.pull_up,
            0x78 => self.select_b,
            0xA8 => self.write_enable,
            0x00 | 0x04 | 0x10 | 0x14 | 0x20 | 0x24 | 0x30 | 0x34 | 0x40 | 0x44 | 0x50 | 0x54
            | 0x60 | 0x64 | 0x70 | 0x74 | 0xA0 | 0xA4 => 0,
            _ => {
                return Err(FaultKind::RegisterNotModelled {
                    peripheral: "PIOA",
                    offset,
                })
            }
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => self.pio_control |= value,
            0x04 => self.pio_control &= !value,
            0x10 => self.output |= value,
            0x14 => self.output &= !value,
            0x20 => self.filter |= value,
            0x24 => self.filter &= !value,
            0x30 => self.data |= value,
            0x34 => self.data &= !value,
            0x38 => self.data = (self.data & !self.write_enable) | (value & self.write_enable),
            0x40 => self.mask |= value,
            0x44 => self.mask &= !value,
            0x50 => self.multi_drive |= value,
            0x54 => self.multi_drive &= !value,
            0x60 => self.pull_up &= !value,
            0x64 => self.pull_up |= value,
            0x70 => self.select_b &= !value,
            0x74 => self.select_b |= value,
            0xA0 => self.write_enable |= value,
            0xA4 => self.write_enable &= !value,
            0x08 | 0x18 | 0x28 | 0x3C | 0x48 | 0x4C | 0x58 | 0x68 | 0x78 | 0xA8 => {}
            _ => {
                return Err(FaultKind::RegisterNotModelled {
                    peripheral: "PIOA",
                    offset,
                })
            }
        }
        Ok(())
    }
}
