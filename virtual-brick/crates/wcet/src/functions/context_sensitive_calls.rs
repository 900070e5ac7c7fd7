// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Context-sensitive interprocedural analysis: a callee is executed in the state of its caller,
//! with its frame, its arguments and, where it is known, memory. The cycles of the callee are added
//! to the path on which it is called. The context is the whole call string, as far as the budget of
//! steps reaches; beyond, a callee costs what it costs for its arguments alone.

use crate::elapsed::{Elapsed, UNBOUNDED};
use crate::error::Error;
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::inputs::image::Entry;
use crate::loops::abstract_execution::AbstractExecution;
use crate::values::block_interpreter::{as_arguments, BlockInterpreter, CallHandler, CallOutcome};
use crate::values::state::State;
use crate::values::value::{Value, RUNNING};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::rc::Rc;

/// Stack of the host for programs whose memory is known: the analysis recurs with the calls.
pub const STACK_BYTES: usize = 1 << 30;

/// Longest call string.
const CALL_DEPTH: usize = 2_000;

/// Instructions executed in the contexts of all calls for one bound.
const CONTEXT_STEPS: u64 = 400_000;

/// The same where memory is known, also for one visit of a loop.
const KNOWN_MEMORY_STEPS: u64 = 4_000_000_000;

/// Instructions executed in one visit of a loop where inputs may be anything: a loop whose end
/// depends on them stays unbounded.
const INPUT_LOOP_STEPS: u64 = 2_000_000;

/// States with different memory that are not joined where paths meet (trace partitioning), where
/// inputs may be anything.
const MAX_PARTITIONS: usize = 16;

/// Analyses calls in their context until the budget of steps is used up.
pub struct ContextSensitiveCalls<'p, 'a> {
    program: &'p Program<'a>,
    steps_left: Cell<u64>,
    /// Address of the host's stack at the beginning.
    host_stack_begin: usize,
    call_string: RefCell<Vec<Entry>>,
    /// Nothing but the program writes to memory, and recursion is analysed too.
    memory_known: bool,
    /// Instructions executed in one visit of a loop where memory is known.
    step_limit: Cell<u64>,
    /// States that are not joined where paths meet.
    max_partitions: usize,
    /// Loops without a bound where memory is known, by function and number.
    unbounded: RefCell<BTreeSet<(Entry, usize)>>,
    /// Why a call has no bound where memory is known.
    failed: RefCell<Option<Error>>,
}

impl<'p, 'a> ContextSensitiveCalls<'p, 'a> {
    /// For calls made by `root`.
    pub fn new(program: &'p Program<'a>, root: Entry, memory_known: bool) -> Self {
        Self {
            program,
            steps_left: Cell::new(if memory_known {
                KNOWN_MEMORY_STEPS
            } else {
                CONTEXT_STEPS
            }),
            host_stack_begin: host_stack_address(),
            call_string: RefCell::new(vec![root]),
            memory_known,
            step_limit: Cell::new(KNOWN_MEMORY_STEPS),
            max_partitions: 1,
            unbounded: RefCell::default(),
            failed: RefCell::default(),
        }
    }

    /// The same where some of what memory holds is not known.
    pub fn with_inputs(self) -> Self {
        Self {
            step_limit: Cell::new(INPUT_LOOP_STEPS),
            max_partitions: MAX_PARTITIONS,
            ..self
        }
    }

    /// Why not all paths could be executed.
    pub fn failure(&self) -> Error {
        let unbounded = self.unbounded.borrow();
        let missing = unbounded.iter().filter_map(|(entry, index)| {
            let summary = self.program.summary(*entry, entry.0).ok()?;
            Some(summary.missing_bound(&self.program.facts, *index))
        });
        let missing: Vec<_> = missing.collect();
        if missing.is_empty() {
            let unknown = || Error::Input("not all paths could be executed".into());
            return self.failed.borrow().clone().unwrap_or_else(unknown);
        }
        Error::MissingBounds(missing)
    }

