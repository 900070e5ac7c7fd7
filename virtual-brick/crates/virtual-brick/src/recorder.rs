// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From what the chip, the board and the observer report to the trace, in the order of time.

use at91sam7s::WatchHit;
use nxt::BoardEvent;
use trace::{Event, EventKind, NameSpace, Trace, TraceError};

use crate::assembly::{self, Machine, Observed};
use crate::configuration::Configuration;
use crate::inputs::Input;
use crate::memory::ChipMemory;
use crate::probes::Probe;
use crate::stacks::Stack;
use crate::stop::{Stop, StopReason};
use crate::threads::{Sink, Thread, ThreadObserver};

/// The trace and everything that feeds it.
#[derive(Clone, Debug)]
pub(crate) struct Recorder {
    pub trace: Trace,
    observer: Option<ThreadObserver>,
    probes: Vec<Probe>,
    pending: Vec<Event>,
    reported: Vec<BoardEvent>,
    hits: Vec<WatchHit>,
    guards_threads: bool,
    row: Vec<f64>,
    signal_period_cycles: u64,
    next_sample_cycles: u64,
}

impl Recorder {
    pub(crate) fn new(
        configuration: &Configuration,
        chip: &Machine,
        observer: Option<ThreadObserver>,
    ) -> Self {
        let mut trace = Trace::new(configuration.trace_limits);
        chip.board().signal_names().iter().for_each(|name| {
            trace.declare_signal(name);
        });
        ["A", "B", "C"].iter().for_each(|motor| {
            trace.names_mut().intern(NameSpace::Motor, motor);
        });
        Self {
            trace,
            observer,
            probes: Vec::new(),
            pending: Vec::new(),
            reported: Vec::new(),
            hits: Vec::new(),
            guards_threads: configuration.guards_threads,
            row: Vec::new(),
            signal_period_cycles: configuration.signal_period_cycles,
            next_sample_cycles: 0,
        }
    }

    pub(crate) fn next_sample_cycles(&self) -> u64 {
        self.next_sample_cycles
    }

    pub(crate) fn add_probe(&mut self, probe: Probe) {
        if !self.probes.iter().any(|known| known.path == probe.path) {
            self.trace.declare_signal(&format!("probe.{}", probe.path));
            self.probes.push(probe);
        }
    }

    pub(crate) fn probes(&self) -> &[Probe] {
        &self.probes
    }

    pub(crate) fn threads(&self, memory: &ChipMemory<'_>) -> Vec<Thread> {
        self.observer
            .as_ref()
            .map_or_else(Vec::new, |observer| observer.report(memory))
    }

    /// Control block of the running thread, 0 while none runs.
    pub(crate) fn running_thread(&self, memory: &ChipMemory<'_>) -> Option<u32> {
        self.observer.as_ref()?.running_block(memory)
    }

    /// The running thread by its position; none while none runs.
    pub(crate) fn running_index(&self) -> Option<usize> {
        self.observer.as_ref()?.running_index()
    }

    /// Position of the thread with this control block.
    pub(crate) fn thread_at(&self, block: u32) -> Option<usize> {
        self.observer.as_ref()?.thread_at(block)
    }

    /// Name of the thread with this control block.
    pub(crate) fn thread_name(&self, block: u32) -> Option<String> {
        Some(self.name_of(self.thread_at(block)?))
    }

    /// Name of a thread by its position.
    pub(crate) fn name_of(&self, index: usize) -> String {
        let observer = self.observer.as_ref();
        observer.map_or_else(String::new, |observer| observer.name_of(index))
    }

    /// Stack of a thread, once it was made ready.
    pub(crate) fn stack_of(&self, index: usize) -> Option<Stack> {
        self.observer.as_ref()?.stack_of(index)
    }

    /// The lowest word of a stack was written since the last call.
    pub(crate) fn take_stack_alarm(&mut self) -> bool {
        self.observer
            .as_mut()
            .is_some_and(ThreadObserver::take_stack_alarm)
    }

    /// Ask the chip to report writes of the words that the observer needs.
    pub(crate) fn watch_new_words(&mut self, chip: &mut Machine) {
        if let Some(observer) = &mut self.observer {
            for address in observer.take_new_watches() {
                // A control block outside RAM cannot change: nothing to watch.
                let _ = chip.watch_word(address);
            }
        }
    }

    pub(crate) fn input_applied(&mut self, at_cycles: u64, input: &Input) {
        let subject = self.trace.names_mut().intern(NameSpace::Input, &input.name);
        let value = input.value.to_bits() as i64;
        self.pending.push(Event {
            at_cycles,
            kind: EventKind::Input,
            subject,
            value,
        });
    }

    /// Something waits to be collected.
    #[inline]
    pub(crate) fn has_news(&self, chip: &Machine) -> bool {
        chip.has_watch_hits() | chip.board().has_events()
    }

