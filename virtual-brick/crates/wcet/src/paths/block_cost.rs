// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycles of a block on each way out of it.
//!
//! Instructions under conditions are added up for each combination of flags, so that two of them
//! with opposite conditions are never both charged. An instruction that sets flags passes the
//! largest sum on to all combinations that may follow.

use crate::error::Error;
use crate::graph::control_flow::{Block, Flow, Target, Transfer};
use crate::inputs::memory_map::MemoryMap;
use crate::values::block::{BlockRecord, InstructionRecord};
use crate::values::state::passing;
use arm7tdmi::instruction::Instruction;

/// Largest cost by flags; `None` where the combination cannot occur.
type ByFlags = [Option<u64>; 16];

/// Cycles after the first fetch when the condition passes, without filling the pipeline.
fn executed_cycles(instruction: &Instruction, record: &InstructionRecord) -> u64 {
    let cycles = instruction.cycles(Default::default());
    u64::from(cycles.reads.count()) * record.read_cycles
        + u64::from(cycles.writes.count()) * record.write_cycles
        + u64::from(record.internal_cycles)
}

fn worst(costs: &ByFlags, mask: u16) -> Option<u64> {
    let possible = (0..16).filter(|flags| mask >> flags & 1 != 0);
    possible.filter_map(|flags| costs[flags]).max()
}

fn keep(costs: &mut ByFlags, mask: u16) {
    for (flags, cost) in costs.iter_mut().enumerate() {
        if mask >> flags & 1 == 0 {
            *cost = None;
        }
    }
}

/// One instruction that does not leave the block.
fn pass_through(
    costs: &ByFlags,
    instruction: &Instruction,
    record: &InstructionRecord,
    fetch: u64,
) -> ByFlags {
    let passes = passing(instruction.condition);
    let executed = fetch + executed_cycles(instruction, record);
    let after = worst(costs, passes).map(|cost| cost + executed);
    std::array::from_fn(|flags| {
        let skipped = costs[flags]
            .filter(|_| passes >> flags & 1 == 0)
            .map(|c| c + fetch);
        let kept = if instruction.sets_flags() {
            after
        } else {
            costs[flags]
                .filter(|_| passes >> flags & 1 != 0)
                .map(|c| c + executed)
        };
        skipped.max(kept)
    })
}

/// What an instruction costs, but for the regions of its accesses and its multiplier.
#[derive(Clone, Copy, Debug)]
pub struct StepCost {
    /// The fetch, which a skipped instruction costs too.
    pub fetch: u64,
    /// Data reads.
    pub reads: u64,
    /// Data writes.
    pub writes: u64,
}

/// Costs of a block that no state changes.
#[derive(Clone, Debug)]
pub struct BlockCost {
    /// One for each instruction.
    pub steps: Vec<StepCost>,
    /// Refill on each way out, callees' included.
    pub refills: Vec<u64>,
    /// Refill after the return of a callee.
    pub after_call: u64,
}

/// Costs of all blocks of a function.
pub fn block_costs(map: &MemoryMap, flow: &Flow) -> Result<Vec<BlockCost>, Error> {
    let nodes: Vec<(u32, bool)> = flow
        .blocks
        .iter()
        .map(|block| (block.node.address, block.node.thumb))
        .collect();
    flow.blocks
        .iter()
        .map(|block| block_cost(map, block, &nodes))
        .collect()
}

fn block_cost(map: &MemoryMap, block: &Block, nodes: &[(u32, bool)]) -> Result<BlockCost, Error> {
    let thumb = block.node.thumb;
    let steps = block.instructions.iter().map(|(address, instruction)| {
        let ahead = address.wrapping_add(2 * instruction.size);
        let cycles = instruction.cycles(Default::default());
        Ok(StepCost {
            fetch: map.sequential_fetch(ahead, thumb)?,
            reads: u64::from(cycles.reads.count()),
            writes: u64::from(cycles.writes.count()),
        })
    });
    let refills = block
        .edges
        .iter()
        .map(|edge| branch_refill(map, block, edge.target, nodes));
    let after_call = match block.resumes() {
        Some((address, thumb)) => map.refill(address, thumb)?,
        None => 0,
    };
    Ok(BlockCost {
        steps: steps.collect::<Result<_, Error>>()?,
        refills: refills.collect::<Result<_, Error>>()?,
        after_call,
    })
}

/// What the ways out of a block cost besides the block itself.
pub struct Outside<'a> {
    /// Regions and their costs.
    pub map: &'a MemoryMap,
    /// Bound of the function called at the end, with the refill of its return to the block; for
    /// a tail call without.
    pub call_cycles: u64,
}

/// Cycles on each edge of a block; `None` for an edge that is never taken.
pub fn edge_cycles(
    outside: &Outside<'_>,
    block: &Block,
    record: &BlockRecord,
    targets: &[(u32, bool)],
) -> Result<Vec<Option<u64>>, Error> {
    let thumb = block.node.thumb;
    let mut costs: ByFlags = [Some(0); 16];
    let straight = block.instructions.len() - usize::from(block.transfer.is_some());
    for (position, (address, instruction)) in block.instructions.iter().enumerate() {
        let known = &record.instructions[position];
        keep(&mut costs, known.flags);
        let ahead = address.wrapping_add(2 * instruction.size);
        let fetch = outside.map.sequential_fetch(ahead, thumb)?;
        if position < straight {
            costs = pass_through(&costs, instruction, known, fetch);
            continue;
        }
        let passes = passing(instruction.condition);
        let executed = executed_cycles(instruction, known) + outside.call_cycles;
        return (0..block.edges.len())
            .map(|edge| {
                let way = &block.edges[edge];
                let mask = if way.executed { passes } else { !passes };
                let before = worst(&costs, mask).filter(|_| record.feasible[edge]);
                let refill = branch_refill(outside.map, block, way.target, targets)?;
                let taken = if way.executed { executed + refill } else { 0 };
                Ok(before.map(|cost| cost + fetch + taken))
            })
            .collect();
    }
    let total = worst(&costs, u16::MAX);
    Ok(record
        .feasible
        .iter()
        .map(|f| total.filter(|_| *f))
        .collect())
}

/// Refill after the block's branch; that of a return belongs to the caller.
fn branch_refill(
    map: &MemoryMap,
    block: &Block,
    target: Target,
    nodes: &[(u32, bool)],
) -> Result<u64, Error> {
    if let (Some(Transfer::Jump(_)), Target::Block(next)) = (&block.transfer, target) {
        let (address, thumb) = nodes[next];
        return map.refill(address, thumb);
    }
    let callees = block.transfer.iter().flat_map(Transfer::callees);
    callees
        .map(|(address, thumb)| map.refill(*address, *thumb))
        .try_fold(0, |most, cycles| Ok(cycles?.max(most)))
}
