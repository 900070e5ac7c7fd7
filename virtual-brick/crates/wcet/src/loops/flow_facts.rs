// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Which loop a given number of iterations belongs to.
//!
//! A fact holds for the loops that begin at its place. One that names no line and no number of a
//! loop must say that it holds for every loop there, unless there is only one. A loop statement of
//! a source belongs to the loops that have code of its lines in no inner loop; where statements are
//! nested, to the outermost of them; where loops are nested that could both be meant, to none.

use crate::error::{Error, Place};
use crate::functions::program::Program;
use crate::graph::control_flow::{Entry, Flow, Target};
use crate::graph::loop_forest::Forest;
use crate::inputs::annotations::{Fact, Statement};
use std::collections::{BTreeMap, BTreeSet};

/// Header executions: anywhere, and while some function is under way.
pub type Given = (Vec<Option<u64>>, Vec<(usize, Entry, u64)>);

/// Loops for which each fact was used: by its number, then by the address of the header.
pub type Uses = BTreeMap<usize, BTreeMap<u32, Use>>;

/// A loop for which a fact was used.
#[derive(Clone, Debug)]
pub struct Use {
    place: Place,
    number: usize,
    inside: bool,
}

type Line = (String, u32);

impl Program<'_> {
    /// Header executions of all loops, as the user and the sources say.
    pub fn given_bounds(&self, flow: &Flow, forest: &Forest, numbers: &[usize]) -> Given {
        let count = forest.loops.len();
        let (mut anywhere, mut within) = (vec![None; count], Vec::new());
        let mut used: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (index, number) in numbers.iter().enumerate() {
            let address = flow.blocks[forest.loops[index].header].node.address;
            let place = self.image.place(address);
            let names = self.image.names_at(address);
            for (which, fact) in self.annotations.loops.iter().enumerate() {
                if !fact.matches(&place, &names, Some(*number)) {
                    continue;
                }
                let Some(bound) = header_executions(fact, flow, forest, index) else {
                    continue;
                };
                match fact.within.as_deref().map(|name| self.image.function(name)) {
                    None => anywhere[index] = anywhere[index].or(Some(bound)),
                    Some(Some(function)) => within.push((index, function, bound)),
                    Some(None) => continue,
                }
                let known = used.entry(which).or_default();
                let inside = known.iter().any(|other| encloses(forest, *other, index));
                known.insert(index);
                let found = Use {
                    place: place.clone(),
                    number: *number,
                    inside,
                };
                let mut uses = self.uses.borrow_mut();
                uses.entry(which).or_default().insert(address, found);
            }
        }
        self.add_statements(flow, forest, &mut anywhere);
        (anywhere, within)
    }

    /// Refuses facts that were used for several loops without saying that they hold for each.
    pub fn check_uses(&self) -> Result<(), Error> {
        for (which, loops) in self.uses.borrow().iter() {
            let fact = &self.annotations.loops[*which];
            let named = fact.line.is_some() || fact.index.is_some();
            let nested = loops.values().any(|found| found.inside);
            let places: BTreeSet<_> = loops.values().map(|found| found.whereabouts()).collect();
            if fact.every || !(nested || (!named && places.len() > 1)) {
                continue;
            }
            let each: Vec<String> = loops.values().map(Use::to_string).collect();
            return Err(Error::Input(format!(
                "{}: [[loop]] {} holds for {} loops: {}; give each its own with 'line', or with \
                 'symbol' and 'index', or add 'every = true' if the number holds for each of them",
                fact.source,
                fact.place(),
                loops.len(),
                each.join(", ")
            )));
        }
        Ok(())
    }

    fn add_statements(&self, flow: &Flow, forest: &Forest, bounds: &mut [Option<u64>]) {
        let statements = &self.annotations.statements;
        if statements.is_empty() || forest.loops.is_empty() {
            return;
        }
        let lines: Vec<BTreeSet<Line>> = (0..forest.loops.len())
            .map(|index| self.own_lines(flow, forest, index))
            .collect();
        let shares: Vec<BTreeMap<usize, usize>> =
            lines.iter().map(|own| shares(statements, own)).collect();
        let picks: Vec<Option<usize>> = (0..shares.len())
            .map(|index| match bounds[index] {
                Some(_) => None,
                None => pick(statements, &shares[index]),
            })
            .collect();
        for (index, picked) in picks.iter().enumerate() {
            let Some(which) = *picked else { continue };
            let doubtful = (0..picks.len()).any(|other| {
                let related = encloses(forest, other, index) || encloses(forest, index, other);
                related && picks[other] == Some(which)
            });
            if !doubtful {
                let fact = Fact {
                    iterations: statements[which].iterations,
                    ..Fact::default()
                };
                bounds[index] = header_executions(&fact, flow, forest, index);
            }
        }
    }

    /// Source lines of a loop's blocks that are in no inner loop.
    pub fn own_lines(&self, flow: &Flow, forest: &Forest, index: usize) -> BTreeSet<Line> {
        let blocks = forest.loops[index].blocks.iter();
        let own = blocks.filter(|block| forest.innermost[**block] == Some(index));
        let instructions = own.flat_map(|block| &flow.blocks[*block].instructions);
        instructions
            .filter_map(|(address, _)| self.image.place(*address).line)
            .collect()
    }
}

