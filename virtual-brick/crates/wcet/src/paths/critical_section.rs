// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Longest critical sections (protected actions), for the blocking of more urgent threads.

use crate::error::Error;
use crate::graph::control_flow::ControlFlowGraph;
use crate::graph::loop_forest::{successors, Loop, LoopForest};
use crate::graph::subgraph::Subgraph;
use crate::paths::longest_path::{longest_path, PathError, PathProblem};
use crate::values::records::BlockRecord;
use std::collections::{BTreeMap, BTreeSet};

/// Longest time in cycles spent at an urgency or above, by urgency.
pub type CriticalSections = BTreeMap<u32, u64>;

/// Longest critical sections within a function, of whose blocks `records` are known. Whole blocks
/// are counted.
pub fn critical_sections(
    function: &PathProblem<'_>,
    records: &[BlockRecord],
) -> Result<CriticalSections, Error> {
    let levels: BTreeSet<u32> = records.iter().filter_map(|r| r.urgency).collect();
    let mut sections = CriticalSections::new();
    for level in levels {
        let inside = |block: usize| records[block].urgency >= Some(level);
        let mut longest = 0;
        for start in entries(function.flow, inside) {
            longest = longest.max(longest_from(function, start, inside)?);
        }
        sections.insert(level, longest);
    }
    Ok(sections)
}

/// Blocks of a part of a graph that are reached from outside of it.
fn entries(flow: &ControlFlowGraph, inside: impl Fn(usize) -> bool) -> Vec<usize> {
    let blocks = 0..flow.blocks.len();
    let outside = blocks.clone().filter(|block| !inside(*block));
    let entered: BTreeSet<usize> = outside.flat_map(|block| successors(flow, block)).collect();
    let is_entry = |block: &usize| inside(*block) && (*block == 0 || entered.contains(block));
    blocks.filter(is_entry).collect()
}

fn longest_from(
    function: &PathProblem<'_>,
    start: usize,
    inside: impl Fn(usize) -> bool,
) -> Result<u64, Error> {
    let part = Subgraph::new(function.flow, start, inside, |_, _| true);
    let origin = part.origin.iter();
    let cycles: Vec<_> = origin.map(|b| function.cycles[*b].clone()).collect();
    let missing = || Error::Input("a protected action ends in the middle of a loop".into());
    let forest = LoopForest::new(&part.flow).map_err(|_| missing())?;
    let bound = |found: &Loop| {
        let header = part.origin[found.header];
        let mut loops = function.forest.loops.iter();
        function.bounds[loops.position(|whole| whole.header == header)?]
    };
    let problem = PathProblem {
        flow: &part.flow,
        forest: &forest,
        cycles: &cycles,
        bounds: &forest.loops.iter().map(bound).collect::<Vec<_>>(),
        repeats: &vec![None; forest.loops.len()],
    };
    match longest_path(&problem) {
        Ok(solution) => Ok(solution.cycles),
        Err(PathError::NoReturn) => Ok(0),
        Err(PathError::Unbounded(_)) => Err(missing()),
    }
}

/// The longer of both for each urgency; a section at an urgency is one at every lower.
pub fn merge(sections: &mut CriticalSections, more: &CriticalSections) {
    for (urgency, cycles) in more {
        let known = sections.entry(*urgency).or_insert(0);
        *known = (*known).max(*cycles);
    }
}