    /// Record what happened since the last call, by `instruction` if one was executed. Of one
    /// instant, the board's and the chip's events come before those of threads.
    ///
    /// # Errors
    /// The stop when the supply is off, the board met what it does not model, the trace is full or
    /// the program wrote what is guarded.
    pub(crate) fn collect(
        &mut self,
        chip: &mut Machine,
        instruction: Option<u32>,
    ) -> Result<(), Stop> {
        let mut end = None;
        if chip.board().has_events() {
            end = self.take_reports(chip);
        }
        if chip.has_watch_hits() {
            self.observe_writes(chip);
            end = end.or(self.forgery(chip, instruction));
        }
        self.write_pending(chip)?;
        end.map_or(Ok(()), Err)
    }

    /// What the board has reported becomes pending; the first stop among it.
    fn take_reports(&mut self, chip: &mut Machine) -> Option<Stop> {
        let mut end = None;
        assembly::take_events(chip, &mut self.reported);
        for event in &self.reported {
            match assembly::observed(event) {
                Observed::Event(event) => self.pending.push(event),
                Observed::ClockStarted { at_cycles } => {
                    if let Some(observer) = &mut self.observer {
                        observer.clock_started(at_cycles);
                    }
                }
                Observed::PowerOff { event, sentence } => {
                    self.pending.push(event);
                    end.get_or_insert(Stop {
                        reason: StopReason::PowerOff,
                        at_cycles: event.at_cycles,
                        message: sentence.to_owned(),
                    });
                }
                Observed::Fault { at_cycles, fault } => {
                    end.get_or_insert(Stop {
                        reason: StopReason::Fault,
                        at_cycles,
                        message: fault.to_string(),
                    });
                }
            }
        }
        end
    }

    fn write_pending(&mut self, chip: &mut Machine) -> Result<(), Stop> {
        if self.pending.len() > 1 {
            self.pending.sort_by_key(|event| event.at_cycles);
        }
        let mut events = self.pending.iter();
        let written = events.try_for_each(|event| self.trace.record(*event));
        self.pending.clear();
        let room = self.trace.event_room();
        chip.board_reports().set_event_room(room);
        written.map_err(|error| stop(chip.now(), &error))
    }

    fn observe_writes(&mut self, chip: &mut Machine) {
        chip.take_watch_hits(&mut self.hits);
        let Some(observer) = &mut self.observer else {
            return;
        };
        let memory = ChipMemory(chip);
        let mut sink = Sink {
            events: &mut self.pending,
            names: self.trace.names_mut(),
        };
        for hit in &self.hits {
            observer.written(hit.at_cycles, hit.address, hit.value, &memory, &mut sink);
        }
        if observer.has_new_watches() {
            self.watch_new_words(chip);
        }
    }

    /// The stop when the program itself wrote one of the words that were observed last.
    fn forgery(&self, chip: &Machine, instruction: Option<u32>) -> Option<Stop> {
        if let Some(stop) = self.running_on(self.hits.last()?.at_cycles) {
            return Some(stop);
        }
        let observer = self.observer.as_ref().filter(|_| self.guards_threads)?;
        let (memory, instruction) = (ChipMemory(chip), instruction?);
        let forged = |hit: &&WatchHit| observer.forged(hit.address, instruction, &memory);
        let hit = self.hits.iter().find(forged)?;
        Some(Stop {
            reason: StopReason::Fault,
            at_cycles: hit.at_cycles,
            message: format!(
                "the program writes what only the run-time writes of its threads; {}",
                observer.place(instruction)
            ),
        })
    }

    /// The stop when a thread that waits, as the program says, runs on all the same.
    fn running_on(&self, at_cycles: u64) -> Option<Stop> {
        let observer = self.observer.as_ref().filter(|_| self.guards_threads)?;
        let name = observer.name_of(observer.running_index().unwrap_or(0));
        observer.waits_and_runs(at_cycles).then(|| Stop {
            reason: StopReason::Fault,
            at_cycles,
            message: format!(
                "the program writes what only the run-time writes of its threads: '{name}' waits \
                 and runs on"
            ),
        })
    }

    /// One row of signals; the next one is due a period later.
    pub(crate) fn sample(&mut self, chip: &Machine) -> Result<(), Stop> {
        let now = chip.now();
        if let Some(stop) = self.running_on(now) {
            return Err(stop);
        }
        self.next_sample_cycles = (now / self.signal_period_cycles + 1) * self.signal_period_cycles;
        self.row.clear();
        chip.board().sample_signals(now, &mut self.row);
        let memory = ChipMemory(chip);
        for probe in &mut self.probes {
            probe.sample(&memory);
            self.row.push(probe.as_float());
        }
        self.trace
            .sample(now, &self.row)
            .map_err(|error| stop(now, &error))
    }
}

/// The stop that a refused record makes.
fn stop(at_cycles: u64, error: &TraceError) -> Stop {
    let reason = match error {
        TraceError::TooManyEvents { .. } | TraceError::TooManySignalValues { .. } => {
            StopReason::TraceFull
        }
        TraceError::OutOfOrder { .. } | TraceError::WrongSampleLength { .. } => StopReason::Fault,
    };
    Stop {
        reason,
        at_cycles,
        message: error.to_string(),
    }
}
