// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A USB host at the end of the brick's cable: whole transfers, cut into transactions.
//!
//! While the cable is plugged in and the brick has its pull-up on (PA16 low), one transaction
//! takes place at a time; of several transfers that wait, each endpoint has its turn. A device
//! that is not ready is asked again later. Full speed: control endpoint 0 with 8 bytes a packet,
//! bulk endpoints with 64. Once the device has been reset, frames start every millisecond.

use std::collections::{BTreeMap, VecDeque};

use at91sam7s::board::{Cycles, UsbAnswer, UsbPacket, UsbSignal, UsbTransaction};

use crate::time::{microseconds, milliseconds, NEVER};

/// Analogue count of the cable's 5 V behind its divider (chosen; firmware compares with 512).
pub const CABLE_COUNT: u16 = 800;
const CONTROL_PACKET: usize = 8;
/// From one transaction to the next: a packet of 64 bytes with its overhead at 12 Mbit/s, and
/// what a host adds (chosen).
const TRANSACTION: Cycles = microseconds(80);
/// A device that was not ready is asked again after this long (chosen).
const RETRY: Cycles = microseconds(200);
const FRAME: Cycles = milliseconds(1);
/// A bus reset lasts at least this long (USB 2.0, 7.1.7.5).
const RESET: Cycles = milliseconds(10);
/// A bus without activity for this long is suspended.
const IDLE: Cycles = milliseconds(3);
/// Transfers that may wait.
const SCHEDULE_LIMIT: usize = 1 << 12;
/// Bytes in one transfer.
const LENGTH_LIMIT: usize = 1 << 20;
const SET_ADDRESS: [u8; 2] = [0, 5];
/// Bit of a request's type: data for the host.
const TO_HOST: u8 = 0x80;
/// A device that does not answer is asked so many times.
const ATTEMPTS: u8 = 3;

/// What a host can ask for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UsbRequest {
    /// Reset of the bus; the device has address 0 afterwards.
    Reset,
    /// A control transfer on endpoint 0.
    Control {
        /// The request.
        setup: [u8; 8],
        /// Data for the device; as many bytes as the request tells when they go to it.
        data: Vec<u8>,
    },
    /// Data for an endpoint of the device.
    Out {
        /// Number of the endpoint, 1 to 15.
        endpoint: u8,
        /// The bytes.
        data: Vec<u8>,
    },
    /// Data from an endpoint, up to a packet that is not full.
    In {
        /// Number of the endpoint, 1 to 15.
        endpoint: u8,
        /// Most bytes.
        length: usize,
    },
}

/// A transfer that the host wants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbTransfer {
    /// When it begins.
    pub at_cycles: Cycles,
    /// Its number, given back with the result.
    pub id: u64,
    /// It fails after this long.
    pub timeout_cycles: Cycles,
    /// What.
    pub request: UsbRequest,
}

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsbError {
    /// The endpoint refuses.
    Stalled,
    /// It took too long: no device, or it was never ready.
    TimedOut,
    /// The device does not answer, or against the rules.
    NoAnswer,
}

/// A transfer that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbCompletion {
    /// When.
    pub at_cycles: Cycles,
    /// Number of the transfer.
    pub id: u64,
    /// Bytes from the device, or why it failed.
    pub result: Result<Vec<u8>, UsbError>,
}

/// What a control transfer does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Setup,
    Data,
    Status,
}

/// A transfer under way.
#[derive(Clone, Debug)]
struct Active {
    id: u64,
    fails_at: Cycles,
    request: UsbRequest,
    stage: Stage,
    sent: usize,
    received: Vec<u8>,
    silent: u8,
    retry_at: Cycles,
}

/// How an answer leaves a transfer.
enum Progress {
    GoesOn,
    Retry,
    Ended(Result<Vec<u8>, UsbError>),
}

impl Active {
    fn new(transfer: UsbTransfer) -> Self {
        let fails_at = transfer.at_cycles.saturating_add(transfer.timeout_cycles);
        Self {
            id: transfer.id,
            fails_at,
            request: transfer.request,
            stage: Stage::Setup,
            sent: 0,
            received: Vec::new(),
            silent: 0,
            retry_at: 0,
        }
    }

