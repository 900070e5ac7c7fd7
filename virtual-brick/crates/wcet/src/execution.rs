// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A function executed on what is known about its arguments, loop by loop and iteration by
//! iteration. A loop whose state runs out of ways back has that many iterations; one whose state
//! repeats, or that takes too long, has no bound of its own.

use crate::flow::Target;
use crate::loops::{Forest, Item};
use crate::state::State;
use crate::walk::Walker;
use std::collections::BTreeMap;

/// Instructions executed in one visit of a loop before it gives up.
const PATIENCE: u64 = 2_000_000;

/// Iterations in a row after which a loop that may be left everywhere gives up.
const UNDECIDED: u64 = 4096;

/// What was found out about a loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopFinding {
    /// Most executions of the header for one entry.
    pub header_executions: u64,
    /// No bound was found.
    pub unbounded: bool,
    /// Most header executions beyond the first of each entry, added up over one entry of the
    /// loop around it.
    pub repeats: u64,
    /// The same since the loop around it was last entered.
    repeats_so_far: u64,
}

/// Executes a function.
pub struct Execution<'a, 'w> {
    /// Executes blocks and keeps what is learned.
    pub walker: Walker<'w>,
    /// The function's loops.
    pub forest: &'a Forest,
    /// Findings, for each loop.
    pub findings: Vec<LoopFinding>,
    /// Iterations after which a loop's bound is left to the user's.
    pub limits: Vec<Option<u64>>,
}

/// States on the edges that leave a scope, by block and edge.
type Exits = BTreeMap<(usize, usize), State>;

struct Pass {
    back: Option<State>,
    exits: Exits,
}

fn merge(place: &mut Option<State>, state: State) {
    *place = Some(match place.take() {
        Some(old) => old.join(&state),
        None => state,
    });
}

impl Execution<'_, '_> {
    /// Executes the function from its entry.
    pub fn run(&mut self, entry: State) {
        let _ = self.pass(None, 0, entry);
    }

    /// The scope's blocks once, in order, from its first block.
    fn pass(&mut self, scope: Option<usize>, first: usize, entry: State) -> Pass {
        let mut states: BTreeMap<usize, State> = BTreeMap::from([(first, entry)]);
        let mut result = Pass {
            back: None,
            exits: Exits::new(),
        };
        let forest = self.forest;
        for item in forest.steps(scope) {
            let leaving: Vec<((usize, usize), State)> = match item {
                Item::Block(block) => {
                    let Some(state) = states.remove(&block) else {
                        continue;
                    };
                    let edges = self.walker.run(block, state).edges;
                    edges
                        .into_iter()
                        .map(|(e, state)| ((block, e), state))
                        .collect()
                }
                Item::Loop(index) => {
                    let Some(state) = states.remove(&forest.loops[index].header) else {
                        continue;
                    };
                    self.run_loop(index, state).into_iter().collect()
                }
            };
            for ((block, edge), state) in leaving {
                match self.walker.flow.blocks[block].edges[edge].target {
                    Target::Block(next) if scope.is_some() && next == first => {
                        merge(&mut result.back, state);
                    }
                    Target::Block(next) if forest.contains(scope, next) => {
                        let mut place = states.remove(&next);
                        merge(&mut place, state);
                        states.extend(place.map(|state| (next, state)));
                    }
                    _ => add_exit(&mut result.exits, (block, edge), state),
                }
            }
        }
        result
    }

    fn run_loop(&mut self, index: usize, entry: State) -> Exits {
        let header = self.forest.loops[index].header;
        let mut exits = Exits::new();
        let mut state = entry.clone();
        let (mut count, mut undecided) = (0, 0);
        let exit_count = self.exit_count(index);
        let steps_before = self.walker.step_count;
        self.start_inner(index);
        while !self.findings[index].unbounded {
            let pass = self.pass(Some(index), header, state.clone());
            count += 1;
            undecided = if pass.exits.len() == exit_count {
                undecided + 1
            } else {
                0
            };
            add_exits(&mut exits, pass.exits);
            let Some(back) = pass.back else {
                let finding = &mut self.findings[index];
                finding.header_executions = finding.header_executions.max(count);
                finding.repeats_so_far += count - 1;
                self.end_inner(index);
                return exits;
            };
            let late = self.limits[index].is_some_and(|limit| count > limit);
            if back == state
                || late
                || undecided > UNDECIDED
                || self.walker.step_count - steps_before > PATIENCE
            {
                self.findings[index].unbounded = true;
                self.walker.step_count = steps_before;
            }
            state = back;
        }
        self.run_unbounded(index, entry.join(&state), exits)
    }

    fn inner(&self, index: usize) -> Vec<usize> {
        let loops = &self.forest.loops;
        let all = 0..loops.len();
        all.filter(|inner| loops[*inner].parent == Some(index))
            .collect()
    }

    fn start_inner(&mut self, index: usize) {
        for inner in self.inner(index) {
            self.findings[inner].repeats_so_far = 0;
        }
    }

    fn end_inner(&mut self, index: usize) {
        for inner in self.inner(index) {
            let finding = &mut self.findings[inner];
            finding.repeats = finding.repeats.max(finding.repeats_so_far);
        }
    }

    fn exit_count(&self, index: usize) -> usize {
        let blocks = &self.forest.loops[index].blocks;
        let edges = blocks
            .iter()
            .flat_map(|block| &self.walker.flow.blocks[*block].edges);
        edges
            .filter(|edge| match edge.target {
                Target::Block(next) => !blocks.contains(&next),
                Target::Return => true,
            })
            .count()
    }

    /// Repeats until the state at the header covers every iteration.
    fn run_unbounded(&mut self, index: usize, entry: State, mut exits: Exits) -> Exits {
        let header = self.forest.loops[index].header;
        let mut state = entry;
        loop {
            let pass = self.pass(Some(index), header, state.clone());
            add_exits(&mut exits, pass.exits);
            let Some(back) = pass.back else {
                return exits;
            };
            let map = self.walker.world.map;
            let wider = state.widen(&back, |value| map.pointer_region(value));
            if wider == state {
                return exits;
            }
            state = wider;
        }
    }
}

fn add_exit(exits: &mut Exits, edge: (usize, usize), state: State) {
    let mut place = exits.remove(&edge);
    merge(&mut place, state);
    exits.extend(place.map(|state| (edge, state)));
}

fn add_exits(exits: &mut Exits, more: Exits) {
    for (edge, state) in more {
        add_exit(exits, edge, state);
    }
}
