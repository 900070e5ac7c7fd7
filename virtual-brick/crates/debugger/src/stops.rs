// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Breakpoints, watchpoints and steps: what ends a run forwards.
//!
//! A breakpoint is an address in a list; the program is not changed. A step is a step of one
//! task: while an interrupt handler or another task executes, the step goes on.

use arm7tdmi::Step;
use virtual_brick::{Access, StepObserver, VirtualBrick};

use crate::tasks::Context;
use crate::watches::{Watch, WatchState, Watched};

/// What the user wants to stop at.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stops {
    breakpoints: Vec<u32>,
    watches: Vec<Watch>,
}

impl Stops {
    pub(crate) fn add_breakpoint(&mut self, address: u32) {
        // GDB may insert one twice and then removes it once.
        if !self.breaks_at(address) {
            self.breakpoints.push(address);
        }
    }

    /// False when there was none.
    pub(crate) fn remove_breakpoint(&mut self, address: u32) -> bool {
        let found = self.breakpoints.iter().position(|known| *known == address);
        found.map(|at| self.breakpoints.swap_remove(at)).is_some()
    }

    pub(crate) fn add_watch(&mut self, watch: Watch) {
        if !self.watches.contains(&watch) {
            self.watches.push(watch);
        }
    }

    /// False when there was none.
    pub(crate) fn remove_watch(&mut self, watch: Watch) -> bool {
        let found = self.watches.iter().position(|known| *known == watch);
        found.map(|at| self.watches.swap_remove(at)).is_some()
    }

    /// To find out about watchpoints from the present on.
    pub(crate) fn watch_from(&self, brick: &VirtualBrick) -> WatchState {
        WatchState::new(&self.watches, brick)
    }

    pub(crate) fn breaks_at(&self, address: u32) -> bool {
        self.breakpoints.contains(&address)
    }
}

/// A step that the user wants made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepWanted {
    /// Whose; none for whatever the processor does next.
    pub whose: Option<Context>,
    /// Go on while the program counter stays between these addresses, the first included.
    pub range: Option<(u32, u32)>,
}

/// Why a run forwards ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Breakpoint,
    /// A watchpoint was hit by the step that began at this cycle.
    Watch(Watched, u64),
    StepDone,
}

/// Observer of a run forwards.
pub(crate) struct Forward<'a> {
    stops: &'a Stops,
    /// Breakpoints that GDB removed for the step of one task and that still hold for the others.
    for_others: &'a [u32],
    watch: &'a mut WatchState,
    step: Option<StepWanted>,
    progress: &'a mut Progress,
    began_at: u64,
    pub outcome: Option<Outcome>,
}

/// What a step has come to when a run is cut into slices.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress {
    executed: bool,
    own: bool,
}

impl<'a> Forward<'a> {
    pub(crate) fn new(
        stops: &'a Stops,
        for_others: &'a [u32],
        step: Option<StepWanted>,
        watch: &'a mut WatchState,
        progress: &'a mut Progress,
        brick: &VirtualBrick,
    ) -> Self {
        Self {
            stops,
            for_others,
            watch,
            step,
            progress,
            began_at: brick.cycles(),
            outcome: None,
        }
    }

    /// What ends the run before the step that is about to be made.
    fn look_ahead(&mut self, brick: &VirtualBrick) -> Option<Outcome> {
        let pc = brick.processor().next_instruction_address();
        let Some(step) = self.step else {
            return self.stops.breaks_at(pc).then_some(Outcome::Breakpoint);
        };
        self.progress.own = step.whose.is_none_or(|who| who == Context::now(brick));
        if !self.progress.own {
            if self.stops.breaks_at(pc) {
                return Some(Outcome::Breakpoint);
            }
            // The step ends early: GDB puts its breakpoints back and finds this one.
            return self.for_others.contains(&pc).then_some(Outcome::StepDone);
        }
        if !self.progress.executed {
            return None;
        }
        let inside = step
            .range
            .is_some_and(|(start, end)| (start..end).contains(&pc));
        if !inside {
            return Some(Outcome::StepDone);
        }
        self.stops.breaks_at(pc).then_some(Outcome::Breakpoint)
    }
}

impl StepObserver for Forward<'_> {
    const SEES_ACCESSES: bool = true;

    fn before_step(&mut self, brick: &VirtualBrick) -> bool {
        self.began_at = brick.cycles();
        // While the processor slept, the data controller may have written.
        let hit = self.watch.hit(brick);
        self.outcome = match hit {
            Some(watched) => Some(Outcome::Watch(watched, self.began_at)),
            None => self.look_ahead(brick),
        };
        self.outcome.is_some()
    }

    fn access(&mut self, access: Access) {
        self.watch.access(access);
    }

    fn after_step(&mut self, brick: &VirtualBrick, step: Step) -> bool {
        if let Some(wanted) = self.step {
            let counts = step == Step::Instruction || wanted.whose.is_none();
            self.progress.executed |= self.progress.own && counts;
        }
        let hit = self.watch.hit(brick);
        self.outcome = hit.map(|watched| Outcome::Watch(watched, self.began_at));
        self.outcome.is_some()
    }
}
