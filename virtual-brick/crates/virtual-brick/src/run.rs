// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The run: processor steps and skipped idle time between inputs and samples.

use arm7tdmi::{BlockBus, Step};
use at91sam7s::ResetCause;

use crate::assembly;
use crate::brick::VirtualBrick;
use crate::engine::Engine;
use crate::observe::{ObservedBus, StepObserver, Unobserved};
use crate::placement::Placement;
use crate::stop::{Stop, StopReason};

/// Fewer quiet cycles are left to the reference engine: entering a block costs more.
const WORTHWHILE_CYCLES: u32 = 16;

/// Why a slice of the run was left early.
enum Break {
    /// The run ended.
    End(Stop),
    /// The observer wants to stop here.
    Observer,
}

impl From<Stop> for Break {
    fn from(stop: Stop) -> Self {
        Self::End(stop)
    }
}

impl VirtualBrick {
    /// Run to the first instruction boundary at or after `limit_cycles`, or until the run ends.
    /// A run that ended stays ended: further calls return the same stop.
    pub fn run_until(&mut self, limit_cycles: u64) -> Stop {
        self.run_observed(limit_cycles, &mut Unobserved)
            .unwrap_or_else(|| self.reached())
    }

    /// As [`VirtualBrick::run_until`], with an observer of each step; none when the observer
    /// ended the call. The run itself is the same, observed or not.
    pub fn run_observed<O: StepObserver>(
        &mut self,
        limit_cycles: u64,
        observer: &mut O,
    ) -> Option<Stop> {
        while self.ended.is_none() && self.chip.now() < limit_cycles {
            let slice = self
                .serve_due()
                .map_err(Break::End)
                .and_then(|()| match self.monitor {
                    Some(_) => self.run_monitor(limit_cycles).map_err(Break::End),
                    None => self.run_slice(limit_cycles, observer),
                });
            match slice {
                Ok(()) => {}
                Err(Break::End(stop)) => self.ended = Some(self.explained(stop)),
                Err(Break::Observer) => return None,
            }
        }
        Some(self.ended.clone().unwrap_or_else(|| self.reached()))
    }

    fn reached(&self) -> Stop {
        Stop {
            reason: StopReason::Reached,
            at_cycles: self.chip.now(),
            message: String::new(),
        }
    }

    /// Apply the inputs that are due, then sample if a sample is due.
    fn serve_due(&mut self) -> Result<(), Stop> {
        let now = self.chip.now();
        while let Some(input) = self.inputs.take_due(now) {
            assembly::apply_input(&mut self.chip, &input).map_err(|error| Stop {
                reason: StopReason::Fault,
                at_cycles: now,
                message: error.to_string(),
            })?;
            self.recorder.input_applied(now, &input);
            self.recorder.collect(&mut self.chip, None)?;
        }
        if self.recorder.next_sample_cycles() <= now {
            self.recorder.sample(&self.chip)?;
            if self.monitor.is_none()
                && (self.endless_loops.at_sample(&self.cpu, &self.chip)
                    || self.failed_and_left_alone())
            {
                return Err(self.loops_for_ever());
            }
        }
        Ok(())
    }

    fn loops_for_ever(&self) -> Stop {
        let here = crate::dead_ends::place(&self.image, self.cpu.next_instruction_address());
        Stop {
            reason: StopReason::Halted,
            at_cycles: self.chip.now(),
            message: format!("the processor loops around {here} with interrupts masked"),
        }
    }

    /// Steps up to the next input, sample or the limit.
    fn run_slice<O: StepObserver>(
        &mut self,
        limit_cycles: u64,
        observer: &mut O,
    ) -> Result<(), Break> {
        let due = self
            .inputs
            .next_cycles()
            .min(self.recorder.next_sample_cycles());
        let now = self.chip.now();
        let due = due.min(self.job_profile.next_change_cycles(now));
        let profiled = self.job_profile.is_active(now);
        let runs_blocks = !O::SEES_STEPS && !profiled && self.engine != Engine::Reference;
        let watched = profiled || self.call_trace.is_active() || self.flow_counts.is_active();
        let end = limit_cycles.min(due);
        let mut next = self.cpu.next_instruction_address();
        let mut steps_of_reference = 0;
        while self.chip.now() < end {
            if self.chip.processor_stopped() {
                self.chip.skip_to_next_event(end);
                self.after_step(next)?;
                next = self.cpu.next_instruction_address();
                continue;
            }
            if steps_of_reference != 0 {
                steps_of_reference -= 1;
            } else if runs_blocks && !self.stacks.following() {
                let accessed = self.run_blocks(end);
                steps_of_reference = self.blocks.steps_of_reference();
                if let Some(instruction) = accessed {
                    self.after_step(instruction)?;
                }
                next = self.cpu.next_instruction_address();
                if accessed.is_some() {
                    continue;
                }
            }
            if observer.before_step(self) {
                return Err(Break::Observer);
            }
            let (before, stack_pointer) = (next, self.cpu.register(13));
            let step = if watched && (profiled || self.chip.observes_arrival(next)) {
                self.watched_step(observer, profiled)?
            } else {
                let step = self.step(observer);
                self.semihost(step)?
            };
            self.after_step(before)?;
            self.check_stacks_after_step(before, stack_pointer);
            next = self.cpu.next_instruction_address();
            if self.dead_ends.needs_check(before, next) {
                self.check_dead_end(before, step)?;
            }
            if observer.after_step(self, step) {
                return Err(Break::Observer);
            }
        }
        Ok(())
    }

