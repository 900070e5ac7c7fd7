// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A part of a function's graph with one entry, as a graph of its own.

use crate::graph::control_flow::{Block, ControlFlowGraph, Edge, Target};
use std::collections::BTreeMap;

/// A part of a graph.
pub struct Subgraph {
    /// Its blocks, the entry first. Edges that leave the part are returns.
    pub flow: ControlFlowGraph,
    /// Their numbers in the whole graph.
    pub origin: Vec<usize>,
}

impl Subgraph {
    /// The part that is reached from `start` within `inside`, on edges for which `follows` holds.
    pub fn new(
        flow: &ControlFlowGraph,
        start: usize,
        inside: impl Fn(usize) -> bool,
        follows: impl Fn(usize, &Edge) -> bool,
    ) -> Self {
        let next = |block: usize, edge: &Edge| match edge.target {
            Target::Block(next) if inside(next) && follows(block, edge) => Some(next),
            _ => None,
        };
        let mut number = BTreeMap::from([(start, 0)]);
        let mut origin = vec![start];
        let mut open = vec![start];
        while let Some(block) = open.pop() {
            for edge in &flow.blocks[block].edges {
                if let Some(found) = next(block, edge).filter(|n| !number.contains_key(n)) {
                    number.insert(found, origin.len());
                    origin.push(found);
                    open.push(found);
                }
            }
        }
        let part = |block: &usize| {
            let whole = &flow.blocks[*block];
            let edges = whole.edges.iter().map(|edge| Edge {
                target: next(*block, edge).map_or(Target::Return, |n| Target::Block(number[&n])),
                ..*edge
            });
            Block {
                edges: edges.collect(),
                ..whole.clone()
            }
        };
        Self {
            flow: ControlFlowGraph {
                blocks: origin.iter().map(part).collect(),
            },
            origin,
        }
    }
}
