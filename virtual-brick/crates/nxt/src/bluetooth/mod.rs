// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The BlueCore 4 Bluetooth module with LEGO's firmware.
//!
//! Lines: PA11 resets it while low; characters come and go through USART1 with hardware
//! handshaking; `ARM7_CMD` (PA27) high is the chip's wish for the stream mode, `BC4_CMD`
//! (analogue input 6) the module's. While both are high the serial line carries the stream of one
//! connection, else messages. Sources: LEGO MINDSTORMS NXT Bluetooth Developer Kit; LEGO's
//! published firmware, NxOS and leJOS for what they wait for. Times that no source gives are
//! named as chosen where they stand.
//!
//! Other devices are reached through [`AirMessage`]s; which ones are in range is told from
//! outside. Neither operating mode breaks the stream: messages wait until it is left.

mod code;
mod commands;
mod device;
mod frame;
mod line;
mod links;
mod store;

use std::collections::BTreeMap;

use at91sam7s::board::{Character, Cycles};

pub use device::{AirMessage, AirSignal, BluetoothAddress, BluetoothDevice, BluetoothText};
pub use store::{BluetoothConfiguration, KnownDevice, Store};

use crate::event::{BoardFault, EventLog};
use crate::time::{milliseconds, NEVER};
use frame::{Message, Receiver};
pub use line::BIT_CYCLES;
use line::{Line, LineMode};
use links::Links;

/// From the end of reset to the reset indication (chosen).
const START_UP: Cycles = milliseconds(500);
/// From a message to its answer (chosen).
const ANSWER: Cycles = milliseconds(2);
/// Looking up the name of a device in range (chosen).
const NAME_LOOK_UP: Cycles = milliseconds(50);
/// Calling a device that is not there: the page time-out of Bluetooth, 5.12 s.
const PAGE_TIME_OUT: Cycles = milliseconds(5_120);
/// Waiting for a program or another device to answer (chosen).
const ANSWER_TIME_OUT: Cycles = milliseconds(30_000);
/// Between results of an inquiry (chosen).
const INQUIRY_RESULT_PERIOD: Cycles = milliseconds(320);
/// Unit of an inquiry's duration.
const INQUIRY_UNIT: Cycles = milliseconds(1_280);
/// From a change of the chip's wish, or the end of a connection, to that of `BC4_CMD` (chosen).
const MODE_CHANGE: Cycles = milliseconds(5);
/// Between two heartbeats (chosen).
const HEARTBEAT_PERIOD: Cycles = milliseconds(5_000);
/// A packet leaves this often while there are bytes to send (chosen) ...
const PACKET_PERIOD: Cycles = milliseconds(5);
/// ... with at most so many of them: payload of an RFCOMM frame in a DM5 packet, about.
const PACKET_BYTES: usize = 127;
/// The module holds the chip back (CTS) above this many bytes.
const OUTBOX_FULL: usize = 384;
/// A connection whose reader leaves so many bytes lying ends.
const INBOX_LIMIT: usize = 1 << 20;
/// Messages from outside that may wait for their time.
const SCHEDULE_LIMIT: usize = 1 << 16;

/// Levels of the chip's lines to the module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChipLines {
    /// PA11 is low.
    pub reset: bool,
    /// PA27 is high.
    pub stream_wanted: bool,
    /// RTS (PA24) is low.
    pub ready: bool,
}

/// What the module does at a later time.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Action {
    Send(Message),
    /// Enter the stream mode on this connection.
    Stream(u8),
    /// Leave the stream mode.
    Command,
    Heartbeat,
    InquiryResult,
    InquiryEnd,
    /// Nobody answered the page of this address.
    PageFailed(BluetoothAddress),
    Packet,
}

/// An inquiry that runs.
#[derive(Clone, Copy, Debug)]
struct Inquiry {
    /// Results that may still come.
    remaining: u8,
    /// Neighbours already looked at.
    next: usize,
    ends: Cycles,
}

/// What a run sees of the air around the module.
#[derive(Clone, Debug, Default)]
struct Air {
    neighbours: Vec<BluetoothDevice>,
    incoming: BTreeMap<(Cycles, u64), AirMessage>,
    scheduled: u64,
    outgoing: Vec<AirMessage>,
}

/// The module.
#[derive(Clone, Debug)]
pub struct Bluetooth {
    store: Store,
    lines: ChipLines,
    /// The module runs; its indication has been queued.
    running: bool,
    starts: Cycles,
    agenda: BTreeMap<(Cycles, u64), Action>,
    planned: u64,
    receiver: Receiver,
    line: Line,
    /// Connection whose stream the line carries or will carry: `BC4_CMD` is high.
    stream: Option<u8>,
    links: Links,
    port_open: bool,
    inquiry: Option<Inquiry>,
    heart: bool,
    packet_planned: bool,
    air: Air,
}

