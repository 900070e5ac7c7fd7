// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Code of the host for hot blocks of the ARM7TDMI core, made by Cranelift.
//!
//! A region of blocks becomes one function. Inside a block, guest registers and flags are values
//! of the compiler; between blocks they are in [`NativeState`], so that code can be entered at
//! each block and left before each of its operations. What the code cannot do, it leaves to the
//! blocks' own operations: everything but registers and RAM whose words nobody watches.
//!
//! Branches out of a region look for their target in a table that has an entry for each place of
//! code, and jump to the code there.

mod alu;
mod block_transfer;
mod branch;
mod compiler;
mod flags;
mod function;
mod machine;
mod multiply;
mod reach;
mod region;
mod shift;
mod table;
mod transfer;
mod translator;
mod workshop;

pub use translator::{Making, Translator};
