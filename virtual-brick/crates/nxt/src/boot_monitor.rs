// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip's boot monitor (SAM-BA) as a USB device: a serial line of class CDC, vendor 03EB,
//! product 6124, bulk endpoints 1 (from the host) and 2 (to the host).
//!
//! The monitor's own code is not run: its end of the bus is answered here, and what its commands
//! do to the chip is done by whoever owns the chip. Sources: AT91SAM7S datasheet (6175M), chapter
//! 22; USB 2.0, chapter 9; the host tools that libnxt publishes.

use std::collections::VecDeque;

use at91sam7s::board::{UsbAnswer, UsbPacket, UsbSignal, UsbTransaction};

const CONTROL_PACKET: usize = 8;
const OUT_ENDPOINT: u8 = 1;
const IN_ENDPOINT: u8 = 2;
/// Bytes from the host that may wait: what the endpoint's two banks hold. While a routine runs,
/// nobody takes them, and the host has to try again.
const RECEIVED_LIMIT: usize = 2 * UsbPacket::CAPACITY;
const DEVICE: [u8; 18] = [
    18, 1, 0x10, 0x01, 2, 0, 0, 8, 0xEB, 0x03, 0x24, 0x61, 0x10, 0x01, 0, 0, 0, 1,
];
/// One configuration: a communication interface with an interrupt endpoint, a data interface
/// with the two bulk endpoints.
const CONFIGURATION: [u8; 67] = [
    9, 2, 67, 0, 2, 1, 0, 0xC0, 0, // configuration
    9, 4, 0, 0, 1, 2, 2, 0, 0, // communication interface
    5, 0x24, 0, 0x10, 0x01, // header
    4, 0x24, 2, 0, // abstract control management
    5, 0x24, 6, 0, 1, // union
    5, 0x24, 1, 0, 1, // call management
    7, 5, 0x83, 3, 8, 0, 0xFF, // interrupt endpoint
    9, 4, 1, 0, 2, 10, 0, 0, 0, // data interface
    7, 5, 1, 2, 64, 0, 0, // bulk from the host
    7, 5, 0x82, 2, 64, 0, 0, // bulk to the host
];
/// 115,200 baud, 8N1: kept for the host, without effect.
const LINE_CODING: [u8; 7] = [0x00, 0xC2, 0x01, 0x00, 0, 0, 8];

/// The device.
#[derive(Clone, Debug, Default)]
pub struct BootMonitor {
    address: u8,
    next_address: Option<u8>,
    control: VecDeque<u8>,
    stalled: bool,
    received: VecDeque<u8>,
    replies: VecDeque<u8>,
}

impl BootMonitor {
    /// Bytes of commands and files from the host, in order.
    pub fn received_mut(&mut self) -> &mut VecDeque<u8> {
        &mut self.received
    }

    /// How many bytes from the host wait.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.received.len()
    }

    /// Bytes for the host.
    pub fn reply(&mut self, bytes: &[u8]) {
        self.replies.extend(bytes);
    }

    /// What the host put on the bus; an answer when it was a transaction.
    pub(crate) fn signal(&mut self, signal: UsbSignal) -> Option<UsbAnswer> {
        let UsbSignal::Transaction {
            address,
            endpoint,
            transaction,
        } = signal
        else {
            if signal == UsbSignal::Reset {
                *self = Self::default();
            }
            return None;
        };
        if address != self.address {
            return Some(UsbAnswer::Silent);
        }
        Some(match (endpoint, transaction) {
            (0, transaction) => self.control(transaction),
            (OUT_ENDPOINT, UsbTransaction::Out(packet)) => self.take(packet),
            (IN_ENDPOINT, UsbTransaction::In) => self.give(),
            (3, UsbTransaction::In) => UsbAnswer::NotReady,
            _ => UsbAnswer::Silent,
        })
    }

    fn take(&mut self, packet: UsbPacket) -> UsbAnswer {
        if self.received.len() + packet.data().len() > RECEIVED_LIMIT {
            return UsbAnswer::NotReady;
        }
        self.received.extend(packet.data());
        UsbAnswer::Acknowledged
    }

    fn give(&mut self) -> UsbAnswer {
        if self.replies.is_empty() {
            return UsbAnswer::NotReady;
        }
        packet(&mut self.replies, UsbPacket::CAPACITY)
    }

    fn control(&mut self, transaction: UsbTransaction) -> UsbAnswer {
        match transaction {
            UsbTransaction::Setup(request) => {
                self.control.clear();
                let reply = self.request(request);
                self.stalled = reply.is_none();
                let length = usize::from(u16::from_le_bytes([request[6], request[7]]));
                let reply = reply.unwrap_or_default();
                self.control.extend(reply.into_iter().take(length));
                UsbAnswer::Acknowledged
            }
            _ if self.stalled => UsbAnswer::Stalled,
            UsbTransaction::Out(_) => UsbAnswer::Acknowledged,
            UsbTransaction::In => {
                if let Some(address) = self.next_address.take() {
                    self.address = address;
                }
                packet(&mut self.control, CONTROL_PACKET)
            }
        }
    }

    /// The bytes that answer a request; none when it is refused.
    fn request(&mut self, request: [u8; 8]) -> Option<Vec<u8>> {
        match [request[0], request[1]] {
            [0x80, 0x06] => match request[3] {
                1 => Some(DEVICE.to_vec()),
                2 => Some(CONFIGURATION.to_vec()),
                _ => None,
            },
            [0x80, 0x08] => Some(vec![1]),
            [0x80..=0x82, 0x00] => Some(vec![0, 0]),
            [0xA1, 0x21] => Some(LINE_CODING.to_vec()),
            [0x00, 0x05] => {
                self.next_address = Some(request[2] & 0x7F);
                Some(Vec::new())
            }
            [0x00, 0x09] | [0x01, 0x0B] | [0x02, 0x01] | [0x21, 0x20 | 0x22] => Some(Vec::new()),
            _ => None,
        }
    }
}

