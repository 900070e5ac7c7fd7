// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! JIT compiler for hot blocks of the ARM7TDMI core, on Cranelift.
//!
//! A region of blocks becomes one function. Inside a block, guest registers and flags are values
//! of the compiler. Between blocks they are in [`arm7tdmi::GuestState`], so that code can be
//! entered at each block and left in front of each of its operations. The code accesses registers
//! and unmarked words of RAM; for everything else it takes a side exit, and the block's operations
//! continue.
//!
//! Branches out of a region look for their target in a table with one entry for each halfword of
//! code, and jump to the code there.

mod access_range;
mod alu;
mod block_transfer;
mod branch;
mod code_memory;
mod compile_thread;
mod compiler;
mod conditions;
mod engine;
mod entry_table;
mod flags;
mod function;
mod host_code;
mod multiply;
mod region;
mod shift;
mod transfer;

pub use engine::{CompileMode, JitEngine};
