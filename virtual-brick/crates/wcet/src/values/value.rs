// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is known about a 32-bit value: constants, small sets, unsigned ranges, places.

use std::rc::Rc;

/// Stands for the address of the running thread in [`Value::Based`].
pub const RUNNING: u32 = 16;

/// Largest set that is kept element by element.
pub const SET_SIZE: usize = 256;

/// Most bytes between the addresses that a place in the stack may be.
const STACK_SPAN: i32 = 64;

/// Knowledge about one register or stack word.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Value {
    /// Exactly this.
    Constant(u32),
    /// One of these, ascending, at least two.
    Set(Rc<[u32]>),
    /// From the first to the second, unsigned.
    Range(u32, u32),
    /// From the first, which is negative, to the second, which is not.
    Signed(i32, i32),
    /// Ones are only where the first has some, and at most as many as the second.
    Bits(u32, u32),
    /// An address derived from one in the region with this index.
    Region(u8),
    /// The stack pointer at the function's entry plus this.
    Stack(i32),
    /// This minus the stack pointer at the function's entry.
    MinusStack(i32),
    /// The stack pointer at the function's entry plus something from the first to the second.
    StackBetween(i32, i32),
    /// An address in the function's own frame.
    StackAny,
    /// An address in the stack outside the function's frame.
    OuterStack,
    /// Something unknown plus a constant. Below 16: what that register held at the function's
    /// entry, 14 the return address; [`RUNNING`]: the running thread; otherwise what the
    /// instruction at that address last produced.
    Based(u32, i32),
    /// Anything.
    Top,
}

impl Value {
    /// From any list of elements; `None` when there are none or too many.
    pub fn of_elements(mut elements: Vec<u32>) -> Option<Self> {
        elements.sort_unstable();
        elements.dedup();
        match elements.len() {
            0 => None,
            1 => Some(Self::Constant(elements[0])),
            2..=SET_SIZE => Some(Self::Set(elements.into())),
            _ => None,
        }
    }

    /// The least value above all of a list; `None` when it is empty.
    pub fn of_constants(elements: Vec<u32>) -> Option<Self> {
        let (low, high) = (*elements.iter().min()?, *elements.iter().max()?);
        Self::of_elements(elements).or_else(|| Some(Self::range(low, high)))
    }

    /// The elements, if they are few.
    pub fn elements(&self) -> Option<Vec<u32>> {
        match self {
            Self::Constant(value) => Some(vec![*value]),
            Self::Set(set) => Some(set.to_vec()),
            Self::Range(low, high) if (high - low) < SET_SIZE as u32 => {
                Some((*low..=*high).collect())
            }
            Self::Signed(low, high) if high.wrapping_sub(*low) < SET_SIZE as i32 => {
                // A distance below zero is one of more than 2^31.
                let few = high.wrapping_sub(*low) >= 0;
                few.then(|| (*low..=*high).map(|e| e as u32).collect())
            }
            Self::Bits(mask, 1) => {
                let single = (0..32).map(|bit| 1 << bit & mask);
                Some(Self::of_elements(single.chain([0]).collect())?.elements()?)
            }
            _ => None,
        }
    }

    /// The constant, if it is one.
    pub fn constant(&self) -> Option<u32> {
        match self {
            Self::Constant(value) => Some(*value),
            _ => None,
        }
    }

    /// Lowest and highest unsigned value; places are not numbers.
    pub fn bounds(&self) -> Option<(u32, u32)> {
        match self {
            Self::Constant(value) => Some((*value, *value)),
            Self::Set(set) => Some((*set.first()?, *set.last()?)),
            Self::Range(low, high) => Some((*low, *high)),
            Self::Signed(..) => Some((0, u32::MAX)),
            Self::Bits(mask, _) => Some((0, *mask)),
            _ => None,
        }
    }

    /// Bounds, the full range for what is unknown.
    pub fn unsigned(&self) -> (u32, u32) {
        self.bounds().unwrap_or((0, u32::MAX))
    }

