// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Behaviour of the observer on a made-up memory with two control blocks.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use trace::{Event, EventKind, NameSpace, Names, IDLE};

use super::layout::Layout;
use super::observer::{Sink, ThreadObserver};
use super::Memory;

const RUNNING: u32 = 0x0020_0000;
const FIRST: u32 = 0x0020_0004;
const CONTROL: u32 = 0x0020_0100;
const DISPLAY: u32 = 0x0020_0200;
const STATE: u32 = 16;
const WAKE: u32 = 20;

const LAYOUT: Layout = Layout {
    running_address: RUNNING,
    first_address: FIRST,
    next: 0,
    name_address: 4,
    name_length: 8,
    base_priority: 12,
    state: STATE,
    wake_time: WAKE,
    stack_base: 28,
    stack_size: 32,
};

#[derive(Default)]
struct Bytes(BTreeMap<u32, u8>);

impl Bytes {
    fn put(&mut self, address: u32, value: u32) {
        for (address, byte) in (address..).zip(value.to_le_bytes()) {
            self.0.insert(address, byte);
        }
    }
}

impl Memory for Bytes {
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool {
        for (address, byte) in (address..).zip(bytes.iter_mut()) {
            *byte = self.0.get(&address).copied().unwrap_or(0);
        }
        (0x0020_0000..0x0021_0000).contains(&address)
    }
}

struct Bench {
    memory: Bytes,
    observer: ThreadObserver,
    events: Vec<Event>,
    names: Names,
}

impl Bench {
    fn new() -> Self {
        let mut memory = Bytes::default();
        for (block, name, priority) in [(CONTROL, b"control", 7), (DISPLAY, b"display", 3)] {
            memory.put(block + 4, block + 64);
            memory.put(block + 8, 7);
            memory.put(block + 12, priority);
            for (address, byte) in (block + 64..).zip(name) {
                memory.0.insert(address, *byte);
            }
        }
        let mut observer = ThreadObserver::new(LAYOUT, None);
        observer.clock_started(1_000);
        Self {
            memory,
            observer,
            events: Vec::new(),
            names: Names::default(),
        }
    }

    fn write(&mut self, at_cycles: u64, address: u32, value: u32) {
        self.memory.put(address, value);
        let mut sink = Sink {
            events: &mut self.events,
            names: &mut self.names,
        };
        self.observer
            .written(at_cycles, address, value, &self.memory, &mut sink);
    }

    fn seen(&self) -> Vec<(u64, EventKind, u32, i64)> {
        self.events
            .iter()
            .map(|e| (e.at_cycles, e.kind, e.subject, e.value))
            .collect()
    }
}

fn with_two_threads() -> Bench {
    let mut bench = Bench::new();
    bench.write(10, FIRST, CONTROL);
    bench.write(20, CONTROL, DISPLAY);
    bench
}

#[test]
fn threads_are_numbered_in_the_order_of_their_appearance_in_the_list() {
    let mut bench = with_two_threads();
    bench.write(30, CONTROL + STATE, 1);
    bench.write(40, DISPLAY + STATE, 1);
    assert_eq!(bench.names.all(NameSpace::Thread), ["control", "display"]);
}

#[test]
fn the_words_to_watch_are_the_list_and_each_threads_link_and_state() {
    let mut bench = Bench::new();
    assert_eq!(bench.observer.take_new_watches(), [RUNNING, FIRST]);
    bench.write(10, FIRST, CONTROL);
    assert_eq!(
        bench.observer.take_new_watches(),
        [CONTROL, CONTROL + STATE]
    );
    assert!(bench.observer.take_new_watches().is_empty());
}

#[test]
fn a_thread_that_was_ready_before_it_was_linked_is_released_at_its_discovery() {
    let mut bench = Bench::new();
    bench.memory.put(CONTROL + STATE, 1);
    bench.write(10, FIRST, CONTROL);
    let expected = [
        (10, EventKind::ThreadState, 0, 1),
        (10, EventKind::Release, 0, 10),
    ];
    assert_eq!(bench.seen(), expected);
}

