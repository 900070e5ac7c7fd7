// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Two-wire interface, master (AT91SAM7S datasheet, 6175M, chapter 29).
//!
//! One bit lasts (CLDIV 2^CKDIV + 3) + (CHDIV 2^CKDIV + 3) master clock cycles; START and STOP
//! take one bit each, a byte nine. A write frame begins when the first byte is put in THR, which
//! moves to the shifter only after the address was acknowledged, and ends by itself when a byte
//! was acknowledged and THR is empty: so STOP in CR changes nothing for writes. Whether THR may
//! still be filled while the slave holds SCL after its acknowledge is `twi_stop_decision`. A read
//! frame begins with START in CR and ends after the byte during whose eight data bits (or earlier)
//! STOP was set. Modes written during a frame count for the next one; a START or a first byte
//! given while STOP is on the bus begins the next frame right after it.

use crate::board::{Board, Cycles, TwiReply};
use crate::clock::NEVER;
use crate::errata::Errata;
use crate::fault::{clock_disabled, no_register, Access};
use crate::registers::registers;
use crate::timing::TwiStopDecision;

/// The control register.
pub(crate) const TWI_CR: u32 = 0x00;
registers! {
    TWI_MMR = 0x04, TWI_IADR = 0x0C, TWI_CWGR = 0x10, TWI_SR = 0x20,
    TWI_IER = 0x24, TWI_IDR = 0x28, TWI_IMR = 0x2C, TWI_RHR = 0x30, TWI_THR = 0x34,
}

const NAME: &str = "TWI";
pub(crate) const IDENTIFIER: u8 = 9;
/// Pins TWD and TWCK.
pub(crate) const LINES: u32 = 1 << 3 | 1 << 4;
const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const OVRE: u32 = 1 << 6;
const NACK: u32 = 1 << 8;
const INTERRUPTS: u32 = TXCOMP | RXRDY | TXRDY | OVRE | NACK | 1 << 7;
const MREAD: u32 = 1 << 12;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    /// START on the bus, then the address with this direction.
    Start {
        read: bool,
    },
    Address {
        read: bool,
    },
    /// `remaining` internal address bytes still to go, counting the one in the shifter.
    InternalAddress {
        remaining: u32,
    },
    Write {
        byte: u8,
    },
    /// The slave holds SCL after a byte, and nothing is in THR yet.
    Held,
    /// Eight bits from the slave.
    Read {
        byte: u8,
    },
    /// Ninth bit of a read byte; `last` when the master does not acknowledge.
    ReadAcknowledge {
        byte: u8,
        last: bool,
    },
    Stop {
        refused: bool,
    },
}

/// Registers and the frame on the bus.
#[derive(Clone, Debug)]
pub(crate) struct Twi {
    stop_decision: TwiStopDecision,
    enabled: bool,
    mode: u32,
    internal_address: u32,
    waveform: u32,
    mask: u32,
    holding: Option<u8>,
    received: u8,
    flags: u32,
    stop_requested: bool,
    start_requested: bool,
    frame_mode: u32,
    frame_internal_address: u32,
    phase: Phase,
    until: Cycles,
    errata: Errata,
    /// Enabled or reset with a line low: dead until a reset with both high.
    locked: bool,
    /// The status was read while the running stop condition was on the bus.
    nack_lost: bool,
}

impl Twi {
    pub(crate) fn new(stop_decision: TwiStopDecision, errata: Errata) -> Self {
        Self {
            stop_decision,
            enabled: false,
            mode: 0,
            internal_address: 0,
            waveform: 0,
            mask: 0,
            holding: None,
            received: 0,
            flags: TXCOMP,
            stop_requested: false,
            start_requested: false,
            frame_mode: 0,
            frame_internal_address: 0,
            phase: Phase::Idle,
            until: NEVER,
            errata,
            locked: false,
            nack_lost: false,
        }
    }

    /// Cycles of one bit on the bus.
    fn bit(&self) -> Cycles {
        let half = |divider: u32| (Cycles::from(divider & 0xFF) << (self.waveform >> 16 & 7)) + 3;
        half(self.waveform) + half(self.waveform >> 8)
    }

    fn status(&self) -> u32 {
        let ready = self.enabled && self.holding.is_none();
        self.flags | if ready { TXRDY } else { 0 }
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status() & self.mask != 0
    }

    pub(crate) fn next_event(&self) -> Cycles {
        self.until
    }

    fn enter(&mut self, phase: Phase, at: Cycles, duration: Cycles) {
        self.phase = phase;
        self.until = at + duration;
    }

