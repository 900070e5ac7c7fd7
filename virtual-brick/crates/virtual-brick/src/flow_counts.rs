// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Counts of what flow facts bound: iterations, depths of recursion, targets of indirect branches,
//! code that is not executed. The run stays the same; without points nothing is looked at.

use std::collections::{BTreeMap, BTreeSet};

use arm7tdmi::Mode;
use image::FlowPoint;
use serde::Serialize;

use crate::backtrace;
use crate::brick::VirtualBrick;
use crate::memory::ChipMemory;
use crate::threads::Memory;

/// Most arrivals that are kept for a point: a place that each job of 4 ms reaches fills them in
/// four hours.
const ARRIVALS_MAX: usize = 4_000_000;

/// Activations of the function within which a fact holds.
fn activations_of(point: &FlowPoint) -> Option<FlowPoint> {
    let FlowPoint::Loop { within, .. } = point else {
        return None;
    };
    within.as_ref().map(|within| FlowPoint::Recursion {
        entry: within.entry,
        returns: within.returns.clone(),
        at_most: u64::MAX,
        calls: u64::MAX,
    })
}

/// Something that a fact excludes happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// When.
    pub at_cycles: u64,
    /// The running thread by its position.
    pub thread: Option<usize>,
    /// Next instruction.
    pub target: u32,
    /// The number that a fact bounds, as far as it grew.
    pub count: u64,
}

/// What a run showed about a point.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FlowCount {
    /// Loop: most executions of the first block for one entry. Recursion: most activations at the
    /// same time. Together: most executions in one call. Else the number of arrivals.
    pub most: u64,
    /// Recursion: most activations in one call from outside.
    pub calls: u64,
    /// Arrivals beyond those that are kept.
    pub dropped: u64,
    /// Arrivals at a place, at each other target of a branch the first and the last, and what is
    /// more than allowed: entries of a loop, calls of a recursion, executions in one call.
    #[serde(skip)]
    pub arrivals: Vec<Arrival>,
}

impl FlowCount {
    /// Keeps an arrival while there is room.
    fn keep(&mut self, arrival: Arrival) {
        if self.arrivals.len() < ARRIVALS_MAX {
            self.arrivals.push(arrival);
        } else {
            self.dropped += 1;
        }
    }

    /// Keeps an arrival with the number that the fact bounds.
    fn keep_counted(&mut self, count: u64, arrival: &Arrival) {
        self.keep(Arrival {
            count,
            ..arrival.clone()
        });
    }
}

/// What happens at an instruction, in the order in which it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Role {
    Call,
    Header,
    Entry,
    Repeat,
    Part,
    Place,
    Branch,
    Return,
}

/// One entry of a loop: counted by the stack pointer, which differs between activations.
#[derive(Clone, Copy, Debug, Default)]
struct LoopEntry {
    count: u64,
    /// Is the function active within which the fact holds? None before that was asked.
    counts: Option<bool>,
    /// Its arrival, if there are more executions than allowed.
    arrival: Option<usize>,
}

/// The points and their counts so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlowCounts {
    /// Those that are asked for, and a recursion for each function within which facts hold.
    points: Vec<FlowPoint>,
    /// The place of that recursion, by the points that are asked for.
    activations: Vec<Option<usize>>,
    counts: Vec<FlowCount>,
    /// By address: what happens there, and to which point.
    roles: Vec<(u32, Role, usize)>,
    /// By point: stack pointers and entries, the last used first. They are few.
    entries: Vec<Vec<(u32, LoopEntry)>>,
    /// Loops on the way back to their first block.
    repeating: BTreeSet<(usize, u32)>,
    /// By point and thread, none for handlers, which have a stack of their own: stack pointers of
    /// the open activations, and activations since the outermost one; or none, and executions
    /// since the last call.
    open: BTreeMap<(usize, Option<usize>), (Vec<u32>, u64)>,
}

