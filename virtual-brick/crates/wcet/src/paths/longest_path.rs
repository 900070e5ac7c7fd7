// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The longest path through a reducible graph whose loops have bounds.
//!
//! A loop whose header executes at most n times costs at most n - 1 times its dearest way back
//! and one way out. From the innermost loop outwards that is the optimum of implicit path
//! enumeration (Li and Malik 1995) under these bounds, found without a solver. Where an inner loop
//! is known to repeat less often in all than its bound times the outer loop's, its repetitions are
//! charged to the outer loop as a whole.

use crate::graph::control_flow::{Flow, Target};
use crate::graph::loop_forest::{Forest, Item};
use std::collections::{BTreeMap, BTreeSet};

/// An edge: block and number.
pub type EdgeId = (usize, usize);

/// Graph, costs and bounds.
pub struct Problem<'a> {
    /// Blocks and edges.
    pub flow: &'a Flow,
    /// Loops.
    pub forest: &'a Forest,
    /// Cycles for each block and edge.
    pub cycles: &'a [Vec<Option<u64>>],
    /// Header executions for each loop; `None` when unknown.
    pub bounds: &'a [Option<u64>],
    /// For each inner loop: header executions beyond the first of each entry, in all for one
    /// entry of the loop around it; `None` when unknown.
    pub repeats: &'a [Option<u64>],
}

/// The longest path as how often it passes each block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Solution {
    /// Cycles.
    pub cycles: u64,
    /// Executions of each block.
    pub counts: Vec<u64>,
}

/// Why there is no longest path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unsolved {
    /// Loops on ways to a return that have no bound.
    Unbounded(BTreeSet<usize>),
    /// No way leads to a return.
    NoReturn,
}

#[derive(Clone, Copy, Debug)]
enum Via {
    Start,
    Edge(EdgeId),
    /// Out of a loop by this edge.
    Loop(usize, EdgeId),
}

/// Longest ways within a scope.
#[derive(Default)]
struct Ways {
    /// To each block, from the scope's first.
    reached: BTreeMap<usize, (u64, Option<Via>)>,
    /// Over the edges back to the first.
    back: Option<(u64, Via)>,
    /// Over each edge out of the scope.
    exits: BTreeMap<EdgeId, (u64, Via)>,
}

struct Solver<'a> {
    problem: &'a Problem<'a>,
    useful: Vec<bool>,
    ways: BTreeMap<usize, Ways>,
    unbounded: BTreeSet<usize>,
}

/// Blocks from which feasible edges lead to a return.
fn useful_blocks(problem: &Problem<'_>) -> Vec<bool> {
    let blocks = &problem.flow.blocks;
    let mut useful = vec![false; blocks.len()];
    let mut changed = true;
    while changed {
        changed = false;
        for index in problem
            .forest
            .order
            .iter()
            .rev()
            .copied()
            .filter(|i| !useful[*i])
            .collect::<Vec<_>>()
        {
            let leads = blocks[index]
                .edges
                .iter()
                .enumerate()
                .any(|(number, edge)| {
                    problem.cycles[index][number].is_some()
                        && match edge.target {
                            Target::Return => true,
                            Target::Block(next) => useful[next],
                        }
                });
            if leads {
                useful[index] = true;
                changed = true;
            }
        }
    }
    useful
}

/// Solves the problem.
pub fn longest_path(problem: &Problem<'_>) -> Result<Solution, Unsolved> {
    let useful = useful_blocks(problem);
    if !useful[0] {
        return Err(Unsolved::NoReturn);
    }
    let mut solver = Solver {
        problem,
        useful,
        ways: BTreeMap::new(),
        unbounded: BTreeSet::new(),
    };
    let ways = solver.scope(None, 0);
    if !solver.unbounded.is_empty() {
        return Err(Unsolved::Unbounded(solver.unbounded));
    }
    let best = ways
        .exits
        .values()
        .max_by_key(|(cycles, _)| *cycles)
        .copied();
    let (cycles, via) = best.ok_or(Unsolved::NoReturn)?;
    let mut counts = vec![0; problem.flow.blocks.len()];
    solver.count(&ways, via, 1, &mut counts);
    Ok(Solution { cycles, counts })
}

fn raise(place: &mut (u64, Option<Via>), cycles: u64, via: Via) {
    if place.1.is_none() || place.0 < cycles {
        *place = (cycles, Some(via));
    }
}

