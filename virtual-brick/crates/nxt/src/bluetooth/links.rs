// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Connections: how they come about, their bytes, their ends.

use std::collections::VecDeque;

use at91sam7s::board::Cycles;

use super::code;
use super::device::{address_bytes, AirMessage, AirSignal, BluetoothAddress, BluetoothDevice};
use super::frame::Message;
// Connections extend the module and use its time-outs, so each knows the other.
use super::{Action, Bluetooth, BluetoothText, ANSWER_TIME_OUT, INBOX_LIMIT, PAGE_TIME_OUT};

/// Handle of the connection that came in through the port.
pub const PORT_HANDLE: u8 = 0;
/// Connections: one that came in, or up to three that were made.
pub const HANDLES: usize = 4;
const SUCCESS: u8 = 1;
const FAILURE: u8 = 0;

#[derive(Clone, Debug)]
struct Link {
    peer: BluetoothDevice,
    inbox: VecDeque<u8>,
    outbox: VecDeque<u8>,
}

/// A connection in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PendingConnection {
    /// Our program's PIN code is awaited before we page.
    PinForPage(BluetoothAddress),
    /// The other device's answer is awaited.
    Paged(BluetoothAddress, bool),
    /// Our program's PIN code is awaited for a device that pages us.
    PinForPort(BluetoothDevice, BluetoothText),
    /// Our program is to accept a device that pages us.
    Offered(BluetoothDevice),
}

/// All connections.
#[derive(Clone, Debug, Default)]
pub struct Links {
    links: [Option<Link>; HANDLES],
    pending: Option<PendingConnection>,
}

impl Links {
    fn get(&mut self, handle: u8) -> Option<&mut Link> {
        self.links.get_mut(usize::from(handle))?.as_mut()
    }

    fn open(&mut self, handle: u8, peer: BluetoothDevice) {
        if let Some(link) = self.links.get_mut(usize::from(handle)) {
            *link = Some(Link {
                peer,
                inbox: VecDeque::new(),
                outbox: VecDeque::new(),
            });
        }
    }

    fn handle_of(&self, peer: BluetoothAddress) -> Option<u8> {
        let found = |link: &Option<Link>| {
            let link = link.as_ref();
            link.is_some_and(|link| link.peer.address == peer)
        };
        self.links.iter().position(found).map(|index| index as u8)
    }

    /// The first free handle of those that we make; none while we are connected as a server.
    fn free_handle(&self) -> Option<u8> {
        let free = |handle: &usize| self.links[*handle].is_none();
        let server = self.links[usize::from(PORT_HANDLE)].is_some();
        (1..HANDLES).find(free).filter(|_| !server).map(|h| h as u8)
    }

    pub fn is_open(&self, handle: u8) -> bool {
        let link = self.links.get(usize::from(handle));
        link.is_some_and(Option::is_some)
    }

    pub fn peers(&self) -> Vec<BluetoothAddress> {
        let peers = self.links.iter().flatten();
        peers.map(|link| link.peer.address).collect()
    }

    pub fn find(&self, peer: BluetoothAddress) -> Option<BluetoothDevice> {
        let mut peers = self.links.iter().flatten().map(|link| link.peer);
        peers.find(|device| device.address == peer)
    }

    pub fn inbox_length(&self) -> usize {
        let links = self.links.iter().flatten();
        links.map(|link| link.inbox.len()).sum()
    }

    pub fn outbox_length(&self) -> usize {
        let links = self.links.iter().flatten();
        links.map(|link| link.outbox.len()).sum()
    }

    pub fn take_inbox(&mut self, handle: u8) -> Option<VecDeque<u8>> {
        self.get(handle).map(|link| std::mem::take(&mut link.inbox))
    }

    pub fn put_back(&mut self, handle: u8, bytes: VecDeque<u8>) {
        if let Some(link) = self.get(handle) {
            link.inbox = bytes;
        }
    }

    /// False when there is no such connection.
    pub fn put_outgoing(&mut self, handle: u8, byte: u8) -> bool {
        let link = self.get(handle);
        link.map(|link| link.outbox.push_back(byte)).is_some()
    }

    pub fn take_packets(&mut self, longest: usize) -> Vec<(BluetoothAddress, Vec<u8>)> {
        let packet = |link: &mut Link| {
            let length = link.outbox.len().min(longest);
            let bytes: Vec<u8> = link.outbox.drain(..length).collect();
            (link.peer.address, bytes)
        };
        let packets = self.links.iter_mut().flatten().map(packet);
        packets.filter(|(_, bytes)| !bytes.is_empty()).collect()
    }
}

