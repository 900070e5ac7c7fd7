// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Abstract domains, states and the transfer functions of instructions and basic blocks.

pub mod approximation;
pub mod arithmetic;
pub mod block_interpreter;
pub mod call_handling;
pub mod comparison;
pub mod flags;
pub mod instruction;
pub mod interval;
pub mod memory_access;
pub mod memory_contents;
pub mod operand;
pub mod quotients;
pub mod records;
pub mod refinement;
pub mod regions;
pub mod relations;
pub mod spans;
pub mod state;
pub mod support_library;
pub mod value;
pub mod words;

#[cfg(test)]
#[path = "tests/random_instructions.rs"]
mod random_instructions;
