// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A block executed on a state, and what is learned on the way.

use crate::graph::control_flow::{Block, Entry, Flow, Target, Transfer};
use crate::paths::block_cost::BlockCost;
use crate::values::instruction::{execute, Effects, World};
use crate::values::state::{enter, State, ANY_URGENCY, ENDLESS};
use crate::values::value::Value;
use arm7tdmi::instruction::{Instruction, Operation, ALWAYS};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Most states that are followed side by side within a block.
const VARIANTS: usize = 8;

/// What all executions of an instruction have in common.
#[derive(Clone, Debug, Default)]
pub struct InstructionRecord {
    /// Flags that are possible before it.
    pub flags: u16,
    /// Dearest read.
    pub read_cycles: u64,
    /// Dearest write.
    pub write_cycles: u64,
    /// Most internal cycles, with what they and the accesses add to the next fetch.
    pub internal_cycles: u32,
    /// Some address was not known to lie in one region.
    pub unknown_address: bool,
}

/// What all executions of a block have in common.
#[derive(Clone, Debug, Default)]
pub struct BlockRecord {
    /// One for each instruction.
    pub instructions: Vec<InstructionRecord>,
    /// Edges that some execution takes.
    pub feasible: Vec<bool>,
    /// r0 to r3 at the call.
    pub arguments: Option<[Value; 4]>,
    /// Deepest stack in bytes below the function's entry; `None` when not known.
    pub depth_bytes: Option<u32>,
    /// Depth at the call.
    pub call_depth_bytes: Option<u32>,
    /// Highest urgency of a protected action that the block is in, at least in part.
    pub urgency: Option<u32>,
    /// Longest call at its end, where calls are followed.
    pub callee_cycles: Option<u64>,
    /// Functions that are really called at its end.
    pub callees: BTreeSet<Entry>,
}

/// What became of a call in one state.
pub enum Called {
    /// It returns, with this state and the cycles of the callee added.
    Returned(State),
    /// It does not return.
    Never,
    /// It was not followed: the state before it, and its cycles for any state with these arguments.
    Apart(State, u64),
}

/// Executes calls in the states in which they are made.
pub trait Calls {
    /// The callee executed on its caller's state.
    fn call(&self, callee: Entry, state: State) -> Called;
}

/// Executes blocks of one function.
pub struct Walker<'a> {
    /// Code, constants, regions.
    pub world: World<'a>,
    /// The function's graph.
    pub flow: &'a Flow,
    /// Which of r0 to r12 a function does not preserve.
    pub changed: &'a BTreeMap<Entry, u16>,
    /// Region given by the user for accesses at a place.
    pub given_region: &'a dyn Fn(u32) -> Option<u8>,
    /// Costs of the blocks, where cycles are counted.
    pub costs: &'a [BlockCost],
    /// Blocks that are not executed; those beyond the list are.
    pub avoided: &'a [bool],
    /// Follows calls.
    pub calls: Option<&'a dyn Calls>,
    /// What was learned, for each block; empty when nothing is to be learned.
    pub records: Vec<BlockRecord>,
    /// Instructions executed.
    pub step_count: u64,
    /// Where executions of blocks are counted.
    pub visits: Option<&'a RefCell<Vec<u64>>>,
}

/// Ways out of a block with their states, and the target of its last instruction.
pub struct Outcome {
    /// Index of the edge and the state on it.
    pub edges: Vec<(usize, State)>,
    /// Value given to r15.
    pub target: Option<Value>,
    /// r14 when that happened.
    pub link: Option<Value>,
}

impl Outcome {
    fn leave(&mut self, edge: usize, state: State) {
        match self.edges.iter_mut().find(|(known, _)| *known == edge) {
            Some((_, known)) => *known = known.join(&state),
            None => self.edges.push((edge, state)),
        }
    }

    fn reach(&mut self, target: Option<Value>, link: Value) {
        self.target = match (self.target.take(), target) {
            (Some(a), Some(b)) => Some(a.join(&b)),
            (a, b) => a.or(b),
        };
        self.link = Some(
            self.link
                .take()
                .map_or(link.clone(), |known| known.join(&link)),
        );
    }
}

