// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of execution times and stacks of ARM7TDMI programs, by static analysis of their ELF
//! files.
//!
//! **In:** an [`Image`] (code, symbols, line table), a [`MemoryMap`] with the cycles of each kind
//! of access, [`Annotations`] (flow facts, conventions of the kernel). **Out:** for a function or a
//! job of a task, cycles and stack with the path that attains them ([`Report`], [`Response`]), or
//! the [`Error`] that names the place that keeps it from being bounded. **Not known here:** the
//! chip, its peripherals, the scheduler; interrupts and DMA are interference, which the caller
//! adds.
//!
//! The rooms, each knowing only those before it:
//!
//! 1. `inputs`: what is given about a program;
//! 2. `graph`: control-flow graph, loop nesting forest, node splitting; no values;
//! 3. `elapsed`: cycles of a path and, where wanted, the steps they are made of;
//! 4. `values`: abstract domains, states, transfer functions of instructions and blocks;
//! 5. `loops`: abstract execution iteration by iteration, and flow facts for other loops;
//! 6. `paths`: costs of blocks, longest path, critical sections;
//! 7. `functions`: the recursion over the call graph: summaries for any arguments, calls in the
//!    context of their caller, bounds;
//! 8. `queries`: what a caller asks, and the answers as data.
//!
//! Instructions and their bus cycles come from the core's crate, so the sums are what the virtual
//! brick charges. The argument for soundness and its assumptions are written down in
//! `docs/internals/timing-analysis.md`.

mod elapsed;
mod error;
mod functions;
mod graph;
mod inputs;
mod loops;
mod paths;
mod queries;
mod values;

pub use error::{Contradiction, Error, MissingBound, Place};
pub use functions::program::Program;
pub use inputs::annotations::Annotations;
pub use inputs::image::Image;
pub use inputs::memory_map::{FetchCost, MemoryMap, Region};
pub use queries::known_memory::{Input, KnownMemory, KnownMemoryBound, LineCount};
pub use queries::path_report::{LineCost, PathReport};
pub use queries::report::Report;
pub use queries::request::{AnnotationFile, Request, Response};
pub use queries::unmatched_facts::{unmatched_facts, UnmatchedFact};
