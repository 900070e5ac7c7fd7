// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One endpoint: its control register, its banks, its answers.
//!
//! A received packet fills bank 0, on a two-bank endpoint then bank 1, and so on in turn;
//! software reads and frees them in the same turn. The bank that is being filled for the host
//! is separate from the one that waits to be sent, so a two-bank endpoint can be filled ahead.

use crate::board::{Cycles, UsbAnswer, UsbPacket, UsbTransaction};
use crate::fault::{not_modelled, Access};

/// Name of the port in the datasheet.
pub(super) const NAME: &str = "UDP";

const TXCOMP: u32 = 1 << 0;
const RX_DATA_BK0: u32 = 1 << 1;
const RXSETUP: u32 = 1 << 2;
const STALLSENT: u32 = 1 << 3;
const TXPKTRDY: u32 = 1 << 4;
const FORCESTALL: u32 = 1 << 5;
const RX_DATA_BK1: u32 = 1 << 6;
const DTGLE: u32 = 1 << 11;
const EPEDS: u32 = 1 << 15;
/// Written directly: FORCESTALL, DIR, EPTYPE, EPEDS.
const SETTINGS: u32 = FORCESTALL | 1 << 7 | 7 << 8 | EPEDS;
/// Cleared by writing 0, unaffected by writing 1.
const CLEARABLE: u32 = TXCOMP | RX_DATA_BK0 | RXSETUP | STALLSENT | RX_DATA_BK1;
/// Any of these asks for service.
pub(super) const FLAGS_THAT_INTERRUPT: u32 = CLEARABLE;
const BANK_FLAGS: [u32; 2] = [RX_DATA_BK0, RX_DATA_BK1];

/// A bank that software reads.
#[derive(Clone, Copy, Debug)]
struct Bank {
    packet: UsbPacket,
    taken: usize,
}

impl Bank {
    const EMPTY: Self = Self {
        packet: UsbPacket::EMPTY,
        taken: 0,
    };
}

#[derive(Clone, Debug)]
pub(super) struct Endpoint {
    capacity: usize,
    two_banks: bool,
    /// Control register without the byte count.
    control: u32,
    crossing: Option<(u32, Cycles)>,
    banks: [Bank; 2],
    arriving: usize,
    reading: usize,
    filling: UsbPacket,
    waiting: UsbPacket,
}

impl Endpoint {
    pub(super) fn new(number: usize) -> Self {
        Self {
            capacity: if number == 0 { 8 } else { UsbPacket::CAPACITY },
            two_banks: number == 1 || number == 2,
            control: 0,
            crossing: None,
            banks: [Bank::EMPTY; 2],
            arriving: 0,
            reading: 0,
            filling: UsbPacket::EMPTY,
            waiting: UsbPacket::EMPTY,
        }
    }

    /// Empty the banks and begin with DATA0 again; the settings stay.
    pub(super) fn reset(&mut self) {
        let gone = RX_DATA_BK0 | RX_DATA_BK1 | RXSETUP | TXPKTRDY | DTGLE;
        self.control &= !gone;
        self.banks = [Bank::EMPTY; 2];
        (self.arriving, self.reading) = (0, 0);
        (self.filling, self.waiting) = (UsbPacket::EMPTY, UsbPacket::EMPTY);
    }

    /// Value of the control register: flags and the number of bytes in the bank to be read.
    pub(super) fn control(&self) -> u32 {
        let bank = &self.banks[self.reading];
        let count = bank.packet.data().len() - bank.taken;
        self.control | (count as u32) << 16
    }

    pub(super) fn settles_at(&self) -> Option<Cycles> {
        self.crossing.map(|(_, at)| at)
    }

    /// A write of the control register, effective at `at`. One that has not crossed yet is
    /// carried out first.
    pub(super) fn write_control(&mut self, value: u32, at: Cycles) -> Access {
        if matches!(value >> 8 & 7, 1 | 5) {
            return not_modelled(NAME, "isochronous endpoints");
        }
        self.settle(at);
        self.crossing = Some((value, at));
        Ok(())
    }

