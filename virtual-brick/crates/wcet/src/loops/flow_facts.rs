// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flow facts: the loop that a number of iterations in an annotation belongs to.
//!
//! A fact holds for the loops that begin at its place. One that names no line and no number of a
//! loop must say that it holds for every loop there, unless there is only one. A loop statement of
//! a source belongs to the loops that have code of its lines in no inner loop; where statements are
//! nested, to the outermost of them; where loops are nested that could both be meant, to none.

use crate::graph::control_flow::{ControlFlowGraph, ControlTransfer, Target};
use crate::graph::loop_forest::LoopForest;
use crate::inputs::annotations::{Fact, Statement};
use crate::inputs::facts::{FactUse, Facts};
use crate::inputs::image::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// Header executions: anywhere, and while some function is active.
pub type LoopFacts = (Vec<Option<u64>>, Vec<(usize, Entry, u64)>);

type Line = (String, u32);

impl Facts<'_> {
    /// Header executions of all loops, by annotations and loop statements of the sources.
    pub fn loop_bounds(
        &self,
        flow: &ControlFlowGraph,
        forest: &LoopForest,
        numbers: &[usize],
    ) -> LoopFacts {
        let count = forest.loops.len();
        let (mut anywhere, mut within) = (vec![None; count], Vec::new());
        let mut used: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (index, number) in numbers.iter().enumerate() {
            let address = flow.blocks[forest.loops[index].header].node.address;
            let place = self.image.place(address);
            let names = self.image.names_at(address);
            for (which, fact) in self.annotations.loops.iter().enumerate() {
                if !fact.matches(&place, names, Some(*number)) {
                    continue;
                }
                let Some(bound) = header_executions(self, fact, flow, forest, index) else {
                    continue;
                };
                match self.image.within(fact) {
                    None => anywhere[index] = anywhere[index].or(Some(bound)),
                    Some(callers) if callers.is_empty() => continue,
                    Some(callers) => within.extend(callers.iter().map(|f| (index, *f, bound))),
                }
                let known = used.entry(which).or_default();
                let nested = known.iter().any(|other| encloses(forest, *other, index));
                known.insert(index);
                let found = FactUse {
                    place: place.clone(),
                    number: *number,
                    nested,
                };
                let mut uses = self.uses.borrow_mut();
                uses.entry(which).or_default().insert(address, found);
            }
        }
        self.add_statements(flow, forest, &mut anywhere);
        (anywhere, within)
    }

    /// Numbers of the loops of a function among those with headers in the same symbol.
    pub fn loop_numbers(&self, flow: &ControlFlowGraph, forest: &LoopForest) -> Vec<usize> {
        let mut seen: BTreeMap<Option<String>, usize> = BTreeMap::new();
        let mut known: BTreeMap<u32, usize> = BTreeMap::new();
        let headers = forest
            .loops
            .iter()
            .map(|found| flow.blocks[found.header].node.address);
        headers
            .map(|address| {
                *known.entry(address).or_insert_with(|| {
                    let symbol = self.image.place(address).symbol.map(|(name, _)| name);
                    let next = seen.entry(symbol).or_default();
                    *next += 1;
                    *next - 1
                })
            })
            .collect()
    }

    fn add_statements(
        &self,
        flow: &ControlFlowGraph,
        forest: &LoopForest,
        bounds: &mut [Option<u64>],
    ) {
        let statements = &self.annotations.statements;
        if statements.is_empty() || forest.loops.is_empty() {
            return;
        }
        let lines: Vec<BTreeSet<Line>> = (0..forest.loops.len())
            .map(|index| self.own_lines(flow, forest, index))
            .collect();
        let matching_lines: Vec<BTreeMap<usize, usize>> = lines
            .iter()
            .map(|own| matching_lines(statements, own))
            .collect();
        let choices: Vec<Option<usize>> = (0..matching_lines.len())
            .map(|index| match bounds[index] {
                Some(_) => None,
                None => choose_statement(statements, &matching_lines[index]),
            })
            .collect();
        for (index, chosen) in choices.iter().enumerate() {
            let Some(which) = *chosen else { continue };
            let ambiguous = (0..choices.len()).any(|other| {
                let related = encloses(forest, other, index) || encloses(forest, index, other);
                related && choices[other] == Some(which)
            });
            if !ambiguous {
                let fact = Fact {
                    iterations: statements[which].iterations,
                    ..Fact::default()
                };
                bounds[index] = header_executions(self, &fact, flow, forest, index);
                let header = flow.blocks[forest.loops[index].header].node.address;
                let mut uses = self.statement_uses.borrow_mut();
                uses.extend(bounds[index].map(|_| (header, which)));
            }
        }
    }

    /// Does a block end in a trap, or in a call of what facts say is never executed?
    fn ends_program(&self, flow: &ControlFlowGraph, block: usize) -> bool {
        let block = &flow.blocks[block];
        let mut calls = block.calls.iter();
        let calls_end = !block.calls.is_empty() && calls.all(|(at, _)| self.is_never_executed(*at));
        block.edges.is_empty() && (calls_end || block.transfer == Some(ControlTransfer::Dead))
    }

    /// Source lines of a loop's blocks that are in no inner loop.
    pub fn own_lines(
        &self,
        flow: &ControlFlowGraph,
        forest: &LoopForest,
        index: usize,
    ) -> BTreeSet<Line> {
        let blocks = forest.loops[index].blocks.iter();
        let own = blocks.filter(|block| forest.innermost[**block] == Some(index));
        let instructions = own.flat_map(|block| &flow.blocks[*block].instructions);
        instructions
            .filter_map(|(address, _)| self.image.place(*address).line)
            .collect()
    }
}

