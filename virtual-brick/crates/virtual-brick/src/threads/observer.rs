// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From writes of watched words to events: who runs, releases and completions of jobs.

use std::sync::Arc;

use trace::{Event, EventKind, NameSpace, Names, IDLE};

use crate::stacks::Stack;
use image::Image;

use super::clock::cycle_of;
use super::layout::Layout;
use super::names::ThreadNames;
use super::Memory;

/// A list longer than this is taken for a loop.
const THREADS_MAX: usize = 256;

const VECTORS: [&str; 2] = ["ravenbrick_vectors", "ravenbrick_vectors_end"];
const FLASH: u32 = 0x0010_0000;
const RAM: u32 = 0x0020_0000;

/// How names of the functions begin that may write watched words. Others of Ada's library write
/// where their caller says.
const WRITERS: [&str; 9] = [
    "ravenbrick_",
    "system__tasking__",
    "system__interrupts__",
    "system__relative_delays__",
    "ada__dispatching__",
    "ada__real_time__delays__",
    "ada__real_time__timing_events__",
    "ada__calendar__delays__",
    "ada__synchronous_task_control__",
];
/// The run-time needs a few hundred from the new state of the running thread to the next thread.
const LEAVES_CYCLES: u64 = 10_000;

const READY: u32 = 1;
const DELAYED: u32 = 2;
const BLOCKED_LAST: u32 = 4;

/// What is known of one thread.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    pub address: u32,
    pub state: u32,
    /// Nominal release of the job that runs.
    release: Option<u64>,
    /// Nominal release of the next job, set while delayed.
    next_release: Option<u64>,
    /// The event that released the last job, where the thread waited for one.
    last_event: Option<u64>,
    named: bool,
    /// As it was when the thread became ready first: what a stack overflow overwrites cannot tell.
    pub created: Option<Created>,
}

impl Watched {
    /// Nominal release of the job that begins as the thread leaves a state to be ready.
    ///
    /// A delay until an instant that passed before the event for which the thread waited releases
    /// nothing at that instant: its job is released where the thread calls it.
    fn nominal_release(&mut self, at_cycles: u64, left: u32) -> u64 {
        let instant = self.next_release.take();
        let last_event = self.last_event.take();
        if instant.is_none() && left > DELAYED {
            self.last_event = Some(at_cycles);
        }
        let nominal = instant
            .filter(|&instant| last_event.is_none_or(|event| event <= instant))
            .unwrap_or(at_cycles);
        self.release = Some(nominal);
        nominal
    }
}

/// What does not change while a thread exists.
#[derive(Clone, Debug)]
pub(super) struct Created {
    pub name: String,
    pub base_priority: u32,
    pub stack: Stack,
}

/// Observer of the threads of a program that was linked with the run-time.
#[derive(Clone, Debug)]
pub(crate) struct ThreadObserver {
    pub(super) layout: Layout,
    pub(super) threads: Vec<Watched>,
    running: u32,
    epoch_cycles: Option<u64>,
    new_watches: Vec<u32>,
    pub(super) names: ThreadNames,
    /// Lowest words of stacks.
    bottoms: Vec<u32>,
    stack_alarm: bool,
    /// Since when the running thread waits.
    leaving: Option<u64>,
    /// A thread went on for longer than the run-time needs.
    went_on: bool,
}

/// Where an observation goes.
pub(crate) struct Sink<'a> {
    pub events: &'a mut Vec<Event>,
    pub names: &'a mut Names,
}

impl Sink<'_> {
    fn event(&mut self, at_cycles: u64, kind: EventKind, subject: u32, value: i64) {
        self.events.push(Event {
            at_cycles,
            kind,
            subject,
            value,
        });
    }
}

impl ThreadObserver {
    pub(crate) fn new(layout: Layout, image: Option<Arc<Image>>) -> Self {
        let new_watches = vec![layout.running_address, layout.first_address];
        Self {
            layout,
            threads: Vec::new(),
            running: IDLE,
            epoch_cycles: None,
            new_watches,
            names: ThreadNames { layout, image },
            bottoms: Vec::new(),
            stack_alarm: false,
            leaving: None,
            went_on: false,
        }
    }

    /// The running thread; none while none runs.
    pub(crate) fn running_index(&self) -> Option<usize> {
        (self.running != IDLE).then_some(self.running as usize)
    }

    pub(crate) fn thread_at(&self, block: u32) -> Option<usize> {
        self.threads
            .iter()
            .position(|thread| thread.address == block)
    }

    pub(crate) fn name_of(&self, index: usize) -> String {
        let created = self
            .threads
            .get(index)
            .and_then(|thread| thread.created.as_ref());
        created.map_or_else(String::new, |created| created.name.clone())
    }

    pub(crate) fn stack_of(&self, index: usize) -> Option<Stack> {
        Some(self.threads.get(index)?.created.as_ref()?.stack)
    }

