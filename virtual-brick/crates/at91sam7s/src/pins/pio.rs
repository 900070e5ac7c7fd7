// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Parallel input/output controller A (AT91SAM7S datasheet, 6175M, chapter 27).
//!
//! Peripheral inputs always follow the pin; the A/B choice affects outputs only. Pins that
//! nothing drives and nothing pulls keep their last level. The glitch filter lets through every
//! pulse of at least one master clock cycle, which is the shortest that the model can show.

use crate::board::{PinLevels, PinOutputs};
use crate::fault::{no_register, Access};
use crate::registers::registers;

registers! {
    PIO_PER = 0x00, PIO_PDR = 0x04, PIO_PSR = 0x08, PIO_OER = 0x10, PIO_ODR = 0x14,
    PIO_OSR = 0x18, PIO_IFER = 0x20, PIO_IFDR = 0x24, PIO_IFSR = 0x28, PIO_SODR = 0x30,
    PIO_CODR = 0x34, PIO_ODSR = 0x38, PIO_PDSR = 0x3C, PIO_IER = 0x40, PIO_IDR = 0x44,
    PIO_IMR = 0x48, PIO_ISR = 0x4C, PIO_MDER = 0x50, PIO_MDDR = 0x54, PIO_MDSR = 0x58,
    PIO_PUDR = 0x60, PIO_PUER = 0x64, PIO_PUSR = 0x68, PIO_ASR = 0x70, PIO_BSR = 0x74,
    PIO_ABSR = 0x78, PIO_OWER = 0xA0, PIO_OWDR = 0xA4, PIO_OWSR = 0xA8,
}

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

    /// What a read gives that changes nothing; of the registers that programs poll.
    pub(crate) fn polled(&self, offset: u32) -> Option<u32> {
        match offset {
            PIO_PDSR => Some(self.levels),
            PIO_ODSR => Some(self.data),
            PIO_ISR if self.changes == 0 => Some(0),
            _ => None,
        }
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            PIO_PSR => self.pio_control,
            PIO_OSR => self.output,
            PIO_IFSR => self.filter,
            PIO_ODSR => self.data,
            PIO_PDSR => self.levels,
            PIO_IMR => self.mask,
            PIO_ISR => std::mem::take(&mut self.changes),
            PIO_MDSR => self.multi_drive,
            PIO_PUSR => !self.pull_up,
            PIO_ABSR => self.select_b,
            PIO_OWSR => self.write_enable,
            PIO_PER | PIO_PDR | PIO_OER | PIO_ODR | PIO_IFER | PIO_IFDR | PIO_SODR | PIO_CODR
            | PIO_IER | PIO_IDR | PIO_MDER | PIO_MDDR | PIO_PUDR | PIO_PUER | PIO_ASR | PIO_BSR
            | PIO_OWER | PIO_OWDR => 0,
            _ => return no_register("PIOA", offset),
        })
    }

    /// The register is written to change the levels of outputs.
    pub(crate) const fn sets_levels(offset: u32) -> bool {
        matches!(offset, PIO_SODR | PIO_CODR | PIO_ODSR)
    }

    /// Levels that a write to such a register changes.
    #[inline]
    pub(crate) fn levels_changed(&self, offset: u32, value: u32) -> u32 {
        match offset {
            PIO_SODR => value & !self.data,
            PIO_CODR => value & self.data,
            _ => (value ^ self.data) & self.write_enable,
        }
    }

    /// Pins of which another level requests an interrupt, or changes what is driven.
    pub(crate) fn followed(&self) -> u32 {
        self.mask | self.multi_drive
    }

    /// Change levels of outputs that are not followed; returns those that the chip drives.
    #[inline]
    pub(crate) fn invert_levels(&mut self, changed: u32, clocked: bool) -> u32 {
        let driven = changed & self.pio_control & self.output;
        self.data ^= changed;
        self.pins ^= driven;
        if clocked {
            self.levels ^= driven;
            self.changes |= driven;
        }
        driven
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access {
        match offset {
            PIO_SODR | PIO_CODR | PIO_ODSR => self.data ^= self.levels_changed(offset, value),
            PIO_PER => self.pio_control |= value,
            PIO_PDR => self.pio_control &= !value,
            PIO_OER => self.output |= value,
            PIO_ODR => self.output &= !value,
            PIO_IFER => self.filter |= value,
            PIO_IFDR => self.filter &= !value,
            PIO_IER => self.mask |= value,
            PIO_IDR => self.mask &= !value,
            PIO_MDER => self.multi_drive |= value,
            PIO_MDDR => self.multi_drive &= !value,
            PIO_PUDR => self.pull_up &= !value,
            PIO_PUER => self.pull_up |= value,
            PIO_ASR => self.select_b &= !value,
            PIO_BSR => self.select_b |= value,
            PIO_OWER => self.write_enable |= value,
            PIO_OWDR => self.write_enable &= !value,
            PIO_PSR | PIO_OSR | PIO_IFSR | PIO_PDSR | PIO_IMR | PIO_ISR | PIO_MDSR | PIO_PUSR
            | PIO_ABSR | PIO_OWSR => {}
            _ => return no_register("PIOA", offset),
        }
        Ok(())
    }
}
