// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Registers that differ by one of a few distances, whatever they hold: the end of an object whose
//! address is not known, and a pointer that moves towards it.
//!
//! These rules are methods of `State`, which keeps what they find, so each file knows the other.

use crate::values::flags::distance_flags;
use crate::values::interval::shifted;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::{LSL, ROR};
use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand};

/// Most pairs that are kept.
const MAX_SPANS: usize = 8;

/// The register `register` holds what `from` holds, shifted by a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftedCopy {
    /// The register.
    pub register: u32,
    /// The other one.
    pub from: u32,
    /// LSL, LSR or ASR.
    pub kind: u32,
    /// By so many bits, from 1 to 31.
    pub amount: u32,
}

/// The register `place` holds what `base` holds plus the distance, modulo 2^32.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// The one register.
    pub place: u32,
    /// The other one.
    pub base: u32,
    /// A number of few elements.
    pub distance: Value,
}

impl Span {
    fn moved(&self, by: u32) -> Option<Value> {
        let elements = self.distance.elements()?;
        Value::of_elements(elements.iter().map(|e| e.wrapping_add(by)).collect())
    }

    /// The flags that comparing these two registers may give for a distance.
    fn flags(&self, first: u32, distance: u32) -> u16 {
        distance_flags(if first == self.place {
            distance as i32
        } else {
            distance.wrapping_neg() as i32
        })
    }

    fn is_of(&self, first: u32, second: u32) -> bool {
        (self.place, self.base) == (first, second) || (self.base, self.place) == (first, second)
    }
}

impl State {
    /// A register was written with what another one holds, shifted.
    pub fn note_shifted(&mut self, copy: ShiftedCopy) {
        let (register, from) = (copy.register, copy.from);
        let shifts = copy.kind != ROR && copy.amount > 0;
        let room = self.shifted.len() < MAX_SPANS;
        if shifts && register != from && register < 13 && from < 13 && room {
            self.shifted.push(copy);
        }
    }

    /// The sum of a register and a shifted copy of it, as one of the register and itself shifted:
    /// both then come from the same number. Other operations stay as they are.
    pub fn with_shifted_itself(&self, processing: &DataProcessing) -> DataProcessing {
        let Operand::Shifted {
            register: second,
            kind: LSL,
            amount: 0,
        } = processing.second
        else {
            return *processing;
        };
        let first = processing.first;
        let is_copy = |copy: &&ShiftedCopy| {
            let pair = (copy.register, copy.from);
            pair == (second, first) || pair == (first, second)
        };
        let adds = processing.operation == AluOperation::Add;
        let Some(copy) = self.shifted.iter().find(is_copy).filter(|_| adds) else {
            return *processing;
        };
        DataProcessing {
            first: copy.from,
            second: Operand::Shifted {
                register: copy.from,
                kind: copy.kind,
                amount: copy.amount,
            },
            ..*processing
        }
    }

    /// What a register holds became known better: so does what is it shifted.
    pub fn refine_shifted(&mut self, from: u32, value: &Value) {
        for copy in self.shifted.iter().filter(|copy| copy.from == from) {
            let known = &mut self.registers[copy.register as usize];
            if let Some(narrower) = known.meet(&shifted(value, copy.kind, copy.amount)) {
                if known.bounds().is_some() {
                    *known = narrower;
                }
            }
        }
    }

    /// A register was written with what another one holds plus a number that is not known exactly.
    pub fn note_span(&mut self, place: u32, base: u32, distance: &Value) {
        let few = matches!(distance, Value::Set(_)) || distance.elements().is_some();
        if place == base || place > 12 || base > 12 || !few || self.spans.len() >= MAX_SPANS {
            return;
        }
        self.spans.push(Span {
            place,
            base,
            distance: distance.clone(),
        });
    }

    /// The spans of a register that became `by` more than `from` held before, which may be itself.
    pub fn spans_moved(&self, register: u32, from: u32, by: u32) -> Vec<Span> {
        let moved = |span: &Span| {
            let (distance, back) = (span.moved(by)?, span.moved(by.wrapping_neg())?);
            let (place, base) = (span.place, span.base);
            let new = if place == from && base != register {
                (register, base, distance)
            } else if base == from && place != register {
                (place, register, back)
            } else {
                return None;
            };
            let (place, base, distance) = new;
            Some(Span {
                place,
                base,
                distance,
            })
        };
        let room = if register == from {
            MAX_SPANS
        } else {
            MAX_SPANS.saturating_sub(self.spans.len())
        };
        self.spans.iter().filter_map(moved).take(room).collect()
    }

    /// Flags that comparing two registers may give.
    pub fn span_flags(&self, first: u32, second: u32) -> Option<u16> {
        let span = self.spans.iter().find(|span| span.is_of(first, second))?;
        let each = span.distance.elements()?.into_iter();
        Some(each.fold(0, |flags, e| flags | span.flags(first, e)))
    }

    /// Keeps the distances of two compared registers that give possible flags.
    pub fn narrow_spans(&mut self, first: Option<u32>, second: Option<u32>) -> Option<()> {
        let (Some(first), Some(second)) = (first, second) else {
            return Some(());
        };
        let flags = self.flags;
        for span in self.spans.iter_mut().filter(|s| s.is_of(first, second)) {
            let Some(mut elements) = span.distance.elements() else {
                continue;
            };
            let distances = span.clone();
            elements.retain(|distance| distances.flags(first, *distance) & flags != 0);
            span.distance = Value::of_elements(elements)?;
        }
        Some(())
    }

    /// Spans that hold in both states.
    pub fn common_spans(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Vec<Span> {
        let common = self.spans.iter().filter_map(|mine| {
            let pair = |theirs: &&Span| (theirs.place, theirs.base) == (mine.place, mine.base);
            let theirs = other.spans.iter().find(pair)?;
            let distance = join(&mine.distance, &theirs.distance);
            distance.elements().map(|_| Span {
                distance,
                ..mine.clone()
            })
        });
        common.collect()
    }
}