#[test]
fn a_cyclic_job_is_released_at_the_wake_time_of_the_preceding_delay() {
    let mut bench = with_two_threads();
    bench.write(100, CONTROL + STATE, 1);
    bench.memory.put(CONTROL + WAKE, 21_024);
    bench.write(900, CONTROL + STATE, 2);
    bench.write(49_100, CONTROL + STATE, 1);
    bench.memory.put(CONTROL + WAKE, 42_048);
    bench.write(50_000, CONTROL + STATE, 2);
    let jobs: Vec<_> = bench
        .seen()
        .into_iter()
        .filter(|e| e.1 != EventKind::ThreadState)
        .collect();
    let expected = [
        (100, EventKind::Release, 0, 100),
        (900, EventKind::Completion, 0, 100),
        (49_100, EventKind::Release, 0, 49_055),
        (50_000, EventKind::Completion, 0, 49_055),
    ];
    assert_eq!(jobs, expected);
}

#[test]
fn a_job_released_by_an_event_has_the_instant_of_the_transition_as_nominal_release() {
    let mut bench = with_two_threads();
    bench.write(100, DISPLAY + STATE, 1);
    bench.write(200, DISPLAY + STATE, 4);
    bench.write(300, DISPLAY + STATE, 1);
    assert_eq!(
        bench.seen().last(),
        Some(&(300, EventKind::Release, 1, 300))
    );
}

/// Nominal releases of a thread that waits for an event at 60,000 and delays until an instant.
fn releases_around_a_delay(wake_time: u32) -> Vec<i64> {
    let mut bench = with_two_threads();
    bench.write(100, DISPLAY + STATE, 1);
    bench.write(200, DISPLAY + STATE, 4);
    bench.write(60_000, DISPLAY + STATE, 1);
    bench.memory.put(DISPLAY + WAKE, wake_time);
    bench.write(60_500, DISPLAY + STATE, 2);
    bench.write(60_600, DISPLAY + STATE, 1);
    let released = |event: &&(u64, EventKind, u32, i64)| event.1 == EventKind::Release;
    let seen = bench.seen();
    seen.iter().filter(released).map(|event| event.3).collect()
}

#[test]
fn a_delay_until_an_instant_before_the_event_is_released_where_it_is_called() {
    assert_eq!(releases_around_a_delay(21_024), [100, 60_000, 60_600]);
}

#[test]
fn a_delay_until_an_instant_after_the_event_is_released_at_that_instant() {
    assert_eq!(releases_around_a_delay(25_900), [100, 60_000, 60_200]);
}

#[test]
fn termination_ends_no_job() {
    let mut bench = with_two_threads();
    bench.write(100, CONTROL + STATE, 1);
    bench.write(200, CONTROL + STATE, 5);
    assert_eq!(
        bench.seen().last(),
        Some(&(200, EventKind::ThreadState, 0, 5))
    );
}

#[test]
fn writes_that_change_nothing_give_no_event() {
    let mut bench = with_two_threads();
    bench.write(90, RUNNING, 0);
    bench.write(100, RUNNING, CONTROL);
    bench.write(110, RUNNING, CONTROL);
    bench.write(120, RUNNING, 0);
    let expected = [
        (100, EventKind::ThreadRunning, 0, 0),
        (120, EventKind::ThreadRunning, IDLE, 0),
    ];
    assert_eq!(bench.seen(), expected);
}

#[test]
fn a_list_that_loops_or_leaves_memory_ends_the_walk() {
    let mut bench = with_two_threads();
    bench.write(30, DISPLAY, CONTROL);
    bench.write(40, DISPLAY, 0x8000_0000);
    bench.write(50, RUNNING, 0x8000_0000);
    assert_eq!(bench.names.all(NameSpace::Thread).len(), 2);
    assert!(bench.seen().is_empty());
}

#[test]
fn stack_use_reaches_from_the_lowest_byte_that_is_not_zero() {
    let mut bench = with_two_threads();
    bench.memory.put(CONTROL + 28, 0x0020_1000);
    bench.memory.put(CONTROL + 32, 256);
    bench.memory.put(DISPLAY + 32, 0xFFFF_FFFF);
    bench.memory.put(0x0020_1000 + 200, 5);
    let threads = bench.observer.report(&bench.memory);
    assert_eq!((threads[0].stack_size, threads[0].stack_used), (256, 56));
    assert_eq!(
        (threads[0].name.as_str(), threads[0].base_priority),
        ("control", 7)
    );
    assert_eq!(threads[1].stack_used, 0);
}
