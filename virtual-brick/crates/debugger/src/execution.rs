// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Running, stepping, and both backwards: what GDB asks for, done in slices.

use gdbstub::common::{Signal, Tid};
use gdbstub::stub::MultiThreadStopReason;
use gdbstub::target::ext::base::multithread::{
    MultiThreadRangeStepping, MultiThreadRangeSteppingOps, MultiThreadResume,
    MultiThreadSchedulerLocking, MultiThreadSchedulerLockingOps, MultiThreadSingleStep,
    MultiThreadSingleStepOps,
};
use gdbstub::target::ext::base::reverse_exec::{
    ReplayLogPosition, ReverseCont, ReverseContOps, ReverseStep, ReverseStepOps,
};
use virtual_brick::{Stop, StopReason};

use crate::backwards::{Arrival, Search, SearchGoal};
use crate::stops::{Forward, Outcome, Progress, StepWanted};
use crate::target::DebugTarget;
use crate::tasks::Context;
use crate::watches::{WatchState, Watched};

/// Between two looks at the connection.
const SLICE_CYCLES: u64 = 1 << 20;

type Reason = MultiThreadStopReason<u32>;

/// What is to be done until the next stop.
#[derive(Debug)]
pub(crate) enum Job {
    Nothing,
    Forward(ForwardJob),
    Back(Search),
    /// There is nothing to go back to.
    AtBeginning,
}

/// A run forwards.
#[derive(Debug, Default)]
pub(crate) struct ForwardJob {
    step: Option<StepWanted>,
    /// The thread whose step it is.
    tid: Option<Tid>,
    progress: Progress,
    watch: Option<WatchState>,
    /// GDB let only one thread go on.
    locked: bool,
}

impl DebugTarget {
    /// Do a slice of what was asked for; a stop reason when it ended.
    pub(crate) fn advance(&mut self) -> Option<Reason> {
        let reason = match std::mem::replace(&mut self.job, Job::Nothing) {
            Job::Nothing => Some(self.signal(Signal::SIGINT)),
            Job::AtBeginning => Some(self.beginning()),
            Job::Forward(job) => self.forward(job),
            Job::Back(search) => self.backward(search),
        };
        if reason.is_some() {
            self.removed.clear();
        }
        reason
    }

    /// Stop where the run is.
    pub(crate) fn interrupt(&mut self) -> Reason {
        self.job = Job::Nothing;
        self.removed.clear();
        self.signal(Signal::SIGINT)
    }

    fn forward(&mut self, mut job: ForwardJob) -> Option<Reason> {
        // After a run backwards, output is repeated.
        self.told = self.told.min(self.timeline.brick().console_bytes());
        let limit = self.timeline.now().saturating_add(SLICE_CYCLES);
        let brick = self.timeline.brick();
        let watch = &mut job.watch;
        let watch = watch.get_or_insert_with(|| self.stops.watch_from(brick));
        let for_others: &[u32] = if job.locked { &self.removed } else { &[] };
        // The observer looks at a brick that the timeline is about to run.
        let mut observer = Forward::new(
            &self.stops,
            for_others,
            job.step,
            watch,
            &mut job.progress,
            brick,
        );
        let stop = self.timeline.run(limit, &mut observer);
        let outcome = observer.outcome;
        match (outcome, stop) {
            (Some(outcome), _) => Some(self.ended(outcome, job.tid)),
            (None, Some(stop)) if stop.reason != StopReason::Reached => Some(self.run_ended(&stop)),
            _ => {
                self.job = Job::Forward(job);
                None
            }
        }
    }

    fn ended(&mut self, outcome: Outcome, stepping: Option<Tid>) -> Reason {
        match outcome {
            Outcome::StepDone => {
                let tid = stepping.filter(|_| self.steps_of_task);
                self.stopped = tid.unwrap_or_else(|| self.executing());
                self.step_done()
            }
            Outcome::Breakpoint => {
                self.stopped = self.executing();
                Reason::SwBreak(self.stopped)
            }
            Outcome::Watch(watched, began_at) => {
                // GDB expects to find an ARM before the access, and makes the step itself.
                if !watched.needs_signal() {
                    self.timeline.go_to(began_at);
                }
                self.at_watchpoint(&watched)
            }
        }
    }

    fn at_watchpoint(&mut self, watched: &Watched) -> Reason {
        self.notices.extend(watched.notice());
        if watched.needs_signal() {
            return self.signal(Signal::SIGUSR1);
        }
        self.at_watch = true;
        self.stopped = self.executing();
        Reason::Watch {
            tid: self.stopped,
            kind: watched.watch.kind,
            addr: watched.watch.address,
        }
    }

    fn backward(&mut self, mut search: Search) -> Option<Reason> {
        let over = search.advance(&mut self.timeline, &self.stops, SLICE_CYCLES);
        let Some(arrival) = over else {
            self.job = Job::Back(search);
            return None;
        };
        self.stopped = self.executing();
        self.told = self.timeline.brick().console_bytes();
        Some(match arrival {
            None => self.beginning(),
            Some(Arrival::StepDone) => self.step_done(),
            Some(Arrival::Breakpoint) => Reason::SwBreak(self.stopped),
            Some(Arrival::Watch(watched)) => self.at_watchpoint(&watched),
        })
    }