    /// Signed bounds.
    pub fn signed(&self) -> (i32, i32) {
        if let Self::Signed(low, high) = self {
            return (*low, *high);
        }
        if let Self::Set(set) = self {
            let signed = set.iter().map(|element| *element as i32);
            let least = signed.clone().min().unwrap_or(i32::MIN);
            return (least, signed.max().unwrap_or(i32::MAX));
        }
        match self.bounds() {
            Some((low, high)) if low >> 31 == high >> 31 => (low as i32, high as i32),
            _ => (i32::MIN, i32::MAX),
        }
    }

    /// What a register held at the function's entry.
    pub const fn entry(register: u32) -> Self {
        Self::Based(register, 0)
    }

    /// A callee-saved register's or the return address's value at the function's entry.
    pub const fn is_saved(&self) -> bool {
        matches!(self, Self::Based(4..=14, 0))
    }

    /// Neither a number nor a place in a region or the stack.
    pub const fn is_unknown(&self) -> bool {
        matches!(self, Self::Top | Self::Based(..))
    }

    /// An address in the stack, own or outer.
    pub fn in_stack(&self) -> bool {
        matches!(
            self,
            Self::Stack(_) | Self::StackBetween(..) | Self::StackAny | Self::OuterStack
        )
    }

    /// Least and greatest offset from the stack pointer at the function's entry, if it is known to
    /// be an address in the stack.
    pub const fn stack_offsets(&self) -> Option<(i32, i32)> {
        match self {
            Self::Stack(offset) => Some((*offset, *offset)),
            Self::StackBetween(low, high) => Some((*low, *high)),
            _ => None,
        }
    }

    /// An address in the stack, between two offsets if these are near each other.
    pub fn stack_between(low: i32, high: i32) -> Self {
        match high.checked_sub(low) {
            Some(0) => Self::Stack(low),
            Some(1..=STACK_SPAN) => Self::StackBetween(low, high),
            _ => Self::StackAny,
        }
    }

    /// A range, or what it shrinks to; the whole range is `Top`.
    pub fn range(low: u32, high: u32) -> Self {
        if low == high {
            Self::Constant(low)
        } else if low == 0 && high == u32::MAX {
            Self::Top
        } else {
            Self::Range(low, high)
        }
    }

    /// Values that are in both, where `self` holds and the unsigned bounds hold too.
    /// `None` when there is no such value.
    pub fn within(&self, low: u32, high: u32) -> Option<Self> {
        if low > high {
            return None;
        }
        match self {
            Self::Constant(value) => (low..=high).contains(value).then(|| self.clone()),
            Self::Set(set) => {
                let kept = set.iter().copied().filter(|e| (low..=high).contains(e));
                Self::of_elements(kept.collect())
            }
            Self::Range(a, b) => {
                let (low, high) = (low.max(*a), high.min(*b));
                (low <= high).then(|| Self::range(low, high))
            }
            Self::Signed(_, most) if high >> 31 == 0 => {
                let high = high.min(*most as u32);
                (low <= high).then(|| Self::range(low, high))
            }
            Self::Signed(least, _) if low >> 31 != 0 => {
                let low = low.max(*least as u32);
                (low <= high).then(|| Self::range(low, high))
            }
            Self::Top => Some(Self::range(low, high)),
            other => Some(other.clone()),
        }
    }

    /// Values that are in both, where `self` holds and the signed bounds hold too.
    /// `None` when there is no such value.
    pub fn within_signed(&self, low: i32, high: i32) -> Option<Self> {
        if low > high {
            return None;
        }
        if low >> 31 == high >> 31 {
            return self.within(low as u32, high as u32);
        }
        let kept = |element: &u32| (low..=high).contains(&(*element as i32));
        match self {
            Self::Constant(value) => kept(value).then(|| self.clone()),
            Self::Set(set) => Self::of_elements(set.iter().copied().filter(kept).collect()),
            Self::Signed(a, b) => Some(Self::Signed(low.max(*a), high.min(*b))),
            Self::Range(a, b) if a >> 31 == b >> 31 => {
                let (a, b) = (low.max(*a as i32), high.min(*b as i32));
                (a <= b).then(|| Self::range(a as u32, b as u32))
            }
            Self::Top if (low, high) != (i32::MIN, i32::MAX) => Some(Self::Signed(low, high)),
            other => Some(other.clone()),
        }
    }

