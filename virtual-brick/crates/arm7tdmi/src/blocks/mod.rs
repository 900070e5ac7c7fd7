// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The fast engine: basic blocks that are decoded once and executed many times.
//!
//! A block is entered only if its worst case ends before anything but the processor can act, so
//! it cannot be observed when in the block its cycles passed. An access that does more than read or
//! write memory is made through the bus, which is told the time before, and ends the block, unless
//! what is left of it still ends before anything else can act. An instruction that changes mode or
//! masks ends the block. The rest is left to the reference engine,
//! [`Cpu::step`](crate::Cpu::step). Both engines leave the same registers, pipeline and cycle
//! counts at the boundaries that they share. Stores to code, also to opcodes already fetched, are
//! made by the reference engine.

mod block;
mod budget;
mod bus;
mod cache;
mod compile;
mod execute;
mod jit;
mod operations;
mod region;
mod state;
#[cfg(test)]
mod tests;
mod translate;

pub use bus::{BlockBus, BusAccess, CodePlace, PlainRead, PlainWords, RamView};
pub use cache::Blocks;
pub use execute::BlocksRun;
pub use jit::{
    CodeExit, CodeWindow, CompileAnswer, Jit, KnownTarget, Region, RegionBlock, RegionInstruction,
    EXIT_BY_BRANCH,
};
pub use state::{GuestState, NO_ADDRESS};
