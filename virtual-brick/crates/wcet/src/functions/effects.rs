// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What code does to other threads although its own time has no bound: a background thread, or
//! what a task does before its first release. Critical sections must be bounded, loops outside of
//! them need not end.

use crate::elapsed::UNBOUNDED;
use crate::error::Error;
use crate::functions::execution::{combined_bound, execute, longest_call, repeats};
use crate::functions::function_bound::FunctionBound;
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::inputs::image::Entry;
use crate::paths::block_cost::{edge_costs, edge_cycles};
use crate::paths::critical_section::{critical_sections, merge, CriticalSections};
use crate::paths::longest_path::PathProblem;
use crate::values::block_interpreter::{any_arguments, as_arguments, deeper};
use crate::values::records::BlockRecord;
use crate::values::state::State;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// What a function with all it calls does to other threads.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// Longest critical sections.
    pub sections: CriticalSections,
    /// Addresses of all functions that may be executed.
    pub functions: BTreeSet<u32>,
    /// Stack below the stack pointer at entry; none when not bounded.
    pub stack_bytes: Option<u32>,
    /// The instruction at which the depth of the stack is lost, if it is not bounded.
    pub stack_lost: Option<u32>,
}

/// Addresses of a function and of all that it calls, in the contexts of these calls; what those
/// call that are `left_out`, and these themselves, are not looked at.
pub fn collect_functions(
    bound: &FunctionBound,
    left_out: &dyn Fn(Entry) -> bool,
    seen: &mut BTreeSet<u32>,
) {
    let (mut open, mut visited) = (vec![bound], BTreeSet::new());
    while let Some(bound) = open.pop() {
        if visited.insert(std::ptr::from_ref(bound)) && !left_out(bound.entry) {
            seen.insert(bound.entry.0);
            seen.extend(&bound.functions);
            let calls = bound.blocks.iter().flat_map(|block| &block.calls);
            open.extend(calls.map(Rc::as_ref));
        }
    }
}

/// Which calls that never return are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Endless {
    /// All of them: the code runs on in the background.
    Followed,
    /// None: such a call ends the program.
    EndsProgram,
}

/// Effects of a function called with any arguments, whether or not it ever returns.
pub fn effects(program: &Program<'_>, entry: Entry, endless: Endless) -> Result<Effects, Error> {
    Search::new(program, endless, true).function(entry)
}

/// Effects of the part of a function with which it begins; calls that never return end the program.
pub fn effects_of_part(
    program: &Program<'_>,
    entry: Entry,
    part: &FunctionSummary,
) -> Result<Effects, Error> {
    Search::new(program, Endless::EndsProgram, true).graph(entry, part)
}

/// Stack of a function and the functions that it may execute, whether or not it ever returns. What
/// has no bound in time, also in a critical section, does not matter.
pub fn stack_of(program: &Program<'_>, entry: Entry) -> Result<Effects, Error> {
    Search::new(program, Endless::Followed, false).function(entry)
}

struct Search<'p, 'a> {
    program: &'p Program<'a>,
    endless: Endless,
    /// Else time has no part in what is searched.
    sections_wanted: bool,
    /// Functions without a bound; while one is searched, nothing is known of it.
    known: BTreeMap<Entry, Effects>,
}

/// Calls at the end of a block: those with a bound, and why others have none.
struct Calls {
    bounded: Vec<Rc<FunctionBound>>,
    unbounded: Option<Error>,
}

impl<'p, 'a> Search<'p, 'a> {
    fn new(program: &'p Program<'a>, endless: Endless, sections_wanted: bool) -> Self {
        Self {
            program,
            endless,
            sections_wanted,
            known: BTreeMap::new(),
        }
    }

    fn function(&mut self, entry: Entry) -> Result<Effects, Error> {
        if let Some(known) = self.known.get(&entry) {
            return Ok(known.clone());
        }
        self.known.insert(entry, Effects::default());
        let summary = self.program.summary(entry, entry.0)?;
        let found = self.graph(entry, &summary)?;
        self.known.insert(entry, found.clone());
        Ok(found)
    }

