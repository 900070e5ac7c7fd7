// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A function executed on abstract values, and what its loops and calls make of that.

use std::rc::Rc;

use crate::elapsed::{Elapsed, UNBOUNDED};
use crate::functions::context_sensitive_calls::ContextSensitiveCalls;
use crate::functions::function_bound::FunctionBound;
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::graph::loop_forest::LoopForest;
use crate::inputs::image::Entry;
use crate::loops::abstract_execution::{AbstractExecution, LoopFinding};
use crate::values::block_interpreter::BlockInterpreter;
use crate::values::records::BlockRecord;
use crate::values::state::State;

/// What executing a function on abstract values shows.
pub struct Executed {
    /// Of each loop.
    pub findings: Vec<LoopFinding>,
    /// Of each block.
    pub records: Vec<BlockRecord>,
    /// Longest path with calls analysed in their context, if each loop on it has a bound.
    pub elapsed: Option<Elapsed>,
}

/// Executes a function on abstract values, from a state at its entry.
pub fn execute(
    program: &Program<'_>,
    entry: Entry,
    summary: &FunctionSummary,
    state: State,
) -> Executed {
    let (flow, forest) = (&summary.flow, &summary.forest);
    let calls = ContextSensitiveCalls::new(program, entry, false);
    let mut interpreter = BlockInterpreter::new(program.environment(), flow, &summary.callees);
    interpreter.costs = &summary.costs;
    interpreter.calls = Some(&calls);
    interpreter.avoided = &summary.avoided;
    let limits = summary.limits_within(&[entry]);
    let mut execution =
        AbstractExecution::new(interpreter, forest, limits, program.undecided_limit);
    let returned = execution.run(state);
    program.note_steps(execution.interpreter.step_count);
    let (active, returns) = (program.bounding.borrow(), !returned.is_empty());
    program.note_contradictions(summary, &execution.findings, &active, returns);
    drop(active);
    let longest = returned.iter().map(|state| &state.elapsed);
    let longest = longest.max_by_key(|elapsed| elapsed.cycles);
    Executed {
        elapsed: longest.filter(|own| own.cycles != UNBOUNDED).cloned(),
        findings: execution.findings,
        records: execution.interpreter.records,
    }
}

/// The smaller of what was found and what was annotated.
pub fn combined_bound((finding, annotated): (&LoopFinding, &Option<u64>)) -> Option<u64> {
    if finding.unbounded {
        return *annotated;
    }
    let found = finding.header_executions;
    Some(annotated.map_or(found, |annotated| annotated.min(found)))
}

/// Repetitions of inner loops, where both the loop and the one around it were executed exactly.
pub fn repeats(findings: &[LoopFinding], forest: &LoopForest) -> Vec<Option<u64>> {
    let exact = |index: usize| !findings[index].unbounded;
    let all = forest.loops.iter().enumerate().map(|(index, found)| {
        let parent = found.parent?;
        (exact(index) && exact(parent)).then_some(findings[index].repeats)
    });
    all.collect()
}

/// The call at the end of a block, without the fetches after its return.
pub fn longest_call(calls: &[Rc<FunctionBound>], record: &BlockRecord, recorded: bool) -> Elapsed {
    let mut longest = Elapsed::begin(recorded);
    let any_context = calls.iter().max_by_key(|bound| bound.cycles);
    let in_context = record.callee_elapsed.as_ref();
    match (in_context, any_context) {
        (_, None) => {}
        (Some(own), Some(bound)) if own.cycles <= bound.cycles => longest.add_path(own),
        (_, Some(bound)) => {
            longest.add_bound(bound.entry.0, bound.cycles, bound.path.as_ref());
        }
    }
    longest
}
