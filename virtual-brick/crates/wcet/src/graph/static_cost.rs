// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Costs of a block that no state changes: fetches of its instructions, refills of the pipeline on
//! its edges, and how often its instructions read and write.

use crate::error::Error;
use crate::graph::control_flow::{Block, ControlFlowGraph, ControlTransfer, Target};
use crate::inputs::memory_map::MemoryMap;

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
    /// Refill on each edge, callees' included.
    pub refills: Vec<u64>,
    /// Refill after the return of a callee.
    pub after_call: u64,
}

/// Costs of all blocks of a function.
pub fn block_costs(map: &MemoryMap, flow: &ControlFlowGraph) -> Result<Vec<BlockCost>, Error> {
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

/// Refill after the block's branch; that of a return belongs to the caller.
fn branch_refill(
    map: &MemoryMap,
    block: &Block,
    target: Target,
    nodes: &[(u32, bool)],
) -> Result<u64, Error> {
    if let (Some(ControlTransfer::Jump(_)), Target::Block(next)) = (&block.transfer, target) {
        let (address, thumb) = nodes[next];
        return map.refill(address, thumb);
    }
    let callees = block.transfer.iter().flat_map(ControlTransfer::callees);
    callees
        .map(|(address, thumb)| map.refill(*address, *thumb))
        .try_fold(0, |most, cycles| Ok(cycles?.max(most)))
}
