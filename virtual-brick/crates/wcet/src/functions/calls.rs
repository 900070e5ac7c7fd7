// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Calls followed into the callee in the state of the caller: its frame, its arguments and, in a
//! closed program, memory. What a callee costs is then added to the way on which it is called.

use crate::error::Error;
use crate::functions::bound::missing_bound;
use crate::functions::program::Program;
use crate::functions::summary::Summary;
use crate::graph::control_flow::{Entry, Target};
use crate::loops::abstract_execution::Execution;
use crate::values::block::{as_arguments, Called, Calls, Walker};
use crate::values::state::{State, ENDLESS};
use crate::values::value::{Value, RUNNING};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::rc::Rc;

/// Stack of the analysis of a closed program, which follows calls by calls of its own.
pub const STACK_BYTES: usize = 1 << 30;

/// Most calls that are open at the same time.
const DEPTH: usize = 2_000;

/// Instructions executed in all calls that are followed for one bound.
const PATIENCE: u64 = 400_000;

/// The same in a closed program, and in one visit of a loop of it.
const CLOSED_PATIENCE: u64 = 4_000_000_000;

/// Instructions executed in one visit of a loop where inputs may be anything: a loop whose end
/// depends on them is given up.
const OPEN_PATIENCE: u64 = 2_000_000;

/// States that are kept apart where ways meet, as long as memory differs, where inputs may be
/// anything.
const APART: usize = 16;

/// Follows calls until its patience ends.
pub struct Follower<'p, 'a> {
    program: &'p Program<'a>,
    left: Cell<u64>,
    /// Where the analysis' own stack was at the beginning.
    stack_begin: usize,
    open: RefCell<Vec<Entry>>,
    /// Nothing but the program writes to memory, and recursion is followed too.
    closed: bool,
    /// Instructions executed in one visit of a loop of a closed program.
    patience: Cell<u64>,
    /// States that are kept apart where ways meet.
    apart: usize,
    /// Loops without a bound in a closed program, by function and number.
    unbounded: RefCell<BTreeSet<(Entry, usize)>>,
    /// Why a call in a closed program has no bound.
    failed: RefCell<Option<Error>>,
}

impl<'p, 'a> Follower<'p, 'a> {
    /// For calls made by `root`.
    pub fn new(program: &'p Program<'a>, root: Entry, closed: bool) -> Self {
        Self {
            program,
            left: Cell::new(if closed { CLOSED_PATIENCE } else { PATIENCE }),
            stack_begin: stack_place(),
            open: RefCell::new(vec![root]),
            closed,
            patience: Cell::new(CLOSED_PATIENCE),
            apart: 1,
            unbounded: RefCell::default(),
            failed: RefCell::default(),
        }
    }

    /// The same where some of what memory holds is not known.
    pub fn with_inputs(self) -> Self {
        Self {
            patience: Cell::new(OPEN_PATIENCE),
            apart: APART,
            ..self
        }
    }

    /// Why not all ways could be followed.
    pub fn obstacle(&self) -> Error {
        let unbounded = self.unbounded.borrow();
        let missing = unbounded.iter().filter_map(|(entry, index)| {
            let summary = self.program.summary(*entry, entry.0).ok()?;
            Some(missing_bound(self.program, &summary, *index))
        });
        let missing: Vec<_> = missing.collect();
        if missing.is_empty() {
            let unknown = || Error::Input("not all ways could be followed".into());
            return self.failed.borrow().clone().unwrap_or_else(unknown);
        }
        Error::MissingBounds(missing)
    }

    /// What comes after the first loop without a bound is gone through in haste: what is found
    /// about it is not used.
    fn note_unbounded(&self, execution: &Execution<'_, '_>) {
        let open = self.open.borrow();
        let Some(entry) = open.last().copied().filter(|_| self.patience.get() > 0) else {
            return;
        };
        let limits = &execution.limits;
        let findings = execution.findings.iter().enumerate();
        let endless = findings.filter(|(index, f)| f.unbounded && limits[*index].is_none());
        let mut unbounded = self.unbounded.borrow_mut();
        unbounded.extend(endless.map(|(index, _)| (entry, index)));
        if !unbounded.is_empty() {
            self.patience.set(0);
        }
    }

    /// Executes a function on a state that holds at its entry; the joined states at its returns.
    pub fn execute(&self, summary: &Summary, state: State) -> Option<State> {
        let region = |address| self.program.given_region(address);
        let (flow, forest) = (&summary.flow, &summary.forest);
        if summary.avoided.first() == Some(&true) {
            return None;
        }
        let mut walker = Walker::counting(
            self.program.world(),
            flow,
            &summary.callees,
            &region,
            &summary.costs,
            Some(self),
        );
        walker.avoided = &summary.avoided;
        let limits = summary.limits_within(&self.open.borrow());
        let mut execution = Execution::new(walker, forest, limits);
        if self.closed {
            execution.walker.visits = Some(&summary.visits);
            execution.patience = self.patience.get();
            execution.rarely_repeats = true;
            execution.apart = self.apart;
        }
        let exits = execution.run(state);
        let steps = execution.walker.step_count;
        self.program.note_steps(steps);
        self.note_unbounded(&execution);
        self.left.set(self.left.get().saturating_sub(steps));
        let returns = exits
            .into_iter()
            .filter(|((block, edge), _)| flow.blocks[*block].edges[*edge].target == Target::Return);
        returns.map(|(_, state)| state).reduce(|a, b| a.join(&b))
    }

