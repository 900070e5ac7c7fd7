// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A function's graph with its costs and loop bounds, for those who solve for the longest path in
//! their own edge.

use crate::functions::function_bound::{BlockBound, FunctionBound, LoopBound};
use crate::functions::program::Program;
use serde::Serialize;
use std::collections::BTreeSet;

/// A edge out of a block.
#[derive(Clone, Debug, Serialize)]
pub struct GraphEdge {
    /// Position of the next block; none for the return.
    pub to: Option<usize>,
    /// Cycles of the block on this edge, calls included; none when it is never taken.
    pub cycles: Option<u64>,
}

/// A block.
#[derive(Clone, Debug, Serialize)]
pub struct GraphBlock {
    /// First instruction.
    pub address: u32,
    /// Source lines of its instructions.
    pub lines: Vec<String>,
    /// Edges that leave it.
    pub edges: Vec<GraphEdge>,
}

/// A loop.
#[derive(Clone, Debug, Serialize)]
pub struct GraphLoop {
    /// Position of its header.
    pub header: usize,
    /// Positions of its blocks.
    pub blocks: Vec<usize>,
    /// Most executions of the header for one entry.
    pub header_executions: Option<u64>,
    /// Header executions beyond the first of each entry, in all for one entry of the loop around
    /// it, and the position of that loop's header.
    pub repeats: Option<(u64, usize)>,
}

/// A function; the first block is its entry.
#[derive(Clone, Debug, Serialize)]
pub struct PathGraph {
    /// Blocks.
    pub blocks: Vec<GraphBlock>,
    /// Loops.
    pub loops: Vec<GraphLoop>,
    /// Cycles of the longest path under these bounds, as this crate finds it.
    pub path_cycles: u64,
}

impl PathGraph {
    /// The graph that was bounded.
    pub fn new(program: &Program<'_>, bound: &FunctionBound) -> Self {
        let line = |address: &u32| program.image.place(*address).line;
        let node = |block: &BlockBound| {
            let lines: BTreeSet<_> = block.addresses.iter().filter_map(line).collect();
            let edges = block.targets.iter().zip(&block.cycles);
            GraphBlock {
                address: block.address,
                lines: lines
                    .iter()
                    .map(|(file, line)| format!("{file}:{line}"))
                    .collect(),
                edges: edges
                    .map(|(to, cycles)| GraphEdge {
                        to: *to,
                        cycles: *cycles,
                    })
                    .collect(),
            }
        };
        let cycle = |found: &LoopBound| GraphLoop {
            header: found.header,
            blocks: found.blocks.clone(),
            header_executions: found.header_executions,
            repeats: found.repeats,
        };
        Self {
            blocks: bound.blocks.iter().map(node).collect(),
            loops: bound.loops.iter().map(cycle).collect(),
            path_cycles: bound.path_cycles,
        }
    }
}
