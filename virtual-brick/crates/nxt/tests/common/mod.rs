// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A board and the chip's side of its lines.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../../plant/tests/common/catalogue.rs"]
pub mod catalogue;

use at91sam7s::board::{Board, Cycles, PinOutputs};
use nxt::{BoardConfiguration, BoardEvent, BoardEventKind, NxtBoard};
use plant::RobotParameters;

pub const HANDSHAKE: &[u8] = b"\xCCLet's samba nxt arm in arm, (c)LEGO System A/S";
/// Nine bit times at 400 kHz.
pub const BYTE_CYCLES: Cycles = 1_081;

pub fn motor() -> String {
    format!(r#"{{"parameters": {}}}"#, *catalogue::TABLE_1)
}

pub fn three_motors() -> String {
    let motor = motor();
    format!(r#"{{"motors": {{"A": {motor}, "B": {motor}, "C": {motor}}}}}"#)
}

pub const fn milliseconds(count: u64) -> Cycles {
    count * 336_384 / 7
}

/// A board, and how far it has been run.
#[derive(Clone)]
pub struct Rig {
    pub board: NxtBoard,
    pub now: Cycles,
}

impl Rig {
    pub fn new(board: &str, robot: &str, seed: u64) -> Self {
        let board: BoardConfiguration = serde_json::from_str(board).unwrap();
        let robot: RobotParameters = serde_json::from_str(robot).unwrap();
        Self {
            board: NxtBoard::new(&board, &robot, seed).unwrap(),
            now: 0,
        }
    }

    /// A brick that has been on for a while.
    pub fn running(board: &str, robot: &str) -> Self {
        let mut rig = Self::new(board, robot, 1);
        rig.board.skip_coprocessor_start_up(0);
        rig
    }

    /// Serves the board's events up to `at`, each at its time, as the chip does.
    pub fn run_until(&mut self, at: Cycles) {
        while self.board.next_event() <= at {
            let next = self.board.next_event();
            self.board.advance(next);
        }
        self.now = at;
    }

    pub fn run(&mut self, cycles: Cycles) {
        self.run_until(self.now + cycles);
    }

    /// Writes bytes to slave 1; whether each of them was acknowledged.
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        let mut acknowledged = self.board.twi_start(self.now, 1, false).acknowledged;
        for &byte in bytes {
            self.run(BYTE_CYCLES);
            acknowledged &= self.board.twi_write(self.now, byte).acknowledged;
        }
        self.board.twi_stop(self.now);
        acknowledged
    }

    pub fn read(&mut self, count: usize) -> Vec<u8> {
        assert!(self.board.twi_start(self.now, 1, true).acknowledged);
        let mut bytes = Vec::new();
        for _ in 0..count {
            self.run(BYTE_CYCLES);
            bytes.push(self.board.twi_read(self.now).0);
        }
        self.board.twi_stop(self.now);
        bytes
    }

    /// The six words of the status frame, after its checksum was found right.
    pub fn words(&mut self) -> [u16; 6] {
        let bytes = self.read(13);
        assert_eq!(
            bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)),
            0xFF
        );
        [0, 1, 2, 3, 4, 5].map(|i| u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]))
    }

    /// Sends a frame with its checksum.
    pub fn send(&mut self, bytes: [u8; 8]) {
        let sum = bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        let mut frame = bytes.to_vec();
        frame.push(!sum);
        assert!(self.write(&frame));
    }

    /// Duty cycles in percent at 8 kHz with the brake bits of `mode`.
    pub fn drive(&mut self, duties: [i8; 3], mode: u8) {
        let [a, b, c] = duties.map(|duty| duty as u8);
        self.send([0, 8, a, b, c, 0, mode, 0]);
    }

    pub fn signal(&self, name: &str) -> f64 {
        let signals = self.board.signals(self.now);
        signals
            .into_iter()
            .find(|(other, _)| other == name)
            .unwrap()
            .1
    }

    /// Events without those of the display, as (cycle, kind).
    pub fn events(&mut self) -> Vec<(Cycles, BoardEventKind)> {
        let events = self.reports().into_iter();
        events.map(|event| (event.at_cycles, event.kind)).collect()
    }

    /// Events since the last call.
    pub fn reports(&mut self) -> Vec<BoardEvent> {
        let mut events = Vec::new();
        self.board.take_events(&mut events);
        events
    }

    pub fn set(&mut self, name: &str, value: f64) {
        self.board.set_input(self.now, name, value).unwrap();
    }

    /// The chip drives these pins.
    pub fn outputs(&mut self, driven: u32, level: u32) {
        let outputs = PinOutputs {
            driven,
            level,
            pull_up: 0,
        };
        self.board.outputs_changed(self.now, outputs);
    }
}
