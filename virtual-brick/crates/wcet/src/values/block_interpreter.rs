// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Abstract interpretation of a basic block, and the records of what is known about it.

use crate::graph::control_flow::{Block, ControlFlowGraph, ControlTransfer, Target};
use crate::graph::static_cost::BlockCost;
use crate::inputs::image::Entry;
use crate::values::instruction::{execute, Effects, Environment};
use crate::values::records::{BlockRecord, InstructionRecord};
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::instruction::{Instruction, Operation, ALWAYS};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

/// Most paths that are distinguished within a block.
const MAX_PATHS: usize = 8;

/// Most of them that are still distinguished when all flags are set anew.
const MAX_PATHS_OVER_FLAGS: usize = 2;

/// The outcome of a call in one state.
pub enum CallOutcome {
    /// It returns, with this state and the cycles of the callee added, after it took at most so
    /// many bytes of stack.
    Returns(State, Option<u32>),
    /// It does not return.
    NeverReturns,
    /// It was not analysed in its context: the state before it, with the cycles added that it takes
    /// for any state with these arguments, and the bytes of stack.
    Bounded(State, Option<u32>),
}

/// Executes calls in the states in which they are made.
pub trait CallHandler {
    /// The callee executed on its caller's state.
    fn call(&self, callee: Entry, state: State) -> CallOutcome;
}

/// Executes blocks of one function.
pub struct BlockInterpreter<'a> {
    /// Code, constants, regions.
    pub environment: Environment<'a>,
    /// The function's graph.
    pub flow: &'a ControlFlowGraph,
    /// Which of r0 to r12 a function does not preserve.
    pub changed: &'a BTreeMap<Entry, u16>,
    /// Costs of the blocks, where cycles are counted.
    pub costs: &'a [BlockCost],
    /// Blocks that are not executed; those beyond the list are.
    pub avoided: &'a [bool],
    /// Analyses calls in their context.
    pub calls: Option<&'a dyn CallHandler>,
    /// What is known about each block; empty where nothing is recorded.
    pub records: Vec<BlockRecord>,
    /// Instructions executed.
    pub step_count: u64,
    /// Where executions of blocks are counted.
    pub visits: Option<&'a RefCell<Vec<u64>>>,
    /// Deepest stack in bytes below the function's entry, with what is called.
    pub deepest_bytes: Option<u32>,
}

/// Edges out of a block with their states, and the target of its last instruction.
pub struct BlockOutcome {
    /// Index of the edge and the state on it.
    pub edges: Vec<(usize, State)>,
    /// Value given to r15.
    pub target: Option<Value>,
    /// r14 when that happened.
    pub link: Option<Value>,
}

impl BlockOutcome {
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

impl<'a> BlockInterpreter<'a> {
    /// An interpreter without records so far.
    pub fn new(
        environment: Environment<'a>,
        flow: &'a ControlFlowGraph,
        changed: &'a BTreeMap<Entry, u16>,
    ) -> Self {
        let record = |block: &Block| BlockRecord {
            instructions: vec![InstructionRecord::default(); block.instructions.len()],
            feasible: vec![false; block.edges.len()],
            depth_bytes: Some(0),
            call_depth_bytes: Some(0),
            callee_depth_bytes: Some(0),
            ..BlockRecord::default()
        };
        Self {
            records: flow.blocks.iter().map(record).collect(),
            ..Self::without_records(environment, flow, changed)
        }
    }

    /// An interpreter that records nothing.
    pub fn without_records(
        environment: Environment<'a>,
        flow: &'a ControlFlowGraph,
        changed: &'a BTreeMap<Entry, u16>,
    ) -> Self {
        Self {
            environment,
            flow,
            changed,
            costs: &[],
            avoided: &[],
            calls: None,
            records: Vec::new(),
            step_count: 0,
            visits: None,
            deepest_bytes: Some(0),
        }
    }

