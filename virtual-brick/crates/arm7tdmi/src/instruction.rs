// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Decoded instructions for programs that look at code without running it.
//!
//! Built on the same formats as the core's handlers. A Thumb instruction decodes to the operation
//! of its ARM equivalent (DDI 0029E, chapter 5). Costs are in [`crate::cost`].

use crate::bus::Width;

/// Condition code that always passes.
pub const ALWAYS: u32 = 14;

/// One instruction with its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Condition code, 0 to 15; [`ALWAYS`] in Thumb state except for the conditional branch.
    pub condition: u32,
    /// Size in bytes: 4 in ARM state, 2 in Thumb state.
    pub size: u32,
    /// What it does when the condition passes.
    pub operation: Operation,
}

/// What an instruction does. Registers are numbers from 0 to 15.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Arithmetic, logic, moves and comparisons.
    DataProcessing(DataProcessing),
    /// Thumb: r15 as a word address plus a constant.
    LoadAddress {
        /// Register written.
        destination: u32,
        /// Added to the word address.
        offset: u32,
    },
    /// All multiplications.
    Multiply(Multiply),
    /// Load or store of one item.
    Transfer(Transfer),
    /// SWP, SWPB.
    Swap {
        /// Byte instead of word.
        byte: bool,
        /// Register loaded.
        destination: u32,
        /// Register stored.
        source: u32,
        /// Register with the address.
        base: u32,
    },
    /// Load or store of several words.
    BlockTransfer(BlockTransfer),
    /// Branch to r15 + offset.
    Branch {
        /// Relative to r15 as the instruction reads it.
        offset: u32,
        /// Stores the return address in r14.
        link: bool,
    },
    /// BX.
    BranchExchange {
        /// Register with the target and, in bit 0, the state.
        register: u32,
    },
    /// First half of the Thumb BL: r14 := r15 + offset.
    LongBranchPrefix {
        /// Relative to r15 as the instruction reads it.
        offset: u32,
    },
    /// Second half of the Thumb BL: to r14 + offset, with the return address in r14.
    LongBranchSuffix {
        /// Relative to r14.
        offset: u32,
    },
    /// MRS.
    ReadStatus {
        /// Register written.
        destination: u32,
        /// The saved status, not the current one.
        saved: bool,
    },
    /// MSR.
    WriteStatus {
        /// The saved status, not the current one.
        saved: bool,
        /// Bits 7 to 0 are written.
        control: bool,
        /// Bits 31 to 28 are written.
        flags: bool,
        /// What is written.
        operand: Operand,
    },
    /// SWI.
    SoftwareInterrupt,
    /// No meaning, or for a coprocessor.
    Undefined,
}

impl Operation {
    /// Writes memory with a store.
    pub const fn stores(&self) -> bool {
        match self {
            Self::Transfer(transfer) => !transfer.load,
            Self::BlockTransfer(block) => !block.load,
            _ => false,
        }
    }
}

/// The sixteen operations of the data processing format, in the order of their codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum AluOperation {
    And,
    Eor,
    Sub,
    Rsb,
    Add,
    Adc,
    Sbc,
    Rsc,
    Tst,
    Teq,
    Cmp,
    Cmn,
    Orr,
    Mov,
    Bic,
    Mvn,
}

impl AluOperation {
    /// All, by code.
    pub const ALL: [Self; 16] = [
        Self::And,
        Self::Eor,
        Self::Sub,
        Self::Rsb,
        Self::Add,
        Self::Adc,
        Self::Sbc,
        Self::Rsc,
        Self::Tst,
        Self::Teq,
        Self::Cmp,
        Self::Cmn,
        Self::Orr,
        Self::Mov,
        Self::Bic,
        Self::Mvn,
    ];

    /// Only sets flags.
    pub const fn compares(self) -> bool {
        matches!(self, Self::Tst | Self::Teq | Self::Cmp | Self::Cmn)
    }

    /// Has a second operand only.
    pub const fn moves(self) -> bool {
        matches!(self, Self::Mov | Self::Mvn)
    }
}

/// An operation of the arithmetic unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataProcessing {
    /// Which.
    pub operation: AluOperation,
    /// N, Z, C and V follow the result; with r15 as destination CPSR is restored instead.
    pub sets_flags: bool,
    /// Register written, unless it compares.
    pub destination: u32,
    /// Register of the first operand; not read by moves.
    pub first: u32,
    /// The second operand.
    pub second: Operand,
}

impl DataProcessing {
    /// Is the register an operand?
    pub const fn reads(&self, register: u32) -> bool {
        !self.operation.moves() && self.first == register || self.second.reads(register)
    }

    /// Takes much or who knows how much of a stack at once. The fast engine leaves it to the
    /// reference engine, whose steps can be looked at: a stack can overflow here without a write.
    pub const fn takes_large_frame(&self) -> bool {
        const LARGE_BYTES: u32 = 128;
        let taken = match (self.operation, self.second) {
            (AluOperation::Sub, Operand::Constant { value, .. }) => value >= LARGE_BYTES,
            (AluOperation::Sub | AluOperation::Add, second) => {
                !matches!(second, Operand::Constant { .. })
            }
            _ => false,
        };
        taken && self.destination == 13
    }
}

