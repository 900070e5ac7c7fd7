// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A function executed on what is known about its arguments, loop by loop and iteration by
//! iteration. A loop whose state has no path back has that many iterations; one whose state
//! repeats, or that takes too long, has no bound of its own.

use crate::elapsed::UNBOUNDED;
use crate::graph::control_flow::{ControlFlowGraph, Target};
use crate::graph::loop_forest::{Item, LoopForest};
use crate::values::block_interpreter::BlockInterpreter;
use crate::values::state::State;
use std::collections::BTreeMap;

/// Instructions executed in one visit of a loop before it gives up.
const STEP_LIMIT: u64 = 2_000_000;

/// Iterations in a row after which a loop that may be left everywhere gives up.
pub const UNDECIDED_LIMIT: u64 = 4096;

/// What was found out about a loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopFinding {
    /// Most executions of the header for one entry.
    pub header_executions: u64,
    /// No bound was found.
    pub unbounded: bool,
    /// It ended because the user's bound was reached.
    pub ended_by_fact: bool,
    /// The user's bound, if some entry certainly exceeds it.
    pub contradiction: Option<u64>,
    /// Most header executions beyond the first of each entry, added up over one entry of the
    /// loop around it.
    pub repeats: u64,
    /// The same since the loop around it was last entered.
    repeats_so_far: u64,
}

/// Executes a function.
pub struct AbstractExecution<'a, 'w> {
    /// Executes blocks and records what is known about them.
    pub interpreter: BlockInterpreter<'w>,
    /// The function's loops.
    pub forest: &'a LoopForest,
    /// Findings, for each loop.
    pub findings: Vec<LoopFinding>,
    /// Iterations after which a loop ends, by flow facts.
    pub limits: Vec<Option<u64>>,
    /// Instructions executed in one visit of a loop before it gives up.
    pub step_limit: u64,
    /// Iterations in a row after which a loop that may be left everywhere gives up.
    undecided_limit: u64,
    /// Look seldom whether a state repeats: few do, and comparing them needs a copy of memory.
    pub compare_rarely: bool,
    /// Most states at a block that are not joined.
    pub max_partitions: usize,
}

/// States on the edges that leave a scope, by block and edge.
pub type Exits = BTreeMap<(usize, usize), State>;

struct Pass {
    back: Option<State>,
    exits: Exits,
}

/// One state for all of them.
fn joined(states: Vec<State>) -> Option<State> {
    states.into_iter().reduce(|all, state| all.join(&state))
}

/// Adds a state to those at a block. It is joined to one with the same memory and, where there are
/// too many, to the one whose path is most nearly as long.
fn add_to_partition(states: &mut Vec<State>, state: State, most: usize) {
    let distance = |known: &State| known.elapsed.cycles.abs_diff(state.elapsed.cycles);
    let nearest = || (0..states.len()).min_by_key(|index| distance(&states[*index]));
    let position = if most == 1 {
        nearest()
    } else {
        let alike = states.iter().position(|k| k.memory == state.memory);
        alike.or_else(|| nearest().filter(|_| states.len() >= most))
    };
    match position {
        Some(index) => states[index] = states[index].join(&state),
        None => states.push(state),
    }
}

fn join_into(place: &mut Option<State>, state: State) {
    *place = Some(match place.take() {
        Some(old) => old.join(&state),
        None => state,
    });
}

impl<'a, 'w> AbstractExecution<'a, 'w> {
    /// An execution that has found out nothing.
    pub fn new(
        interpreter: BlockInterpreter<'w>,
        forest: &'a LoopForest,
        limits: Vec<Option<u64>>,
        undecided_limit: u64,
    ) -> Self {
        Self {
            interpreter,
            forest,
            findings: vec![LoopFinding::default(); forest.loops.len()],
            limits,
            step_limit: STEP_LIMIT,
            undecided_limit,
            compare_rarely: false,
            max_partitions: 1,
        }
    }

    /// Executes the function from its entry; the states at its returns.
    pub fn run(&mut self, entry: State) -> Vec<State> {
        self.pass(None, 0, entry).exits.into_values().collect()
    }

    /// The scope's blocks once, in order, from its first block.
    fn pass(&mut self, scope: Option<usize>, first: usize, entry: State) -> Pass {
        // Few at a time: a list is quicker than a map.
        let mut states = vec![(first, vec![entry])];
        let mut back = Vec::new();
        let mut result = Pass {
            back: None,
            exits: Exits::new(),
        };
        let (forest, max_partitions) = (self.forest, self.max_partitions);
        for item in forest.steps(scope) {
            let header = match item {
                Item::Block(block) => block,
                Item::Loop(index) => forest.loops[index].header,
            };
            let Some(position) = states.iter().position(|(block, _)| *block == header) else {
                continue;
            };
            let (_, here) = states.swap_remove(position);
            let mut leave =
                |flow: &ControlFlowGraph, (block, edge): (usize, usize), state| match flow.blocks
                    [block]
                    .edges[edge]
                    .target
                {
                    Target::Block(next) if scope.is_some() && next == first => {
                        add_to_partition(&mut back, state, max_partitions);
                    }
                    Target::Block(next) if forest.contains(scope, next) => {
                        match states.iter_mut().find(|(block, _)| *block == next) {
                            Some((_, known)) => add_to_partition(known, state, max_partitions),
                            None => states.push((next, vec![state])),
                        }
                    }
                    _ => add_exit(&mut result.exits, (block, edge), state),
                };
            match item {
                Item::Block(block) => {
                    for state in here {
                        for (edge, state) in self.interpreter.run(block, state).edges {
                            leave(self.interpreter.flow, (block, edge), state);
                        }
                    }
                }
                Item::Loop(index) => {
                    let exits = joined(here).map(|state| self.run_loop(index, state));
                    for (edge, state) in exits.into_iter().flatten() {
                        leave(self.interpreter.flow, edge, state);
                    }
                }
            }
        }
        result.back = joined(back);
        result
    }