    /// Begin a frame if one is asked for and the bus is free.
    fn try_start(&mut self, now: Cycles) {
        if self.phase != Phase::Idle || !self.enabled || self.locked {
            return;
        }
        let read = self.mode & MREAD != 0;
        let wanted = if read {
            self.start_requested
        } else {
            self.holding.is_some()
        };
        if !wanted {
            return;
        }
        self.start_requested = false;
        self.frame_mode = self.mode;
        self.frame_internal_address = self.internal_address;
        self.flags &= !TXCOMP;
        let first_is_read = read && self.internal_length() == 0;
        self.enter(
            Phase::Start {
                read: first_is_read,
            },
            now,
            self.bit(),
        );
    }

    fn internal_length(&self) -> u32 {
        self.frame_mode >> 8 & 3
    }

    fn slave_address(&self) -> u8 {
        (self.frame_mode >> 16 & 0x7F) as u8
    }

    /// The phase on the bus ended. `connected`: the two pins belong to this peripheral.
    pub(crate) fn serve<B: Board>(&mut self, at: Cycles, board: &mut B, connected: bool) {
        match self.phase {
            Phase::Idle => self.until = NEVER,
            Phase::Start { read } => self.enter(Phase::Address { read }, at, 9 * self.bit()),
            Phase::Address { read } => {
                let address = self.slave_address();
                let reply = answer(connected, || board.twi_start(at, address, read));
                self.address_answered(at, read, reply, board, connected);
            }
            Phase::InternalAddress { remaining } => {
                let byte = (self.frame_internal_address >> (8 * (remaining - 1))) as u8;
                let reply = answer(connected, || board.twi_write(at, byte));
                self.internal_address_answered(at, remaining - 1, reply);
            }
            Phase::Write { byte } => {
                let reply = answer(connected, || board.twi_write(at, byte));
                if self.errata.twi_received_byte_overwritten {
                    self.received = byte;
                }
                if reply.acknowledged {
                    self.next_write(at, reply.stretch_cycles);
                } else {
                    self.refuse(at);
                }
            }
            Phase::Held => self.next_write(at, 0),
            Phase::Read { byte } => {
                let last = self.stop_requested || !self.enabled;
                self.enter(Phase::ReadAcknowledge { byte, last }, at, self.bit());
            }
            Phase::ReadAcknowledge { byte, last } => {
                self.store(byte);
                if last {
                    let stretch = if connected {
                        board.twi_end_of_read(at)
                    } else {
                        0
                    };
                    self.stop(at + stretch, false);
                } else {
                    self.next_read(at, board, connected);
                }
            }
            Phase::Stop { refused } => {
                if connected {
                    board.twi_stop(at);
                }
                self.stopped(at, refused);
            }
        }
    }

    fn address_answered<B: Board>(
        &mut self,
        at: Cycles,
        read: bool,
        reply: TwiReply,
        board: &mut B,
        connected: bool,
    ) {
        if !reply.acknowledged {
            return self.refuse(at);
        }
        let released = at + reply.stretch_cycles;
        if read {
            self.next_read(released, board, connected);
        } else if self.internal_length() != 0 {
            let remaining = self.internal_length();
            let phase = Phase::InternalAddress { remaining };
            self.enter(phase, released, 9 * self.bit());
        } else {
            self.next_write(at, reply.stretch_cycles);
        }
    }

    fn internal_address_answered(&mut self, at: Cycles, remaining: u32, reply: TwiReply) {
        let at_next = at + reply.stretch_cycles;
        if !reply.acknowledged {
            self.refuse(at);
        } else if remaining != 0 {
            self.enter(
                Phase::InternalAddress { remaining },
                at_next,
                9 * self.bit(),
            );
        } else if self.frame_mode & MREAD != 0 {
            self.enter(Phase::Start { read: true }, at_next, self.bit());
        } else {
            self.next_write(at, reply.stretch_cycles);
        }
    }

    /// Move THR to the shifter, or end the frame when it is empty. The slave holds SCL from `at`
    /// on for `stretch` cycles.
    fn next_write(&mut self, at: Cycles, stretch: Cycles) {
        let waits = self.stop_decision == TwiStopDecision::Release && stretch > 0;
        match self.holding.take() {
            Some(byte) => self.enter(Phase::Write { byte }, at + stretch, 9 * self.bit()),
            None if waits => self.enter(Phase::Held, at, stretch),
            None => self.stop(at + stretch, false),
        }
    }

    fn next_read<B: Board>(&mut self, at: Cycles, board: &mut B, connected: bool) {
        let (byte, stretch) = if connected {
            board.twi_read(at)
        } else {
            (0xFF, 0)
        };
        self.enter(Phase::Read { byte }, at, stretch + 8 * self.bit());
    }