impl Bluetooth {
    /// A message came through the air.
    pub(super) fn receive(&mut self, now: Cycles, message: AirMessage) {
        let peer = message.peer;
        match message.signal {
            AirSignal::InRange(device) => {
                self.out_of_range(peer);
                self.air.neighbours.push(device);
            }
            AirSignal::OutOfRange => self.out_of_range(peer),
            AirSignal::Page { device, pin } => self.paged(now, device, pin),
            AirSignal::Accept => self.page_answered(now, peer, true),
            AirSignal::Refuse => self.page_answered(now, peer, false),
            AirSignal::Data(bytes) => self.receive_data(now, peer, bytes),
            AirSignal::Close => self.closed(now, peer),
        }
    }

    fn out_of_range(&mut self, peer: BluetoothAddress) {
        self.air.neighbours.retain(|device| device.address != peer);
    }

    fn paged(&mut self, now: Cycles, device: BluetoothDevice, pin: Option<BluetoothText>) {
        let free = self.running
            && self.port_open
            && self.links.pending.is_none()
            && self.links.peers().is_empty();
        let paired = self.store.is_paired(device.address);
        match pin {
            _ if !free => self.transmit(now, device.address, AirSignal::Refuse),
            _ if paired => self.offer(now, device),
            Some(pin) => {
                self.links.pending = Some(PendingConnection::PinForPort(device, pin));
                self.ask(now, code::REQUEST_PIN_CODE, device.address);
            }
            None => self.transmit(now, device.address, AirSignal::Refuse),
        }
    }

    fn offer(&mut self, now: Cycles, device: BluetoothDevice) {
        self.links.pending = Some(PendingConnection::Offered(device));
        self.ask(now, code::REQUEST_CONNECTION, device.address);
    }

    /// Ask the program about a device; without an answer in time the connection fails.
    fn ask(&mut self, now: Cycles, question: u8, peer: BluetoothAddress) {
        self.answer(now, question, &address_bytes(peer));
        self.wait_for(now + ANSWER_TIME_OUT, peer);
    }

    fn wait_for(&mut self, until: Cycles, peer: BluetoothAddress) {
        self.cancel(|action| matches!(action, Action::PageFailed(_)));
        self.plan(until, Action::PageFailed(peer));
    }

    /// The program wants a connection.
    pub(super) fn connect(&mut self, now: Cycles, peer: BluetoothAddress) {
        let possible = self.links.pending.is_none()
            && self.links.free_handle().is_some()
            && self.links.handle_of(peer).is_none();
        if !possible {
            self.answer(now, code::CONNECT_RESULT, &[FAILURE, u8::MAX]);
        } else if self.store.is_paired(peer) {
            self.page(now, peer, None);
        } else {
            self.links.pending = Some(PendingConnection::PinForPage(peer));
            self.ask(now, code::REQUEST_PIN_CODE, peer);
        }
    }

    fn page(&mut self, now: Cycles, peer: BluetoothAddress, pin: Option<BluetoothText>) {
        self.links.pending = Some(PendingConnection::Paged(peer, pin.is_some()));
        let there = self.air.neighbours.iter().any(|d| d.address == peer);
        let patience = if there {
            ANSWER_TIME_OUT
        } else {
            PAGE_TIME_OUT
        };
        self.wait_for(now + patience, peer);
        let device = self.device();
        self.transmit(now, peer, AirSignal::Page { device, pin });
    }

    /// The program gave a PIN code.
    pub(super) fn pin_code(&mut self, now: Cycles, peer: BluetoothAddress, given: BluetoothText) {
        match self.links.pending {
            Some(PendingConnection::PinForPage(wanted)) if wanted == peer => {
                self.answer(now, code::PIN_CODE_ACKNOWLEDGED, &[]);
                self.page(now, peer, Some(given));
            }
            Some(PendingConnection::PinForPort(device, pin)) if device.address == peer => {
                self.answer(now, code::PIN_CODE_ACKNOWLEDGED, &[]);
                if pin == given {
                    self.store.pair(peer);
                    self.offer(now, device);
                } else {
                    self.give_up(now, peer);
                }
            }
            _ => {}
        }
    }

    /// The program accepts or refuses a connection.
    pub(super) fn accept(&mut self, now: Cycles, accepted: bool) {
        let Some(PendingConnection::Offered(device)) = self.links.pending else {
            return;
        };
        if !accepted {
            self.give_up(now, device.address);
            return;
        }
        self.transmit(now, device.address, AirSignal::Accept);
        self.connected(now, PORT_HANDLE, device);
    }

    fn connected(&mut self, now: Cycles, handle: u8, device: BluetoothDevice) {
        self.links.pending = None;
        self.cancel(|action| matches!(action, Action::PageFailed(_)));
        self.links.open(handle, device);
        self.answer(now, code::CONNECT_RESULT, &[SUCCESS, handle]);
    }

    /// A connection in the making ends: the other device and the program are told.
    fn give_up(&mut self, now: Cycles, peer: BluetoothAddress) {
        self.links.pending = None;
        self.cancel(|action| matches!(action, Action::PageFailed(_)));
        self.transmit(now, peer, AirSignal::Refuse);
        self.answer(now, code::CONNECT_RESULT, &[FAILURE, u8::MAX]);
    }

