// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycles of a block on each edge out of it.
//!
//! Instructions under conditions are added up for each combination of flags, so that two of them
//! with opposite conditions are never both charged. An instruction that sets flags passes the
//! largest sum on to all combinations that may follow.

use crate::elapsed::Elapsed;
use crate::graph::control_flow::{Block, Edge};
use crate::graph::static_cost::BlockCost;
use crate::values::flags::passing;
use crate::values::records::{BlockRecord, InstructionRecord};
use arm7tdmi::instruction::Instruction;

/// Largest cost by flags; `None` where the combination cannot occur.
type ByFlags = [Option<Elapsed>; 16];

/// Cycles after the first fetch when the condition passes, without filling the pipeline.
fn executed_cycles(instruction: &Instruction, record: &InstructionRecord) -> u64 {
    let cycles = instruction.cycles(Default::default());
    u64::from(cycles.reads.count()) * record.read_cycles
        + u64::from(cycles.writes.count()) * record.write_cycles
        + u64::from(record.internal_cycles)
}

fn worst(costs: &ByFlags, mask: u16) -> Option<&Elapsed> {
    let possible = (0..16).filter(|flags| mask >> flags & 1 != 0);
    let costs = possible.filter_map(|flags| costs[flags].as_ref());
    costs.max_by_key(|cost| cost.cycles)
}

fn keep(costs: &mut ByFlags, mask: u16) {
    for (flags, cost) in costs.iter_mut().enumerate() {
        if mask >> flags & 1 == 0 {
            *cost = None;
        }
    }
}

/// The cost with the cycles of an instruction.
fn with(cost: &Elapsed, address: u32, cycles: u64) -> Elapsed {
    let mut sum = cost.clone();
    sum.add(address, 1, cycles);
    sum
}

/// One instruction that does not leave the block.
fn pass_through(
    costs: &ByFlags,
    (address, instruction): (u32, &Instruction),
    record: &InstructionRecord,
    fetch: u64,
) -> ByFlags {
    let passes = passing(instruction.condition);
    let executed = fetch + executed_cycles(instruction, record);
    let after = worst(costs, passes).map(|cost| with(cost, address, executed));
    std::array::from_fn(|flags| {
        let before = costs[flags].as_ref();
        let skipped = before
            .filter(|_| passes >> flags & 1 == 0)
            .map(|cost| with(cost, address, fetch));
        let kept = if instruction.sets_flags() {
            after.clone()
        } else {
            before
                .filter(|_| passes >> flags & 1 != 0)
                .map(|cost| with(cost, address, executed))
        };
        match (skipped, kept) {
            (Some(skipped), Some(kept)) => Some(kept.longer(&skipped)),
            (skipped, kept) => skipped.or(kept),
        }
    })
}

/// Cost on each edge of a block with the call at its end, which takes `call` without the refill
/// after its return; `None` for an edge that is never taken. Recorded as `call` is.
pub fn edge_costs(
    block: &Block,
    cost: &BlockCost,
    record: &BlockRecord,
    call: &Elapsed,
) -> Vec<Option<Elapsed>> {
    let mut costs: ByFlags = std::array::from_fn(|_| Some(call.restarted()));
    let straight = block.instructions.len() - usize::from(block.transfer.is_some());
    for (position, (address, instruction)) in block.instructions.iter().enumerate() {
        let known = &record.instructions[position];
        keep(&mut costs, known.flags);
        let fetch = cost.steps[position].fetch;
        if position < straight {
            costs = pass_through(&costs, (*address, instruction), known, fetch);
            continue;
        }
        let passes = passing(instruction.condition);
        let executed = executed_cycles(instruction, known) + cost.after_call;
        let edge_cost = |(number, edge): (usize, &Edge)| {
            let mask = if edge.executed { passes } else { !passes };
            let before = worst(&costs, mask).filter(|_| record.feasible[number])?;
            let mut sum = with(before, *address, fetch);
            if edge.executed {
                sum.add(*address, 0, executed + cost.refills[number]);
                sum.add_path(call);
            }
            Some(sum)
        };
        return block.edges.iter().enumerate().map(edge_cost).collect();
    }
    let total = worst(&costs, u16::MAX);
    let feasible = record.feasible.iter();
    feasible
        .map(|feasible| total.filter(|_| *feasible).cloned())
        .collect()
}

/// The cycles of such a cost.
pub fn edge_cycles(cost: &Option<Elapsed>) -> Option<u64> {
    cost.as_ref().map(|cost| cost.cycles)
}
