// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Longest stays in protected actions, for the blocking of more urgent threads.

use crate::error::Error;
use crate::graph::control_flow::Flow;
use crate::graph::loop_forest::Forest;
use crate::graph::subgraph::Subgraph;
use crate::paths::longest_path::{longest_path, Problem, Unsolved};
use crate::values::block::BlockRecord;
use std::collections::{BTreeMap, BTreeSet};

/// Longest time in cycles spent at an urgency or above, by urgency.
pub type Sections = BTreeMap<u32, u64>;

/// A function's blocks with what is known about them.
pub struct Stay<'a> {
    /// Its graph.
    pub flow: &'a Flow,
    /// Its loops.
    pub forest: &'a Forest,
    /// Bounds of its loops.
    pub bounds: &'a [Option<u64>],
    /// What was learned about its blocks.
    pub records: &'a [BlockRecord],
    /// Cycles on each way out of each block.
    pub cycles: &'a [Vec<Option<u64>>],
}

impl Stay<'_> {
    /// Longest stays within this function. Whole blocks are counted.
    pub fn sections(&self) -> Result<Sections, Error> {
        let levels: BTreeSet<u32> = self.records.iter().filter_map(|r| r.urgency).collect();
        let mut sections = Sections::new();
        for level in levels {
            let inside = |block: usize| self.records[block].urgency >= Some(level);
            let mut longest = 0;
            for start in (0..self.flow.blocks.len()).filter(|block| self.begins(*block, &inside)) {
                longest = longest.max(self.longest_from(start, &inside)?);
            }
            sections.insert(level, longest);
        }
        Ok(sections)
    }

    fn begins(&self, block: usize, inside: &impl Fn(usize) -> bool) -> bool {
        let outside = (0..self.flow.blocks.len()).filter(|other| !inside(*other));
        let entered = outside
            .flat_map(|other| crate::graph::loop_forest::successors(self.flow, other))
            .any(|next| next == block);
        inside(block) && (block == 0 || entered)
    }

    fn longest_from(&self, start: usize, inside: &impl Fn(usize) -> bool) -> Result<u64, Error> {
        let part = Subgraph::new(self.flow, start, inside, |_, _| true);
        let cycles: Vec<_> = part
            .origin
            .iter()
            .map(|b| self.cycles[*b].clone())
            .collect();
        let missing = || Error::Input("a protected action ends in the middle of a loop".into());
        let forest = Forest::new(&part.flow).map_err(|_| missing())?;
        let bounds: Vec<Option<u64>> = forest
            .loops
            .iter()
            .map(|found| {
                let header = part.origin[found.header];
                let whole = self.forest.loops.iter().position(|l| l.header == header)?;
                self.bounds[whole]
            })
            .collect();
        let problem = Problem {
            flow: &part.flow,
            forest: &forest,
            cycles: &cycles,
            bounds: &bounds,
            repeats: &vec![None; forest.loops.len()],
        };
        match longest_path(&problem) {
            Ok(solution) => Ok(solution.cycles),
            Err(Unsolved::NoReturn) => Ok(0),
            Err(Unsolved::Unbounded(_)) => Err(missing()),
        }
    }
}

/// The longer of both for each urgency; a stay at an urgency is one at every lower.
pub fn merge(sections: &mut Sections, more: &Sections) {
    for (urgency, cycles) in more {
        let known = sections.entry(*urgency).or_insert(0);
        *known = (*known).max(*cycles);
    }
}