    /// The lowest word of a stack was written since the last call.
    pub(crate) fn take_stack_alarm(&mut self) -> bool {
        std::mem::take(&mut self.stack_alarm)
    }

    /// The running thread's control block as the program states it now, 0 while none runs.
    pub(crate) fn running_block(&self, memory: &impl Memory) -> Option<u32> {
        memory.word(self.layout.running_address)
    }

    /// There are words to watch from now on.
    pub(crate) fn has_new_watches(&self) -> bool {
        !self.new_watches.is_empty()
    }

    /// Words to watch from now on that were not asked for before.
    pub(crate) fn take_new_watches(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.new_watches)
    }

    /// A thread waits, so that its job has ended, and runs on.
    pub(crate) fn waits_and_runs(&self, now_cycles: u64) -> bool {
        self.went_on
            || self
                .leaving
                .is_some_and(|since| Self::is_long(since, now_cycles))
    }

    fn is_long(since_cycles: u64, now_cycles: u64) -> bool {
        now_cycles.saturating_sub(since_cycles) > LEAVES_CYCLES
    }

    /// The running thread, or what it is, changes.
    fn left(&mut self, at_cycles: u64) {
        let since = self.leaving.take();
        self.went_on |= since.is_some_and(|since| Self::is_long(since, at_cycles));
    }

    /// A watched word, but for one of a stack, was written by an instruction of the program itself,
    /// or by one that it has put into the run-time. Before there are threads, the start clears the
    /// memory.
    pub(crate) fn forged(&self, address: u32, instruction: u32, memory: &impl Memory) -> bool {
        let Some(image) = &self.names.image else {
            return false;
        };
        let linked = Self::linked_address(image, instruction);
        let function = image.symbols().function_at(linked);
        let names = function.map_or(&[][..], |(_, function)| &function.names);
        let may_write = |name: &String| WRITERS.iter().any(|part| name.starts_with(part));
        let watched = !self.threads.is_empty() && !self.bottoms.contains(&address);
        let built = Self::word_of(image, linked & !3);
        let place = if instruction < FLASH {
            RAM + instruction
        } else {
            instruction
        };
        let replaced = built.is_some() && memory.word(place & !3) != built;
        watched && (replaced || !names.iter().any(may_write))
    }

    fn word_of(image: &Image, address: u32) -> Option<u32> {
        image.segments().iter().find_map(|segment| {
            let begin = address.checked_sub(segment.virtual_address)? as usize;
            let bytes = segment.bytes.get(begin..begin + 4)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?))
        })
    }

    /// Where the instruction lies in the image: at address 0 the RAM appears a second time, and
    /// there the run-time has a copy of its vectors and of its handler of interrupts.
    fn linked_address(image: &Image, instruction: u32) -> u32 {
        if instruction >= FLASH {
            return instruction;
        }
        match VECTORS.map(|name| image.symbols().get(name)) {
            [Some(begin), Some(end)] if instruction < end.address.saturating_sub(begin.address) => {
                begin.address + instruction
            }
            _ => RAM + instruction,
        }
    }

    /// The instruction's place, for people.
    pub(crate) fn place(&self, instruction: u32) -> String {
        let image = self.names.image.as_deref();
        image.map_or_else(String::new, |image| {
            crate::dead_ends::place(image, instruction)
        })
    }

    /// The clock of the run-time starts: the interval timer was enabled at this cycle.
    pub(crate) fn clock_started(&mut self, at_cycles: u64) {
        self.epoch_cycles = Some(at_cycles);
    }

    /// A watched word was written.
    pub(crate) fn written(
        &mut self,
        at_cycles: u64,
        address: u32,
        value: u32,
        memory: &impl Memory,
        sink: &mut Sink<'_>,
    ) {
        if address == self.layout.running_address {
            self.selected(at_cycles, value, memory, sink);
            return;
        }
        if self.bottoms.contains(&address) {
            self.stack_alarm = true;
            return;
        }
        let state = self
            .threads
            .iter()
            .position(|t| t.address.wrapping_add(self.layout.state) == address);
        match state {
            Some(index) => self.state_changed(at_cycles, index, value, memory, sink),
            None => self.discover(at_cycles, memory, sink),
        }
    }

    fn selected(&mut self, at_cycles: u64, block: u32, memory: &impl Memory, sink: &mut Sink<'_>) {
        let subject = match block {
            0 => IDLE,
            _ => match self.index_of(at_cycles, block, memory, sink) {
                Some(index) => index as u32,
                None => return,
            },
        };
        if subject != self.running {
            self.left(at_cycles);
            self.running = subject;
            sink.event(at_cycles, EventKind::ThreadRunning, subject, 0);
        }
    }

    /// Index of a control block; one that is not in the list yet is added.
    fn index_of(
        &mut self,
        at_cycles: u64,
        block: u32,
        memory: &impl Memory,
        sink: &mut Sink<'_>,
    ) -> Option<usize> {
        self.discover(at_cycles, memory, sink);
        let index = self
            .threads
            .iter()
            .position(|thread| thread.address == block);
        let index = index.or_else(|| self.add(at_cycles, block, memory, sink))?;
        self.name(index, memory, sink);
        Some(index)
    }

    /// Walk the list of control blocks and add those that are new.
    fn discover(&mut self, at_cycles: u64, memory: &impl Memory, sink: &mut Sink<'_>) {
        let mut block = memory.word(self.layout.first_address).unwrap_or(0);
        for _ in 0..THREADS_MAX {
            if block == 0 {
                return;
            }
            if !self.threads.iter().any(|thread| thread.address == block)
                && self.add(at_cycles, block, memory, sink).is_none()
            {
                return;
            }
            block = memory
                .word(block.wrapping_add(self.layout.next))
                .unwrap_or(0);
        }
    }

    fn add(
        &mut self,
        at_cycles: u64,
        block: u32,
        memory: &impl Memory,
        sink: &mut Sink<'_>,
    ) -> Option<usize> {
        let state = memory.word(block.wrapping_add(self.layout.state))?;
        if block % 4 != 0 || self.threads.len() >= THREADS_MAX {
            return None;
        }
        let index = self.threads.len();
        self.threads.push(Watched {
            address: block,
            state: 0,
            release: None,
            next_release: None,
            last_event: None,
            named: false,
            created: None,
        });
        sink.names
            .add(NameSpace::Thread, &format!("thread {index}"));
        self.new_watches.push(block.wrapping_add(self.layout.next));
        self.new_watches.push(block.wrapping_add(self.layout.state));
        self.state_changed(at_cycles, index, state, memory, sink);
        Some(index)
    }

    fn name(&mut self, index: usize, memory: &impl Memory, sink: &mut Sink<'_>) {
        let thread = &mut self.threads[index];
        if thread.named {
            return;
        }
        if let Some(name) = self.names.of(thread.address, memory) {
            sink.names.rename(NameSpace::Thread, index as u32, &name);
            thread.named = true;
        }
    }

    fn state_changed(
        &mut self,
        at_cycles: u64,
        index: usize,
        state: u32,
        memory: &impl Memory,
        sink: &mut Sink<'_>,
    ) {
        let previous = std::mem::replace(&mut self.threads[index].state, state);
        if previous == state {
            return;
        }
        self.name(index, memory, sink);
        let subject = index as u32;
        let waits = (DELAYED..=BLOCKED_LAST).contains(&state);
        if subject == self.running {
            self.left(at_cycles);
            self.leaving = (previous == READY && waits).then_some(at_cycles);
        }
        sink.event(at_cycles, EventKind::ThreadState, subject, i64::from(state));
        if state == READY {
            self.note_created(index, memory);
            let nominal = self.threads[index].nominal_release(at_cycles, previous);
            sink.event(at_cycles, EventKind::Release, subject, nominal as i64);
        } else if previous == READY && waits {
            if let Some(nominal) = self.threads[index].release.take() {
                sink.event(at_cycles, EventKind::Completion, subject, nominal as i64);
            }
        }
        if state == DELAYED {
            self.threads[index].next_release = self.wake_cycle(index, memory);
        }
    }

    /// The control block is complete when the thread becomes ready first.
    fn note_created(&mut self, index: usize, memory: &impl Memory) {
        let thread = &self.threads[index];
        if thread.created.is_some() {
            return;
        }
        let word = |offset: u32| memory.word(thread.address.wrapping_add(offset));
        let layout = &self.layout;
        let fields = (
            word(layout.base_priority),
            word(layout.stack_base),
            word(layout.stack_size),
        );
        let (Some(base_priority), Some(base), Some(size)) = fields else {
            return;
        };
        let handlers = self.names.image.as_deref().and_then(Stack::of_handlers);
        let handlers = handlers.filter(|_| self.bottoms.is_empty());
        let bottoms = [Some(base), handlers.map(|stack| stack.base)];
        self.bottoms.extend(bottoms.into_iter().flatten());
        self.new_watches.extend(bottoms.into_iter().flatten());
        self.threads[index].created = Some(Created {
            name: self.names.of(thread.address, memory).unwrap_or_default(),
            base_priority,
            stack: Stack { base, size },
        });
    }

    fn wake_cycle(&self, index: usize, memory: &impl Memory) -> Option<u64> {
        let epoch_cycles = self.epoch_cycles?;
        let address = self.threads[index]
            .address
            .wrapping_add(self.layout.wake_time);
        let low = u64::from(memory.word(address)?);
        let high = u64::from(memory.word(address.wrapping_add(4))?);
        Some(cycle_of(epoch_cycles, high << 32 | low))
    }
}