    fn executing(&self) -> Tid {
        let brick = self.timeline.brick();
        Context::now(brick).tid(brick)
    }

    fn step_done(&self) -> Reason {
        Reason::SignalWithThread {
            tid: self.stopped,
            signal: Signal::SIGTRAP,
        }
    }

    fn signal(&mut self, signal: Signal) -> Reason {
        self.stopped = self.executing();
        Reason::SignalWithThread {
            tid: self.stopped,
            signal,
        }
    }

    fn beginning(&mut self) -> Reason {
        self.stopped = self.executing();
        Reason::ReplayLog {
            tid: Some(self.stopped),
            pos: ReplayLogPosition::Begin,
        }
    }

    /// The run cannot go on. The brick is still there, so that its past can be looked at.
    fn run_ended(&mut self, stop: &Stop) -> Reason {
        self.signal(match stop.reason {
            StopReason::PowerOff => Signal::SIGPWR,
            StopReason::Fault => Signal::SIGSEGV,
            StopReason::TraceFull => Signal::SIGXFSZ,
            StopReason::Halted | StopReason::Reached => Signal::SIGABRT,
        })
    }

    fn want_step(&mut self, tid: Tid, range: Option<(u32, u32)>) {
        let at_watch = std::mem::take(&mut self.at_watch);
        let who = Context::of(tid, self.timeline.brick());
        let task = self.steps_of_task && !at_watch && who != Context::Processor;
        self.job = Job::Forward(ForwardJob {
            step: Some(StepWanted {
                whose: task.then_some(who),
                range,
            }),
            tid: task.then_some(tid),
            ..ForwardJob::default()
        });
    }

    fn go_back(&mut self, wanted: SearchGoal) {
        self.job = match Search::new(wanted, &mut self.timeline) {
            Some(search) => Job::Back(search),
            None => Job::AtBeginning,
        };
    }
}

impl MultiThreadResume for DebugTarget {
    fn resume(&mut self) -> Result<(), Self::Error> {
        self.at_watch = false;
        Ok(())
    }

    fn clear_resume_actions(&mut self) -> Result<(), Self::Error> {
        self.job = Job::Forward(ForwardJob::default());
        Ok(())
    }

    fn set_resume_action_continue(
        &mut self,
        _tid: Tid,
        _signal: Option<Signal>,
    ) -> Result<(), Self::Error> {
        Ok(())
    }

    fn support_single_step(&mut self) -> Option<MultiThreadSingleStepOps<'_, Self>> {
        Some(self)
    }

    fn support_range_step(&mut self) -> Option<MultiThreadRangeSteppingOps<'_, Self>> {
        Some(self)
    }

    fn support_scheduler_locking(&mut self) -> Option<MultiThreadSchedulerLockingOps<'_, Self>> {
        Some(self)
    }

    fn support_reverse_step(&mut self) -> Option<ReverseStepOps<'_, Tid, Self>> {
        Some(self)
    }

    fn support_reverse_cont(&mut self) -> Option<ReverseContOps<'_, Tid, Self>> {
        Some(self)
    }
}

impl MultiThreadSingleStep for DebugTarget {
    fn set_resume_action_step(
        &mut self,
        tid: Tid,
        _signal: Option<Signal>,
    ) -> Result<(), Self::Error> {
        self.want_step(tid, None);
        Ok(())
    }
}

impl MultiThreadRangeStepping for DebugTarget {
    fn set_resume_action_range_step(
        &mut self,
        tid: Tid,
        start: u32,
        end: u32,
    ) -> Result<(), Self::Error> {
        self.want_step(tid, Some((start, end)));
        Ok(())
    }
}

impl MultiThreadSchedulerLocking for DebugTarget {
    fn set_resume_action_scheduler_lock(&mut self) -> Result<(), Self::Error> {
        if let Job::Forward(job) = &mut self.job {
            job.locked = true;
        }
        Ok(())
    }
}

impl ReverseStep<Tid> for DebugTarget {
    /// GDB may name a thread of an earlier stop: the one of the last stop is meant.
    fn reverse_step(&mut self, _tid: Tid) -> Result<(), Self::Error> {
        let who = Context::of(self.stopped, self.timeline.brick());
        let at_watch = std::mem::take(&mut self.at_watch);
        let any = at_watch || !self.steps_of_task || who == Context::Processor;
        self.go_back(if any {
            SearchGoal::AnyStep
        } else {
            SearchGoal::StepOf(who)
        });
        Ok(())
    }
}

impl ReverseCont<Tid> for DebugTarget {
    fn reverse_cont(&mut self) -> Result<(), Self::Error> {
        self.at_watch = false;
        self.go_back(SearchGoal::Stop);
        Ok(())
    }
}