    /// A step of which calls, flow or a job's profile take note.
    #[inline(never)]
    fn watched_step<O: StepObserver>(
        &mut self,
        observer: &mut O,
        profiled: bool,
    ) -> Result<Step, Stop> {
        let before = self.cpu.next_instruction_address();
        let stack_pointer = self.cpu.register(13);
        if self.call_trace.traces(before) {
            self.record_call();
        }
        let counted = self.flow_counts.watched(before);
        let profile = profiled.then(|| self.before_profiled_step());
        let step = self.step(observer);
        let step = self.semihost(step)?;
        if let Some(profile) = profile {
            self.after_profiled_step(&profile, step);
        }
        if let (Some(first), Step::Instruction) = (counted, step) {
            self.count_instruction(first, stack_pointer);
        }
        Ok(step)
    }

    /// As far as the fast engine gets before an instruction boundary at which something besides
    /// the processor can act, or an instruction that it leaves to the reference engine. The
    /// address of the last instruction when that was an access through the bus: it has to be
    /// looked at before the next.
    #[inline]
    fn run_blocks(&mut self, end: u64) -> Option<u32> {
        let blocks = &mut self.blocks;
        let run = self
            .cpu
            .run_blocks(&mut self.chip, blocks, end, WORTHWHILE_CYCLES);
        if run.ran {
            self.dead_ends.instructions_skipped();
        }
        if run.branched_to_itself {
            self.dead_ends.interruptible_loop();
        }
        run.accessed
    }

    #[inline(always)]
    fn step<O: StepObserver>(&mut self, observer: &mut O) -> Step {
        if !O::SEES_ACCESSES {
            return self.cpu.step(&mut self.chip);
        }
        let chip = &mut self.chip;
        self.cpu.step(&mut ObservedBus { chip, observer })
    }

    #[cold]
    fn check_dead_end(&mut self, before: u32, step: Step) -> Result<(), Stop> {
        let end = self
            .dead_ends
            .check(before, step, &self.cpu, &self.chip, &self.image);
        end.map_or(Ok(()), |end| {
            let at_cycles = self.chip.now();
            Err(Stop {
                reason: end.reason,
                at_cycles,
                message: end.message,
            })
        })
    }

    /// Record what happened, end the run at the first fault of the chip, follow a reset.
    #[inline]
    pub(crate) fn after_step(&mut self, instruction: u32) -> Result<(), Stop> {
        if self.recorder.has_news(&self.chip) | self.chip.fault().is_some() {
            self.attend(instruction)?;
        }
        match self.chip.take_reset() {
            Some(cause) => self.reset(cause),
            None => Ok(()),
        }
    }

    #[cold]
    fn attend(&mut self, instruction: u32) -> Result<(), Stop> {
        let noticed = self.chip.has_watch_hits() | self.chip.fault().is_some();
        self.recorder.collect(&mut self.chip, Some(instruction))?;
        if noticed {
            self.check_stacks();
        }
        let Some(fault) = self.chip.fault() else {
            return Ok(());
        };
        let place = crate::dead_ends::place(&self.image, instruction);
        let message = format!("{fault}; by the instruction at {place}");
        Err(Stop {
            reason: StopReason::Fault,
            at_cycles: fault.at_cycles,
            message,
        })
    }

    /// A reset starts a flash image again; a RAM image is gone with its start by the boot monitor.
    #[cold]
    fn reset(&mut self, cause: ResetCause) -> Result<(), Stop> {
        if self.placement == Placement::Flash {
            self.cpu.reset();
            return Ok(());
        }
        let message = format!(
            "reset of the processor ({cause:?}); an image in RAM cannot start again without the \
             boot monitor"
        );
        Err(Stop {
            reason: StopReason::Fault,
            at_cycles: self.chip.now(),
            message,
        })
    }
}