    /// Executes a block. Where a condition may pass or fail both states go on, until flags are
    /// set again or there are too many.
    pub fn run(&mut self, index: usize, state: State) -> BlockOutcome {
        let block = &self.flow.blocks[index];
        let last = block.instructions.len() - 1;
        let straight = if block.transfer.is_some() {
            last
        } else {
            last + 1
        };
        self.step_count += block.instructions.len() as u64;
        self.count_visit(index);
        let mut outcome = BlockOutcome {
            edges: Vec::with_capacity(1),
            target: None,
            link: None,
        };
        let mut state = state;
        for position in 0..straight {
            if !self.execute_if_decided(index, position, &mut state) {
                for state in self.execute_paths(index, position..straight, state) {
                    self.leave(index, state, &mut outcome);
                }
                return outcome;
            }
        }
        self.leave(index, state, &mut outcome);
        outcome
    }

    /// Out of a block after all instructions but a transfer at its end.
    fn leave(&mut self, index: usize, state: State, outcome: &mut BlockOutcome) {
        let flow = self.flow;
        match &flow.blocks[index].transfer {
            Some(transfer) => self.execute_transfer(index, transfer, state, outcome),
            None => self.fall_through(index, state, outcome),
        }
    }

    /// The rest of a block from an instruction on of which it is not known whether it is executed.
    fn execute_paths(&mut self, index: usize, rest: Range<usize>, state: State) -> Vec<State> {
        let block = &self.flow.blocks[index];
        let mut states = vec![state];
        for position in rest {
            if let [state] = states.as_mut_slice() {
                if self.execute_if_decided(index, position, state) {
                    continue;
                }
            }
            let merges = {
                let instruction = &block.instructions[position].1;
                instruction.condition == ALWAYS && instruction.sets_flags()
            };
            if states.len() > MAX_PATHS || merges && states.len() > MAX_PATHS_OVER_FLAGS {
                states = states
                    .into_iter()
                    .reduce(|a, b| a.join(&b))
                    .into_iter()
                    .collect();
            }
            let before = std::mem::take(&mut states);
            for state in before {
                self.execute_both_ways(index, position, state, &mut states);
            }
        }
        states
    }

    fn count_visit(&self, index: usize) {
        if let Some(visits) = self.visits {
            let mut visits = visits.borrow_mut();
            if visits.is_empty() {
                visits.resize(self.flow.blocks.len(), 0);
            }
            visits[index] += 1;
        }
    }