    fn graph(&mut self, entry: Entry, summary: &FunctionSummary) -> Result<Effects, Error> {
        let mut found = Effects {
            stack_bytes: Some(0),
            functions: BTreeSet::from([entry.0]),
            ..Effects::default()
        };
        if summary.avoided.first() != Some(&true) {
            self.own(entry, summary, &mut found)?;
        }
        Ok(found)
    }

    /// Adds a function's own effects and those of what it calls.
    fn own(
        &mut self,
        entry: Entry,
        summary: &FunctionSummary,
        found: &mut Effects,
    ) -> Result<(), Error> {
        let executed = execute(self.program, entry, summary, State::entry(&any_arguments()));
        let (flow, forest) = (&summary.flow, &summary.forest);
        let mut cycles = Vec::new();
        for (index, block) in flow.blocks.iter().enumerate() {
            let record = &executed.records[index];
            let calls = self.calls(&block.calls, record, found)?;
            let in_section = self.sections_wanted && record.urgency.is_some();
            if let (Some(error), true) = (calls.unbounded, in_section) {
                return Err(error);
            }
            found.stack_bytes = deeper(found.stack_bytes, record.depth_bytes);
            found.stack_lost = found.stack_lost.or(record.depth_lost);
            let longest = longest_call(&calls.bounded, record, false);
            let costs = edge_costs(block, &summary.costs[index], record, &longest);
            cycles.push(costs.iter().map(edge_cycles).collect());
        }
        if !self.sections_wanted {
            return Ok(());
        }
        let annotated = summary.limits_within(&[entry]);
        let findings = executed.findings.iter().zip(&annotated);
        let problem = PathProblem {
            flow,
            forest,
            cycles: &cycles,
            bounds: &findings.map(combined_bound).collect::<Vec<_>>(),
            repeats: &repeats(&executed.findings, forest),
        };
        merge(
            &mut found.sections,
            &critical_sections(&problem, &executed.records)?,
        );
        Ok(())
    }

    /// Adds the effects of the calls at the end of a block.
    fn calls(
        &mut self,
        callees: &[Entry],
        record: &BlockRecord,
        found: &mut Effects,
    ) -> Result<Calls, Error> {
        let mut calls = Calls {
            bounded: Vec::new(),
            unbounded: None,
        };
        let arguments = record.arguments.as_ref().map(as_arguments);
        let reached = callees
            .iter()
            .filter(|callee| record.callees.contains(callee));
        for (callee, known) in reached.flat_map(|c| arguments.iter().map(move |a| (*c, a))) {
            let (stack_bytes, stack_lost) = match self.program.bound(callee, known) {
                Ok(bound) => {
                    if !self.program.conventions.unlocks.contains(&callee.0) {
                        merge(&mut found.sections, &bound.sections);
                    }
                    collect_functions(&bound, &|_| false, &mut found.functions);
                    let stack = (bound.stack_bytes, bound.stack_lost);
                    calls.bounded.push(bound);
                    stack
                }
                Err(Error::NeverReturns(_)) if self.endless == Endless::EndsProgram => continue,
                Err(error)
                    if !self.sections_wanted
                        || matches!(error, Error::NeverReturns(_) | Error::MissingBounds(_)) =>
                {
                    let inner = self.function(callee)?;
                    merge(&mut found.sections, &inner.sections);
                    found.functions.extend(&inner.functions);
                    let in_context = record.callee_elapsed.as_ref().map(|own| own.cycles);
                    match in_context.filter(|cycles| *cycles != UNBOUNDED) {
                        Some(cycles) => calls.bounded.push(Rc::new(FunctionBound {
                            cycles,
                            ..FunctionBound::uncharged(callee)
                        })),
                        None if matches!(error, Error::MissingBounds(_)) => {
                            calls.unbounded = calls.unbounded.or(Some(error));
                        }
                        None => {}
                    }
                    (inner.stack_bytes, inner.stack_lost)
                }
                Err(error) => return Err(error),
            };
            let deepest = record.depth_of_call(stack_bytes);
            found.stack_bytes = deeper(found.stack_bytes, deepest);
            found.stack_lost = found
                .stack_lost
                .or(stack_lost.filter(|_| deepest.is_none()));
        }
        Ok(calls)
    }
}
