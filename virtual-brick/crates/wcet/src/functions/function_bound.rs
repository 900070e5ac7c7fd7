// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The bounds of one function: time, stack, protected actions, and the path that attains the time.

use crate::elapsed::PathTree;
use crate::inputs::image::Entry;
use crate::paths::critical_section::CriticalSections;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Longest time in cycles from a call to the end of the caller, by the number of the group of
/// functions that are called; none where none of them is.
pub type RemainingTimes = BTreeMap<u32, u64>;

/// Where a loop's bound comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BoundOrigin {
    /// From abstract execution.
    Derived,
    /// From the user.
    Annotated,
    /// There is none, and none is needed: no path through the loop returns.
    #[serde(rename = "not needed")]
    NotNeeded,
}

/// A loop of the function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopBound {
    /// Address of the header.
    pub address: u32,
    /// Number within its symbol.
    pub number: usize,
    /// Most executions of the header for one entry.
    pub header_executions: Option<u64>,
    /// Who says so.
    pub origin: BoundOrigin,
    /// Its header as a position among the blocks.
    pub header: usize,
    /// All its blocks.
    pub blocks: Vec<usize>,
    /// Header executions beyond the first of each entry, in all for one entry of the loop around
    /// it, and the position of that loop's header.
    pub repeats: Option<(u64, usize)>,
}

/// A block as the longest path passes it.
#[derive(Clone, Debug)]
pub struct BlockBound {
    /// First instruction.
    pub address: u32,
    /// How often the path passes.
    pub count: u64,
    /// Cycles by edge, calls included; none for an edge that is never taken.
    pub cycles: Vec<Option<u64>>,
    /// Bounds of the functions called at its end.
    pub calls: Vec<Rc<FunctionBound>>,
    /// Accesses whose region is not known, charged as the most expensive.
    pub unknown_accesses: usize,
    /// Blocks to which the edges lead; none for the return.
    pub targets: Vec<Option<usize>>,
    /// Addresses of its instructions.
    pub addresses: Vec<u32>,
}

/// Bounds of one function for one set of arguments.
#[derive(Debug)]
pub struct FunctionBound {
    /// Entry.
    pub entry: Entry,
    /// Cycles from its first instruction to its last, without the fetches of the return: the
    /// smaller of the longest path and of the longest path with calls in context.
    pub cycles: u64,
    /// Cycles of the longest path, on which each block costs what it can cost at most.
    pub path_cycles: u64,
    /// Stack below the stack pointer at entry, with all callees; `None` when not bounded.
    pub stack_bytes: Option<u32>,
    /// The instruction at which the depth of the stack is lost, if it is not bounded.
    pub stack_lost: Option<u32>,
    /// Blocks by address, with the longest path.
    pub blocks: Vec<BlockBound>,
    /// Loops by address of their header.
    pub loops: Vec<LoopBound>,
    /// Longest critical sections (protected actions), here and in all callees.
    pub sections: CriticalSections,
    /// Longest times from calls of certain functions (`Program::requesting`) to the return.
    pub remaining: RemainingTimes,
    /// What `cycles` are made of, if that is recorded.
    pub path: Option<Rc<PathTree>>,
    /// Functions that may be executed, where `blocks` do not show it.
    pub functions: BTreeSet<u32>,
}

impl FunctionBound {
    /// With nothing charged yet: also the inner call of a recursive function, whose time and stack
    /// are the outer one's.
    pub fn uncharged(entry: Entry) -> Self {
        Self {
            entry,
            cycles: 0,
            path_cycles: 0,
            stack_bytes: Some(0),
            stack_lost: None,
            blocks: Vec::new(),
            loops: Vec::new(),
            sections: CriticalSections::new(),
            remaining: RemainingTimes::new(),
            path: None,
            functions: BTreeSet::new(),
        }
    }
}
