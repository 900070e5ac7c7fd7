// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Decoding: from opcodes to formats, and from formats to [`Instruction`]s.

mod arm;
pub(crate) mod format;
mod thumb;

use crate::instruction::Instruction;

impl Instruction {
    /// Decodes an ARM opcode. Every encoding has a meaning, if only `Undefined`.
    pub fn arm(opcode: u32) -> Self {
        Self {
            condition: opcode >> 28,
            size: 4,
            operation: arm::operation(opcode),
        }
    }

    /// Decodes a Thumb opcode.
    pub fn thumb(opcode: u16) -> Self {
        let opcode = u32::from(opcode);
        Self {
            condition: thumb::condition(opcode),
            size: 2,
            operation: thumb::operation(opcode),
        }
    }
}