fn depth(state: &State) -> Option<u32> {
    match state.registers[13] {
        Value::Stack(offset) => Some(u32::try_from(-i64::from(offset)).unwrap_or(0)),
        _ => state
            .lowest
            .or(state.parked)
            .and_then(|offset| u32::try_from(-i64::from(offset)).ok()),
    }
}

impl<'a> Walker<'a> {
    /// A walker that has learned nothing.
    pub fn new(
        world: World<'a>,
        flow: &'a Flow,
        changed: &'a BTreeMap<Entry, u16>,
        given_region: &'a dyn Fn(u32) -> Option<u8>,
    ) -> Self {
        let record = |block: &Block| BlockRecord {
            instructions: vec![InstructionRecord::default(); block.instructions.len()],
            feasible: vec![false; block.edges.len()],
            arguments: None,
            depth_bytes: Some(0),
            call_depth_bytes: Some(0),
            urgency: None,
            callee_cycles: None,
            callees: BTreeSet::new(),
        };
        Self {
            records: flow.blocks.iter().map(record).collect(),
            ..Self::counting(world, flow, changed, given_region, &[], None)
        }
    }

    /// A walker that counts cycles and learns nothing.
    pub fn counting(
        world: World<'a>,
        flow: &'a Flow,
        changed: &'a BTreeMap<Entry, u16>,
        given_region: &'a dyn Fn(u32) -> Option<u8>,
        costs: &'a [BlockCost],
        calls: Option<&'a dyn Calls>,
    ) -> Self {
        Self {
            world,
            flow,
            changed,
            given_region,
            costs,
            avoided: &[],
            calls,
            records: Vec::new(),
            step_count: 0,
            visits: None,
        }
    }

    /// Executes a block. Where a condition may pass or fail both states go on, until flags are
    /// set again or there are too many.
    pub fn run(&mut self, index: usize, state: State) -> Outcome {
        let block = &self.flow.blocks[index];
        let last = block.instructions.len() - 1;
        let straight = if block.transfer.is_some() {
            last
        } else {
            last + 1
        };
        self.step_count += block.instructions.len() as u64;
        self.note_visit(index);
        let mut outcome = Outcome {
            edges: Vec::with_capacity(1),
            target: None,
            link: None,
        };
        let mut state = state;
        for position in 0..straight {
            if !self.run_single(index, position, &mut state) {
                for state in self.run_variants(index, position..straight, state) {
                    self.leave(index, state, &mut outcome);
                }
                return outcome;
            }
        }
        self.leave(index, state, &mut outcome);
        outcome
    }

    /// Out of a block after all instructions but a transfer at its end.
    fn leave(&mut self, index: usize, state: State, outcome: &mut Outcome) {
        let flow = self.flow;
        match &flow.blocks[index].transfer {
            Some(transfer) => self.run_transfer(index, transfer, state, outcome),
            None => self.fall_through(index, state, outcome),
        }
    }

    /// The rest of a block from an instruction on of which it is not known whether it is executed.
    fn run_variants(&mut self, index: usize, rest: Range<usize>, state: State) -> Vec<State> {
        let block = &self.flow.blocks[index];
        let mut states = vec![state];
        for position in rest {
            if let [state] = states.as_mut_slice() {
                if self.run_single(index, position, state) {
                    continue;
                }
            }
            let merges = {
                let instruction = &block.instructions[position].1;
                instruction.condition == ALWAYS && instruction.sets_flags()
            };
            if states.len() > VARIANTS || merges {
                states = states
                    .into_iter()
                    .reduce(|a, b| a.join(&b))
                    .into_iter()
                    .collect();
            }
            let before = std::mem::take(&mut states);
            for state in before {
                self.run_straight(index, position, state, &mut states);
            }
        }
        states
    }

    fn note_visit(&self, index: usize) {
        if let Some(visits) = self.visits {
            let mut visits = visits.borrow_mut();
            if visits.is_empty() {
                visits.resize(self.flow.blocks.len(), 0);
            }
            visits[index] += 1;
        }
    }

