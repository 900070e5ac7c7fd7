// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bus cycles of an instruction, stated without running it (DDI 0029E, chapter 10). The core makes
//! these cycles one by one; tests hold both to each other for every format.

use crate::instruction::{
    BlockTransfer, DataProcessing, Instruction, Multiply, MultiplyKind, Operand, Operation,
};
use crate::timing::TimingProfile;

/// Data cycles of one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DataCycles {
    /// N-cycles.
    pub nonsequential: u32,
    /// S-cycles.
    pub sequential: u32,
}

impl DataCycles {
    const NONE: Self = Self {
        nonsequential: 0,
        sequential: 0,
    };
    const ONE: Self = Self {
        nonsequential: 1,
        sequential: 0,
    };

    const fn block(count: u32) -> Self {
        Self {
            nonsequential: 1,
            sequential: count - 1,
        }
    }

    /// All accesses.
    pub const fn count(self) -> u32 {
        self.nonsequential + self.sequential
    }
}

/// Cycles of one instruction after the fetch it starts with: that fetch is of the opcode two
/// ahead, an S-cycle unless the instruction before it stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusCycles {
    /// Times the pipeline is filled: an N-cycle fetch at the target and an S-cycle one after it.
    pub refills: u32,
    /// Data reads.
    pub reads: DataCycles,
    /// Data writes.
    pub writes: DataCycles,
    /// Fewest internal cycles.
    pub internal_min: u32,
    /// Most internal cycles; differs from the fewest only for multiplications.
    pub internal_max: u32,
    /// The fetch of the next instruction is an N-cycle.
    pub next_fetch_nonsequential: bool,
}

impl BusCycles {
    /// An instruction whose condition failed.
    pub const SKIPPED: Self = Self {
        refills: 0,
        reads: DataCycles::NONE,
        writes: DataCycles::NONE,
        internal_min: 0,
        internal_max: 0,
        next_fetch_nonsequential: false,
    };

    const fn new(refills: u32, internal: u32) -> Self {
        Self {
            refills,
            internal_min: internal,
            internal_max: internal,
            ..Self::SKIPPED
        }
    }

    const fn load(reads: DataCycles, loads_pc: bool) -> Self {
        Self {
            reads,
            ..Self::new(loads_pc as u32, 1)
        }
    }

    const fn store(writes: DataCycles) -> Self {
        Self {
            writes,
            next_fetch_nonsequential: true,
            ..Self::SKIPPED
        }
    }
}

impl MultiplyKind {
    /// Internal cycles with this value in the multiplier register: the array's, one more for a
    /// long product, one more to accumulate.
    #[inline(always)]
    pub const fn internal_cycles(self, multiplier: u32) -> u32 {
        let array = if self.signed {
            signed_cycles(multiplier)
        } else {
            unsigned_cycles(multiplier)
        };
        array + self.long as u32 + self.accumulate as u32
    }
}

/// Cycles of the multiplier array, which takes 8 bits per cycle, when leading ones end it early as
/// leading zeros do.
#[inline]
pub(crate) const fn signed_cycles(multiplier: u32) -> u32 {
    let leading = if multiplier >> 31 == 0 {
        multiplier
    } else {
        !multiplier
    };
    unsigned_cycles(leading)
}

/// Cycles of the array when only leading zeros end it early.
#[inline]
pub(crate) const fn unsigned_cycles(multiplier: u32) -> u32 {
    match multiplier {
        0..=0xFF => 1,
        0x100..=0xFFFF => 2,
        0x1_0000..=0xFF_FFFF => 3,
        _ => 4,
    }
}

impl Instruction {
    /// Cycles of the instruction when its condition passes, for accesses that are not aborted.
    pub const fn cycles(&self, profile: TimingProfile) -> BusCycles {
        match &self.operation {
            Operation::DataProcessing(processing) => data_processing(processing),
            Operation::Multiply(product) => multiply(product),
            Operation::Transfer(transfer) if transfer.load => {
                BusCycles::load(DataCycles::ONE, transfer.register == 15)
            }
            Operation::Transfer(_) => BusCycles::store(DataCycles::ONE),
            Operation::Swap { destination, .. } => BusCycles {
                writes: DataCycles::ONE,
                ..BusCycles::load(DataCycles::ONE, *destination == 15)
            },
            Operation::BlockTransfer(block) => block_transfer(block),
            Operation::ReadStatus { destination, .. } => {
                BusCycles::new((*destination == 15) as u32, 0)
            }
            Operation::LoadAddress { .. }
            | Operation::LongBranchPrefix { .. }
            | Operation::WriteStatus { .. } => BusCycles::SKIPPED,
            Operation::Branch { .. }
            | Operation::BranchExchange { .. }
            | Operation::LongBranchSuffix { .. }
            | Operation::SoftwareInterrupt => BusCycles::new(1, 0),
            Operation::Undefined => BusCycles::new(1, profile.undefined_internal_cycles),
        }
    }
}

const fn data_processing(processing: &DataProcessing) -> BusCycles {
    let shift = matches!(processing.second, Operand::ShiftedByRegister { .. }) as u32;
    let branches = processing.destination == 15 && !processing.operation.compares();
    BusCycles::new(branches as u32, shift)
}

const fn multiply(product: &Multiply) -> BusCycles {
    let low = matches!(product.low, Some(15)) as u32;
    BusCycles {
        refills: (product.destination == 15) as u32 + low,
        internal_min: product.kind.internal_cycles(0),
        internal_max: product.kind.internal_cycles(0x5555_5555),
        ..BusCycles::SKIPPED
    }
}

const fn block_transfer(block: &BlockTransfer) -> BusCycles {
    let data = DataCycles::block(block.list.count_ones());
    if block.load {
        BusCycles::load(data, block.list >> 15 & 1 != 0)
    } else {
        BusCycles::store(data)
    }
}
