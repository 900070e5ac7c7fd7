// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Breakpoints, watchpoints and steps: what ends a run forwards.
//!
//! A breakpoint is an address in a list; the program is not changed. A step is a step of one
//! task: while an interrupt handler or another task executes, the step goes on.

use arm7tdmi::Step;
use gdbstub::target::ext::breakpoints::WatchKind;
use virtual_brick::{Access, StepObserver, VirtualBrick};

use crate::tasks::Who;

/// Below this address lies what the remap shows: flash, or after the remap the RAM.
const ALIAS_END: u32 = 0x10_0000;
const RAM: u32 = 0x20_0000;
const RAM_MASK: u32 = 0xFFFF;

/// Memory that is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Watch {
    pub address: u32,
    pub length: u32,
    pub kind: WatchKind,
}

impl Watch {
    fn concerned(&self, access: Access) -> bool {
        let kind = match self.kind {
            WatchKind::Write => access.write,
            WatchKind::Read => !access.write,
            WatchKind::ReadWrite => true,
        };
        let first = u64::from(unaliased(access.address));
        let watched = u64::from(unaliased(self.address));
        kind && first < watched + u64::from(self.length)
            && watched < first + u64::from(access.width_bytes)
    }

    fn bytes(&self, brick: &VirtualBrick) -> Vec<u8> {
        let address = unaliased(self.address);
        let length = self.length as usize;
        brick.read_memory(address, length).unwrap_or_default()
    }
}

/// The RAM appears at address 0 after the remap and repeats itself.
fn unaliased(address: u32) -> u32 {
    if address < ALIAS_END || address >> 20 == RAM >> 20 {
        RAM | address & RAM_MASK
    } else {
        address
    }
}

/// What the user wants to stop at.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stops {
    breakpoints: Vec<u32>,
    watches: Vec<Watch>,
}

impl Stops {
    pub(crate) fn add_breakpoint(&mut self, address: u32) {
        self.breakpoints.push(address);
    }

    /// False when there was none.
    pub(crate) fn remove_breakpoint(&mut self, address: u32) -> bool {
        let found = self.breakpoints.iter().position(|known| *known == address);
        found.map(|at| self.breakpoints.swap_remove(at)).is_some()
    }

    pub(crate) fn add_watch(&mut self, watch: Watch) {
        self.watches.push(watch);
    }

    /// False when there was none.
    pub(crate) fn remove_watch(&mut self, watch: Watch) -> bool {
        let found = self.watches.iter().position(|known| *known == watch);
        found.map(|at| self.watches.swap_remove(at)).is_some()
    }

    pub(crate) fn breaks_at(&self, address: u32) -> bool {
        self.breakpoints.contains(&address)
    }
}

/// A watched access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Watched {
    pub address: u32,
    pub kind: WatchKind,
}

/// Finds out after each step whether watched memory was accessed. A write that leaves the value
/// as it was is none.
#[derive(Clone, Debug)]
pub(crate) struct WatchState {
    watches: Vec<(Watch, Vec<u8>)>,
    touched: bool,
    last: Vec<Access>,
}

impl WatchState {
    pub(crate) fn new(stops: &Stops, brick: &VirtualBrick) -> Self {
        let watches = stops.watches.iter();
        Self {
            watches: watches.map(|watch| (*watch, watch.bytes(brick))).collect(),
            touched: false,
            last: Vec::new(),
        }
    }

    pub(crate) fn access(&mut self, access: Access) {
        if self
            .watches
            .iter()
            .any(|(watch, _)| watch.concerned(access))
        {
            self.touched = true;
            self.last.push(access);
        }
    }

    /// The watchpoint that the step just made hit.
    pub(crate) fn hit(&mut self, brick: &VirtualBrick) -> Option<Watched> {
        if !self.touched {
            return None;
        }
        self.touched = false;
        let accesses = std::mem::take(&mut self.last);
        let mut hit = None;
        for (watch, value) in &mut self.watches {
            let concerned = accesses.iter().any(|access| watch.concerned(*access));
            if !concerned {
                continue;
            }
            let now = watch.bytes(brick);
            let changed = std::mem::replace(value, now) != *value;
            if changed || watch.kind != WatchKind::Write {
                hit.get_or_insert(Watched {
                    address: watch.address,
                    kind: watch.kind,
                });
            }
        }
        hit
    }
}

/// A step that the user wants made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepWanted {
    /// Whose; none for whatever the processor does next.
    pub whose: Option<Who>,
    /// Go on while the program counter stays between these addresses, the first included.
    pub range: Option<(u32, u32)>,
}

/// Why a run forwards ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Breakpoint,
    /// The step that began at this cycle accesses watched memory.
    Watch(Watched, u64),
    StepDone,
}

/// Observer of a run forwards.
pub(crate) struct Forward<'a> {
    stops: &'a Stops,
    /// Breakpoints that GDB removed for the step of one task and that still hold for the others.
    for_others: &'a [u32],
    watch: WatchState,
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
        progress: &'a mut Progress,
        brick: &VirtualBrick,
    ) -> Self {
        Self {
            stops,
            for_others,
            watch: WatchState::new(stops, brick),
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
        self.progress.own = step.whose.is_none_or(|who| who == Who::now(brick));
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
        self.outcome = self.look_ahead(brick);
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
