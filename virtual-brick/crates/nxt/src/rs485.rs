// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The far end of port 4's RS485 line: characters to the brick and from it.
//!
//! One transceiver serves both directions. While the brick drives the line it hears nothing, and
//! what another device sends meanwhile is lost.

use std::collections::VecDeque;

use at91sam7s::board::{Character, Cycles};

use crate::time::NEVER;

/// Start bit, eight data bits, stop bit.
const CHARACTER_BITS: Cycles = 10;
/// Most characters that wait in either direction.
const CAPACITY: usize = 1 << 16;

/// Characters for the brick and from it, in the order of time.
#[derive(Clone, Debug, Default)]
pub struct Rs485Line {
    incoming: VecDeque<(Cycles, Character)>,
    sent: Vec<(Cycles, u8)>,
}

impl Rs485Line {
    /// Bytes from another device, the first of which begins at `at_cycles` or after what was
    /// scheduled before; bits last `bit_cycles`. False when too many wait.
    pub fn schedule(&mut self, at_cycles: Cycles, bytes: &[u8], bit_cycles: Cycles) -> bool {
        if self.incoming.len() + bytes.len() > CAPACITY {
            return false;
        }
        let free_at = self.incoming.back().map_or(0, |(at, _)| *at);
        let mut ends = free_at.max(at_cycles);
        for &byte in bytes {
            ends += CHARACTER_BITS * bit_cycles;
            let data = u16::from(byte);
            self.incoming
                .push_back((ends, Character { data, bit_cycles }));
        }
        true
    }

    /// What the brick sent since the last call, each byte with the end of its stop bit.
    pub fn take_sent(&mut self) -> Vec<(Cycles, u8)> {
        std::mem::take(&mut self.sent)
    }

    pub(crate) fn sent(&mut self, now: Cycles, character: Character) {
        if self.sent.len() < CAPACITY {
            self.sent.push((now, character.data as u8));
        }
    }

    pub(crate) fn next_event(&self) -> Cycles {
        self.incoming.front().map_or(NEVER, |(at, _)| *at)
    }

    /// The character that has reached the chip by now; none that came while it drove the line.
    pub(crate) fn take(&mut self, now: Cycles, chip_drives: bool) -> Option<Character> {
        while self.next_event() <= now {
            let (_, character) = self.incoming.pop_front()?;
            if !chip_drives {
                return Some(character);
            }
        }
        None
    }
}
