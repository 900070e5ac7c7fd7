// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Jobs, response times and the use of the processor.
//!
//! A job's response time runs from its nominal release to its completion; its release latency from
//! its nominal release to the instant at which it first gets the processor. The release jitter of a
//! task is the spread (largest less smallest) of its release latencies.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use trace::{EventKind, IDLE};

use crate::run::{Run, Thread};

/// Owner of the processor while it sleeps, or where the program's threads all wait.
pub const IDLE_OWNER: i64 = -1;
/// Owner of the processor in the run-time.
pub const KERNEL_OWNER: i64 = -2;
/// Owner of the processor in a handler.
pub const INTERRUPT_OWNER: i64 = -3;
const NO_SOURCE: i64 = -1;

/// One task of the task set.
#[derive(Clone, Debug, Deserialize)]
pub struct Task {
    /// The thread's name, in whatever letter case.
    pub name: String,
    /// `cyclic`, `sporadic` or `background`.
    pub release: String,
    /// Deadline of each job.
    pub deadline_us: Option<u64>,
}

/// One activation of a task; instants in cycles, none for what the run did not reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// Nominal release.
    pub release_cycles: i64,
    /// First execution.
    pub start_cycles: Option<i64>,
    /// End.
    pub completion_cycles: Option<i64>,
}

/// What one run shows of one task; times in cycles, none when no job completed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct TaskMeasures {
    pub name: String,
    pub releases: usize,
    pub completions: usize,
    pub response_time_cycles_min: Option<i64>,
    pub response_time_cycles_mean: Option<f64>,
    pub response_time_cycles_max: Option<i64>,
    pub release_jitter_cycles: Option<i64>,
    pub release_latency_cycles_max: Option<i64>,
    pub deadline_cycles: Option<i64>,
    pub deadline_misses: usize,
}

/// A time in which the processor did one thing; instants in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// Begin.
    pub begin_cycles: i64,
    /// End; may be the begin.
    pub end_cycles: i64,
    /// A thread's index, or an owner below zero.
    pub owner: i64,
    /// The interrupt's source while a handler runs, else -1.
    pub source: i64,
}

/// Shares of the whole run, each 0 to 1; `background` is part of `threads`, the rest sum to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Utilization {
    /// By the thread's index.
    pub threads: Vec<f64>,
    /// Handlers.
    pub interrupts: f64,
    /// The run-time.
    pub kernel: f64,
    /// Nothing.
    pub idle: f64,
    /// What background threads took: the processor would otherwise be idle.
    pub background: f64,
}

impl Utilization {
    /// Share of tasks, interrupts and kernel, without background threads.
    #[must_use]
    pub fn busy(&self) -> f64 {
        1.0 - self.idle - self.background
    }
}

/// Jobs of one thread, event by event.
#[derive(Default)]
struct JobBuilder {
    starts: BTreeMap<i64, i64>,
    ends: BTreeMap<i64, i64>,
    releases: Vec<i64>,
    pending: Option<i64>,
}

impl JobBuilder {
    fn select(&mut self, at: i64) {
        if let Some(nominal) = self.pending.take() {
            self.starts.insert(nominal, at);
        }
    }

    /// A job is released; when the thread is running already, it starts at once.
    fn release(&mut self, at: i64, nominal: i64, running: bool) {
        self.releases.push(nominal);
        if running {
            self.starts.insert(nominal, at.max(nominal));
        } else {
            self.pending = Some(nominal);
        }
    }

    fn jobs(self) -> Vec<Job> {
        let job = |&release_cycles: &i64| Job {
            release_cycles,
            start_cycles: self.starts.get(&release_cycles).copied(),
            completion_cycles: self.ends.get(&release_cycles).copied(),
        };
        self.releases.iter().map(job).collect()
    }
}

/// Jobs of every thread, by the thread's index, in the order of their releases.
///
/// A completion names the nominal release of its job; the first execution of a job is the first
/// selection of the thread after its release event, or the release itself when it already ran.
#[must_use]
pub fn jobs(run: &Run<'_>) -> Vec<Vec<Job>> {
    let mut builders: Vec<JobBuilder> = Vec::new();
    builders.resize_with(run.threads.len(), JobBuilder::default);
    let mut running = IDLE;
    for event in run.events.iter() {
        let (at, value) = (event.at_cycles as i64, event.value);
        if event.kind == EventKind::ThreadRunning {
            running = event.subject;
        }
        let Some(builder) = builders.get_mut(event.subject as usize) else {
            continue;
        };
        match event.kind {
            EventKind::ThreadRunning => builder.select(at),
            EventKind::Release => builder.release(at, value, running == event.subject),
            EventKind::Completion => drop(builder.ends.insert(value, at)),
            _ => {}
        }
    }
    builders.into_iter().map(JobBuilder::jobs).collect()
}

/// Indices of the threads, from high to low base priority.
#[must_use]
pub fn by_priority(threads: &[Thread]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..threads.len()).collect();
    order.sort_by_key(|&index| Reverse(threads[index].base_priority));
    order
}

