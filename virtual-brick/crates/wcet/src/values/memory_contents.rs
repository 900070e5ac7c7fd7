// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What memory holds in a program that nothing else writes to: it begins as the image says, zero
//! elsewhere, and each store is executed. Copies share the pages that are alike. A word of which
//! only some bytes are known is kept as its bytes.

use crate::inputs::image::Image;
use crate::values::value::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

const PAGE_WORDS: usize = 32;
const PAGE_BYTES: u32 = 4 * PAGE_WORDS as u32;

/// Most addresses that one store is applied to.
const MAX_STORE_ADDRESSES: u32 = 4096;

/// Most of them that keep what else may be there.
const MAX_JOINED_ADDRESSES: u32 = 256;

/// Most values of a word that is not split into bytes when a part of it is written.
const MAX_WORD_VALUES: usize = 16;

type Page = Rc<[Value; PAGE_WORDS]>;
type Bytes = [Value; 4];

/// The words of memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    initial: Rc<BTreeMap<u32, Page>>,
    pages: Rc<BTreeMap<u32, Page>>,
    /// Bytes of the words that are not known as a whole.
    parts: Rc<BTreeMap<u32, Bytes>>,
    /// Pages that are not listed are no longer those of the image.
    lost: bool,
}

/// A part of a word: bits of it from `shift` on.
fn part(word: &Value, shift: u32, mask: u32) -> Value {
    if mask == u32::MAX {
        return word.clone();
    }
    if let Value::Constant(word) = word {
        return Value::Constant(word >> shift & mask);
    }
    let parts = word
        .elements()
        .map(|elements| elements.iter().map(|e| e >> shift & mask).collect());
    parts
        .and_then(Value::of_elements)
        .unwrap_or(Value::Range(0, mask))
}

/// A word with a part replaced, if it stays one of few.
fn replaced(word: &Value, shift: u32, mask: u32, value: &Value) -> Option<Value> {
    let kept = !(mask << shift);
    if let (Value::Constant(word), Value::Constant(value)) = (word, value) {
        return Some(Value::Constant(word & kept | (value & mask) << shift));
    }
    let (words, parts) = (word.elements()?, value.elements()?);
    if words.len() * parts.len() > MAX_WORD_VALUES {
        return None;
    }
    let pairs = words
        .iter()
        .flat_map(|word| parts.iter().map(move |p| word & kept | (p & mask) << shift));
    Value::of_elements(pairs.collect())
}

/// Only numbers mean the same wherever they are read.
fn number(value: &Value) -> Value {
    value.bounds().map_or(Value::Top, |_| value.clone())
}