    fn store(&mut self, byte: u8) {
        if self.flags & RXRDY != 0 {
            self.flags |= OVRE;
        }
        self.flags |= RXRDY;
        self.received = byte;
    }

    /// What waits in THR is dropped with the end of the stop: TXRDY, TXCOMP and NACK are set at
    /// the same time (datasheet, TWI status register).
    fn refuse(&mut self, at: Cycles) {
        self.stop(at, true);
    }

    fn stop(&mut self, at: Cycles, refused: bool) {
        self.stop_requested = false;
        self.enter(Phase::Stop { refused }, at, self.bit());
    }

    fn stopped(&mut self, at: Cycles, refused: bool) {
        self.phase = Phase::Idle;
        self.until = NEVER;
        self.flags |= TXCOMP;
        if refused {
            self.flags |= if self.nack_lost { 0 } else { NACK };
            self.holding = None;
        }
        self.nack_lost = false;
        self.try_start(at);
    }

    /// What a read gives that changes nothing; of the register that programs poll.
    pub(crate) fn polled(&self, offset: u32) -> Option<u32> {
        let same = self.flags & (OVRE | NACK) == 0 && self.nack_lost == self.loses_nack();
        (offset == TWI_SR && same).then(|| self.status())
    }

    /// A read of the status now loses the refusal of the frame that ends.
    fn loses_nack(&self) -> bool {
        self.errata.twi_nack_lost && matches!(self.phase, Phase::Stop { .. })
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            TWI_CR | TWI_IER | TWI_IDR | TWI_THR => 0,
            TWI_MMR => self.mode,
            TWI_IADR => self.internal_address,
            TWI_CWGR => self.waveform,
            TWI_SR => {
                let value = self.status();
                self.flags &= !(OVRE | NACK);
                self.nack_lost = self.loses_nack();
                value
            }
            TWI_IMR => self.mask,
            TWI_RHR => {
                self.flags &= !RXRDY;
                u32::from(self.received)
            }
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles, clocked: bool) -> Access {
        match offset {
            TWI_CR => self.control(value, now),
            TWI_MMR => self.mode = value & 0x007F_1300,
            TWI_IADR => self.internal_address = value & 0x00FF_FFFF,
            TWI_CWGR => self.waveform = value & 0x0007_FFFF,
            TWI_IER => self.mask |= value & INTERRUPTS,
            TWI_IDR => self.mask &= !value,
            TWI_THR => {
                self.holding = Some(value as u8);
                self.try_start(now);
            }
            TWI_SR | TWI_IMR | TWI_RHR => {}
            _ => return no_register(NAME, offset),
        }
        if self.phase != Phase::Idle && !clocked {
            return clock_disabled(NAME, IDENTIFIER);
        }
        Ok(())
    }

    fn control(&mut self, value: u32, now: Cycles) {
        if value & 1 << 7 != 0 {
            *self = Self::new(self.stop_decision, self.errata);
        }
        if value & 1 << 3 != 0 {
            self.enabled = false;
            if self.errata.twi_disable_freezes {
                self.until = NEVER;
            }
        } else if value & 1 << 2 != 0 {
            self.enabled = true;
        }
        let start = value & 1 << 0 != 0 && self.mode & MREAD != 0;
        let stop = value & 1 << 1 != 0;
        if start {
            self.start_requested = true;
        }
        if self.reading() {
            self.stop_requested |= stop;
        } else if start {
            self.stop_requested = stop;
        } else if self.start_requested {
            self.stop_requested |= stop;
        }
        self.try_start(now);
    }

    /// After a write of the control register: the lines' levels decide whether the interface
    /// still works.
    pub(crate) fn follow_lines(&mut self, control: u32, high: bool) {
        const RESET_OR_ENABLE: u32 = 1 << 7 | 1 << 2;
        if self.errata.twi_locked_by_low_line && control & RESET_OR_ENABLE != 0 && !high {
            self.locked = true;
            self.phase = Phase::Idle;
            self.until = NEVER;
        }
    }

    /// A read frame is on the bus and not yet ending.
    fn reading(&self) -> bool {
        self.frame_mode & MREAD != 0 && !matches!(self.phase, Phase::Idle | Phase::Stop { .. })
    }
}

/// What the bus answers; with the pins elsewhere the data line stays high.
fn answer(connected: bool, slave: impl FnOnce() -> TwiReply) -> TwiReply {
    if connected {
        slave()
    } else {
        TwiReply {
            acknowledged: false,
            stretch_cycles: 0,
        }
    }
}
