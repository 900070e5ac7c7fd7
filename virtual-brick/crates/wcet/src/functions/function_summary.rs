// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is true of a function whatever its arguments.

use crate::error::{Error, MissingBound};
use crate::graph::control_flow::{Block, ControlFlowGraph};
use crate::graph::loop_forest::LoopForest;
use crate::graph::static_cost::{block_costs, BlockCost};
use crate::inputs::facts::Facts;
use crate::inputs::image::Entry;
use crate::inputs::memory_map::MemoryMap;
use crate::values::state::State;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// What is true of a function whatever its arguments.
#[derive(Debug, Default)]
pub struct FunctionSummary {
    /// Its graph.
    pub flow: ControlFlowGraph,
    /// Its loops.
    pub forest: LoopForest,
    /// Some path returns.
    pub returns: bool,
    /// Registers of r0 to r12 that it does not preserve.
    pub changed: u16,
    /// The same for all functions it calls.
    pub callees: BTreeMap<Entry, u16>,
    /// Number of each loop within its symbol.
    pub numbers: Vec<usize>,
    /// What holds at each block, whatever the arguments; none where nothing leads.
    pub states: Vec<Option<State>>,
    /// Costs of its blocks.
    pub costs: Vec<BlockCost>,
    /// Blocks that are not executed in what is bounded.
    pub avoided: Vec<bool>,
    /// Header executions of each loop, by flow facts.
    pub limits: Vec<Option<u64>>,
    /// The same while some function is active: loop, function, header executions.
    pub limits_within_callers: Vec<(usize, Entry, u64)>,
    /// How often its blocks were executed in a program whose memory is known; empty before.
    pub visits: RefCell<Vec<u64>>,
}

/// Registers that a function may change (procedure call standard, 6.1.1).
pub const SCRATCH: u16 = 0b0001_0000_0000_1111;

impl FunctionSummary {
    /// What is assumed of a recursive function at its inner calls, and checked afterwards.
    pub fn of_recursive_call() -> Self {
        Self {
            returns: true,
            changed: SCRATCH,
            ..Self::default()
        }
    }

    /// A graph with what is looked up for it: costs of its blocks, bounds of its loops, blocks that
    /// are avoided. `numbers` are those of its loops.
    pub fn of_graph(
        facts: &Facts<'_>,
        map: &MemoryMap,
        (flow, forest): (ControlFlowGraph, LoopForest),
        numbers: Vec<usize>,
    ) -> Result<Self, Error> {
        let (limits, limits_within_callers) = facts.loop_bounds(&flow, &forest, &numbers);
        let avoided = |block: &Block| {
            let mut instructions = block.instructions.iter();
            instructions.any(|(address, _)| facts.is_avoided(*address))
        };
        Ok(Self {
            costs: block_costs(map, &flow)?,
            avoided: flow.blocks.iter().map(avoided).collect(),
            limits,
            limits_within_callers,
            numbers,
            flow,
            forest,
            ..Self::default()
        })
    }

    /// A loop without a bound, as the user is asked for it.
    pub fn missing_bound(&self, facts: &Facts<'_>, index: usize) -> MissingBound {
        let header = self.forest.loops[index].header;
        let lines = facts.own_lines(&self.flow, &self.forest, index);
        MissingBound {
            place: facts.image.place(self.flow.blocks[header].node.address),
            index: self.numbers[index],
            lines: lines.into_iter().collect(),
            callers: Vec::new(),
        }
    }

    /// Header executions of each loop, by flow facts, while these functions are active.
    pub fn limits_within(&self, callers: &[Entry]) -> Vec<Option<u64>> {
        let mut limits = self.limits.clone();
        for (index, function, bound) in &self.limits_within_callers {
            if callers.contains(function) {
                let known = limits[*index].unwrap_or(u64::MAX);
                limits[*index] = Some(known.min(*bound));
            }
        }
        limits
    }
}
