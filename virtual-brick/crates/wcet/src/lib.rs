// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Execution-time and stack bounds of ARM7TDMI programs, from their ELF files.
//!
//! Instructions and their bus cycles come from the core's own crate, so what is summed here is
//! what the virtual brick charges. The steps for a function:
//!
//! 1. [`flow`] and [`summary`]: its control-flow graph, indirect branches resolved by the values
//!    of registers and stack words ([`state`], [`transfer`], [`alu`]);
//! 2. [`loops`]: its loops; a graph that is not reducible is an error;
//! 3. [`execution`]: the function on abstract values, iteration by iteration: loop bounds,
//!    branches never taken, regions of accesses, multiplier sizes, arguments of calls. Calls are
//!    followed into the callee in their caller's state ([`context`]), and the cycles of the longest
//!    way are carried along;
//! 4. [`cost`]: cycles of each block on each way out;
//! 5. [`path`]: the longest path on which each block costs what it can cost at most. The bound is
//!    the smaller of both.
//!
//! A program that nothing disturbs is bounded as it is, with what memory holds ([`closed`]).
//!
//! Assumptions: no interrupt and no DMA transfer intervenes (they are interference, not
//! execution time); code does not change; saved registers and return addresses on the stack are
//! not overwritten; what is computed from an address in a region stays in the region; a trap
//! (undefined instruction) ends the path and is no return.

mod error;
mod functions;
mod graph;
mod inputs;
mod loops;
mod paths;
mod queries;
mod values;

pub use error::{Error, MissingBound, Place};
pub use functions::program::Program;
pub use inputs::annotations::Annotations;
pub use inputs::image::Image;
pub use inputs::memory_map::{FetchCost, MemoryMap, Region};
pub use queries::known_memory::{Closed, Found, Input, LineCount};
pub use queries::report::Report;
pub use queries::request::{Request, Response, Source};