impl Solver<'_> {
    fn scope(&mut self, scope: Option<usize>, first: usize) -> Ways {
        let forest = self.problem.forest;
        let mut ways = Ways::default();
        ways.reached.insert(first, (0, Some(Via::Start)));
        for item in forest.steps(scope) {
            let block = match item {
                Item::Block(block) => block,
                Item::Loop(index) => forest.loops[index].header,
            };
            let Some((before, _)) = ways.reached.get(&block).copied() else {
                continue;
            };
            if !self.useful[block] {
                continue;
            }
            for (edge, cycles, via) in self.leaving(item) {
                self.follow(scope, first, &mut ways, edge, before + cycles, via);
            }
        }
        ways
    }

    /// Edges out of a block or of a loop, with the cycles from its entry.
    fn leaving(&mut self, item: Item) -> Vec<(EdgeId, u64, Via)> {
        match item {
            Item::Block(block) => {
                let costs = self.problem.cycles[block].iter().enumerate();
                costs
                    .filter_map(|(number, cycles)| Some(((block, number), (*cycles)?)))
                    .map(|(edge, cycles)| (edge, cycles, Via::Edge(edge)))
                    .collect()
            }
            Item::Loop(index) => {
                let ways = self.scope(Some(index), self.problem.forest.loops[index].header);
                let bound = match (ways.back, self.problem.bounds[index]) {
                    (None, _) => 1,
                    (Some(_), Some(bound)) => bound.max(1),
                    (Some(_), None) => {
                        self.unbounded.insert(index);
                        1
                    }
                };
                let own = match self.lump(index) {
                    Some(_) => 0,
                    None => bound - 1,
                };
                let mut again = ways.back.map_or(0, |(cycles, _)| cycles) * own;
                for (inner, times) in self.lumps(index) {
                    let back = self.ways.get(&inner).and_then(|ways| ways.back);
                    again += times * back.map_or(0, |(cycles, _)| cycles);
                }
                let exits = ways.exits.iter();
                let leaving = exits
                    .map(|(edge, (cycles, _))| (*edge, again + cycles, Via::Loop(index, *edge)))
                    .collect();
                self.ways.insert(index, ways);
                leaving
            }
        }
    }

    /// Repetitions of a loop that are charged to the loop around it.
    fn lump(&self, index: usize) -> Option<u64> {
        let parent = self.problem.forest.loops[index].parent?;
        let apart = self.problem.bounds[parent]? * self.problem.bounds[index]?.saturating_sub(1);
        self.problem.repeats[index].filter(|repeats| *repeats < apart)
    }

    /// Inner loops whose repetitions are charged to this one.
    fn lumps(&self, index: usize) -> Vec<(usize, u64)> {
        let loops = &self.problem.forest.loops;
        let inner = (0..loops.len()).filter(|inner| loops[*inner].parent == Some(index));
        inner
            .filter_map(|inner| Some((inner, self.lump(inner)?)))
            .collect()
    }

    fn follow(
        &self,
        scope: Option<usize>,
        first: usize,
        ways: &mut Ways,
        edge: EdgeId,
        cycles: u64,
        via: Via,
    ) {
        match self.problem.flow.blocks[edge.0].edges[edge.1].target {
            Target::Block(next) if !self.useful[next] => {}
            Target::Block(next) if scope.is_some() && next == first => {
                if ways.back.is_none_or(|(known, _)| known < cycles) {
                    ways.back = Some((cycles, via));
                }
            }
            Target::Block(next) if self.problem.forest.contains(scope, next) => {
                raise(ways.reached.entry(next).or_insert((0, None)), cycles, via);
            }
            _ => {
                let known = ways.exits.get(&edge).map(|(known, _)| *known);
                if known.is_none_or(|known| known < cycles) {
                    ways.exits.insert(edge, (cycles, via));
                }
            }
        }
    }

    /// Counts the blocks on the way that ends with `via`, taken `times`.
    fn count(&self, ways: &Ways, mut via: Via, times: u64, counts: &mut [u64]) {
        loop {
            let block = match via {
                Via::Start => return,
                Via::Edge((block, _)) => {
                    counts[block] += times;
                    block
                }
                Via::Loop(index, edge) => {
                    self.count_loop(index, edge, times, counts);
                    self.problem.forest.loops[index].header
                }
            };
            let Some((_, Some(before))) = ways.reached.get(&block) else {
                return;
            };
            via = *before;
        }
    }

    fn count_loop(&self, index: usize, exit: EdgeId, times: u64, counts: &mut [u64]) {
        let Some(ways) = self.ways.get(&index) else {
            return;
        };
        if let Some((_, via)) = ways.exits.get(&exit) {
            self.count(ways, *via, times, counts);
        }
        if let (Some((_, via)), Some(bound), None) =
            (ways.back, self.problem.bounds[index], self.lump(index))
        {
            self.count(ways, via, times * (bound.max(1) - 1), counts);
        }
        for (inner, repeats) in self.lumps(index) {
            if let Some((way, (_, via))) = self.ways.get(&inner).and_then(|w| Some((w, w.back?))) {
                self.count(way, via, times * repeats, counts);
            }
        }
    }
}