/// Parts of a number, least significant first, each of `8 * step` bits, store_at together.
fn assembled(parts: &[Value], step: u32) -> Value {
    let (mut low, mut high) = (0, 0);
    for (part, shift) in parts.iter().zip((0..).step_by(8 * step as usize)) {
        let most = if step == 1 { 0xFF } else { 0xFFFF };
        let (least, greatest) = part.bounds().unwrap_or((0, most));
        low |= least << shift;
        high |= greatest.min(most) << shift;
    }
    Value::range(low, high)
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
        if !self.parts.is_empty() && self.parts.contains_key(&(address & !3)) {
            Rc::make_mut(&mut self.parts).remove(&(address & !3));
        }
        let number = address / PAGE_BYTES;
        if !self.pages.contains_key(&number) {
            let page = self.fresh_page(number);
            Rc::make_mut(&mut self.pages).insert(number, page);
        }
        if let Some(page) = Rc::make_mut(&mut self.pages).get_mut(&number) {
            Rc::make_mut(page)[(address % PAGE_BYTES / 4) as usize] = value;
        }
    }

    fn bytes(&self, address: u32) -> Bytes {
        if let Some(bytes) = self.parts.get(&(address & !3)) {
            return bytes.clone();
        }
        let word = self.word(address);
        std::array::from_fn(|index| part(&word, 8 * index as u32, 0xFF))
    }

    fn set_bytes(&mut self, address: u32, bytes: Bytes) {
        let whole = assembled(&bytes, 1);
        let known = bytes.iter().any(|byte| *byte != Value::Range(0, 0xFF));
        if whole.constant().is_some() || !known {
            return self.set_word(address, whole);
        }
        self.set_word(address, Value::Top);
        Rc::make_mut(&mut self.parts).insert(address & !3, bytes);
    }

    /// What `size` bytes at a constant address hold.
    fn at(&self, address: u32, size: u32) -> Value {
        let word = self.word(address);
        if word == Value::Top && !self.parts.is_empty() {
            let first = (address & 3 & !(size - 1)) as usize;
            let bytes = &self.bytes(address)[first..first + size as usize];
            return match bytes {
                [byte] => byte.clone(),
                bytes => assembled(bytes, 1),
            };
        }
        part(&word, 8 * (address & 3), mask_of(size))
    }

    /// What `size` bytes at an address hold, without sign; `None` when the address is not known.
    pub fn load(&self, address: &Value, size: u32) -> Option<Value> {
        if let Value::Constant(address) = address {
            return (address % size == 0).then(|| self.at(*address, size));
        }
        let places = address.elements()?;
        if places.iter().any(|place| place % size != 0) {
            return None;
        }
        let mut constants = Vec::with_capacity(places.len());
        let mut others: Option<Value> = None;
        for place in places {
            match self.at(place, size) {
                Value::Top => return None,
                Value::Constant(value) => constants.push(value),
                value => others = Some(others.map_or(value.clone(), |known| known.join(&value))),
            }
        }
        let joined = match (Value::of_constants(constants), others) {
            (Some(constants), Some(others)) => constants.join(&others),
            (constants, others) => constants.or(others)?,
        };
        (joined != Value::Top).then_some(joined)
    }

    /// A store of `size` bytes.
    pub fn store(&mut self, address: &Value, size: u32, value: &Value) {
        let value = &number(value);
        if let Value::Constant(address) = address {
            return self.store_at(*address, size, value, false);
        }
        match (address.elements(), address.bounds()) {
            (Some(places), _) => {
                for place in places {
                    self.store_at(place, size, value, true);
                }
            }
            (None, Some((low, high))) if high - low <= MAX_STORE_ADDRESSES => {
                let few = (high - low) / size <= MAX_JOINED_ADDRESSES;
                for place in (low & !(size - 1)..=high).step_by(size as usize) {
                    let value = if few { value } else { &Value::Top };
                    self.store_at(place, size, value, few);
                }
            }
            _ => self.invalidate(),
        }
    }

    /// A store at a constant address; with `weak`, what was there may also stay.
    fn store_at(&mut self, address: u32, size: u32, value: &Value, weak: bool) {
        let word = self.word(address);
        let (shift, mask) = (8 * (address & 3 & !(size - 1)), mask_of(size));
        let whole = if size == 4 {
            Some(value.clone())
        } else {
            replaced(&word, shift, mask, value)
        };
        match whole {
            Some(new) if !weak => self.set_word(address, new),
            Some(new) if word != Value::Top => self.set_word(address, word.join(&new)),
            _ => {
                let mut bytes = self.bytes(address);
                for (index, byte) in bytes.iter_mut().enumerate() {
                    let place = (index as u32).wrapping_sub(shift / 8);
                    if place >= size {
                        continue;
                    }
                    let new = part(value, 8 * place, 0xFF);
                    *byte = if weak { byte.join(&new) } else { new };
                }
                self.set_bytes(address, bytes);
            }
        }
    }

    /// Nothing is known any more.
    pub fn invalidate(&mut self) {
        self.pages = Rc::default();
        self.parts = Rc::default();
        self.lost = true;
    }

    /// What `join` makes of both, word by word.
    pub fn combine(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Self {
        let alike = Rc::ptr_eq(&self.pages, &other.pages) && Rc::ptr_eq(&self.parts, &other.parts);
        if alike && self.lost == other.lost {
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
        let mut both = Self {
            initial: Rc::clone(&self.initial),
            pages: Rc::new(pages),
            parts: Rc::default(),
            lost,
        };
        let places = self.parts.keys().chain(other.parts.keys());
        for place in places.copied().collect::<BTreeSet<u32>>() {
            let (mine, theirs) = (self.bytes(place), other.bytes(place));
            let bytes = std::array::from_fn(|n| match joined(&mine[n], &theirs[n], &join) {
                Value::Top => Value::Range(0, 0xFF),
                byte => byte,
            });
            both.set_bytes(place, bytes);
        }
        both
    }
}

fn joined(a: &Value, b: &Value, join: &impl Fn(&Value, &Value) -> Value) -> Value {
    if a == b {
        a.clone()
    } else {
        join(a, b)
    }
}
