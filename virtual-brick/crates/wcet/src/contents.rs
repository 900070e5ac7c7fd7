// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What memory holds in a program that nothing else writes to: it begins as the image says, zero
//! elsewhere, and each store is followed. Copies share the pages that are alike.

use crate::image::Image;
use crate::value::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

const PAGE_WORDS: usize = 32;
const PAGE_BYTES: u32 = 4 * PAGE_WORDS as u32;

/// Most addresses that one store is followed to.
const PLACES: u32 = 4096;

type Page = Rc<[Value; PAGE_WORDS]>;

/// The words of memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    initial: Rc<BTreeMap<u32, Page>>,
    pages: Rc<BTreeMap<u32, Page>>,
    /// Pages that are not listed are no longer those of the image.
    lost: bool,
}

/// A part of a word: bits of it from `shift` on.
fn part(word: &Value, shift: u32, mask: u32) -> Value {
    if mask == u32::MAX {
        return word.clone();
    }
    let parts = word
        .elements()
        .map(|elements| elements.iter().map(|e| e >> shift & mask).collect());
    parts
        .and_then(Value::of_elements)
        .unwrap_or(Value::Range(0, mask))
}

/// A word with a part replaced.
fn replaced(word: &Value, shift: u32, mask: u32, value: &Value) -> Value {
    if mask == u32::MAX {
        // Only numbers mean the same wherever they are read.
        return value.bounds().map_or(Value::Top, |_| value.clone());
    }
    let (Some(words), Some(parts)) = (word.elements(), value.elements()) else {
        return Value::Top;
    };
    if words.len() * parts.len() > crate::value::SET_SIZE {
        return Value::Top;
    }
    let kept = !(mask << shift);
    let pairs = words
        .iter()
        .flat_map(|word| parts.iter().map(move |p| word & kept | (p & mask) << shift));
    Value::of_elements(pairs.collect()).unwrap_or(Value::Top)
}

const fn mask_of(size: u32) -> u32 {
    match size {
        1 => 0xFF,
        2 => 0xFFFF,
        _ => u32::MAX,
    }
}

impl Contents {
    /// Memory as an image leaves it.
    pub fn of_image(image: &Image) -> Self {
        let mut contents = Self::default();
        for (start, bytes) in image.contents() {
            for (offset, byte) in bytes.iter().enumerate() {
                let place = Value::Constant(start.wrapping_add(offset as u32));
                contents.store(&place, 1, &Value::Constant(u32::from(*byte)));
            }
        }
        contents.initial = std::mem::take(&mut contents.pages);
        contents
    }

    fn fresh_page(&self, number: u32) -> Page {
        let initial = self.initial.get(&number).filter(|_| !self.lost);
        let empty = if self.lost {
            Value::Top
        } else {
            Value::Constant(0)
        };
        initial.map_or_else(
            || Rc::new(std::array::from_fn(|_| empty.clone())),
            Rc::clone,
        )
    }

    fn word(&self, address: u32) -> Value {
        let number = address / PAGE_BYTES;
        let initial = || self.initial.get(&number).filter(|_| !self.lost);
        match self.pages.get(&number).or_else(initial) {
            Some(page) => page[(address % PAGE_BYTES / 4) as usize].clone(),
            None if self.lost => Value::Top,
            None => Value::Constant(0),
        }
    }

    fn set_word(&mut self, address: u32, value: Value) {
        let number = address / PAGE_BYTES;
        if !self.pages.contains_key(&number) {
            let page = self.fresh_page(number);
            Rc::make_mut(&mut self.pages).insert(number, page);
        }
        if let Some(page) = Rc::make_mut(&mut self.pages).get_mut(&number) {
            Rc::make_mut(page)[(address % PAGE_BYTES / 4) as usize] = value;
        }
    }

    /// What `size` bytes at an address hold, without sign; `None` when the address is not known.
    pub fn load(&self, address: &Value, size: u32) -> Option<Value> {
        let at = |address: u32| {
            let word = self.word(address);
            part(&word, 8 * (address & 3), mask_of(size))
        };
        if let Value::Constant(address) = address {
            return (address % size == 0).then(|| at(*address));
        }
        let places = address.elements()?;
        if places.iter().any(|place| place % size != 0) {
            return None;
        }
        let mut elements = Vec::new();
        for place in &places {
            match at(*place) {
                Value::Constant(value) => elements.push(value),
                other => elements.extend(other.elements()?),
            }
        }
        let (low, high) = (
            elements.iter().min().copied(),
            elements.iter().max().copied(),
        );
        Value::of_elements(elements).or_else(|| Some(Value::range(low?, high?)))
    }

    /// A store of `size` bytes.
    pub fn store(&mut self, address: &Value, size: u32, value: &Value) {
        if let Value::Constant(address) = address {
            let word = self.word(*address);
            let new = replaced(&word, 8 * (address & 3), mask_of(size), value);
            return self.set_word(*address, new);
        }
        match (address.elements(), address.bounds()) {
            (Some(places), _) => {
                for place in places {
                    let word = self.word(place);
                    let new = replaced(&word, 8 * (place & 3), mask_of(size), value);
                    self.set_word(place, word.join(&new));
                }
            }
            (None, Some((low, high))) if high - low <= PLACES => {
                for place in (low & !3..=high).step_by(4) {
                    self.set_word(place, Value::Top);
                }
            }
            _ => self.forget(),
        }
    }

    /// Nothing is known any more.
    pub fn forget(&mut self) {
        self.pages = Rc::default();
        self.lost = true;
    }

    /// What `join` makes of both, word by word.
    pub fn combine(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Self {
        if Rc::ptr_eq(&self.pages, &other.pages) && self.lost == other.lost {
            return self.clone();
        }
        let lost = self.lost || other.lost;
        let mut pages = BTreeMap::new();
        let numbers: BTreeSet<u32> = self
            .pages
            .keys()
            .chain(other.pages.keys())
            .copied()
            .collect();
        for number in numbers {
            let page = |one: &Self| match one.pages.get(&number) {
                Some(page) => Rc::clone(page),
                None => one.fresh_page(number),
            };
            let (mine, theirs) = (page(self), page(other));
            let both = if mine == theirs {
                mine
            } else {
                Rc::new(std::array::from_fn(|n| joined(&mine[n], &theirs[n], &join)))
            };
            pages.insert(number, both);
        }
        Self {
            initial: Rc::clone(&self.initial),
            pages: Rc::new(pages),
            lost,
        }
    }
}

fn joined(a: &Value, b: &Value, join: &impl Fn(&Value, &Value) -> Value) -> Value {
    if a == b {
        a.clone()
    } else {
        join(a, b)
    }
}
