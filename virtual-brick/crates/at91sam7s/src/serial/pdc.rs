// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Peripheral data controller (AT91SAM7S datasheet, 6175M, chapter 22).
//!
//! One channel in each direction, each with a current and a next buffer. A next buffer given
//! while the current count is 0 becomes the current one at once.

use arm7tdmi::bus::Width;

use crate::clock::Cycles;
use crate::fault::{no_register, Access, TransferFault};
use crate::memory::Memories;
use crate::registers::registers;

registers! {
    PERIPH_RPR = 0x100, PERIPH_RCR = 0x104, PERIPH_TPR = 0x108, PERIPH_TCR = 0x10C,
    PERIPH_RNPR = 0x110, PERIPH_RNCR = 0x114, PERIPH_TNPR = 0x118, PERIPH_TNCR = 0x11C,
    PERIPH_PTCR = 0x120, PERIPH_PTSR = 0x124,
}

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

    /// One transfer of this width was made.
    fn transferred(&mut self, width: Width) {
        let bytes = match width {
            Width::Byte => 1,
            Width::Halfword => 2,
            Width::Word => 4,
        };
        self.pointer = self.pointer.wrapping_add(bytes);
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

    fn set_counts(&mut self, count: u32, next_count: u32) {
        (self.count, self.next_count) = (count, next_count);
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
            PERIPH_RPR => self.receive.pointer,
            PERIPH_RCR => self.receive.count,
            PERIPH_TPR => self.transmit.pointer,
            PERIPH_TCR => self.transmit.count,
            PERIPH_RNPR => self.receive.next_pointer,
            PERIPH_RNCR => self.receive.next_count,
            PERIPH_TNPR => self.transmit.next_pointer,
            PERIPH_TNCR => self.transmit.next_count,
            PERIPH_PTCR => 0,
            PERIPH_PTSR => u32::from(self.receive.enabled) | u32::from(self.transmit.enabled) << 8,
            _ => return no_register(peripheral, offset),
        })
    }

    /// Write a register; `offset` counts from the peripheral's base.
    pub(crate) fn write(&mut self, offset: u32, value: u32, peripheral: &'static str) -> Access {
        let count = value & 0xFFFF;
        match offset {
            PERIPH_RPR => self.receive.pointer = value,
            PERIPH_RCR => self.receive.set_counts(count, self.receive.next_count),
            PERIPH_TPR => self.transmit.pointer = value,
            PERIPH_TCR => self.transmit.set_counts(count, self.transmit.next_count),
            PERIPH_RNPR => self.receive.next_pointer = value,
            PERIPH_RNCR => self.receive.set_counts(self.receive.count, count),
            PERIPH_TNPR => self.transmit.next_pointer = value,
            PERIPH_TNCR => self.transmit.set_counts(self.transmit.count, count),
            PERIPH_PTCR => self.control(value),
            PERIPH_PTSR => {}
            _ => return no_register(peripheral, offset),
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

/// A peripheral whose data the data controller moves.
pub(crate) trait Stream {
    /// Name in the datasheet.
    fn name(&self) -> &'static str;
    fn pdc(&mut self) -> &mut Pdc;
    /// Width of one transfer.
    fn transfer_width(&self) -> Width;
    /// The data controller may write the transmit register.
    fn wants_data(&self) -> bool;
    /// Put a word in the transmit register.
    fn transmit(&mut self, value: u32, now: Cycles) -> Access;
    /// The data controller may read the receive register.
    fn has_data(&self) -> bool {
        false
    }
    /// Read the receive register.
    fn take_received(&mut self) -> u32 {
        0
    }
}

/// Memory to transmit register, as long as the data controller may.
pub(crate) fn feed(
    stream: &mut impl Stream,
    memories: &mut Memories,
    at: Cycles,
) -> Result<(), TransferFault> {
    while stream.wants_data() {
        let (name, width) = (stream.name(), stream.transfer_width());
        let pointer = stream.pdc().transmit.pointer;
        let value = memories.transfer_from(name, pointer, width, at)?;
        stream.pdc().transmit.transferred(width);
        let refused = |kind| TransferFault {
            kind,
            pointer,
            written: None,
        };
        stream.transmit(value, at).map_err(refused)?;
    }
    Ok(())
}

/// Receive register to memory, when the data controller may.
pub(crate) fn drain(
    stream: &mut impl Stream,
    memories: &mut Memories,
    at: Cycles,
) -> Result<(), TransferFault> {
    if !stream.has_data() {
        return Ok(());
    }
    let (name, width) = (stream.name(), stream.transfer_width());
    let pointer = stream.pdc().receive.pointer;
    let value = stream.take_received();
    memories.transfer_to(name, pointer, width, value, at)?;
    stream.pdc().receive.transferred(width);
    Ok(())
}
