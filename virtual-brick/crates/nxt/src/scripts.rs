// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Scripts that stand for devices in driver tests: on the two-wire bus, at the converter, in place
//! of the Bluetooth module.

use std::collections::VecDeque;

use at91sam7s::board::{Character, Cycles, TwiReply};

use crate::bluetooth::BIT_CYCLES;
use crate::time::NEVER;

/// Start bit, eight data bits, stop bit.
const CHARACTER_CYCLES: Cycles = 10 * BIT_CYCLES;

/// How a scripted slave of the two-wire bus answers one START.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TwiTurn {
    /// Bytes that it acknowledges, the address included.
    pub acknowledged: usize,
    /// What it gives; FF after the last.
    pub data: Vec<u8>,
    /// How long it holds the clock after each byte.
    pub stretch_cycles: Cycles,
}

/// The script of the two-wire bus: after its last turn nobody acknowledges.
#[derive(Clone, Debug, Default)]
pub struct TwiScript {
    turns: VecDeque<TwiTurn>,
    current: TwiTurn,
    given: usize,
}

impl TwiScript {
    pub fn new(turns: Vec<TwiTurn>) -> Self {
        Self {
            turns: turns.into(),
            ..Self::default()
        }
    }

    pub fn start(&mut self) -> TwiReply {
        self.current = self.turns.pop_front().unwrap_or_default();
        self.given = 0;
        self.written()
    }

    pub fn written(&mut self) -> TwiReply {
        let acknowledged = self.current.acknowledged > 0;
        self.current.acknowledged = self.current.acknowledged.saturating_sub(1);
        TwiReply {
            acknowledged,
            stretch_cycles: self.current.stretch_cycles,
        }
    }

    pub fn read(&mut self) -> (u8, Cycles) {
        let byte = self.current.data.get(self.given).copied().unwrap_or(0xFF);
        self.given += 1;
        (byte, self.current.stretch_cycles)
    }
}

/// Counts of the converter's channels, the last one for good.
#[derive(Clone, Debug, Default)]
pub struct ConverterScript([VecDeque<u16>; 8]);

impl ConverterScript {
    pub fn set(&mut self, channel: u8, counts: &[u16]) {
        self.0[usize::from(channel & 7)] = counts.iter().copied().collect();
    }

    /// The next count of a channel, if it has a script.
    pub fn next(&mut self, channel: u8) -> Option<u16> {
        let counts = &mut self.0[usize::from(channel & 7)];
        if counts.len() > 1 {
            counts.pop_front()
        } else {
            counts.front().copied()
        }
    }
}

/// Bytes that a scripted module sends once the program has sent enough.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleTurn {
    /// Bytes that the program sends since the turn before.
    pub after_bytes: usize,
    /// From the last of them to the beginning of the answer.
    pub delay_cycles: Cycles,
    /// The answer.
    pub bytes: Vec<u8>,
}

/// A script in place of the Bluetooth module.
#[derive(Clone, Debug, Default)]
pub struct ModuleScript {
    turns: VecDeque<ModuleTurn>,
    received: usize,
    outgoing: VecDeque<(Cycles, Character)>,
}

impl ModuleScript {
    /// These turns, the first of them at `now` if it waits for no byte.
    pub fn new(now: Cycles, turns: Vec<ModuleTurn>) -> Self {
        let mut script = Self {
            turns: turns.into(),
            ..Self::default()
        };
        script.answer(now);
        script
    }

    /// A byte of the program.
    pub fn receive(&mut self, now: Cycles) {
        self.received += 1;
        self.answer(now);
    }

    fn answer(&mut self, now: Cycles) {
        while self
            .turns
            .front()
            .is_some_and(|turn| turn.after_bytes <= self.received)
        {
            let Some(turn) = self.turns.pop_front() else {
                return;
            };
            self.received = 0;
            let free_at = self.outgoing.back().map_or(now, |(at, _)| *at);
            let mut ends = free_at.max(now) + turn.delay_cycles;
            for byte in turn.bytes {
                ends += CHARACTER_CYCLES;
                let character = Character {
                    data: u16::from(byte),
                    bit_cycles: BIT_CYCLES,
                };
                self.outgoing.push_back((ends, character));
            }
        }
    }

    pub fn next_event(&self) -> Cycles {
        self.outgoing.front().map_or(NEVER, |(at, _)| *at)
    }

    /// The character that has reached the chip by now.
    pub fn take(&mut self, now: Cycles) -> Option<Character> {
        if self.next_event() > now {
            return None;
        }
        self.outgoing.pop_front().map(|(_, character)| character)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_answers_when_all_bytes_of_the_turn_have_come() {
        let turn = |byte| ModuleTurn {
            after_bytes: 2,
            delay_cycles: 10,
            bytes: vec![byte],
        };
        let mut script = ModuleScript::new(0, vec![turn(1), turn(2)]);
        let mut answers = Vec::new();
        for number in 1..=5 {
            let now = number * 10 * CHARACTER_CYCLES;
            script.receive(now);
            let taken = script.take(now + 10 + CHARACTER_CYCLES);
            answers.push(taken.map(|character| character.data));
        }
        assert_eq!(answers, [None, Some(1), None, Some(2), None]);
    }
}