    /// Queue in which it waits: endpoint, direction.
    const fn queue(request: &UsbRequest) -> (u8, bool) {
        match request {
            UsbRequest::Reset | UsbRequest::Control { .. } => (0, false),
            UsbRequest::Out { endpoint, .. } => (*endpoint, false),
            UsbRequest::In { endpoint, .. } => (*endpoint, true),
        }
    }

    /// The next packet of `data`.
    fn packet(&self, data: &[u8], longest: usize) -> UsbPacket {
        let rest = data.get(self.sent..).unwrap_or_default();
        let length = rest.len().min(longest);
        UsbPacket::new(&rest[..length]).unwrap_or(UsbPacket::EMPTY)
    }

    /// Its next transaction; a reset of the bus when there is none.
    fn transaction(&self) -> Option<UsbTransaction> {
        Some(match &self.request {
            UsbRequest::Reset => return None,
            UsbRequest::Out { data, .. } => {
                UsbTransaction::Out(self.packet(data, UsbPacket::CAPACITY))
            }
            UsbRequest::In { .. } => UsbTransaction::In,
            UsbRequest::Control { setup, data } => match (self.stage, setup[0] & TO_HOST != 0) {
                (Stage::Setup, _) => UsbTransaction::Setup(*setup),
                (Stage::Data, true) | (Stage::Status, false) => UsbTransaction::In,
                (Stage::Data, false) => UsbTransaction::Out(self.packet(data, CONTROL_PACKET)),
                (Stage::Status, true) => UsbTransaction::Out(UsbPacket::EMPTY),
            },
        })
    }

    fn answered(&mut self, answer: UsbAnswer) -> Progress {
        match answer {
            UsbAnswer::NotReady => Progress::Retry,
            UsbAnswer::Stalled => Progress::Ended(Err(UsbError::Stalled)),
            UsbAnswer::Silent => {
                self.silent += 1;
                if self.silent == ATTEMPTS {
                    Progress::Ended(Err(UsbError::NoAnswer))
                } else {
                    Progress::Retry
                }
            }
            UsbAnswer::Acknowledged => {
                self.silent = 0;
                self.taken()
            }
            UsbAnswer::Data(packet) => {
                self.silent = 0;
                self.packet_received(packet)
            }
        }
    }

    /// The device took a packet.
    fn taken(&mut self) -> Progress {
        match &self.request {
            UsbRequest::Out { data, .. } => {
                self.sent += self.packet(data, UsbPacket::CAPACITY).data().len();
                if self.sent < data.len() {
                    return Progress::GoesOn;
                }
            }
            UsbRequest::Control { setup, data } => match self.stage {
                Stage::Setup => {
                    let length = u16::from_le_bytes([setup[6], setup[7]]);
                    self.stage = if length == 0 {
                        Stage::Status
                    } else {
                        Stage::Data
                    };
                    return Progress::GoesOn;
                }
                Stage::Data => {
                    self.sent += self.packet(data, CONTROL_PACKET).data().len();
                    if self.sent >= data.len() {
                        self.stage = Stage::Status;
                    }
                    return Progress::GoesOn;
                }
                Stage::Status => {}
            },
            UsbRequest::Reset | UsbRequest::In { .. } => {}
        }
        Progress::Ended(Ok(std::mem::take(&mut self.received)))
    }

    /// The device gave a packet.
    fn packet_received(&mut self, packet: UsbPacket) -> Progress {
        let bytes = packet.data();
        let (wanted, longest) = match &self.request {
            UsbRequest::In { length, .. } => (*length, UsbPacket::CAPACITY),
            UsbRequest::Control { setup, .. } if self.stage == Stage::Data => {
                let length = u16::from_le_bytes([setup[6], setup[7]]);
                (usize::from(length), CONTROL_PACKET)
            }
            _ => return Progress::Ended(Ok(std::mem::take(&mut self.received))),
        };
        self.received.extend(bytes);
        self.received.truncate(wanted);
        if self.received.len() < wanted && bytes.len() == longest {
            return Progress::GoesOn;
        }
        if matches!(self.request, UsbRequest::Control { .. }) {
            self.stage = Stage::Status;
            return Progress::GoesOn;
        }
        Progress::Ended(Ok(std::mem::take(&mut self.received)))
    }
}

