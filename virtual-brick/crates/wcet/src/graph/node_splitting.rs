// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loops with several entries get one each: the blocks of such a loop, without its first entry,
//! are copied for those who enter elsewhere, and the copies lead to the first entry. Executions
//! of the copies are executions of the originals, so that no path is lost or added.

use crate::graph::control_flow::{ControlFlowGraph, Target};
use crate::graph::loop_forest::{successors, LoopForest};
use std::collections::{BTreeMap, BTreeSet};

/// Most blocks of a function with copies.
const LIMIT: usize = 20_000;

/// A graph whose loops have one entry each.
pub struct ReducibleGraph {
    /// The same paths as in the given graph.
    pub flow: ControlFlowGraph,
    /// Its loops.
    pub forest: LoopForest,
    /// The block of the given graph that each block is or is a copy of.
    pub origin: Vec<usize>,
}

/// A graph with the same paths whose loops have one entry each. `Err` is a block at which a loop
/// is entered when too many copies would be needed.
pub fn reducible(mut flow: ControlFlowGraph) -> Result<ReducibleGraph, usize> {
    let mut origin: Vec<usize> = (0..flow.blocks.len()).collect();
    loop {
        let entered = match LoopForest::new(&flow) {
            Ok(forest) => {
                return Ok(ReducibleGraph {
                    flow,
                    forest,
                    origin,
                })
            }
            Err(block) => block,
        };
        let all: BTreeSet<usize> = (0..flow.blocks.len()).collect();
        let Some((first, region)) = irreducible(&flow, &all, 0).filter(|_| all.len() < LIMIT)
        else {
            return Err(entered);
        };
        let copied = copy(&mut flow, first, &region);
        origin.extend(
            copied
                .iter()
                .map(|block| origin[*block])
                .collect::<Vec<_>>(),
        );
    }
}

/// Strongly connected parts with an edge inside, of the graph on these blocks.
fn cycles(
    flow: &ControlFlowGraph,
    blocks: &BTreeSet<usize>,
    cut: Option<usize>,
) -> Vec<BTreeSet<usize>> {
    let follow = |block: usize| {
        let next = successors(flow, block);
        next.filter(move |n| blocks.contains(n) && Some(*n) != cut)
    };
    let reach = |start: usize| {
        let mut seen = BTreeSet::new();
        let mut open: Vec<usize> = follow(start).collect();
        while let Some(block) = open.pop() {
            if seen.insert(block) {
                open.extend(follow(block));
            }
        }
        seen
    };
    let reached: BTreeMap<usize, BTreeSet<usize>> =
        blocks.iter().map(|b| (*b, reach(*b))).collect();
    let mut parts: Vec<BTreeSet<usize>> = Vec::new();
    for block in blocks.iter().filter(|b| reached[b].contains(b)) {
        if !parts.iter().any(|part| part.contains(block)) {
            let same = reached[block].iter().filter(|o| reached[o].contains(block));
            parts.push(same.copied().collect());
        }
    }
    parts
}

/// A part entered at several blocks: the first of them and the part.
fn irreducible(
    flow: &ControlFlowGraph,
    blocks: &BTreeSet<usize>,
    start: usize,
) -> Option<(usize, BTreeSet<usize>)> {
    let mut open = vec![(blocks.clone(), None)];
    while let Some((within, cut)) = open.pop() {
        for part in cycles(flow, &within, cut) {
            let outside = (0..flow.blocks.len()).filter(|b| !part.contains(b));
            let mut entries: BTreeSet<usize> = outside
                .flat_map(|b| successors(flow, b))
                .filter(|b| part.contains(b))
                .collect();
            entries.extend(part.contains(&start).then_some(start));
            let first = *entries.first()?;
            if entries.len() > 1 {
                return Some((first, part));
            }
            open.push((part, Some(first)));
        }
    }
    None
}

/// Copies a region without its first entry; the blocks that were copied, in the order of copies.
fn copy(flow: &mut ControlFlowGraph, first: usize, region: &BTreeSet<usize>) -> Vec<usize> {
    let mut copies: BTreeMap<usize, usize> = BTreeMap::new();
    for block in region.iter().filter(|block| **block != first) {
        copies.insert(*block, flow.blocks.len());
        flow.blocks.push(flow.blocks[*block].clone());
    }
    let copied: BTreeSet<usize> = copies.values().copied().collect();
    for index in 0..flow.blocks.len() {
        if region.contains(&index) {
            continue;
        }
        for edge in &mut flow.blocks[index].edges {
            if let Target::Block(next) = edge.target {
                let from_outside = next != first || copied.contains(&index);
                if let Some(new) = copies.get(&next).filter(|_| from_outside) {
                    edge.target = Target::Block(*new);
                }
            }
        }
    }
    copies.into_keys().collect()
}