    pub(super) fn page_failed(&mut self, now: Cycles, peer: BluetoothAddress) {
        if self.links.pending.is_some() {
            self.give_up(now, peer);
        }
    }

    fn page_answered(&mut self, now: Cycles, from: BluetoothAddress, accepted: bool) {
        let Some(PendingConnection::Paged(peer, new_key)) = self.links.pending else {
            return;
        };
        let handle = self.links.free_handle();
        let Some(handle) = handle.filter(|_| peer == from && accepted) else {
            if peer == from {
                self.links.pending = None;
                self.cancel(|action| matches!(action, Action::PageFailed(_)));
                self.answer(now, code::CONNECT_RESULT, &[FAILURE, u8::MAX]);
            }
            return;
        };
        if new_key {
            self.store.pair(peer);
        }
        let device = self.neighbour(peer).unwrap_or(BluetoothDevice {
            address: peer,
            name: BluetoothText::default(),
            class: [0; 4],
        });
        self.connected(now, handle, device);
    }

    fn receive_data(&mut self, now: Cycles, peer: BluetoothAddress, bytes: Vec<u8>) {
        let Some(handle) = self.links.handle_of(peer) else {
            return;
        };
        if self.waiting_bytes() + bytes.len() > INBOX_LIMIT {
            self.transmit(now, peer, AirSignal::Close);
            self.closed(now, peer);
        } else if self.stream == Some(handle) {
            self.line.send_stream(bytes);
        } else if let Some(link) = self.links.get(handle) {
            link.inbox.extend(bytes);
        }
    }

    /// The other device closed the connection, or gave up making one.
    fn closed(&mut self, now: Cycles, peer: BluetoothAddress) {
        match self.links.pending {
            Some(PendingConnection::PinForPort(device, _) | PendingConnection::Offered(device))
                if device.address == peer =>
            {
                self.give_up(now, peer);
            }
            _ => {}
        }
        if let Some(handle) = self.links.handle_of(peer) {
            self.end_link(now, handle);
            self.answer(now, code::CLOSE_CONNECTION_RESULT, &[SUCCESS, handle]);
        }
    }

    /// The program closes a connection.
    pub(super) fn close(&mut self, now: Cycles, handle: u8) {
        let Some(peer) = self.links.get(handle).map(|link| link.peer.address) else {
            self.answer(now, code::CLOSE_CONNECTION_RESULT, &[FAILURE, handle]);
            return;
        };
        for (peer, bytes) in self.links.take_packets(usize::MAX) {
            self.transmit(now, peer, AirSignal::Data(bytes));
        }
        self.transmit(now, peer, AirSignal::Close);
        self.end_link(now, handle);
        self.answer(now, code::CLOSE_CONNECTION_RESULT, &[SUCCESS, handle]);
    }

    fn end_link(&mut self, now: Cycles, handle: u8) {
        if let Some(link) = self.links.links.get_mut(usize::from(handle)) {
            *link = None;
        }
        self.cancel(|action| *action == Action::Stream(handle));
        if self.stream == Some(handle) {
            self.plan(now + super::MODE_CHANGE, Action::Command);
        }
    }

    /// The program wants the stream of a connection.
    pub(super) fn open_stream(&mut self, now: Cycles, handle: u8) {
        if self.links.is_open(handle) {
            self.plan(now + super::MODE_CHANGE, Action::Stream(handle));
        }
    }

    /// A device that is in range or connected.
    pub(super) fn neighbour(&self, address: BluetoothAddress) -> Option<BluetoothDevice> {
        let mut near = self.air.neighbours.iter().copied();
        near.find(|device| device.address == address)
            .or_else(|| self.links.find(address))
    }

    /// The first result of an inquiry, or the next one.
    pub(super) fn inquiry_result(&mut self, now: Cycles) {
        let Some(mut inquiry) = self.inquiry else {
            return;
        };
        let found = self.air.neighbours.get(inquiry.next).copied();
        inquiry.next += 1;
        if let Some(device) = found {
            self.send(Message::new(code::INQUIRY_RESULT, &device.to_bytes()));
            inquiry.remaining -= 1;
        }
        let more = inquiry.next < self.air.neighbours.len() && inquiry.remaining > 0;
        let next = now + super::INQUIRY_RESULT_PERIOD;
        if more && next < inquiry.ends {
            self.plan(next, Action::InquiryResult);
        } else if inquiry.remaining == 0 {
            self.end_inquiry(now);
            return;
        }
        self.inquiry = Some(inquiry);
    }

    pub(super) fn end_inquiry(&mut self, now: Cycles) {
        self.inquiry = None;
        self.cancel(|a| matches!(a, Action::InquiryResult | Action::InquiryEnd));
        self.answer(now, code::INQUIRY_STOPPED, &[]);
    }
}
