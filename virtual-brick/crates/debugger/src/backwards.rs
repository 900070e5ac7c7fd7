// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The run backwards: the last place before the present that is wanted, found by running again the
//! stretches between checkpoints, from the latest to the first.

use arm7tdmi::Step;
use virtual_brick::{Access, StepObserver, StopReason, VirtualBrick};

use crate::stops::Stops;
use crate::tasks::Context;
use crate::timeline::Timeline;
use crate::watches::{WatchState, Watched};

/// Checkpoints that running again leaves in one stretch, so that the next run backwards is short.
const CHECKPOINTS_PER_STRETCH: u64 = 16;
const DISTANCE_CYCLES_MIN: u64 = 1 << 13;

/// Goal of a search backwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SearchGoal {
    /// The last instruction of a task.
    StepOf(Context),
    /// The last step of any kind.
    AnyStep,
    /// A breakpoint or watchpoint.
    Stop,
}

/// Why the run backwards ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    StepDone,
    Breakpoint,
    Watch(Watched),
}

/// A search under way.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    wanted: SearchGoal,
    /// Where the stretch begins that is run again, and where it ends.
    begin: u64,
    end: u64,
    found: Option<(u64, Arrival)>,
    /// From the beginning of the stretch on.
    watch: Option<WatchState>,
}

/// Remembers the last wanted place of a stretch.
struct Scan<'a> {
    stops: &'a Stops,
    search: &'a mut Search,
    watch: &'a mut WatchState,
    began_at: u64,
    pc: u32,
    who: Context,
}

impl StepObserver for Scan<'_> {
    const SEES_ACCESSES: bool = true;

    fn before_step(&mut self, brick: &VirtualBrick) -> bool {
        self.began_at = brick.cycles();
        self.pc = brick.processor().next_instruction_address();
        if matches!(self.search.wanted, SearchGoal::StepOf(_)) {
            self.who = Context::now(brick);
        }
        // While the processor slept, the data controller may have written.
        self.search
            .watch_hit(self.watch.hit(brick), self.began_at, self.began_at);
        false
    }

    fn access(&mut self, access: Access) {
        self.watch.access(access);
    }

    fn after_step(&mut self, brick: &VirtualBrick, step: Step) -> bool {
        let instruction = step == Step::Instruction;
        let own = match self.search.wanted {
            SearchGoal::StepOf(who) => instruction && who == self.who,
            SearchGoal::AnyStep => true,
            SearchGoal::Stop => false,
        };
        if own {
            self.search.found = Some((self.began_at, Arrival::StepDone));
        } else if instruction && self.stops.breaks_at(self.pc) {
            self.search.found = Some((self.began_at, Arrival::Breakpoint));
        }
        self.search
            .watch_hit(self.watch.hit(brick), self.began_at, brick.cycles());
        false
    }
}

impl Search {
    /// Begin at the present; none when the present is the beginning.
    pub(crate) fn new(wanted: SearchGoal, timeline: &mut Timeline) -> Option<Self> {
        let end = timeline.now();
        let begin = timeline.checkpoint_before(end)?;
        timeline.go_to(begin);
        Some(Self {
            wanted,
            begin,
            end,
            found: None,
            watch: None,
        })
    }

    /// A watchpoint was hit by the step between two instants. GDB goes back over it itself,
    /// unless it is told of a signal.
    fn watch_hit(&mut self, hit: Option<Watched>, began_at: u64, ended_at: u64) {
        if let Some(watched) = hit.filter(|_| self.wanted == SearchGoal::Stop) {
            let at = if watched.needs_signal() {
                began_at
            } else {
                ended_at
            };
            self.found = Some((at, Arrival::Watch(watched)));
        }
    }

    /// Run again for at most `slice_cycles`. `Some` when the search is over: with the arrival,
    /// or without when nothing was found and the timeline is at its beginning.
    pub(crate) fn advance(
        &mut self,
        timeline: &mut Timeline,
        stops: &Stops,
        slice_cycles: u64,
    ) -> Option<Option<Arrival>> {
        let distance = (self.end - self.begin) / CHECKPOINTS_PER_STRETCH;
        let limit = timeline.now().saturating_add(slice_cycles).min(self.end);
        let kept = self.watch.take();
        let mut watch = kept.unwrap_or_else(|| stops.watch_from(timeline.brick()));
        let mut scan = Scan {
            stops,
            watch: &mut watch,
            began_at: timeline.now(),
            pc: 0,
            who: Context::Processor,
            search: self,
        };
        let distance = distance.max(DISTANCE_CYCLES_MIN);
        let stop = timeline.run_with_checkpoints(limit, distance, &mut scan);
        let now = timeline.now();
        self.watch_hit(watch.hit(timeline.brick()), now, now);
        let ended = stop.is_some_and(|stop| stop.reason != StopReason::Reached);
        if now < self.end && !ended {
            self.watch = Some(watch);
            return None;
        }
        if let Some((cycles, arrival)) = self.found {
            timeline.go_to(cycles);
            return Some(Some(arrival));
        }
        self.end = self.begin;
        match timeline.checkpoint_before(self.end) {
            Some(begin) => {
                self.begin = begin;
                timeline.go_to(begin);
                None
            }
            None => {
                timeline.go_to(timeline.beginning());
                Some(None)
            }
        }
    }
}
