// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The longest path through a reducible graph whose loops have bounds.
//!
//! A loop whose header executes at most n times costs at most n - 1 times its most expensive path
//! back and one path out. From the innermost loop outwards that is the optimum of implicit path
//! enumeration (Li and Malik 1995) under these bounds, found without a solver. Where an inner loop
//! is known to repeat less often in all than its bound times the outer loop's, its repetitions are
//! charged to the outer loop as a whole.

use crate::graph::control_flow::{ControlFlowGraph, Target};
use crate::graph::loop_forest::{Item, LoopForest};
use std::collections::{BTreeMap, BTreeSet};

/// An edge: block and number.
pub type EdgeId = (usize, usize);

/// Graph, costs and bounds.
pub struct PathProblem<'a> {
    /// Blocks and edges.
    pub flow: &'a ControlFlowGraph,
    /// Loops.
    pub forest: &'a LoopForest,
    /// Cycles for each block and edge.
    pub cycles: &'a [Vec<Option<u64>>],
    /// Header executions for each loop; `None` when unknown.
    pub bounds: &'a [Option<u64>],
    /// For each inner loop: header executions beyond the first of each entry, in all for one
    /// entry of the loop around it; `None` when unknown.
    pub repeats: &'a [Option<u64>],
}

/// The longest path as how often it passes each block and leaves it on each edge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LongestPath {
    /// Cycles.
    pub cycles: u64,
    /// Executions of each block, by edge.
    pub counts: Vec<Vec<u64>>,
}

/// Why there is no longest path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathError {
    /// Loops on paths to a return that have no bound.
    Unbounded(BTreeSet<usize>),
    /// No path leads to a return.
    NoReturn,
}

#[derive(Clone, Copy, Debug)]
enum Predecessor {
    Start,
    Edge(EdgeId),
    /// Out of a loop by this edge.
    Loop(usize, EdgeId),
}

/// Longest paths within a scope.
#[derive(Default)]
struct ScopePaths {
    /// To each block, from the scope's first.
    reached: BTreeMap<usize, (u64, Option<Predecessor>)>,
    /// Over the edges back to the first.
    back: Option<(u64, Predecessor)>,
    /// Over each edge out of the scope.
    exits: BTreeMap<EdgeId, (u64, Predecessor)>,
}

struct Solver<'a> {
    problem: &'a PathProblem<'a>,
    reaches_return: Vec<bool>,
    paths: BTreeMap<usize, ScopePaths>,
    unbounded: BTreeSet<usize>,
}

/// Blocks from which feasible edges lead to a return.
fn blocks_reaching_return(problem: &PathProblem<'_>) -> Vec<bool> {
    let blocks = &problem.flow.blocks;
    let mut reaches_return = vec![false; blocks.len()];
    let mut changed = true;
    while changed {
        changed = false;
        for index in problem
            .forest
            .order
            .iter()
            .rev()
            .copied()
            .filter(|i| !reaches_return[*i])
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
                            Target::Block(next) => reaches_return[next],
                        }
                });
            if leads {
                reaches_return[index] = true;
                changed = true;
            }
        }
    }
    reaches_return
}

/// Solves the problem.
pub fn longest_path(problem: &PathProblem<'_>) -> Result<LongestPath, PathError> {
    let reaches_return = blocks_reaching_return(problem);
    if !reaches_return[0] {
        return Err(PathError::NoReturn);
    }
    let mut solver = Solver {
        problem,
        reaches_return,
        paths: BTreeMap::new(),
        unbounded: BTreeSet::new(),
    };
    let paths = solver.scope(None, 0);
    if !solver.unbounded.is_empty() {
        return Err(PathError::Unbounded(solver.unbounded));
    }
    let best = paths
        .exits
        .values()
        .max_by_key(|(cycles, _)| *cycles)
        .copied();
    let (cycles, via) = best.ok_or(PathError::NoReturn)?;
    let edges = problem.cycles.iter().map(|edges| vec![0; edges.len()]);
    let mut counts = edges.collect::<Vec<_>>();
    solver.count(&paths, via, 1, &mut counts);
    Ok(LongestPath { cycles, counts })
}

fn keep_longest(place: &mut (u64, Option<Predecessor>), cycles: u64, via: Predecessor) {
    if place.1.is_none() || place.0 < cycles {
        *place = (cycles, Some(via));
    }
}