impl FlowCounts {
    fn new(mut points: Vec<FlowPoint>) -> Self {
        let asked = points.len();
        let mut activations = Vec::with_capacity(asked);
        for index in 0..asked {
            let function = activations_of(&points[index]);
            activations.push(function.map(|function| {
                let known = points.iter().position(|point| *point == function);
                known.unwrap_or_else(|| {
                    points.push(function);
                    points.len() - 1
                })
            }));
        }
        let mut roles = Vec::new();
        for (index, point) in points.iter().enumerate() {
            let mut add = |addresses: &[u32], role| {
                roles.extend(addresses.iter().map(|&address| (address, role, index)));
            };
            match point {
                FlowPoint::Loop {
                    header,
                    at_call,
                    entries,
                    repeats,
                    ..
                } => {
                    add(entries, Role::Entry);
                    add(repeats, Role::Repeat);
                    if *at_call {
                        add(&[*header], Role::Header);
                    }
                }
                FlowPoint::Place { addresses } => add(addresses, Role::Place),
                FlowPoint::Branch { address, .. } => add(&[*address], Role::Branch),
                FlowPoint::Together {
                    entry, addresses, ..
                } => {
                    add(&[*entry], Role::Call);
                    add(addresses, Role::Part);
                }
                FlowPoint::Recursion { entry, returns, .. } => {
                    add(&[*entry], Role::Call);
                    add(returns, Role::Return);
                }
            }
        }
        roles.sort_unstable();
        roles.dedup();
        Self {
            counts: vec![FlowCount::default(); points.len()],
            entries: vec![Vec::new(); points.len()],
            points,
            activations,
            roles,
            ..Self::default()
        }
    }

    /// Something is counted.
    pub(crate) fn is_active(&self) -> bool {
        !self.roles.is_empty()
    }

    /// What is counted at this instruction, as the first place among the roles.
    pub(crate) fn watched(&self, address: u32) -> Option<usize> {
        let begin = self.roles.partition_point(|role| role.0 < address);
        let role = self.roles.get(begin)?;
        (role.0 == address).then_some(begin)
    }

    /// The entry of a loop with this stack pointer.
    fn entry(&mut self, (point, pointer): (usize, u32)) -> &mut LoopEntry {
        let entries = &mut self.entries[point];
        match entries.iter().position(|(known, _)| *known == pointer) {
            Some(0) => {}
            Some(place) => entries.swap(0, place),
            None => {
                entries.push((pointer, LoopEntry::default()));
                let last = entries.len() - 1;
                entries.swap(0, last);
            }
        }
        &mut entries[0].1
    }

    /// Instructions at which something is counted.
    pub(crate) fn addresses(&self) -> impl Iterator<Item = u32> + '_ {
        self.roles.iter().map(|role| role.0)
    }
}

impl VirtualBrick {
    /// Count these points from now on.
    pub fn count_flow(&mut self, points: Vec<FlowPoint>) {
        self.flow_counts = FlowCounts::new(points);
        self.observe_arrivals();
    }

    /// The counts so far, in the order of the points.
    #[must_use]
    pub fn flow_counts(&self) -> &[FlowCount] {
        let asked = self.flow_counts.activations.len();
        &self.flow_counts.counts[..asked]
    }

    /// Counts the instruction whose roles begin at `first`, which was executed with this stack
    /// pointer before.
    pub(crate) fn count_instruction(&mut self, first: usize, pointer_before: u32) {
        let address = self.flow_counts.roles[first].0;
        let pointer = self.cpu.register(13);
        let arrival = Arrival {
            at_cycles: self.chip.now(),
            thread: self.recorder.running_index(),
            target: self.cpu.next_instruction_address(),
            count: 1,
        };
        let went_on = arrival.target.wrapping_sub(address) <= 4;
        for place in first.. {
            let Some((at, role, point)) = self.flow_counts.roles.get(place).copied() else {
                return;
            };
            if at != address {
                return;
            }
            let key = (point, pointer);
            match role {
                Role::Entry => self.count_loop((point, pointer), 1, &arrival),
                Role::Repeat => self.count_repeat(key, address, &arrival),
                Role::Header => {
                    let key = (point, pointer_before);
                    if !self.flow_counts.repeating.remove(&key) {
                        self.count_loop(key, 1, &arrival);
                    }
                }
                Role::Part => self.count_together(point, &arrival),
                Role::Place => self.count_arrival(point, &arrival),
                Role::Branch if !went_on && !self.is_allowed(point, arrival.target) => {
                    self.count_arrival(point, &arrival);
                }
                Role::Call => self.count_call(point, pointer_before, &arrival),
                Role::Return if !went_on => {
                    let key = (point, self.executing_thread());
                    if let Some((open, _)) = self.flow_counts.open.get_mut(&key) {
                        open.retain(|outer| *outer > pointer);
                    }
                }
                Role::Branch | Role::Return => {}
            }
        }
    }

    /// The running thread, unless a handler interrupts it.
    pub(crate) fn executing_thread(&self) -> Option<usize> {
        let in_thread = self.cpu.mode() == Some(Mode::System);
        self.recorder.running_index().filter(|_| in_thread)
    }

    /// Is this a target of the branch, or another of the calls that share it?
    fn is_allowed(&self, point: usize, target: u32) -> bool {
        let FlowPoint::Branch {
            targets,
            returns_to,
            ..
        } = &self.flow_counts.points[point]
        else {
            return true;
        };
        let link = self.cpu.register(14) & !1;
        targets.contains(&target) || returns_to.is_some_and(|place| place != link)
    }

