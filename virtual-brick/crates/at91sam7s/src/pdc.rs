// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Peripheral data controller (AT91SAM7S datasheet, 6175M, chapter 22).
//!
//! One channel in each direction, each with a current and a next buffer. A next buffer given
//! while the current count is 0 becomes the current one at once.

use crate::fault::{Access, FaultKind};

/// One direction.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    pointer: u32,
    count: u32,
    next_pointer: u32,
    next_count: u32,
    enabled: bool,
    ended: bool,
}

impl Channel {
    fn new() -> Self {
        Self {
            pointer: 0,
            count: 0,
            next_pointer: 0,
            next_count: 0,
            enabled: false,
            ended: true,
        }
    }

    /// A transfer may take place.
    pub(crate) fn ready(&self) -> bool {
        self.enabled && self.count != 0
    }

    /// Address of the next transfer.
    pub(crate) fn pointer(&self) -> u32 {
        self.pointer
    }

    /// One transfer of `size` bytes was made.
    pub(crate) fn transferred(&mut self, size: u32) {
        self.pointer = self.pointer.wrapping_add(size);
        self.count -= 1;
        if self.count == 0 {
            self.ended = true;
            self.take_next();
        }
    }

    fn take_next(&mut self) {
        if self.count == 0 && self.next_count != 0 {
            self.pointer = self.next_pointer;
            self.count = self.next_count;
            self.next_count = 0;
        }
    }

    fn counts_written(&mut self) {
        self.take_next();
        self.ended = self.count == 0;
    }

    /// ENDRX or ENDTX: the count reached 0 since it was last written.
    pub(crate) fn ended(&self) -> bool {
        self.ended
    }

    /// RXBUFF or TXBUFE: both counts are 0.
    pub(crate) fn exhausted(&self) -> bool {
        self.count == 0 && self.next_count == 0
    }
}

/// Both channels of one peripheral.
#[derive(Clone, Debug)]
pub(crate) struct Pdc {
    pub(crate) receive: Channel,
    pub(crate) transmit: Channel,
}

impl Pdc {
    pub(crate) fn new() -> Self {
        Self {
            receive: Channel::new(),
            transmit: Channel::new(),
        }
    }

    /// Read a register; `offset` counts from the peripheral's base.
    pub(crate) fn read(&self, offset: u32, peripheral: &'static str) -> Access<u32> {
        Ok(match offset {
            0x100 => self.receive.pointer,
            0x104 => self.receive.count,
            0x108 => self.transmit.pointer,
            0x10C => self.transmit.count,
            0x110 => self.receive.next_pointer,
            0x114 => self.receive.next_count,
            0x118 => self.transmit.next_pointer,
            0x11C => self.transmit.next_count,
            0x120 => 0,
            0x124 => u32::from(self.receive.enabled) | u32::from(self.transmit.enabled) << 8,
            _ => return Err(FaultKind::RegisterNotModelled { peripheral, offset }),
        })
    }

    /// Write a register; `offset` counts from the peripheral's base.
    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        peripheral: &'static str,
    ) -> Access<()> {
        let count = value & 0xFFFF;
        match offset {
            0x100 => self.receive.pointer = value,
            0x104 => {
                self.receive.count = count;
                self.receive.counts_written();
            }
            0x108 => self.transmit.pointer = value,
            0x10C => {
                self.transmit.count = count;
                self.transmit.counts_written();
            }
            0x110 => self.receive.next_pointer = value,
            0x114 => {
                self.receive.next_count = count;
                self.receive.counts_written();
            }
            0x118 => self.transmit.next_pointer = value,
            0x11C => {
                self.transmit.next_count = count;
                self.transmit.counts_written();
            }
            0x120 => self.control(value),
            0x124 => {}
            _ => return Err(FaultKind::RegisterNotModelled { peripheral, offset }),
        }
        Ok(())
    }

    fn control(&mut self, value: u32) {
        if value & 1 << 0 != 0 {
            self.receive.enabled = true;
        }
        if value & 1 << 1 != 0 {
            self.receive.enabled = false;
        }
        if value & 1 << 8 != 0 {
            self.transmit.enabled = true;
        }
        if value & 1 << 9 != 0 {
            self.transmit.enabled = false;
        }
    }
}