    pub(super) fn settle(&mut self, now: Cycles) {
        if let Some((value, _)) = self.crossing.filter(|(_, at)| *at <= now) {
            self.crossing = None;
            self.apply(value);
        }
    }

    fn apply(&mut self, value: u32) {
        let cleared = self.control & CLEARABLE & !value;
        let sends = value & TXPKTRDY != 0 && self.control & TXPKTRDY == 0;
        self.control &= !(cleared | SETTINGS);
        self.control |= value & SETTINGS;
        if cleared & RXSETUP != 0 {
            self.banks[0] = Bank::EMPTY;
        }
        for (bank, flag) in BANK_FLAGS.into_iter().enumerate() {
            if cleared & flag != 0 {
                self.banks[bank] = Bank::EMPTY;
                self.reading = self.after(bank);
            }
        }
        if sends {
            self.control |= TXPKTRDY;
            self.waiting = std::mem::replace(&mut self.filling, UsbPacket::EMPTY);
        }
    }

    /// The bank that follows in turn.
    fn after(&self, bank: usize) -> usize {
        if self.two_banks {
            1 - bank
        } else {
            0
        }
    }

    /// Read a byte of the received packet; 0 when there is none left.
    pub(super) fn take(&mut self) -> u32 {
        let bank = &mut self.banks[self.reading];
        let byte = bank.packet.data().get(bank.taken).copied();
        bank.taken += usize::from(byte.is_some());
        byte.map_or(0, u32::from)
    }

    /// Write a byte of the next packet for the host.
    pub(super) fn put(&mut self, value: u32) -> Access {
        if self.filling.data().len() == self.capacity || !self.filling.push(value as u8) {
            return not_modelled(NAME, "more bytes than the endpoint's memory holds");
        }
        Ok(())
    }

    /// The endpoint's type, 0 for control; 2 and 3 take data, 6 and 7 give data.
    fn kind(&self) -> u32 {
        self.control >> 8 & 7
    }

    pub(super) fn transaction(&mut self, transaction: UsbTransaction) -> UsbAnswer {
        if self.control & EPEDS == 0 {
            return UsbAnswer::Silent;
        }
        match (transaction, self.kind()) {
            (UsbTransaction::Setup(request), 0) => self.setup(request),
            (UsbTransaction::Out(packet), 0 | 2 | 3) => self.out(packet),
            (UsbTransaction::In, 0 | 6 | 7) => self.give(),
            _ => UsbAnswer::Silent,
        }
    }

    /// A request is always taken; it ends whatever the endpoint was doing. That TXCOMP of the
    /// transfer before is gone is inferred: firmware that real hosts enumerate leaves it set
    /// after the status stage and waits for it again in the next transfer.
    fn setup(&mut self, request: [u8; 8]) -> UsbAnswer {
        self.reset();
        self.control &= !TXCOMP;
        let Some(packet) = UsbPacket::new(&request) else {
            return UsbAnswer::Silent;
        };
        self.banks[0] = Bank { packet, taken: 0 };
        self.control |= RXSETUP;
        UsbAnswer::Acknowledged
    }

    fn stall(&mut self) -> UsbAnswer {
        self.control |= STALLSENT;
        UsbAnswer::Stalled
    }

    fn out(&mut self, packet: UsbPacket) -> UsbAnswer {
        let flag = BANK_FLAGS[self.arriving];
        if self.control & FORCESTALL != 0 {
            return self.stall();
        }
        if self.control & (RXSETUP | flag) != 0 {
            return UsbAnswer::NotReady;
        }
        if packet.data().len() > self.capacity {
            return UsbAnswer::Silent;
        }
        self.banks[self.arriving] = Bank { packet, taken: 0 };
        self.arriving = self.after(self.arriving);
        self.control |= flag;
        self.control ^= DTGLE;
        UsbAnswer::Acknowledged
    }

    fn give(&mut self) -> UsbAnswer {
        if self.control & FORCESTALL != 0 {
            return self.stall();
        }
        if self.control & TXPKTRDY == 0 || self.control & RXSETUP != 0 {
            return UsbAnswer::NotReady;
        }
        self.control &= !TXPKTRDY;
        self.control |= TXCOMP;
        UsbAnswer::Data(self.waiting)
    }
}
