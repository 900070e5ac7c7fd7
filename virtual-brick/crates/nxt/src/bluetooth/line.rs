// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The module's end of the serial line: 460,800 baud, 8 data bits, no parity, one stop bit, held
//! back by the chip's RTS.

use std::collections::VecDeque;

use at91sam7s::board::{Character, Cycles};

use crate::time::NEVER;

/// One bit in master clock cycles.
pub const BIT_CYCLES: Cycles = 104;
/// Start bit, eight data bits, stop bit.
const CHARACTER_CYCLES: Cycles = 10 * BIT_CYCLES;
const TOLERANCE_PERCENT: Cycles = 5;

/// What the line may carry now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineMode {
    Messages,
    Stream,
    Nothing,
}

/// Bytes that wait for the line, and the one on it.
#[derive(Clone, Debug, Default)]
pub struct Line {
    messages: VecDeque<u8>,
    stream: VecDeque<u8>,
    shifting: Option<(u8, Cycles)>,
    arrived: Option<u8>,
}

impl Line {
    pub fn send_frame(&mut self, frame: Vec<u8>) {
        self.messages.extend(frame);
    }

    pub fn send_stream(&mut self, bytes: impl IntoIterator<Item = u8>) {
        self.stream.extend(bytes);
    }

    /// Bytes of the stream that wait.
    pub fn waiting_stream(&self) -> usize {
        self.stream.len()
    }

    /// Takes back the bytes of the stream that wait.
    pub fn take_stream(&mut self) -> VecDeque<u8> {
        std::mem::take(&mut self.stream)
    }

    pub fn no_frame_waits(&self) -> bool {
        self.messages.is_empty() && self.shifting.is_none()
    }

    pub fn next_event(&self) -> Cycles {
        self.shifting.map_or(NEVER, |(_, end)| end)
    }

    /// Ends the character on the line if its time has come, and begins the next one.
    pub fn advance(&mut self, now: Cycles, ready: bool, carries: LineMode) {
        if let Some((byte, _)) = self.shifting.filter(|(_, end)| *end <= now) {
            self.shifting = None;
            self.arrived = Some(byte);
        }
        if self.shifting.is_some() || !ready {
            return;
        }
        let next = match carries {
            LineMode::Messages => self.messages.pop_front(),
            LineMode::Stream => self.stream.pop_front(),
            LineMode::Nothing => None,
        };
        self.shifting = next.map(|byte| (byte, now + CHARACTER_CYCLES));
    }

    /// A character has reached the chip.
    pub const fn has_arrived(&self) -> bool {
        self.arrived.is_some()
    }

    /// The character that has reached the chip.
    pub fn take_arrived(&mut self) -> Option<Character> {
        self.arrived.take().map(|byte| Character {
            data: u16::from(byte),
            bit_cycles: BIT_CYCLES,
        })
    }
}

/// The byte in a character from the chip; nothing when its bits are too long or too short.
pub fn received(character: Character) -> Option<u8> {
    let off = character.bit_cycles.abs_diff(BIT_CYCLES);
    (off * 100 <= BIT_CYCLES * TOLERANCE_PERCENT).then_some(character.data as u8)
}