/// The first bytes of a queue as a packet.
fn packet(bytes: &mut VecDeque<u8>, longest: usize) -> UsbAnswer {
    let length = bytes.len().min(longest);
    let data: Vec<u8> = bytes.drain(..length).collect();
    UsbAnswer::Data(UsbPacket::new(&data).unwrap_or(UsbPacket::EMPTY))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn control(monitor: &mut BootMonitor, address: u8, transaction: UsbTransaction) -> UsbAnswer {
        let signal = UsbSignal::Transaction {
            address,
            endpoint: 0,
            transaction,
        };
        monitor.signal(signal).unwrap()
    }

    /// The answer to a request without data: nothing, or a refusal.
    fn answer(request: [u8; 8]) -> UsbAnswer {
        let mut monitor = BootMonitor::default();
        let setup = UsbTransaction::Setup(request);
        assert_eq!(control(&mut monitor, 0, setup), UsbAnswer::Acknowledged);
        control(&mut monitor, 0, UsbTransaction::In)
    }

    /// USB 2.0, 9.4.6: the address holds from the end of the request on.
    #[test]
    fn a_new_address_holds_when_its_request_has_ended() {
        let mut monitor = BootMonitor::default();
        let set_address = UsbTransaction::Setup([0x00, 0x05, 9, 0, 0, 0, 0, 0]);
        let get_status = UsbTransaction::Setup([0x80, 0x00, 0, 0, 0, 0, 2, 0]);
        let mut at = |address, transaction| control(&mut monitor, address, transaction);
        assert_eq!(at(0, set_address), UsbAnswer::Acknowledged);
        assert_eq!(at(9, get_status), UsbAnswer::Silent);
        assert_eq!(at(0, UsbTransaction::In), UsbAnswer::Data(UsbPacket::EMPTY));
        assert_eq!(at(0, get_status), UsbAnswer::Silent);
        assert_eq!(at(9, get_status), UsbAnswer::Acknowledged);
    }

    /// USB 2.0, 9.6: each descriptor's length leads to the next, interfaces are numbered from 0,
    /// and each has the endpoints that it announces. CDC 1.1, 5.2.3.8: the union joins both.
    #[test]
    fn the_configuration_describes_two_joined_interfaces_with_their_endpoints() {
        let mut monitor = BootMonitor::default();
        let read = UsbTransaction::Setup([0x80, 0x06, 0, 2, 0, 0, 0xFF, 0]);
        control(&mut monitor, 0, read);
        let mut bytes = Vec::new();
        while let UsbAnswer::Data(packet) = control(&mut monitor, 0, UsbTransaction::In) {
            bytes.extend(packet.data());
            if packet.data().len() < CONTROL_PACKET {
                break;
            }
        }
        assert_eq!(
            usize::from(u16::from_le_bytes([bytes[2], bytes[3]])),
            bytes.len()
        );
        let (mut interfaces, mut joined) = (Vec::new(), Vec::<u8>::new());
        let mut rest = &bytes[..];
        while let [length, kind, what, ..] = *rest {
            let (descriptor, others) = rest.split_at(usize::from(length));
            match (kind, what) {
                (4, number) => interfaces.push((number, descriptor[4], 0)),
                (5, _) => interfaces.last_mut().unwrap().2 += 1,
                (0x24, 6) => joined.extend(&descriptor[3..]),
                _ => {}
            }
            rest = others;
        }
        assert!(rest.is_empty());
        assert_eq!(interfaces, [(0, 1, 1), (1, 2, 2)]);
        assert_eq!(usize::from(bytes[4]), interfaces.len());
        assert_eq!(joined, [0, 1]);
    }

    #[test]
    fn requests_of_a_host_that_opens_the_port_are_granted_and_others_refused() {
        let granted = UsbAnswer::Data(UsbPacket::EMPTY);
        for request in [
            [0x00, 0x09, 1, 0, 0, 0, 0, 0], // SET_CONFIGURATION 1
            [0x01, 0x0B, 0, 0, 0, 0, 0, 0], // SET_INTERFACE
            [0x02, 0x01, 0, 0, 1, 0, 0, 0], // CLEAR_FEATURE of an endpoint
            [0x21, 0x20, 0, 0, 0, 0, 0, 0], // SET_LINE_CODING
            [0x21, 0x22, 3, 0, 0, 0, 0, 0], // SET_CONTROL_LINE_STATE
        ] {
            assert_eq!(answer(request), granted, "{request:02X?}");
        }
        for request in [
            [0x01, 0x09, 1, 0, 0, 0, 0, 0],
            [0x00, 0x0B, 0, 0, 0, 0, 0, 0],
        ] {
            assert_eq!(answer(request), UsbAnswer::Stalled, "{request:02X?}");
        }
    }
}
