// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycles of a block on each edge out of it.
//!
//! Instructions under conditions are added up for each combination of flags, so that two of them
//! with opposite conditions are never both charged. An instruction that sets flags passes the
//! largest sum on to all combinations that may follow.

use crate::graph::control_flow::{Block, Edge};
use crate::graph::static_cost::BlockCost;
use crate::values::flags::passing;
use crate::values::records::{BlockRecord, InstructionRecord};
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

/// Cycles on each edge of a block with the call at its end, which takes `call_cycles` without the
/// refill after its return; `None` for an edge that is never taken.
pub fn edge_cycles(
    block: &Block,
    cost: &BlockCost,
    record: &BlockRecord,
    call_cycles: u64,
) -> Vec<Option<u64>> {
    let mut costs: ByFlags = [Some(0); 16];
    let straight = block.instructions.len() - usize::from(block.transfer.is_some());
    for (position, (_, instruction)) in block.instructions.iter().enumerate() {
        let known = &record.instructions[position];
        keep(&mut costs, known.flags);
        let fetch = cost.steps[position].fetch;
        if position < straight {
            costs = pass_through(&costs, instruction, known, fetch);
            continue;
        }
        let passes = passing(instruction.condition);
        let executed = executed_cycles(instruction, known) + call_cycles + cost.after_call;
        let cycles = |(number, edge): (usize, &Edge)| {
            let mask = if edge.executed { passes } else { !passes };
            let before = worst(&costs, mask).filter(|_| record.feasible[number])?;
            let refill = cost.refills[number];
            Some(before + fetch + if edge.executed { executed + refill } else { 0 })
        };
        return block.edges.iter().enumerate().map(cycles).collect();
    }
    let total = worst(&costs, u16::MAX);
    let feasible = record.feasible.iter();
    feasible
        .map(|feasible| total.filter(|_| *feasible))
        .collect()
}