impl Bluetooth {
    /// Its supply comes on at cycle 0.
    pub fn new(configuration: &BluetoothConfiguration) -> Self {
        Self {
            store: Store::new(configuration),
            lines: ChipLines::default(),
            running: false,
            starts: START_UP,
            agenda: BTreeMap::new(),
            planned: 0,
            receiver: Receiver::default(),
            line: Line::default(),
            stream: None,
            links: Links::default(),
            port_open: false,
            inquiry: None,
            heart: false,
            packet_planned: false,
            air: Air::default(),
        }
    }

    /// The brick has been on for a while: the indication waits for the chip.
    pub fn skip_start_up(&mut self, now: Cycles) {
        self.starts = now + 1;
    }

    /// The module as others see it.
    pub const fn device(&self) -> BluetoothDevice {
        self.store.device()
    }

    /// Others find it in an inquiry.
    pub const fn discoverable(&self) -> bool {
        self.running && self.store.discoverable
    }

    /// Level of `BC4_CMD`.
    pub const fn stream_mode(&self) -> bool {
        self.stream.is_some()
    }

    /// Level of CTS: low while the module takes characters.
    pub fn refuses_characters(&self) -> bool {
        !self.running || self.links.outbox_length() > OUTBOX_FULL
    }

    /// Bytes that came through the air and that the chip has not got yet.
    pub fn waiting_bytes(&self) -> usize {
        let scheduled = self.air.incoming.values().map(|message| {
            let AirSignal::Data(bytes) = &message.signal else {
                return 0;
            };
            bytes.len()
        });
        scheduled.sum::<usize>() + self.links.inbox_length() + self.line.waiting_stream()
    }

    /// Lets a message reach the module at its time; false when too many wait already.
    pub fn schedule(&mut self, message: AirMessage) -> bool {
        if self.air.incoming.len() >= SCHEDULE_LIMIT {
            return false;
        }
        let key = (message.at_cycles, self.air.scheduled);
        self.air.scheduled += 1;
        self.air.incoming.insert(key, message);
        true
    }

    /// Messages sent through the air since the last call.
    pub fn take_sent(&mut self) -> Vec<AirMessage> {
        std::mem::take(&mut self.air.outgoing)
    }

    /// The chip's lines have these levels already.
    pub fn has_lines(&self, lines: ChipLines) -> bool {
        self.lines == lines
    }

    /// The chip's lines changed.
    pub fn lines_changed(&mut self, now: Cycles, lines: ChipLines) {
        if lines == self.lines {
            return;
        }
        let before = std::mem::replace(&mut self.lines, lines);
        if lines.reset && !before.reset {
            self.reset(now);
        } else if !lines.reset && before.reset {
            self.starts = now + START_UP;
        }
        if !lines.stream_wanted && before.stream_wanted && self.stream.is_some() {
            self.plan(now + MODE_CHANGE, Action::Command);
        }
        self.continue_line(now);
    }

    /// Everything but the store and the surroundings is lost; connections break off.
    fn reset(&mut self, now: Cycles) {
        for peer in self.links.peers() {
            self.transmit(now, peer, AirSignal::Close);
        }
        let fresh = Self::new(&BluetoothConfiguration::default());
        *self = Self {
            store: self.store.clone(),
            lines: self.lines,
            starts: NEVER,
            planned: self.planned,
            air: std::mem::take(&mut self.air),
            ..fresh
        };
    }

    /// When it changes by itself next.
    pub fn next_event(&self) -> Cycles {
        let starts = if self.running { NEVER } else { self.starts };
        first_time(&self.agenda)
            .min(first_time(&self.air.incoming))
            .min(starts)
            .min(self.line.next_event())
    }

    /// Serves what is due at `now`: start, the air, its own plans, then the line.
    pub fn advance(&mut self, now: Cycles) {
        if !self.running && self.starts <= now {
            self.running = true;
            self.send(Message::new(code::RESET_INDICATION, &[]));
        }
        while let Some(message) = pop_due(&mut self.air.incoming, now) {
            self.receive(now, message);
        }
        while let Some(action) = pop_due(&mut self.agenda, now) {
            self.act(now, action);
        }
        self.continue_line(now);
    }

    fn plan(&mut self, at: Cycles, action: Action) {
        self.agenda.insert((at, self.planned), action);
        self.planned += 1;
    }

    /// Forget plans of a kind.
    fn cancel(&mut self, which: impl Fn(&Action) -> bool) {
        self.agenda.retain(|_, action| !which(action));
    }

