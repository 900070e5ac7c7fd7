// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Accesses of one block around the same base: one comparison with RAM is enough for all.

use arm7tdmi::bus::Width;
use arm7tdmi::instruction::{Operand, Operation, Transfer};
use arm7tdmi::RegionInstruction;

/// At most so many bytes are compared at once.
const BYTES_MAX: i32 = 0x1000;

/// Bytes around a base that are accessed before it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AccessRange {
    /// Distance of the first byte from the base, and of the end.
    pub first: i32,
    pub end: i32,
    /// Bits that are zero in the address of the first byte.
    pub alignment: u32,
}

pub(crate) const fn alignment(width: Width) -> u32 {
    match width {
        Width::Byte => 0,
        Width::Halfword => 1,
        Width::Word => 3,
    }
}

/// Distance from the base of an access that leaves it as it is.
pub(crate) const fn distance(transfer: &Transfer) -> Option<i32> {
    match transfer.offset {
        Operand::Constant { value, .. } if !transfer.moves_base() && transfer.base != 15 => {
            let distance = value as i32;
            Some(if transfer.add { distance } else { -distance })
        }
        _ => None,
    }
}

impl AccessRange {
    /// The range of one access.
    pub const fn of(distance: i32, width: Width) -> Self {
        let alignment = alignment(width);
        Self {
            first: distance,
            end: distance + alignment as i32 + 1,
            alignment,
        }
    }

    /// Is the other within this?
    pub const fn covers(&self, other: &Self) -> bool {
        other.first >= self.first
            && other.end <= self.end
            && other.alignment <= self.alignment
            && (other.first - self.first) as u32 & other.alignment == 0
    }

    /// Both together; none if they are far apart, or no address suits both.
    fn with(&self, other: &Self) -> Option<Self> {
        let (coarse, fine) = if self.alignment >= other.alignment {
            (self, other)
        } else {
            (other, self)
        };
        if (fine.first - coarse.first) as u32 & fine.alignment != 0 {
            return None;
        }
        let below = (coarse.first - fine.first).max(0) as u32;
        let joined = Self {
            first: coarse.first - (below.wrapping_add(coarse.alignment) & !coarse.alignment) as i32,
            end: self.end.max(other.end),
            alignment: coarse.alignment,
        };
        (joined.end - joined.first <= BYTES_MAX).then_some(joined)
    }
}

/// The range that the first of these instructions, an access, and those behind it access around its
/// base until that changes.
pub(crate) fn range_around_base(instructions: &[RegionInstruction]) -> Option<AccessRange> {
    let base = match &instructions.first()?.instruction.operation {
        Operation::Transfer(transfer) => transfer.base,
        _ => return None,
    };
    let mut all: Option<AccessRange> = None;
    for one in instructions {
        let operation = &one.instruction.operation;
        if let Operation::Transfer(transfer) = operation {
            if let (true, Some(distance)) = (transfer.base == base, distance(transfer)) {
                let own = AccessRange::of(distance, transfer.width);
                all = match all {
                    Some(range) => range.with(&own).or(all),
                    None => Some(own),
                };
            }
        }
        if may_write(operation, base) {
            break;
        }
    }
    all
}

fn may_write(operation: &Operation, register: u32) -> bool {
    match operation {
        Operation::DataProcessing(processing) => {
            processing.destination == register && !processing.operation.compares()
        }
        Operation::Multiply(product) => {
            product.destination == register || product.low == Some(register)
        }
        Operation::Transfer(transfer) => {
            transfer.load && transfer.register == register
                || transfer.moves_base() && transfer.base == register
        }
        Operation::BlockTransfer(block) => {
            block.load && block.list >> register & 1 != 0
                || block.write_back && block.base == register
        }
        Operation::LoadAddress { destination, .. } => *destination == register,
        Operation::Branch { link, .. } => *link,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accesses_around_one_base_are_taken_together() {
        let word = AccessRange::of(8, Width::Word);
        let byte = AccessRange::of(3, Width::Byte);
        let joined = AccessRange {
            first: 0,
            end: 12,
            alignment: 3,
        };
        assert_eq!(word.with(&byte), Some(joined));
        assert_eq!(byte.with(&word), Some(joined));
        assert!(joined.covers(&word) && joined.covers(&byte));
        assert!(!byte.covers(&word));
    }

    #[test]
    fn accesses_that_cannot_be_aligned_together_stay_apart() {
        let word = AccessRange::of(8, Width::Word);
        assert_eq!(word.with(&AccessRange::of(2, Width::Word)), None);
        assert_eq!(word.with(&AccessRange::of(0x2000, Width::Word)), None);
    }
}