    /// Whether a call is followed; the summary of the callee and, where it is known, the caller's
    /// stack pointer.
    fn followed(&self, callee: Entry, state: &State) -> Option<(Rc<Summary>, Option<i32>)> {
        let pointer = match (&state.registers[13], self.closed) {
            (Value::Stack(pointer), _) => Some(*pointer),
            (Value::Constant(_), true) => Some(0),
            (_, true) => return None,
            _ => None,
        };
        let recursive =
            self.open.borrow().contains(&callee) || self.program.given_recursion(callee).is_some();
        // A way that has no bound gets none by being followed.
        let endless = state.elapsed.0 == ENDLESS && !self.closed;
        let deep = self.open.borrow().len() >= DEPTH
            || self.stack_begin.abs_diff(stack_place()) > STACK_BYTES / 4 * 3;
        let failed = self.failed.borrow().is_some();
        let tired = endless || failed || self.left.get() == 0 || deep;
        if tired || (recursive && !self.closed) {
            return None;
        }
        let summary = self.program.summary(callee, callee.0).ok()?;
        Some((summary, pointer))
    }

    /// A callee whose caller's frame has no known place: it is followed from its arguments alone.
    fn follow_alone(&self, callee: Entry, state: State, summary: &Summary) -> Called {
        let arguments = std::array::from_fn(|n| state.registers[n].clone());
        let mut inner = State::entry(&as_arguments(&arguments));
        inner.urgencies.clone_from(&state.urgencies);
        if self.program.conventions.unlocks.contains(&callee.0) {
            inner.masks = None;
        }
        self.open.borrow_mut().push(callee);
        let after = self.execute(summary, inner);
        self.open.borrow_mut().pop();
        match after {
            None => Called::Never,
            Some(after) if after.elapsed.0 == ENDLESS => self.apart(callee, state),
            Some(after) => Called::Apart(state, self.capped(callee, after.elapsed.0)),
        }
    }

    fn capped(&self, callee: Entry, cycles: u64) -> u64 {
        let given = self.program.given_cycles(callee);
        given.map_or(cycles, |given| given.min(cycles))
    }

    fn follow(&self, callee: Entry, mut state: State, summary: &Summary, pointer: i32) -> Called {
        let memory = state.memory.take();
        let before = state.clone();
        state.memory = memory;
        let leaves = self.program.conventions.unlocks.contains(&callee.0);
        if !leaves {
            state.masks = Some(0);
        }
        state.shift(pointer);
        self.open.borrow_mut().push(callee);
        let after = self.execute(summary, state);
        self.open.borrow_mut().pop();
        let Some(mut after) = after else {
            return Called::Never;
        };
        after.shift(pointer.wrapping_neg());
        restore(&mut after, &before, summary.changed, pointer);
        if !leaves {
            after.masks = before.masks;
        }
        if after.elapsed.0 != ENDLESS {
            let cycles = after.elapsed.0 - before.elapsed.0;
            after.elapsed.0 = before.elapsed.0 + self.capped(callee, cycles);
        }
        Called::Returned(after)
    }

    /// Bound of a callee for any state in which it has these arguments.
    fn apart(&self, callee: Entry, state: State) -> Called {
        let arguments = std::array::from_fn(|n| state.registers[n].clone());
        match self.program.bound(callee, &as_arguments(&arguments)) {
            Ok(bound) => Called::Apart(state, bound.cycles),
            Err(Error::NeverReturns(_)) => Called::Never,
            Err(error) => {
                self.failed.borrow_mut().get_or_insert(error);
                Called::Apart(state, ENDLESS)
            }
        }
    }
}

impl Calls for Follower<'_, '_> {
    fn call(&self, callee: Entry, state: State) -> Called {
        match self.followed(callee, &state) {
            Some((summary, Some(pointer))) => self.follow(callee, state, &summary, pointer),
            Some((summary, None)) => self.follow_alone(callee, state, &summary),
            None => self.apart(callee, state),
        }
    }
}

/// About where the analysis' own stack is.
fn stack_place() -> usize {
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
    after.lowest = before.lowest;
    after.parked = before.parked;
    after.comparison = None;
    after.relations.clear();
    if matches!(before.registers[13], Value::Stack(_)) {
        after.slots.retain(|offset, _| *offset >= pointer);
    }
}