    fn send(&mut self, message: Message) {
        self.line.send_frame(message.frame());
    }

    fn answer(&mut self, now: Cycles, code: u8, arguments: &[u8]) {
        self.plan(now + ANSWER, Action::Send(Message::new(code, arguments)));
    }

    fn transmit(&mut self, now: Cycles, peer: BluetoothAddress, signal: AirSignal) {
        self.air.outgoing.push(AirMessage {
            at_cycles: now,
            peer,
            signal,
        });
    }

    fn act(&mut self, now: Cycles, action: Action) {
        match action {
            Action::Send(message) => self.send(message),
            Action::Stream(handle) => self.enter_stream(now, handle),
            Action::Command => self.leave_stream(),
            Action::Heartbeat => self.send_heartbeat(now),
            Action::InquiryResult => self.inquiry_result(now),
            Action::InquiryEnd => self.end_inquiry(now),
            Action::PageFailed(peer) => self.page_failed(now, peer),
            Action::Packet => self.send_packets(now),
        }
    }

    /// The stream begins when the answers that wait have left.
    fn enter_stream(&mut self, now: Cycles, handle: u8) {
        if !self.line.no_frame_waits() {
            self.plan(now + MODE_CHANGE, Action::Stream(handle));
        } else if let Some(bytes) = self.links.take_inbox(handle) {
            self.stream = Some(handle);
            self.line.send_stream(bytes);
        }
    }

    /// What the chip has not got of the stream waits for the next one.
    fn leave_stream(&mut self) {
        let bytes = self.line.take_stream();
        if let Some(handle) = self.stream.take() {
            self.links.put_back(handle, bytes);
        }
        self.receiver.clear();
    }

    fn send_heartbeat(&mut self, now: Cycles) {
        if self.line_mode() == LineMode::Messages {
            self.send(Message::new(code::HEARTBEAT, &[]));
        }
        self.plan(now + HEARTBEAT_PERIOD, Action::Heartbeat);
    }

    const fn line_mode(&self) -> LineMode {
        match (self.stream.is_some(), self.lines.stream_wanted) {
            (true, true) => LineMode::Stream,
            (false, false) => LineMode::Messages,
            _ => LineMode::Nothing,
        }
    }

    fn continue_line(&mut self, now: Cycles) {
        let carries = self.line_mode();
        self.line.advance(now, self.lines.ready, carries);
    }

    /// A character has reached the chip.
    pub const fn has_character(&self) -> bool {
        self.line.has_arrived()
    }

    /// The character that has reached the chip.
    pub fn take_character(&mut self) -> Option<Character> {
        self.line.take_arrived()
    }

    /// A character from the chip.
    pub fn character(&mut self, now: Cycles, character: Character, log: &mut EventLog) {
        let Some(byte) = line::received(character).filter(|_| self.running) else {
            return;
        };
        if self.lines.stream_wanted {
            self.stream_byte(now, byte);
        } else if let Some(message) = self.receiver.push(byte) {
            if let Err(fault) = self.command(now, &message) {
                log.fault(now, fault);
            }
        }
    }

    /// A byte for the stream that is or will be open; without one it is lost.
    fn stream_byte(&mut self, now: Cycles, byte: u8) {
        let opening = self.agenda.values().find_map(|action| match action {
            Action::Stream(handle) => Some(*handle),
            _ => None,
        });
        let Some(handle) = self.stream.or(opening) else {
            return;
        };
        if self.links.put_outgoing(handle, byte) && !self.packet_planned {
            self.packet_planned = true;
            self.plan(now + PACKET_PERIOD, Action::Packet);
        }
    }

    fn send_packets(&mut self, now: Cycles) {
        for (peer, bytes) in self.links.take_packets(PACKET_BYTES) {
            self.transmit(now, peer, AirSignal::Data(bytes));
        }
        self.packet_planned = self.links.outbox_length() > 0;
        if self.packet_planned {
            self.plan(now + PACKET_PERIOD, Action::Packet);
        }
    }
}

fn first_time<T>(waiting: &BTreeMap<(Cycles, u64), T>) -> Cycles {
    let first = waiting.first_key_value();
    first.map_or(NEVER, |((at, _), _)| *at)
}

/// The first entry that is due.
fn pop_due<T>(waiting: &mut BTreeMap<(Cycles, u64), T>, now: Cycles) -> Option<T> {
    let due = waiting
        .first_key_value()
        .is_some_and(|((at, _), _)| *at <= now);
    due.then(|| waiting.pop_first().map(|(_, entry)| entry))?
}

/// A message that the module does not know or that the model does not carry out.
const fn not_modelled(code: u8) -> BoardFault {
    BoardFault::BluetoothMessage { code }
}
