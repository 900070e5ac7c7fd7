// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The comparison that set the flags, and the order of its operands that flags tell.

use crate::values::value::Value;

/// Two operands whose difference set the flags, and the registers that still hold them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The minuend.
    pub left: (Option<u32>, Value),
    /// The subtrahend.
    pub right: (Option<u32>, Value),
    /// The register that holds the difference.
    pub result: Option<u32>,
    /// A register that holds the minuend plus a distance.
    pub moved: Option<(u32, u32)>,
}

/// What flags say about the operands of the comparison that set them.
pub struct Order {
    at_least: bool,
    at_most: bool,
    different: bool,
}

impl Order {
    fn new(flags: u16, at_least: impl Fn(u16) -> bool) -> Self {
        let all = |test: &dyn Fn(u16) -> bool| (0..16).all(|f| flags >> f & 1 == 0 || test(f));
        Self {
            at_least: all(&at_least),
            at_most: all(&|f| !at_least(f) || f & 4 != 0),
            different: all(&|f| f & 4 == 0),
        }
    }

    pub fn unsigned(flags: u16) -> Self {
        Self::new(flags, |f| f & 2 != 0)
    }

    pub fn signed(flags: u16) -> Self {
        Self::new(flags, |f| (f >> 3 ^ f) & 1 == 0)
    }

    /// Bounds of both sides narrowed by the order. `None` when nothing is left.
    pub fn apply<T: Ord + Copy>(
        &self,
        left: (T, T),
        right: (T, T),
        less: impl Fn(T) -> Option<T>,
        more: impl Fn(T) -> Option<T>,
    ) -> Option<((T, T), (T, T))> {
        let (mut a, mut b) = (left, right);
        let strict = self.different;
        if self.at_least {
            a.0 = a.0.max(if strict { more(right.0)? } else { right.0 });
            b.1 = b.1.min(if strict { less(left.1)? } else { left.1 });
        }
        if self.at_most {
            a.1 = a.1.min(if strict { less(right.1)? } else { right.1 });
            b.0 = b.0.max(if strict { more(left.0)? } else { left.0 });
        }
        (a.0 <= a.1 && b.0 <= b.1).then_some((a, b))
    }
}