    /// Numbers that are in both; `None` when there are none.
    pub fn meet(&self, other: &Self) -> Option<Self> {
        if let (Some(mine), Some(theirs)) = (self.elements(), other.elements()) {
            let both = mine.into_iter().filter(|e| theirs.contains(e));
            return Self::of_elements(both.collect());
        }
        if let Self::Signed(low, high) = other {
            return self.within_signed(*low, *high);
        }
        let (low, high) = other.unsigned();
        self.within(low, high)
    }

    /// Least value above both.
    pub fn join(&self, other: &Self) -> Self {
        if self == other {
            return self.clone();
        }
        if let (Some(mut all), Some(more)) = (self.elements(), other.elements()) {
            all.extend(more);
            if let Some(value) = Self::of_elements(all) {
                return value;
            }
        }
        if let (Self::Bits(..), _) | (_, Self::Bits(..)) = (self, other) {
            let mask = self.possible_ones() | other.possible_ones();
            return Self::bits(mask, self.most_ones().max(other.most_ones()));
        }
        if let (Some((a, b)), Some((c, d))) = (self.bounds(), other.bounds()) {
            let unsigned = (a.min(c), b.max(d));
            let ((a, b), (c, d)) = (self.signed(), other.signed());
            let (low, high) = (a.min(c), b.max(d));
            return if high.abs_diff(low) < unsigned.1 - unsigned.0 {
                Self::of_interval(i128::from(low), i128::from(high))
            } else {
                Self::range(unsigned.0, unsigned.1)
            };
        }
        match (self.stack_offsets(), other.stack_offsets()) {
            (Some((a, b)), Some((c, d))) => Self::stack_between(a.min(c), b.max(d)),
            (Some(_), None) if *other == Self::StackAny => Self::StackAny,
            (None, Some(_)) if *self == Self::StackAny => Self::StackAny,
            _ => Self::Top,
        }
    }

    /// Is everything `self` allows allowed by `other`?
    pub fn below(&self, other: &Self) -> bool {
        if self == other || *other == Self::Top {
            return true;
        }
        match (self, other) {
            (Self::Stack(_) | Self::StackBetween(..), Self::StackAny) => true,
            (place, Self::StackBetween(low, high)) => place
                .stack_offsets()
                .is_some_and(|(a, b)| *low <= a && b <= *high),
            (_, Self::Set(_)) => self
                .elements()
                .zip(other.elements())
                .is_some_and(|(mine, theirs)| mine.iter().all(|e| theirs.binary_search(e).is_ok())),
            (_, Self::Signed(low, high)) => {
                let (a, b) = self.signed();
                self.bounds().is_some() && *low <= a && b <= *high
            }
            (_, Self::Bits(mask, most)) => {
                self.possible_ones() & !mask == 0 && self.most_ones() <= *most
            }
            (_, Self::Range(low, high)) => {
                self.bounds().is_some_and(|(a, b)| *low <= a && b <= *high)
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_constants_stay_a_set_until_they_are_many() {
        let few = Value::Constant(4).join(&Value::Constant(9));
        assert_eq!(few, Value::Set(vec![4, 9].into()));
        assert_eq!(few.join(&Value::Range(0, 1000)), Value::Range(0, 1000));
    }

    #[test]
    fn near_places_in_the_stack_stay_known_and_far_ones_are_anywhere_in_it() {
        let near = Value::Stack(-8).join(&Value::Stack(-4));
        assert_eq!(near, Value::StackBetween(-8, -4));
        assert_eq!(near.join(&Value::Stack(0)), Value::StackBetween(-8, 0));
        assert_eq!(near.join(&Value::Stack(400)), Value::StackAny);
        assert_eq!(near.join(&Value::StackAny), Value::StackAny);
        assert_eq!(near.join(&Value::Constant(4)), Value::Top);
        assert!(Value::Stack(-4).below(&near) && near.below(&Value::StackAny));
        assert!(!Value::Stack(0).below(&near) && !near.below(&Value::Stack(-4)));
    }

    #[test]
    fn a_bound_cuts_sets_and_ranges_and_empties_them() {
        let set = Value::Set(vec![1, 5, 9].into());
        assert_eq!(set.within(2, 8), Some(Value::Constant(5)));
        assert_eq!(set.within(10, 20), None);
        assert_eq!(Value::Top.within(0, 7), Some(Value::Range(0, 7)));
    }
}