/// Measures of one thread's jobs; its deadline comes from the task set.
pub(crate) fn measure_task(
    run: &Run<'_>,
    thread: usize,
    jobs: &[Job],
    task: Option<&Task>,
) -> TaskMeasures {
    let ends = jobs
        .iter()
        .filter_map(|job| Some(job.completion_cycles? - job.release_cycles));
    let responses: Vec<i64> = ends.collect();
    let starts = jobs
        .iter()
        .filter_map(|job| Some(job.start_cycles? - job.release_cycles));
    let latencies: Vec<i64> = starts.collect();
    let (earliest, latest) = (latencies.iter().min(), latencies.iter().max());
    let deadline = task.and_then(|task| task.deadline_us);
    let deadline = deadline.map(|us| run.clock.cycles_of_us(us) as i64);
    let late = |job: &&Job| {
        let end = job.completion_cycles.unwrap_or(run.stop.at_cycles as i64);
        deadline.is_some_and(|deadline| end - job.release_cycles > deadline)
    };
    let total: i128 = responses.iter().copied().map(i128::from).sum();
    TaskMeasures {
        name: run.threads[thread].name.clone(),
        releases: jobs.len(),
        completions: responses.len(),
        response_time_cycles_min: responses.iter().min().copied(),
        response_time_cycles_mean: (!responses.is_empty())
            .then(|| total as f64 / responses.len() as f64),
        response_time_cycles_max: responses.iter().max().copied(),
        release_jitter_cycles: latest
            .zip(earliest)
            .map(|(latest, earliest)| latest - earliest),
        release_latency_cycles_max: latest.copied(),
        deadline_cycles: deadline,
        deadline_misses: jobs.iter().filter(late).count(),
    }
}

/// Who has the processor, event by event.
struct Processor {
    stops: bool,
    stopped: bool,
    handlers: Vec<u32>,
    running: u32,
}

impl Processor {
    /// Owner of the next cycles, and source of the innermost handler.
    ///
    /// Without stop events, the idle thread counts as idle.
    fn owner(&self) -> (i64, i64) {
        match self.handlers.last() {
            _ if self.stopped => (IDLE_OWNER, NO_SOURCE),
            Some(&source) => (INTERRUPT_OWNER, i64::from(source)),
            None if self.running != IDLE => (i64::from(self.running), NO_SOURCE),
            None if self.stops => (KERNEL_OWNER, NO_SOURCE),
            None => (IDLE_OWNER, NO_SOURCE),
        }
    }

    /// Take an event into account; false for one that gives the processor to nobody.
    fn apply(&mut self, kind: EventKind, subject: u32) -> bool {
        match kind {
            EventKind::ThreadRunning => self.running = subject,
            EventKind::InterruptEntered => self.handlers.push(subject),
            EventKind::InterruptLeft => drop(self.handlers.pop()),
            EventKind::ProcessorStopped => self.stopped = true,
            EventKind::ProcessorResumed => self.stopped = false,
            _ => return false,
        }
        true
    }
}

/// The run cut at its events, from cycle 0 to the stop without gaps.
///
/// Neighbours may have the same owner, and a stretch may be empty.
#[must_use]
pub fn stretches(run: &Run<'_>) -> Vec<Stretch> {
    let mut found = Vec::new();
    each_stretch(run, |stretch| found.push(stretch));
    found
}

fn each_stretch(run: &Run<'_>, mut found: impl FnMut(Stretch)) {
    let mut processor = Processor {
        stops: run.of_kind(EventKind::ProcessorStopped).next().is_some(),
        stopped: false,
        handlers: Vec::new(),
        running: IDLE,
    };
    let (mut begin_cycles, mut owner) = (0, processor.owner());
    let mut cut = |at: u64, next: (i64, i64)| {
        let end_cycles = begin_cycles.max(at as i64);
        let (was, source) = std::mem::replace(&mut owner, next);
        found(Stretch {
            begin_cycles,
            end_cycles,
            owner: was,
            source,
        });
        begin_cycles = end_cycles;
    };
    for event in run.events.iter() {
        if processor.apply(event.kind, event.subject) {
            cut(event.at_cycles, processor.owner());
        }
    }
    cut(run.stop.at_cycles, (IDLE_OWNER, NO_SOURCE));
}

/// Shares of the processor over the whole run; `background` are names of background threads.
#[must_use]
pub fn utilization(run: &Run<'_>, background: &BTreeSet<&str>) -> Utilization {
    let mut cycles: BTreeMap<i64, i64> = BTreeMap::new();
    each_stretch(run, |stretch| {
        *cycles.entry(stretch.owner).or_default() += stretch.end_cycles - stretch.begin_cycles;
    });
    let total = cycles.values().sum::<i64>().max(1);
    let share = |owner: i64| cycles.get(&owner).copied().unwrap_or(0) as f64 / total as f64;
    let threads: Vec<f64> = (0..run.threads.len())
        .map(|index| share(index as i64))
        .collect();
    let aside = run.threads.iter().zip(&threads);
    let aside = aside.filter(|(thread, _)| background.contains(thread.name.as_str()));
    Utilization {
        background: aside.map(|(_, part)| part).sum::<f64>() + 0.0,
        threads,
        interrupts: share(INTERRUPT_OWNER),
        kernel: share(KERNEL_OWNER),
        idle: share(IDLE_OWNER),
    }
}