/// Is the second loop inside of the first?
fn encloses(forest: &LoopForest, outer: usize, inner: usize) -> bool {
    let mut around = forest.loops[inner].parent;
    while let Some(index) = around {
        if index == outer {
            return true;
        }
        around = forest.loops[index].parent;
    }
    false
}

/// How many lines of each statement are among a loop's own.
fn matching_lines(statements: &[Statement], own: &BTreeSet<Line>) -> BTreeMap<usize, usize> {
    let counts = statements.iter().enumerate().map(|(which, statement)| {
        let is_its = |(file, line): &&Line| statement.has(file, *line);
        (which, own.iter().filter(is_its).count())
    });
    counts.filter(|(_, count)| *count > 0).collect()
}

/// The outermost statement, of several the one with most lines; none if two have as many.
fn choose_statement(
    statements: &[Statement],
    matching_lines: &BTreeMap<usize, usize>,
) -> Option<usize> {
    let depth = matching_lines
        .keys()
        .map(|which| statements[*which].depth)
        .min()?;
    let outermost = matching_lines
        .iter()
        .filter(|(which, _)| statements[**which].depth == depth);
    let most = outermost.clone().map(|(_, count)| *count).max()?;
    let mut found = outermost.filter(|(_, count)| **count == most);
    let first = found.next()?;
    found.next().is_none().then_some(*first.0)
}

/// Header executions that a fact allows: iterations, and one more where the loop may be left
/// elsewhere than at the end of an iteration. A way on which the program ends does not leave it.
pub fn header_executions(
    facts: &Facts<'_>,
    fact: &Fact,
    flow: &ControlFlowGraph,
    forest: &LoopForest,
    index: usize,
) -> Option<u64> {
    if let Some(executions) = fact.header_executions {
        return Some(executions);
    }
    let found = &forest.loops[index];
    let leaves = |block: &usize| {
        let mut edges = flow.blocks[*block].edges.iter();
        edges.any(|edge| match edge.target {
            Target::Block(next) => !found.blocks.contains(&next) && !facts.ends_program(flow, next),
            Target::Return => true,
        })
    };
    let mut nested = found
        .blocks
        .iter()
        .filter(|block| !found.latches.contains(block));
    let leaves_early = nested.any(leaves);
    fact.iterations
        .map(|count| count.saturating_add(u64::from(leaves_early)))
}