    /// Out of a block that ends without a branch.
    fn fall_through(&mut self, index: usize, state: State, outcome: &mut BlockOutcome) {
        let edges = 0..self.flow.blocks[index].edges.len();
        let open: Vec<usize> = edges.filter(|e| self.is_allowed(index, *e)).collect();
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

    /// May this edge be taken in what is bounded?
    fn is_allowed(&self, index: usize, edge: usize) -> bool {
        match self.flow.blocks[index].edges[edge].target {
            Target::Block(next) => self.avoided.get(next) != Some(&true),
            Target::Return => true,
        }
    }

    /// An instruction on the only state, when it is known whether it is executed.
    fn execute_if_decided(&mut self, index: usize, position: usize, state: &mut State) -> bool {
        let (address, instruction) = self.flow.blocks[index].instructions[position];
        let passes = match instruction.condition {
            ALWAYS => Some(true),
            condition => state.decided(condition),
        };
        let Some(passes) = passes else {
            return false;
        };
        self.fetch(index, position, state);
        if passes {
            self.perform(index, position, state, address, &instruction);
        }
        true
    }

    fn execute_both_ways(
        &mut self,
        index: usize,
        position: usize,
        mut state: State,
        after: &mut Vec<State>,
    ) {
        let (address, instruction) = self.flow.blocks[index].instructions[position];
        self.fetch(index, position, &mut state);
        if instruction.condition == ALWAYS {
            self.perform(index, position, &mut state, address, &instruction);
            after.push(state);
            return;
        }
        let (failed, passed) = state.split(instruction.condition);
        after.extend(failed);
        if let Some(mut state) = passed {
            self.perform(index, position, &mut state, address, &instruction);
            after.push(state);
        }
    }

    /// The instruction is fetched, whether or not its condition passes.
    fn fetch(&mut self, index: usize, position: usize, state: &mut State) {
        if let Some(record) = self.records.get_mut(index) {
            record.instructions[position].flags |= state.flags;
        }
        if let Some(cost) = self.costs.get(index) {
            let address = self.flow.blocks[index].instructions[position].0;
            state.elapsed.add(address, 1, cost.steps[position].fetch);
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
        let depth_before = state.depth_bytes();
        let effects = execute(self.environment, state, address, instruction);
        let urgency = before.max(state.urgencies.last().copied());
        let region = effects.address.as_ref().map(|value| {
            let found = self.environment.map.of_value(value);
            found.or_else(|| self.environment.facts?.region(address))
        });
        let cycles = internal_cycles(instruction, effects.multiplier.as_ref());
        let cycles = cycles + self.gap_cycles(index, address, instruction, cycles);
        let depth = state.depth_bytes();
        self.deepest_bytes = deeper(self.deepest_bytes, depth);
        let access = |write| region.map_or(0, |r| self.environment.map.data_cycles(r, write));
        let (read, write) = (access(false), access(true));
        if let Some(cost) = self.costs.get(index) {
            let step = cost.steps[position];
            let cycles = step.reads * read + step.writes * write + u64::from(cycles);
            state.elapsed.add(address, 0, cycles);
        }
        if let Some(block) = self.records.get_mut(index) {
            let record = &mut block.instructions[position];
            record.read_cycles = record.read_cycles.max(read);
            record.write_cycles = record.write_cycles.max(write);
            record.unknown_address |= region == Some(None);
            record.internal_cycles = record.internal_cycles.max(cycles);
            block.urgency = block.urgency.max(urgency);
            block.depth_bytes = deeper(block.depth_bytes, depth);
            if depth.is_none() && depth_before.is_some() {
                block.depth_lost.get_or_insert(address);
            }
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
        self.environment.map.after_gap(next, thumb) as u32
    }

    fn execute_transfer(
        &mut self,
        index: usize,
        transfer: &ControlTransfer,
        state: State,
        outcome: &mut BlockOutcome,
    ) {
        let block = &self.flow.blocks[index];
        let position = block.instructions.len() - 1;
        let (address, instruction) = block.instructions[position];
        let mut state = state;
        self.fetch(index, position, &mut state);
        let mut own_target = None;
        let (mut failed, passed) = state.split(instruction.condition);
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
        let feasible_edge = |number: &usize| {
            let edge = &edges[*number];
            self.is_allowed(index, *number)
                && (!edge.executed || flow.edge_fits(edge, transfer, targets.as_deref()))
        };
        let open: Vec<usize> = (0..edges.len()).filter(feasible_edge).collect();
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
                    let refills = cost.refills[number] + cost.after_call;
                    state.elapsed.add(address, 0, refills);
                }
                outcome.leave(number, state);
            }
        }
    }
}

impl ControlFlowGraph {
    /// Can an executed edge be taken when r15 gets one of these values?
    fn edge_fits(
        &self,
        edge: &crate::graph::control_flow::Edge,
        transfer: &ControlTransfer,
        targets: Option<&[u32]>,
    ) -> bool {
        match (edge.target, transfer, targets) {
            (Target::Block(block), ControlTransfer::Jump(_), Some(targets)) => {
                let address = self.blocks[block].node.address;
                targets.iter().any(|target| target & !1 == address)
            }
            _ => true,
        }
    }
}

/// The deeper of two stacks, unknown where one is.
pub fn deeper(one: Option<u32>, other: Option<u32>) -> Option<u32> {
    one.zip(other).map(|(one, other)| one.max(other))
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