impl Solver<'_> {
    fn scope(&mut self, scope: Option<usize>, first: usize) -> ScopePaths {
        let forest = self.problem.forest;
        let mut paths = ScopePaths::default();
        paths.reached.insert(first, (0, Some(Predecessor::Start)));
        for item in forest.steps(scope) {
            let block = match item {
                Item::Block(block) => block,
                Item::Loop(index) => forest.loops[index].header,
            };
            let Some((before, _)) = paths.reached.get(&block).copied() else {
                continue;
            };
            if !self.reaches_return[block] {
                continue;
            }
            for (edge, cycles, via) in self.leaving(item) {
                self.follow(scope, first, &mut paths, edge, before + cycles, via);
            }
        }
        paths
    }

    /// Edges out of a block or of a loop, with the cycles from its entry.
    fn leaving(&mut self, item: Item) -> Vec<(EdgeId, u64, Predecessor)> {
        match item {
            Item::Block(block) => {
                let costs = self.problem.cycles[block].iter().enumerate();
                costs
                    .filter_map(|(number, cycles)| Some(((block, number), (*cycles)?)))
                    .map(|(edge, cycles)| (edge, cycles, Predecessor::Edge(edge)))
                    .collect()
            }
            Item::Loop(index) => {
                let paths = self.scope(Some(index), self.problem.forest.loops[index].header);
                let bound = match (paths.back, self.problem.bounds[index]) {
                    (None, _) => 1,
                    (Some(_), Some(bound)) => bound.max(1),
                    (Some(_), None) => {
                        self.unbounded.insert(index);
                        1
                    }
                };
                let own = match self.total_repeats(index) {
                    Some(_) => 0,
                    None => bound - 1,
                };
                let mut again = paths.back.map_or(0, |(cycles, _)| cycles) * own;
                for (inner, times) in self.inner_total_repeats(index) {
                    let back = self.paths.get(&inner).and_then(|paths| paths.back);
                    again += times * back.map_or(0, |(cycles, _)| cycles);
                }
                let exits = paths.exits.iter();
                let leaving = exits
                    .map(|(edge, (cycles, _))| {
                        (*edge, again + cycles, Predecessor::Loop(index, *edge))
                    })
                    .collect();
                self.paths.insert(index, paths);
                leaving
            }
        }
    }

    /// Repetitions of a loop that are charged to the loop around it.
    fn total_repeats(&self, index: usize) -> Option<u64> {
        let parent = self.problem.forest.loops[index].parent?;
        let separate = self.problem.bounds[parent]? * self.problem.bounds[index]?.saturating_sub(1);
        self.problem.repeats[index].filter(|repeats| *repeats < separate)
    }

    /// Inner loops whose repetitions are charged to this one.
    fn inner_total_repeats(&self, index: usize) -> Vec<(usize, u64)> {
        let loops = &self.problem.forest.loops;
        let inner = (0..loops.len()).filter(|inner| loops[*inner].parent == Some(index));
        inner
            .filter_map(|inner| Some((inner, self.total_repeats(inner)?)))
            .collect()
    }

    fn follow(
        &self,
        scope: Option<usize>,
        first: usize,
        paths: &mut ScopePaths,
        edge: EdgeId,
        cycles: u64,
        via: Predecessor,
    ) {
        match self.problem.flow.blocks[edge.0].edges[edge.1].target {
            Target::Block(next) if !self.reaches_return[next] => {}
            Target::Block(next) if scope.is_some() && next == first => {
                if paths.back.is_none_or(|(known, _)| known < cycles) {
                    paths.back = Some((cycles, via));
                }
            }
            Target::Block(next) if self.problem.forest.contains(scope, next) => {
                keep_longest(paths.reached.entry(next).or_insert((0, None)), cycles, via);
            }
            _ => {
                let known = paths.exits.get(&edge).map(|(known, _)| *known);
                if known.is_none_or(|known| known < cycles) {
                    paths.exits.insert(edge, (cycles, via));
                }
            }
        }
    }

    /// Counts the blocks on the path that ends with `via`, taken `times`.
    fn count(&self, paths: &ScopePaths, mut via: Predecessor, times: u64, counts: &mut [Vec<u64>]) {
        loop {
            let block = match via {
                Predecessor::Start => return,
                Predecessor::Edge((block, edge)) => {
                    counts[block][edge] += times;
                    block
                }
                Predecessor::Loop(index, edge) => {
                    self.count_loop(index, edge, times, counts);
                    self.problem.forest.loops[index].header
                }
            };
            let Some((_, Some(before))) = paths.reached.get(&block) else {
                return;
            };
            via = *before;
        }
    }

    fn count_loop(&self, index: usize, exit: EdgeId, times: u64, counts: &mut [Vec<u64>]) {
        let Some(paths) = self.paths.get(&index) else {
            return;
        };
        if let Some((_, via)) = paths.exits.get(&exit) {
            self.count(paths, *via, times, counts);
        }
        if let (Some((_, via)), Some(bound), None) = (
            paths.back,
            self.problem.bounds[index],
            self.total_repeats(index),
        ) {
            self.count(paths, via, times * (bound.max(1) - 1), counts);
        }
        for (inner, repeats) in self.inner_total_repeats(index) {
            if let Some((path, (_, via))) = self.paths.get(&inner).and_then(|w| Some((w, w.back?)))
            {
                self.count(path, via, times * repeats, counts);
            }
        }
    }
}
