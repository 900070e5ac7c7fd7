// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flags as far as they are known in a block. They are computed only where they are observed.

use std::mem::offset_of;

use arm7tdmi::GuestState;
use cranelift_codegen::ir::Value;

/// A flag's place in the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    Negative,
    Zero,
    Carry,
    Overflow,
}

impl Field {
    pub const ALL: [Self; 4] = [Self::Negative, Self::Zero, Self::Carry, Self::Overflow];

    pub const fn offset(self) -> i32 {
        let offset = match self {
            Self::Negative => offset_of!(GuestState, negative),
            Self::Zero => offset_of!(GuestState, zero),
            Self::Carry => offset_of!(GuestState, carry),
            Self::Overflow => offset_of!(GuestState, overflow),
        };
        offset as i32
    }
}

/// How the value of a flag is obtained, in the form of [`arm7tdmi::GuestState`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flag {
    /// The state has it.
    State,
    Value(Value),
    Constant(u32),
    /// C of a subtraction: no borrow.
    NoBorrow(Value, Value),
    /// C of an addition: its sum and one addend.
    CarryOut(Value, Value),
    /// V of a subtraction: operands and result.
    SubtractionOverflow(Value, Value, Value),
    /// V of an addition: operands and result.
    AdditionOverflow(Value, Value, Value),
    /// A bit of a value.
    Bit(Value, u8),
}

/// The four flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Flags {
    flags: [Flag; 4],
    /// All flags are those of the difference of these.
    pub compared: Option<(Value, Value)>,
    /// Fields whose value is not in the state, one bit each.
    pub dirty: u8,
}

impl Flags {
    pub const IN_STATE: Self = Self {
        flags: [Flag::State; 4],
        compared: None,
        dirty: 0,
    };

    pub const fn get(&self, field: Field) -> Flag {
        self.flags[field as usize]
    }

    /// Sets one flag.
    pub fn set(&mut self, field: Field, flag: Flag) {
        self.compared = None;
        self.dirty |= 1 << field as u8;
        self.flags[field as usize] = flag;
    }

    /// N and Z of a result.
    pub fn set_nz(&mut self, result: Value) {
        self.set(Field::Negative, Flag::Value(result));
        self.set(Field::Zero, Flag::Value(result));
    }

    /// All of a - b.
    pub fn set_difference(&mut self, a: Value, b: Value, result: Value) {
        self.set_nz(result);
        self.set(Field::Carry, Flag::NoBorrow(a, b));
        self.set(Field::Overflow, Flag::SubtractionOverflow(a, b, result));
        self.compared = Some((a, b));
    }

    /// All of a + b, with this carry.
    pub fn set_sum(&mut self, a: Value, b: Value, result: Value, carry: Flag) {
        self.set_nz(result);
        self.set(Field::Carry, carry);
        self.set(Field::Overflow, Flag::AdditionOverflow(a, b, result));
    }
}