    /// Out of a block that ends without a branch.
    fn fall_through(&mut self, index: usize, state: State, outcome: &mut Outcome) {
        let edges = 0..self.flow.blocks[index].edges.len();
        let open: Vec<usize> = edges.filter(|e| self.is_open(index, *e)).collect();
        let Some((last, others)) = open.split_last() else {
            return;
        };
        for edge in &open {
            if let Some(record) = self.records.get_mut(index) {
                record.feasible[*edge] = true;
            }
        }
        for edge in others {
            outcome.leave(*edge, state.clone());
        }
        outcome.leave(*last, state);
    }

    /// May this way out be taken in what is bounded?
    fn is_open(&self, index: usize, edge: usize) -> bool {
        match self.flow.blocks[index].edges[edge].target {
            Target::Block(next) => self.avoided.get(next) != Some(&true),
            Target::Return => true,
        }
    }

    /// An instruction on the only state, when it is known whether it is executed.
    fn run_single(&mut self, index: usize, position: usize, state: &mut State) -> bool {
        let (address, instruction) = self.flow.blocks[index].instructions[position];
        let passes = match instruction.condition {
            ALWAYS => Some(true),
            condition => state.decides(condition),
        };
        let Some(passes) = passes else {
            return false;
        };
        self.pass(index, position, state);
        if passes {
            self.perform(index, position, state, address, &instruction);
        }
        true
    }

    fn run_straight(
        &mut self,
        index: usize,
        position: usize,
        mut state: State,
        after: &mut Vec<State>,
    ) {
        let (address, instruction) = self.flow.blocks[index].instructions[position];
        self.pass(index, position, &mut state);
        if instruction.condition == ALWAYS {
            self.perform(index, position, &mut state, address, &instruction);
            after.push(state);
            return;
        }
        let (failed, passed) = state.divide(instruction.condition);
        after.extend(failed);
        if let Some(mut state) = passed {
            self.perform(index, position, &mut state, address, &instruction);
            after.push(state);
        }
    }

    /// The instruction is fetched, whether or not its condition passes.
    fn pass(&mut self, index: usize, position: usize, state: &mut State) {
        if let Some(record) = self.records.get_mut(index) {
            record.instructions[position].flags |= state.flags;
        }
        if let Some(cost) = self.costs.get(index) {
            state.spend(cost.steps[position].fetch);
        }
    }

    fn perform(
        &mut self,
        index: usize,
        position: usize,
        state: &mut State,
        address: u32,
        instruction: &Instruction,
    ) -> Effects {
        let before = state.urgencies.last().copied();
        let effects = execute(self.world, state, address, instruction);
        let urgency = before.max(state.urgencies.last().copied());
        let region = effects.address.as_ref().map(|value| {
            let found = self.world.map.of_value(value);
            found.or_else(|| (self.given_region)(address))
        });
        let cycles = internal_cycles(instruction, effects.multiplier.as_ref());
        let cycles = cycles + self.gap_cycles(index, address, instruction, cycles);
        let access = |write| region.map_or(0, |r| self.world.map.data_cycles(r, write));
        let (read, write) = (access(false), access(true));
        if let Some(cost) = self.costs.get(index) {
            let step = cost.steps[position];
            state.spend(step.reads * read + step.writes * write + u64::from(cycles));
        }
        if let Some(block) = self.records.get_mut(index) {
            let record = &mut block.instructions[position];
            record.read_cycles = record.read_cycles.max(read);
            record.write_cycles = record.write_cycles.max(write);
            record.unknown_address |= region == Some(None);
            record.internal_cycles = record.internal_cycles.max(cycles);
            block.urgency = block.urgency.max(urgency);
            block.depth_bytes = block.depth_bytes.zip(depth(state)).map(|(a, b)| a.max(b));
        }
        effects
    }

    /// What the next fetch costs more because this instruction keeps the bus from it. After a
    /// branch that fetch is not made.
    fn gap_cycles(&self, index: usize, at: u32, instruction: &Instruction, internal: u32) -> u32 {
        let cycles = instruction.cycles(Default::default());
        let keeps_bus = internal > 0 || cycles.reads.count() + cycles.writes.count() > 0;
        if !keeps_bus {
            return 0;
        }
        let next = at.wrapping_add(3 * instruction.size);
        let thumb = self.flow.blocks[index].node.thumb;
        self.world.map.after_gap(next, thumb) as u32
    }