    /// Notes loops without a bound. After the first one the analysis takes no more steps in loops:
    /// its result is not used.
    fn note_unbounded(&self, execution: &AbstractExecution<'_, '_>) {
        let call_string = self.call_string.borrow();
        let Some(entry) = call_string
            .last()
            .copied()
            .filter(|_| self.step_limit.get() > 0)
        else {
            return;
        };
        let limits = &execution.limits;
        let findings = execution.findings.iter().enumerate();
        let without_bound = findings.filter(|(index, f)| f.unbounded && limits[*index].is_none());
        let mut unbounded = self.unbounded.borrow_mut();
        unbounded.extend(without_bound.map(|(index, _)| (entry, index)));
        if !unbounded.is_empty() {
            self.step_limit.set(0);
        }
    }

    /// Executes a function on a state that holds at its entry; the joined states at its returns,
    /// and its deepest stack with what it calls.
    pub fn execute(&self, summary: &FunctionSummary, state: State) -> Option<(State, Option<u32>)> {
        let (flow, forest) = (&summary.flow, &summary.forest);
        if summary.avoided.first() == Some(&true) {
            return None;
        }
        let mut interpreter =
            BlockInterpreter::without_records(self.program.environment(), flow, &summary.callees);
        interpreter.costs = &summary.costs;
        interpreter.calls = Some(self);
        interpreter.avoided = &summary.avoided;
        let limits = summary.limits_within(&self.call_string.borrow());
        let mut execution =
            AbstractExecution::new(interpreter, forest, limits, self.program.undecided_limit);
        if self.memory_known {
            execution.interpreter.visits = Some(&summary.visits);
            execution.step_limit = self.step_limit.get();
            execution.compare_rarely = true;
            execution.max_partitions = self.max_partitions;
        }
        let returned = execution.run(state);
        let steps = execution.interpreter.step_count;
        self.program.note_steps(steps);
        let (findings, returns) = (&execution.findings, !returned.is_empty());
        self.program
            .note_contradictions(summary, findings, &self.call_string.borrow(), returns);
        self.note_unbounded(&execution);
        self.steps_left
            .set(self.steps_left.get().saturating_sub(steps));
        let after = returned.into_iter().reduce(|a, b| a.join(&b))?;
        Some((after, execution.interpreter.deepest_bytes))
    }

    /// The summary of a callee that is analysed in its context and, where it is known, the caller's
    /// stack pointer. `None` when the budget is used up or the context says nothing.
    fn calling_context(
        &self,
        callee: Entry,
        state: &State,
    ) -> Option<(Rc<FunctionSummary>, Option<i32>)> {
        let pointer = match (&state.registers[13], self.memory_known) {
            (Value::Stack(pointer), _) => Some(*pointer),
            (Value::Constant(_), true) => Some(0),
            (_, true) => return None,
            _ => None,
        };
        let recursive = self.call_string.borrow().contains(&callee)
            || self.program.facts.recursion(callee).is_some();
        // A path without a bound gets none in a context.
        let unbounded = state.elapsed.cycles == UNBOUNDED && !self.memory_known;
        let deep = self.call_string.borrow().len() >= CALL_DEPTH
            || self.host_stack_begin.abs_diff(host_stack_address()) > STACK_BYTES / 4 * 3;
        let failed = self.failed.borrow().is_some();
        let exhausted = unbounded || failed || self.steps_left.get() == 0 || deep;
        if exhausted || (recursive && !self.memory_known) {
            return None;
        }
        let summary = self.program.summary(callee, callee.0).ok()?;
        Some((summary, pointer))
    }

    /// A callee whose caller's frame has no known place: its context is its arguments alone.
    fn analyse_without_frame(
        &self,
        callee: Entry,
        state: State,
        summary: &FunctionSummary,
    ) -> CallOutcome {
        let arguments = std::array::from_fn(|n| state.registers[n].clone());
        let mut inner = State::entry(&as_arguments(&arguments));
        inner.elapsed = state.elapsed.restarted();
        inner.urgencies.clone_from(&state.urgencies);
        if self.program.conventions.unlocks.contains(&callee.0) {
            inner.mask_count = None;
        }
        self.call_string.borrow_mut().push(callee);
        let after = self.execute(summary, inner);
        self.call_string.borrow_mut().pop();
        match after {
            None => CallOutcome::NeverReturns,
            Some((after, _)) if after.elapsed.cycles == UNBOUNDED => {
                self.bound_without_context(callee, state)
            }
            Some((after, stack_bytes)) => {
                let mut state = state;
                self.add_call(callee, &mut state.elapsed, &after.elapsed);
                CallOutcome::Bounded(state, stack_bytes)
            }
        }
    }

