// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Registers that differ from other registers or from words of memory by a known distance, whatever
//! they hold: what a comparison says about one is then known of the others.

use crate::values::value::{Value, RUNNING};

/// Most places that are related to one place.
const MOST: usize = 12;

/// Where a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Location {
    /// One of r0 to r12.
    Register(u32),
    /// The word of memory at this address.
    Word(u32),
}

/// Pairs in ascending order, the first of each a register: the first is the second plus the
/// distance, modulo 2^32.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Relations(Vec<(Location, Location, u32)>);

impl Relations {
    /// Places related to one, each with what it is more than that one.
    pub fn of(&self, place: Location) -> impl Iterator<Item = (Location, u32)> + '_ {
        self.0.iter().filter_map(move |(first, second, distance)| {
            if *first == place {
                Some((*second, distance.wrapping_neg()))
            } else {
                (*second == place).then_some((*first, *distance))
            }
        })
    }

    /// What a place is more than another one, where it is known.
    pub fn between(&self, place: Location, other: Location) -> Option<u32> {
        let mut found = self.of(other).filter(|(related, _)| *related == place);
        found.next().map(|(_, distance)| distance)
    }

    /// A place is written.
    pub fn invalidate(&mut self, place: Location) {
        self.0.retain(|(a, b, _)| *a != place && *b != place);
    }

    /// Any word may be written.
    pub fn invalidate_words(&mut self) {
        self.0
            .retain(|(_, b, _)| matches!(b, Location::Register(_)));
    }

    /// A place was written: it is `distance` more than another one.
    pub fn note(&mut self, place: Location, from: Location, distance: u32) {
        let others: Vec<_> = self.of(from).collect();
        if place == from || others.len() >= MOST {
            return;
        }
        for (other, more) in others.into_iter().chain([(from, 0)]) {
            self.add(place, other, distance.wrapping_sub(more));
        }
    }

    fn add(&mut self, place: Location, other: Location, distance: u32) {
        let pair = if place < other {
            (place, other, distance)
        } else {
            (other, place, distance.wrapping_neg())
        };
        if !matches!(pair.0, Location::Register(_)) {
            return;
        }
        if let Err(position) = self.0.binary_search(&pair) {
            self.0.insert(position, pair);
        }
    }

    /// A place becomes `distance` more than it was.
    pub fn move_by(&mut self, place: Location, distance: u32) {
        for (first, second, known) in &mut self.0 {
            if *first == place {
                *known = known.wrapping_add(distance);
            } else if *second == place {
                *known = known.wrapping_sub(distance);
            }
        }
    }

    /// What holds in both.
    pub fn common(&self, other: &Self) -> Self {
        let both = self.0.iter().filter(|pair| other.0.contains(pair));
        Self(both.copied().collect())
    }

    /// No relation is known any more.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// What is known of a word that holds `known` and is `distance` more than one that holds `value`;
/// nothing new for addresses and the running thread, and where the sum of a range overflows.
pub fn narrowed(known: &Value, value: &Value, distance: u32) -> Option<Value> {
    let named = matches!(known, Value::Based(RUNNING, _));
    if named || !known.is_unknown() && known.bounds().is_none() {
        return None;
    }
    let moved = match value.elements() {
        Some(elements) => {
            let sums = elements.iter().map(|e| e.wrapping_add(distance));
            Value::of_elements(sums.collect())?
        }
        None => {
            let (low, high) = value.bounds().map(|_| value.interval())?;
            let distance = i128::from(distance as i32);
            Value::of_interval(low + distance, high + distance)
        }
    };
    match (known.bounds(), &moved) {
        (_, Value::Top) => None,
        (Some(_), _) => known.meet(&moved),
        _ => Some(moved),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Location::{Register, Word};

    #[test]
    fn what_a_word_and_two_copies_of_it_differ_by_follows_additions() {
        let mut relations = Relations::default();
        relations.note(Register(0), Word(0x100), 0);
        relations.move_by(Register(0), 2_u32.wrapping_neg());
        relations.note(Register(12), Register(0), 0);
        relations.invalidate(Register(0));
        relations.note(Register(0), Word(0x100), 0);
        let found: Vec<_> = relations.of(Register(0)).collect();
        assert_eq!(
            found,
            [(Register(12), 2_u32.wrapping_neg()), (Word(0x100), 0)]
        );
        relations.invalidate_words();
        assert_eq!(
            relations.of(Register(12)).collect::<Vec<_>>(),
            [(Register(0), 2)]
        );
    }

    #[test]
    fn a_word_is_narrowed_by_another_one_unless_it_is_an_address() {
        let set = Value::Set(vec![0, 1, 5].into());
        let other = Value::Set(vec![3, 4, 7].into());
        let two_less = 2_u32.wrapping_neg();
        assert_eq!(
            narrowed(&set, &other, two_less),
            Some(Value::Set(vec![1, 5].into()))
        );
        assert_eq!(
            narrowed(&Value::Range(0, 9), &Value::Range(4, 1000), two_less),
            Some(Value::Range(2, 9))
        );
        let overflowing = narrowed(&Value::Range(0, 9), &Value::Range(0, 1000), two_less);
        assert_eq!(overflowing, Some(Value::Range(0, 9)));
        assert_eq!(narrowed(&Value::Stack(8), &set, 0), None);
    }
}
