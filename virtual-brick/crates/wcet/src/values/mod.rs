// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Abstract domains, states and the transfer functions of instructions and basic blocks.

pub mod arithmetic;
pub mod block;
pub mod instruction;
pub mod memory_contents;
pub mod relations;
pub mod state;
pub mod value;

#[cfg(test)]
#[path = "tests/random_instructions.rs"]
mod random_instructions;