    fn run_transfer(
        &mut self,
        index: usize,
        transfer: &Transfer,
        state: State,
        outcome: &mut Outcome,
    ) {
        let block = &self.flow.blocks[index];
        let position = block.instructions.len() - 1;
        let (address, instruction) = block.instructions[position];
        let mut state = state;
        self.pass(index, position, &mut state);
        let mut own_target = None;
        let (mut failed, passed) = state.divide(instruction.condition);
        let mut after = passed.and_then(|mut state| {
            let link = state.registers[14].clone();
            let effects = self.perform(index, position, &mut state, address, &instruction);
            own_target.clone_from(&effects.target);
            outcome.reach(effects.target, link);
            if !transfer.callees().is_empty() {
                let targets = own_target.as_ref().and_then(Value::elements);
                return self.call(index, address, targets.as_deref(), state);
            }
            Some(state)
        });
        let targets = own_target.as_ref().and_then(Value::elements);
        let flow = self.flow;
        let edges = &flow.blocks[index].edges;
        let possible = |number: &usize| {
            let edge = &edges[*number];
            self.is_open(index, *number)
                && (!edge.executed || flow.edge_fits(edge, transfer, targets.as_deref()))
        };
        let open: Vec<usize> = (0..edges.len()).filter(possible).collect();
        for (position, number) in open.iter().copied().enumerate() {
            let edge = &edges[number];
            let again = open[position + 1..].iter();
            let last = again
                .clone()
                .all(|other| edges[*other].executed != edge.executed);
            let state = if edge.executed {
                &mut after
            } else {
                &mut failed
            };
            let state = if last { state.take() } else { state.clone() };
            if let Some(mut state) = state {
                if let Some(record) = self.records.get_mut(index) {
                    record.feasible[number] = true;
                }
                if let Some(cost) = self.costs.get(index).filter(|_| edge.executed) {
                    state.spend(cost.refills[number] + cost.after_call);
                }
                outcome.leave(number, state);
            }
        }
    }

    /// The state after the call at the end of a block; none when it does not return.
    fn call(
        &mut self,
        index: usize,
        address: u32,
        targets: Option<&[u32]>,
        mut state: State,
    ) -> Option<State> {
        let callees = self.reached(index, targets, &state);
        self.note_masks(&callees, &mut state);
        let urgencies = self.note_call(index, &callees, &state);
        let Some(follower) = self.calls.filter(|_| !callees.is_empty()) else {
            state.urgencies = urgencies;
            self.leave_out(index, address, &mut state);
            return (!callees.is_empty()).then_some(state);
        };
        let before = state.elapsed.0;
        let mut after: Option<State> = None;
        let mut state = Some(state);
        for (position, callee) in callees.iter().enumerate() {
            let last = position + 1 == callees.len();
            let own = if last { state.take() } else { state.clone() };
            let found = match follower.call(*callee, own?) {
                Called::Returned(found) => found,
                Called::Never => continue,
                Called::Apart(mut apart, cycles) => {
                    self.leave_out(index, address, &mut apart);
                    apart.spend(cycles);
                    apart
                }
            };
            after = Some(match after {
                Some(known) => known.join(&found),
                None => found,
            });
        }
        let mut after = after?;
        after.urgencies = urgencies;
        if let Some(record) = self.records.get_mut(index) {
            let cycles = match after.elapsed.0 {
                ENDLESS => ENDLESS,
                cycles => cycles - before,
            };
            record.callee_cycles = record.callee_cycles.max(Some(cycles));
        }
        Some(after)
    }

    /// The functions that a call can reach in this state.
    fn reached(&self, index: usize, targets: Option<&[u32]>, state: &State) -> Vec<Entry> {
        let conventions = self.world.conventions;
        let calls = &self.flow.blocks[index].calls;
        let named = |callee: &Entry| {
            let found = targets.is_none_or(|t| t.iter().any(|target| target & !1 == callee.0));
            found || calls.len() == 1
        };
        let spared = |callee: &Entry| {
            let locks = conventions.locks.contains(&callee.0);
            locks && conventions.spares(&state.registers[0])
                || state.masks == Some(0) && conventions.unmasks.contains(&callee.0)
        };
        let reached = calls
            .iter()
            .filter(|callee| named(callee) && !spared(callee));
        reached.copied().collect()
    }