/// The host and its end of the cable.
#[derive(Clone, Debug)]
pub struct UsbHost {
    plugged: bool,
    pulled_up: bool,
    address: u8,
    frame: u16,
    frame_at: Cycles,
    suspend_at: Cycles,
    /// When the bus reset under way ends, and the number of its transfer.
    reset: Option<(Cycles, u64)>,
    free_at: Cycles,
    scheduled: BTreeMap<(Cycles, u64), UsbTransfer>,
    queues: BTreeMap<(u8, bool), VecDeque<Active>>,
    /// Queue whose transaction is on the bus, or was last.
    turn: (u8, bool),
    asked: bool,
    completed: Vec<UsbCompletion>,
}

impl Default for UsbHost {
    fn default() -> Self {
        Self {
            plugged: false,
            pulled_up: false,
            address: 0,
            frame: 0,
            frame_at: NEVER,
            suspend_at: NEVER,
            reset: None,
            free_at: 0,
            scheduled: BTreeMap::new(),
            queues: BTreeMap::new(),
            turn: (0, false),
            asked: false,
            completed: Vec::new(),
        }
    }
}

impl UsbHost {
    /// The cable is plugged in or pulled out. Until the host resets the bus, it is idle.
    pub fn set_plugged(&mut self, now: Cycles, plugged: bool) {
        if self.plugged != plugged {
            self.plugged = plugged;
            self.suspend_at = if plugged { NEVER } else { now + IDLE };
            self.bus_changed(now);
        }
    }

    /// Frames and a reset end; a device that is now on the bus finds it idle.
    fn bus_changed(&mut self, now: Cycles) {
        self.frame_at = NEVER;
        if let Some((_, id)) = self.reset.take() {
            self.complete(now, id, Err(UsbError::NoAnswer));
        }
        if self.attached() {
            self.suspend_at = now + IDLE;
        }
    }

    /// The cable brings 5 V.
    pub const fn plugged(&self) -> bool {
        self.plugged
    }

    /// The pull-up is switched so already, and no frame waits where it is off.
    pub const fn has_pull_up(&self, on: bool) -> bool {
        self.pulled_up == on && (on || self.frame_at == NEVER)
    }

    /// The brick switches its pull-up.
    pub fn set_pull_up(&mut self, now: Cycles, on: bool) {
        if self.pulled_up != on {
            self.pulled_up = on;
            self.bus_changed(now);
        }
    }

    /// The host sees a device.
    pub const fn attached(&self) -> bool {
        self.plugged && self.pulled_up
    }

    /// Lets a transfer begin at its time; false when it is too long or too many wait already.
    pub fn schedule(&mut self, transfer: UsbTransfer) -> bool {
        let length = match &transfer.request {
            UsbRequest::Reset => 0,
            UsbRequest::Control { data, .. } | UsbRequest::Out { data, .. } => data.len(),
            UsbRequest::In { length, .. } => *length,
        };
        let waiting = self.scheduled.len() + self.queues.values().map(VecDeque::len).sum::<usize>();
        if waiting >= SCHEDULE_LIMIT || length > LENGTH_LIMIT {
            return false;
        }
        let key = (transfer.at_cycles, transfer.id);
        self.scheduled.insert(key, transfer);
        true
    }

    /// Transfers that ended since the last call.
    pub fn take_completed(&mut self) -> Vec<UsbCompletion> {
        std::mem::take(&mut self.completed)
    }

    /// When a transfer begins or fails next.
    pub fn next_event(&self) -> Cycles {
        let scheduled = self.scheduled.first_key_value();
        let begins = scheduled.map_or(NEVER, |((at, _), _)| *at);
        let waiting = self.queues.values().flatten();
        waiting.fold(begins, |next, active| next.min(active.fails_at))
    }

    /// When [`Self::signal`] has something next.
    pub fn next_signal(&self) -> Cycles {
        if !self.attached() {
            return self.suspend_at;
        }
        if let Some((ends_at, _)) = self.reset {
            return ends_at;
        }
        let first = self.queues.values().filter_map(VecDeque::front);
        let transaction = first.map(|active| active.retry_at.max(self.free_at));
        let transaction = transaction.min().unwrap_or(NEVER);
        transaction.min(self.frame_at).min(self.suspend_at)
    }