impl Use {
    /// File and line where they are known, so that copies of one loop count once.
    fn whereabouts(&self) -> (Option<&Line>, u32) {
        let line = self.place.line.as_ref();
        (line, line.map_or(self.place.address, |_| 0))
    }
}

impl std::fmt::Display for Use {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some((file, line)) = &self.place.line {
            write!(f, "{file}:{line}, ")?;
        }
        let symbol = self.place.symbol.as_ref();
        write!(
            f,
            "loop {} of {}",
            self.number,
            symbol.map_or("?", |(name, _)| name)
        )
    }
}

/// Is the second loop inside of the first?
fn encloses(forest: &Forest, outer: usize, inner: usize) -> bool {
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
fn shares(statements: &[Statement], own: &BTreeSet<Line>) -> BTreeMap<usize, usize> {
    let counts = statements.iter().enumerate().map(|(which, statement)| {
        let is_its = |(file, line): &&Line| statement.has(file, *line);
        (which, own.iter().filter(is_its).count())
    });
    counts.filter(|(_, count)| *count > 0).collect()
}

/// The outermost statement, of several the one with most lines; none if two have as many.
fn pick(statements: &[Statement], shares: &BTreeMap<usize, usize>) -> Option<usize> {
    let depth = shares.keys().map(|which| statements[*which].depth).min()?;
    let outermost = shares
        .iter()
        .filter(|(which, _)| statements[**which].depth == depth);
    let most = outermost.clone().map(|(_, count)| *count).max()?;
    let mut found = outermost.filter(|(_, count)| **count == most);
    let first = found.next()?;
    found.next().is_none().then_some(*first.0)
}

/// Header executions that a fact allows: iterations, and one more where the loop may be left
/// elsewhere than at the end of an iteration.
fn header_executions(fact: &Fact, flow: &Flow, forest: &Forest, index: usize) -> Option<u64> {
    if let Some(executions) = fact.header_executions {
        return Some(executions);
    }
    let found = &forest.loops[index];
    let leaves = |block: &usize| {
        let mut edges = flow.blocks[*block].edges.iter();
        edges.any(|edge| match edge.target {
            Target::Block(next) => !found.blocks.contains(&next),
            Target::Return => true,
        })
    };
    let mut inside = found
        .blocks
        .iter()
        .filter(|block| !found.latches.contains(block));
    let leaves_early = inside.any(leaves);
    fact.iterations
        .map(|count| count.saturating_add(u64::from(leaves_early)))
}