    /// Back to the loop's first block, if the branch is taken; a call comes back and goes there.
    fn count_repeat(&mut self, key: (usize, u32), address: u32, arrival: &Arrival) {
        let FlowPoint::Loop {
            header,
            at_call,
            calls,
            ..
        } = &self.flow_counts.points[key.0]
        else {
            return;
        };
        if arrival.target != *header && !calls.contains(&address) {
            return;
        }
        if *at_call {
            self.flow_counts.repeating.insert(key);
        }
        let count = self.flow_counts.entry(key).count.max(1);
        self.count_loop(key, count + 1, arrival);
    }

    /// The loop's first block is executed for the `count`-th time since its entry.
    fn count_loop(&mut self, key: (usize, u32), count: u64, arrival: &Arrival) {
        let entry = self.flow_counts.entry(key);
        if count == 1 {
            *entry = LoopEntry::default();
        }
        entry.count = count;
        let (counts, known) = (entry.counts, entry.arrival);
        let FlowPoint::Loop { at_most, .. } = self.flow_counts.points[key.0] else {
            return;
        };
        if count <= self.flow_counts.counts[key.0].most && count <= at_most {
            return;
        }
        let counts = counts.unwrap_or_else(|| self.is_within(key));
        let found = &mut self.flow_counts.counts[key.0];
        let mut place = known;
        if counts {
            found.most = found.most.max(count);
            if count > at_most {
                let index = known.unwrap_or(found.arrivals.len());
                match found.arrivals.get_mut(index) {
                    Some(arrival) => arrival.count = count,
                    None if known.is_none() => found.keep_counted(count, arrival),
                    None => {}
                }
                place = Some(index);
            }
        }
        let entry = self.flow_counts.entry(key);
        (entry.counts, entry.arrival) = (Some(counts), place);
    }

    /// Is the function active within which the fact holds? The chain of calls is followed only
    /// where the thread, or a handler, has entered it and not returned.
    fn is_within(&self, (point, pointer): (usize, u32)) -> bool {
        let counts = &self.flow_counts;
        let FlowPoint::Loop {
            within: Some(within),
            ..
        } = &counts.points[point]
        else {
            return true;
        };
        let thread = self.executing_thread();
        let open = counts.activations[point].and_then(|at| counts.open.get(&(at, thread)));
        if !open.is_some_and(|(open, _)| open.iter().any(|outer| *outer >= pointer)) {
            return false;
        }
        let memory = ChipMemory(&self.chip);
        let registers = self.cpu.registers();
        let active = backtrace::addresses(&self.image, registers, |at| memory.word(at));
        let name = |address: &u32| self.image.symbols().nearest_code(*address);
        active
            .iter()
            .filter_map(name)
            .any(|(name, _)| name == within.function)
    }

    fn count_arrival(&mut self, point: usize, arrival: &Arrival) {
        let is_place = matches!(self.flow_counts.points[point], FlowPoint::Place { .. });
        let found = &mut self.flow_counts.counts[point];
        found.most += 1;
        if !is_place {
            let known = found.arrivals.iter_mut();
            let mut known = known.filter(|other| other.target == arrival.target);
            if let Some(last) = known.nth(1) {
                *last = arrival.clone();
                return;
            }
        }
        found.keep(arrival.clone());
    }

    fn count_together(&mut self, point: usize, arrival: &Arrival) {
        let FlowPoint::Together { at_most, .. } = self.flow_counts.points[point] else {
            return;
        };
        let key = (point, self.executing_thread());
        let (_, number) = self.flow_counts.open.entry(key).or_default();
        *number += 1;
        let count = *number;
        let found = &mut self.flow_counts.counts[point];
        found.most = found.most.max(count);
        if count > at_most {
            found.keep_counted(count, arrival);
        }
    }

    fn count_call(&mut self, point: usize, pointer: u32, arrival: &Arrival) {
        let key = (point, self.executing_thread());
        let FlowPoint::Recursion { at_most, calls, .. } = self.flow_counts.points[point] else {
            self.flow_counts.open.remove(&key);
            return;
        };
        let (open, number) = self.flow_counts.open.entry(key).or_default();
        open.retain(|outer| *outer > pointer);
        *number = if open.is_empty() { 1 } else { *number + 1 };
        open.push(pointer);
        let (depth, number) = (open.len() as u64, *number);
        let found = &mut self.flow_counts.counts[point];
        found.most = found.most.max(depth);
        found.calls = found.calls.max(number);
        if depth > at_most || number > calls {
            found.keep_counted(if depth > at_most { depth } else { number }, arrival);
        }
    }
}