    /// Begins the transfers that are due and ends those that took too long.
    pub fn advance(&mut self, now: Cycles) {
        while let Some(entry) = self.scheduled.first_entry().filter(|e| e.key().0 <= now) {
            let active = Active::new(entry.remove());
            let queue = Active::queue(&active.request);
            self.queues.entry(queue).or_default().push_back(active);
        }
        let mut failed = Vec::new();
        for queue in self.queues.values_mut() {
            let late = |active: &Active| active.fails_at <= now;
            failed.extend(queue.iter().filter(|a| late(a)).map(|active| active.id));
            queue.retain(|active| !late(active));
        }
        for id in failed {
            self.complete(now, id, Err(UsbError::TimedOut));
        }
    }

    fn complete(&mut self, now: Cycles, id: u64, result: Result<Vec<u8>, UsbError>) {
        self.completed.push(UsbCompletion {
            at_cycles: now,
            id,
            result,
        });
    }

    /// What the host puts on the bus now.
    pub fn signal(&mut self, now: Cycles) -> Option<UsbSignal> {
        if self.suspend_at <= now {
            self.suspend_at = NEVER;
            return Some(UsbSignal::Suspend);
        }
        if !self.attached() {
            return None;
        }
        if let Some((ends_at, id)) = self.reset {
            return (ends_at <= now).then(|| self.end_reset(now, id));
        }
        if self.frame_at <= now {
            self.frame_at += FRAME;
            self.frame = (self.frame + 1) & 0x7FF;
            let number = self.frame;
            return Some(UsbSignal::StartOfFrame { number });
        }
        if self.asked || self.free_at > now {
            return None;
        }
        self.turn = self.next_turn(now)?;
        self.free_at = now + TRANSACTION;
        let active = self.queues.get(&self.turn)?.front()?;
        let Some(transaction) = active.transaction() else {
            self.reset = Some((now + RESET, active.id));
            self.queues.get_mut(&self.turn)?.pop_front();
            (self.frame_at, self.suspend_at) = (NEVER, NEVER);
            return Some(UsbSignal::ResetBegins);
        };
        self.asked = true;
        Some(UsbSignal::Transaction {
            address: self.address,
            endpoint: self.turn.0,
            transaction,
        })
    }

    /// The queue after the last one served that has something to do now.
    fn next_turn(&self, now: Cycles) -> Option<(u8, bool)> {
        let ready = |queue: &VecDeque<Active>| queue.front().is_some_and(|a| a.retry_at <= now);
        let ready = self.queues.iter().filter(|(_, queue)| ready(queue));
        let ready: Vec<_> = ready.map(|(key, _)| *key).collect();
        let after = ready.iter().find(|key| **key > self.turn);
        after.or(ready.first()).copied()
    }

    fn end_reset(&mut self, now: Cycles, id: u64) -> UsbSignal {
        self.reset = None;
        self.address = 0;
        self.frame_at = now + FRAME;
        self.complete(now, id, Ok(Vec::new()));
        UsbSignal::Reset
    }

    /// The first transfer of the queue in turn has ended.
    fn end_first(&mut self, now: Cycles, result: Result<Vec<u8>, UsbError>) {
        let first = self
            .queues
            .get_mut(&self.turn)
            .and_then(VecDeque::pop_front);
        let Some(active) = first else {
            return;
        };
        if let UsbRequest::Control { setup, .. } = active.request {
            if setup[..2] == SET_ADDRESS && result.is_ok() {
                self.address = setup[2] & 0x7F;
            }
        }
        self.complete(now, active.id, result);
    }

    /// How the device answered the transaction.
    pub fn answer(&mut self, now: Cycles, answer: UsbAnswer) {
        self.asked = false;
        let first = self.queues.get_mut(&self.turn);
        let Some(active) = first.and_then(VecDeque::front_mut) else {
            return;
        };
        match active.answered(answer) {
            Progress::GoesOn => {}
            Progress::Retry => active.retry_at = now + RETRY,
            Progress::Ended(result) => self.end_first(now, result),
        }
    }
}
