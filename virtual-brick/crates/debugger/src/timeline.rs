// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Time in both directions: checkpoints, and running again from them with the same inputs and
//! the same changes made by the debugger's user.
//!
//! An instant is a cycle. Each step takes at least one cycle, so a cycle at which a step began
//! tells the state; how a run is cut makes no difference to it.

use arm7tdmi::Step;
use virtual_brick::{Access, MemoryError, StepObserver, Stop, StopReason, VirtualBrick};

use crate::arch::{Banked, BrickRegister, BANKED, CPSR, PC};
use crate::checkpoints::{Checkpoints, SavedCheckpoint};

/// Distance of checkpoints while the run goes where it never was.
const INTERVAL_CYCLES: u64 = 1 << 21;

/// A change from outside that is no scheduled input of the run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
    Memory { address: u32, bytes: Vec<u8> },
    Register { register: BrickRegister, value: u32 },
    Input { name: String, value: f64 },
    Semihosting(bool),
}

#[derive(Clone, Debug)]
struct Intervention {
    at_cycles: u64,
    change: Change,
}

/// A change that the brick does not accept.
#[derive(Debug)]
pub(crate) enum Refused {
    Memory(MemoryError),
    Input(virtual_brick::InputError),
}

/// A brick with its past.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    brick: VirtualBrick,
    checkpoints: Checkpoints,
    interventions: Vec<Intervention>,
    /// Interventions made so far at the present place.
    made: usize,
}

/// Observes nothing.
struct NoObserver;

impl StepObserver for NoObserver {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        false
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, _brick: &VirtualBrick, _step: Step) -> bool {
        false
    }
}

impl Timeline {
    /// The present becomes the beginning of what can be gone back to.
    pub(crate) fn new(mut brick: VirtualBrick) -> Self {
        let first = SavedCheckpoint {
            checkpoint: brick.checkpoint(),
            interventions: 0,
        };
        Self {
            brick,
            checkpoints: Checkpoints::new(first),
            interventions: Vec::new(),
            made: 0,
        }
    }

    pub(crate) fn brick(&self) -> &VirtualBrick {
        &self.brick
    }

    pub(crate) fn into_brick(self) -> VirtualBrick {
        self.brick
    }

    pub(crate) fn now(&self) -> u64 {
        self.brick.cycles()
    }

    pub(crate) fn beginning(&self) -> u64 {
        self.checkpoints.first().cycles()
    }

    pub(crate) fn checkpoint_count(&self) -> usize {
        self.checkpoints.len()
    }

    /// The last checkpoint before an instant; none at the beginning.
    pub(crate) fn checkpoint_before(&self, cycles: u64) -> Option<u64> {
        let before = cycles.checked_sub(1)?;
        let found = self.checkpoints.at_or_before(before).cycles();
        (found < cycles).then_some(found)
    }

    /// Run to the first step that begins at or after `limit`. None when the observer ended the
    /// call.
    pub(crate) fn run(&mut self, limit: u64, observer: &mut impl StepObserver) -> Option<Stop> {
        self.run_with_checkpoints(limit, INTERVAL_CYCLES, observer)
    }

    /// As [`Timeline::run`], with another distance of checkpoints.
    pub(crate) fn run_with_checkpoints(
        &mut self,
        limit: u64,
        distance_cycles: u64,
        observer: &mut impl StepObserver,
    ) -> Option<Stop> {
        let kept = self.checkpoints.at_or_before(self.now()).cycles();
        let mut checkpoint_due = kept.saturating_add(distance_cycles);
        loop {
            self.intervene_due();
            if self.now() >= checkpoint_due {
                self.keep(limit);
                checkpoint_due = self.now().saturating_add(distance_cycles);
            }
            let next_change = self.interventions.get(self.made);
            let change_due = next_change.map_or(u64::MAX, |next| next.at_cycles);
            let end = limit.min(checkpoint_due).min(change_due);
            let stop = self.brick.run_observed(end, observer)?;
            if stop.reason != StopReason::Reached || self.now() >= limit {
                self.intervene_due();
                return Some(stop);
            }
        }
    }

    fn keep(&mut self, limit: u64) {
        let present = if limit == u64::MAX { self.now() } else { limit };
        let kept = SavedCheckpoint {
            checkpoint: self.brick.checkpoint(),
            interventions: self.made,
        };
        self.checkpoints.add(kept, present);
    }

    /// Make the changes of the present again.
    fn intervene_due(&mut self) {
        while let Some(next) = self.interventions.get(self.made) {
            if next.at_cycles > self.brick.cycles() {
                return;
            }
            // A change that was accepted once is accepted again in the same state.
            let _ = change(&mut self.brick, &next.change);
            self.made += 1;
        }
    }

    /// Go to an instant of the past at which a step began, or of the future.
    pub(crate) fn go_to(&mut self, cycles: u64) {
        if self.now() > cycles {
            let kept = self.checkpoints.at_or_before(cycles);
            // A checkpoint before an instant of the past has been passed: this cannot fail.
            if self.brick.go_back(&kept.checkpoint).is_ok() {
                self.made = kept.interventions;
            }
        }
        self.run(cycles, &mut NoObserver);
    }

    /// Back to the beginning; what the user changed is forgotten.
    pub(crate) fn reset(&mut self) {
        self.interventions.clear();
        self.made = 0;
        self.checkpoints.forget_after(self.beginning());
        self.go_to(self.beginning());
    }

    /// Change something now. What came after the present is another future and is forgotten.
    pub(crate) fn intervene(&mut self, wanted: Change) -> Result<(), Refused> {
        change(&mut self.brick, &wanted)?;
        let at_cycles = self.now();
        self.interventions.truncate(self.made);
        self.checkpoints.forget_after(at_cycles);
        self.interventions.push(Intervention {
            at_cycles,
            change: wanted,
        });
        self.made += 1;
        Ok(())
    }
}

fn change(brick: &mut VirtualBrick, change: &Change) -> Result<(), Refused> {
    match change {
        Change::Memory { address, bytes } => brick
            .write_memory(*address, bytes)
            .map_err(Refused::Memory)?,
        Change::Register { register, value } => set_register(brick, *register, *value),
        Change::Input { name, value } => brick
            .schedule_input(brick.cycles(), name, *value)
            .map_err(Refused::Input)?,
        Change::Semihosting(on) => brick.set_semihosting(*on),
    }
    Ok(())
}

fn set_register(brick: &mut VirtualBrick, register: BrickRegister, value: u32) {
    let cpu = brick.processor_mut();
    match register {
        BrickRegister::Core(CPSR) => cpu.set_cpsr(value),
        BrickRegister::Core(PC) => cpu.set_pc(value),
        BrickRegister::Core(number) => cpu.set_register(number as u32, value),
        BrickRegister::Banked(position) => match BANKED.get(position) {
            Some(Banked::Register(mode, number)) => cpu.set_banked_register(*mode, *number, value),
            Some(Banked::Status(mode)) => cpu.set_spsr_of(*mode, value),
            None => {}
        },
    }
}