    fn analyse_with_frame(
        &self,
        callee: Entry,
        mut state: State,
        summary: &FunctionSummary,
        pointer: i32,
    ) -> CallOutcome {
        let memory = state.memory.take();
        let before = state.clone();
        state.memory = memory;
        let leaves = self.program.conventions.unlocks.contains(&callee.0);
        if !leaves {
            state.mask_count = Some(0);
        }
        state.elapsed = state.elapsed.restarted();
        state.rebase_stack(pointer);
        self.call_string.borrow_mut().push(callee);
        let after = self.execute(summary, state);
        self.call_string.borrow_mut().pop();
        let Some((mut after, stack_bytes)) = after else {
            return CallOutcome::NeverReturns;
        };
        after.rebase_stack(pointer.wrapping_neg());
        restore(&mut after, &before, summary.changed, pointer);
        if !leaves {
            after.mask_count = before.mask_count;
        }
        let called = std::mem::replace(&mut after.elapsed, before.elapsed);
        self.add_call(callee, &mut after.elapsed, &called);
        CallOutcome::Returns(after, stack_bytes)
    }

    /// Adds a call with its own path, and what facts say about it.
    fn add_call(&self, callee: Entry, elapsed: &mut Elapsed, own: &Elapsed) {
        let cycles = match own.cycles {
            UNBOUNDED => UNBOUNDED,
            cycles => self.program.facts.call_cycles(callee, cycles),
        };
        elapsed.add_call(callee.0, own, cycles);
    }

    /// Bound of a callee for any state in which it has these arguments.
    fn bound_without_context(&self, callee: Entry, state: State) -> CallOutcome {
        let arguments = std::array::from_fn(|n| state.registers[n].clone());
        let mut state = state;
        let stack_bytes = match self.program.bound(callee, &as_arguments(&arguments)) {
            Ok(bound) => {
                let tree = bound.path.as_ref();
                state.elapsed.add_bound(callee.0, bound.cycles, tree);
                bound.stack_bytes
            }
            Err(Error::NeverReturns(_)) => return CallOutcome::NeverReturns,
            Err(error) => {
                self.failed.borrow_mut().get_or_insert(error);
                state.elapsed.add_bound(callee.0, UNBOUNDED, None);
                None
            }
        };
        CallOutcome::Bounded(state, stack_bytes)
    }
}

impl CallHandler for ContextSensitiveCalls<'_, '_> {
    fn call(&self, callee: Entry, state: State) -> CallOutcome {
        match self.calling_context(callee, &state) {
            Some((summary, Some(pointer))) => {
                self.analyse_with_frame(callee, state, &summary, pointer)
            }
            Some((summary, None)) => self.analyse_without_frame(callee, state, &summary),
            None => self.bound_without_context(callee, state),
        }
    }
}

/// About where the host's stack is.
fn host_stack_address() -> usize {
    let here = 0_u8;
    std::ptr::from_ref(&here).addr()
}

/// What a callee preserves is again as its caller had it.
fn restore(after: &mut State, before: &State, changed: u16, pointer: i32) {
    for number in (4..12).filter(|number| changed >> number & 1 == 0) {
        let old = &before.registers[number];
        let named = matches!(old, Value::Based(base, _) if *base > RUNNING);
        if !named {
            after.registers[number] = old.clone();
        } else if after.registers[number] != *old {
            after.registers[number] = Value::Top;
        }
    }
    after.registers[13] = before.registers[13].clone();
    after.lowest_pointer = before.lowest_pointer;
    after.suspended_pointer = before.suspended_pointer;
    after.comparison = None;
    after.tested = None;
    after.relations.clear();
    after.quotients.clear();
    after.spans.clear();
    after.shifted.clear();
    if matches!(before.registers[13], Value::Stack(_)) {
        after.stack_words.retain(|offset, _| offset >= pointer);
        after.saved_pointers.retain(|offset, _| offset >= pointer);
    }
}