/// Second operand of an arithmetic operation, or offset of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    /// A constant.
    Constant {
        /// Its value.
        value: u32,
        /// Carry out of its rotation, if it is rotated.
        carry: Option<bool>,
    },
    /// A register shifted by a constant, encoded as in ARM state.
    Shifted {
        /// The register.
        register: u32,
        /// 0 LSL, 1 LSR, 2 ASR, 3 ROR.
        kind: u32,
        /// 0 to 31; 0 stands for LSL #0, LSR #32, ASR #32 and RRX.
        amount: u32,
    },
    /// A register shifted by the low byte of another.
    ShiftedByRegister {
        /// The register.
        register: u32,
        /// 0 LSL, 1 LSR, 2 ASR, 3 ROR.
        kind: u32,
        /// Register whose low byte is the amount.
        amount: u32,
    },
}

impl Operand {
    /// A register as it is.
    pub const fn register(register: u32) -> Self {
        Self::Shifted {
            register,
            kind: 0,
            amount: 0,
        }
    }

    /// A constant that leaves the carry alone.
    pub const fn constant(value: u32) -> Self {
        Self::Constant { value, carry: None }
    }

    /// The register, if it is one without a shift.
    pub const fn plain_register(&self) -> Option<u32> {
        match *self {
            Self::Shifted {
                register,
                kind: 0,
                amount: 0,
            } => Some(register),
            _ => None,
        }
    }

    /// Does it depend on this register?
    pub const fn reads(&self, wanted: u32) -> bool {
        match *self {
            Self::Constant { .. } => false,
            Self::Shifted { register, .. } => register == wanted,
            Self::ShiftedByRegister {
                register, amount, ..
            } => register == wanted || amount == wanted,
        }
    }
}

/// A multiplication.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multiply {
    /// Which, as far as its cycles depend on it.
    pub kind: MultiplyKind,
    /// Register of the result, or of its upper half.
    pub destination: u32,
    /// Register of the lower half of a long result.
    pub low: Option<u32>,
    /// Register of the multiplicand.
    pub multiplicand: u32,
    /// Register of the multiplier (Rs), on which the number of cycles depends.
    pub multiplier: u32,
    /// Register added to a short product.
    pub addend: Option<u32>,
    /// N and Z follow the result.
    pub sets_flags: bool,
}

impl Multiply {
    /// The register of the lower half or of the addend, which one field encodes; else r0.
    pub fn third(&self) -> u32 {
        self.low.or(self.addend).unwrap_or(0)
    }

    /// Does it read or write the register?
    pub fn uses(&self, register: u32) -> bool {
        let used = [
            self.destination,
            self.multiplicand,
            self.multiplier,
            self.third(),
        ];
        used.contains(&register)
    }
}

/// What the cycles of a multiplication depend on besides the multiplier's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MultiplyKind {
    /// 64-bit product.
    pub long: bool,
    /// Leading ones end the multiplication early as leading zeros do: all but UMULL and UMLAL.
    pub signed: bool,
    /// Adds to the destination or to another register.
    pub accumulate: bool,
}

/// Load or store of one item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// Load or store.
    pub load: bool,
    /// Size of the item.
    pub width: Width,
    /// Sign-extended when loaded.
    pub signed: bool,
    /// Register loaded or stored.
    pub register: u32,
    /// Register with the address; r15 counts as a word address.
    pub base: u32,
    /// Distance from the base.
    pub offset: Operand,
    /// The distance is added, otherwise subtracted.
    pub add: bool,
    /// The transfer uses the moved address, otherwise the base itself.
    pub before: bool,
    /// The base register receives the moved address.
    pub write_back: bool,
}

impl Transfer {
    /// Does the base register move? Behind a transfer at the base itself it always does.
    pub const fn moves_base(&self) -> bool {
        self.write_back || !self.before
    }
}

/// Load or store of several words, the lowest register at the lowest address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockTransfer {
    /// Load or store.
    pub load: bool,
    /// Register with the address.
    pub base: u32,
    /// Registers transferred, one bit each; an empty list in the encoding transfers r15.
    pub list: u32,
    /// What the base moves by.
    pub size_bytes: u32,
    /// The address moves before each transfer.
    pub before: bool,
    /// The addresses lie above the base.
    pub up: bool,
    /// The base register receives the moved address.
    pub write_back: bool,
    /// The S bit: user registers, or with r15 loaded the return from an exception.
    pub status: bool,
}

impl Instruction {
    /// Does it write N, Z, C or V when its condition passes?
    pub const fn sets_flags(&self) -> bool {
        match &self.operation {
            Operation::DataProcessing(processing) => processing.sets_flags,
            Operation::Multiply(product) => product.sets_flags,
            Operation::WriteStatus { saved, flags, .. } => *flags && !*saved,
            _ => false,
        }
    }
}