    fn run_loop(&mut self, index: usize, mut state: State) -> Exits {
        let header = self.forest.loops[index].header;
        let mut exits = Exits::new();
        let mut entry = state.clone();
        if self.compare_rarely {
            entry.memory = None;
        }
        let (mut count, mut undecided) = (0_u64, 0);
        let exit_count = self.forest.loops[index].exit_count;
        let steps_before = self.interpreter.step_count;
        self.start_inner(index);
        while !self.findings[index].unbounded {
            count += 1;
            let compared = !self.compare_rarely || count.is_power_of_two();
            let before = compared.then(|| state.clone());
            let repeats_before = self.inner_repeats(index);
            let mut pass = self.pass(Some(index), header, state);
            undecided = if pass.exits.len() == exit_count {
                undecided + 1
            } else {
                0
            };
            if before.is_some() && before == pass.back {
                if let Some(limit) = self.limits[index].filter(|limit| *limit > count) {
                    let again = limit - count;
                    self.repeat(index, &repeats_before, again);
                    add_repetitions(&mut pass, before.as_ref(), again);
                    count = limit;
                }
            }
            add_exits(&mut exits, pass.exits);
            let ended_by_fact = self.limits[index].is_some_and(|limit| count >= limit);
            let finding = &mut self.findings[index];
            let never_left = exits.is_empty() && exit_count > 0 && pass.back.is_some();
            if ended_by_fact && never_left {
                finding.contradiction = self.limits[index];
            }
            finding.ended_by_fact |= ended_by_fact && pass.back.is_some();
            let Some(back) = pass.back.filter(|_| !ended_by_fact) else {
                finding.header_executions = finding.header_executions.max(count);
                finding.repeats_so_far += count - 1;
                self.end_inner(index);
                return exits;
            };
            if before.as_ref() == Some(&back)
                || undecided > self.undecided_limit
                || self.interpreter.step_count - steps_before > self.step_limit
            {
                self.findings[index].unbounded = true;
                self.interpreter.step_count = steps_before;
            }
            state = back;
        }
        let before = entry.elapsed.clone();
        let mut exits = self.run_unbounded(index, entry.join(&state));
        for state in exits.values_mut() {
            let own = std::mem::replace(&mut state.elapsed, before.clone());
            state.elapsed.add_path(&own);
        }
        exits
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

    fn inner_repeats(&self, index: usize) -> Vec<u64> {
        let inner = self.inner(index).into_iter();
        inner.map(|i| self.findings[i].repeats_so_far).collect()
    }

    /// The last pass is made `again` times more, each time in the same state.
    fn repeat(&mut self, index: usize, before: &[u64], again: u64) {
        for (inner, before) in self.inner(index).into_iter().zip(before) {
            let so_far = &mut self.findings[inner].repeats_so_far;
            *so_far = so_far.saturating_add(again.saturating_mul(*so_far - before));
        }
    }

    fn end_inner(&mut self, index: usize) {
        for inner in self.inner(index) {
            let finding = &mut self.findings[inner];
            finding.repeats = finding.repeats.max(finding.repeats_so_far);
        }
    }

    /// Repeats until the state at the header covers every iteration. Its exits cost as many
    /// of the most expensive iterations as flow facts allow.
    fn run_unbounded(&mut self, index: usize, entry: State) -> Exits {
        let header = self.forest.loops[index].header;
        let mut state = entry;
        loop {
            let begin = state.elapsed.restarted();
            state.elapsed = begin.clone();
            let mut pass = self.pass(Some(index), header, state.clone());
            let Some(back) = pass.back else {
                return pass.exits;
            };
            let map = self.interpreter.environment.map;
            let wider = state.widen(&back, 0, |value| map.pointer_region(value));
            if wider == state {
                let again = self.limits[index].map_or(UNBOUNDED, |limit| limit.max(1) - 1);
                let exits = pass.exits.values_mut();
                exits.for_each(|state| state.elapsed.add_repeated(&begin, &back.elapsed, again));
                return pass.exits;
            }
            state = wider;
        }
    }
}

/// Adds the cycles of further passes, each as long as this one.
fn add_repetitions(pass: &mut Pass, before: Option<&State>, again: u64) {
    let (Some(before), Some(back)) = (before, &pass.back) else {
        return;
    };
    let (begin, end) = (&before.elapsed, back.elapsed.clone());
    let states = pass.exits.values_mut().chain(&mut pass.back);
    states.for_each(|state| state.elapsed.add_repeated(begin, &end, again));
}

fn add_exit(exits: &mut Exits, edge: (usize, usize), state: State) {
    let mut place = exits.remove(&edge);
    join_into(&mut place, state);
    exits.extend(place.map(|state| (edge, state)));
}

fn add_exits(exits: &mut Exits, more: Exits) {
    for (edge, state) in more {
        add_exit(exits, edge, state);
    }
}