    fn note_masks(&self, callees: &[Entry], state: &mut State) {
        let conventions = self.world.conventions;
        let is_one = |set: &BTreeSet<u32>| callees.iter().any(|callee| set.contains(&callee.0));
        if is_one(&conventions.locks) {
            state.masks = state.masks.map(|masks| masks + 1);
        } else if is_one(&conventions.unmasks) {
            state.masks = state.masks.and_then(|masks| masks.checked_sub(1));
        }
    }

    /// Records arguments, depth and protected actions of a call; the urgencies after it.
    fn note_call(&mut self, index: usize, callees: &[Entry], state: &State) -> Vec<u32> {
        let conventions = self.world.conventions;
        let mut entered = None;
        let mut after = state.urgencies.clone();
        for (callee, _) in callees {
            if conventions.locks.contains(callee) {
                let object = state.registers[0].constant();
                let urgency = object.and_then(|object| conventions.words.get(&object));
                let urgency = urgency.copied().unwrap_or(ANY_URGENCY);
                enter(&mut after, urgency);
                entered = Some(urgency);
            } else if conventions.unlocks.contains(callee) {
                after.pop();
            }
        }
        if let Some(record) = self.records.get_mut(index) {
            let arguments: [Value; 4] = std::array::from_fn(|n| state.registers[n].clone());
            let joined = match record.arguments.take() {
                Some(known) => std::array::from_fn(|n| known[n].join(&arguments[n])),
                None => arguments,
            };
            record.arguments = Some(joined);
            record.callees.extend(callees);
            let depths = record.call_depth_bytes.zip(depth(state));
            record.call_depth_bytes = depths.map(|(a, b)| a.max(b));
            record.urgency = record.urgency.max(entered);
        }
        after
    }

    /// After a call that is not followed.
    fn leave_out(&self, index: usize, address: u32, state: &mut State) {
        let calls = &self.flow.blocks[index].calls;
        let known = calls.iter().filter_map(|callee| self.changed.get(callee));
        state.after_call(known.fold(0, |all, changed| all | changed));
        if state.registers[0] == Value::Top {
            state.set_fresh(0, address);
        }
    }
}

impl Flow {
    /// Can an executed edge be taken when r15 gets one of these values?
    fn edge_fits(
        &self,
        edge: &crate::graph::control_flow::Edge,
        transfer: &Transfer,
        targets: Option<&[u32]>,
    ) -> bool {
        match (edge.target, transfer, targets) {
            (Target::Block(block), Transfer::Jump(_), Some(targets)) => {
                let address = self.blocks[block].node.address;
                targets.iter().any(|target| target & !1 == address)
            }
            _ => true,
        }
    }
}

/// Most internal cycles with what is known about the multiplier.
fn internal_cycles(instruction: &Instruction, multiplier: Option<&Value>) -> u32 {
    let most = instruction.cycles(Default::default()).internal_max;
    let (Operation::Multiply(product), Some(value)) = (&instruction.operation, multiplier) else {
        return most;
    };
    if let Some(elements) = value.elements() {
        let cycles = elements.iter().map(|e| product.kind.internal_cycles(*e));
        return cycles.max().unwrap_or(most);
    }
    match value.bounds() {
        Some((_, high)) if high >> 31 == 0 => product.kind.internal_cycles(high),
        _ => most,
    }
}

/// Which of r0 to r12 do not hold their old values at a function's end.
pub fn changed_registers(state: &State) -> u16 {
    let kept =
        |number: u16| state.registers[usize::from(number)] == Value::entry(u32::from(number));
    (0..13)
        .filter(|number| !kept(*number))
        .fold(0, |mask, number| mask | 1 << number)
}

/// Knowledge about arguments as the callee may use it.
pub fn as_arguments(values: &[Value; 4]) -> [Value; 4] {
    std::array::from_fn(|n| match &values[n] {
        Value::Based(..) | Value::MinusStack(_) => Value::Top,
        place if place.in_stack() => Value::OuterStack,
        value => value.clone(),
    })
}

/// Nothing known about the arguments.
pub fn any_arguments() -> [Value; 4] {
    std::array::from_fn(|_| Value::Top)
}
