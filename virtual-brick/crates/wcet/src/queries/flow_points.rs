// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where a run can show whether the user's facts hold.

use crate::error::Error;
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::graph::control_flow::{Block, ControlTransfer, Node, Target};
use crate::graph::loop_forest::successors;
use crate::inputs::annotations::Fact;
use crate::inputs::image::Entry;
use crate::loops::flow_facts::header_executions;
use arm7tdmi::instruction::Operation;
use image::{FlowPoint, Within};
use serde::Serialize;
use std::collections::BTreeMap;

/// A fact and a point at which it is counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CountedFact {
    /// The fact as it is written, with its file.
    pub fact: String,
    /// Its file.
    pub file: String,
    /// Its table.
    pub table: &'static str,
    /// The place in the program: file and line, else the function.
    pub place: String,
    /// What the fact allows: iterations, activations at the same time; 0 for no execution.
    pub declared: u64,
    /// Where.
    pub point: FlowPoint,
}

/// Points at which the facts about these functions and all that they call are counted.
pub fn counted_facts(program: &Program<'_>, roots: &[String]) -> Result<Vec<CountedFact>, Error> {
    let mut found = Vec::new();
    let mut returns: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut open: Vec<Entry> = roots
        .iter()
        .map(|name| program.function(name))
        .collect::<Result<_, _>>()?;
    while let Some(entry) = open.pop() {
        if returns.contains_key(&entry.0) {
            continue;
        }
        let summary = program.summary(entry, entry.0)?;
        returns.insert(entry.0, last_instructions(&summary));
        open.extend(summary.flow.blocks.iter().flat_map(|block| &block.calls));
        found.extend(loop_facts(program, &summary));
        found.extend(branch_facts(program, &summary));
        found.extend(recursion_fact(program, entry, &summary));
    }
    found.extend(place_facts(program));
    let mut unique: BTreeMap<String, CountedFact> = BTreeMap::new();
    for mut fact in found {
        if let FlowPoint::Loop {
            within: Some(within),
            ..
        } = &mut fact.point
        {
            within.returns = returns.get(&within.entry).cloned().unwrap_or_default();
        }
        let key = format!("{} {:?}", fact.fact, fact.point);
        unique.entry(key).or_insert(fact);
    }
    Ok(unique.into_values().collect())
}

fn counted(
    program: &Program<'_>,
    table: &'static str,
    fact: &Fact,
    point: FlowPoint,
) -> CountedFact {
    let address = match &point {
        FlowPoint::Loop { header, .. } => *header,
        FlowPoint::Place { addresses } => addresses.first().copied().unwrap_or(0),
        FlowPoint::Branch { address, .. } => *address,
        FlowPoint::Recursion { entry, .. } | FlowPoint::Together { entry, .. } => *entry,
    };
    CountedFact {
        fact: fact.written(table),
        file: fact.source.clone(),
        table,
        place: place_of(program, address),
        declared: fact.depth.map_or(0, u64::from),
        point,
    }
}

/// File and line, else the function.
fn place_of(program: &Program<'_>, address: u32) -> String {
    let line = program.image.place(address).line;
    let words = line.map(|(file, line)| format!("{file}:{line}"));
    words.unwrap_or_else(|| program.image.name_at(address))
}

/// Bounds of this function's loops.
fn loop_facts(program: &Program<'_>, summary: &FunctionSummary) -> Vec<CountedFact> {
    let facts = &program.facts;
    let (flow, forest) = (&summary.flow, &summary.forest);
    let mut found = Vec::new();
    for (index, each) in forest.loops.iter().enumerate() {
        let header = flow.blocks[each.header].node.address;
        let uses = facts.uses.borrow();
        let used = uses.iter().filter(|(_, uses)| uses.contains_key(&header));
        let mut stated: Vec<Fact> = used
            .map(|(which, _)| facts.annotations.loops[*which].clone())
            .collect();
        stated.extend(facts.statement_fact(header));
        for fact in stated {
            let Some(at_most) = header_executions(facts, &fact, flow, forest, index) else {
                continue;
            };
            let callers = program.image.within(&fact).map(|callers| {
                let each = callers.iter().filter_map(|(entry, _)| {
                    Some(Within {
                        function: program.image.names_at(*entry).first()?.clone(),
                        entry: *entry,
                        // Known when all functions have been visited.
                        returns: Vec::new(),
                    })
                });
                each.map(Some).collect()
            });
            for within in callers.unwrap_or_else(|| vec![None]) {
                let point = loop_point(summary, index, (within, at_most));
                found.extend(point.map(|point| CountedFact {
                    declared: fact.iterations.unwrap_or(at_most),
                    ..counted(program, "loop", &fact, point)
                }));
            }
        }
    }
    found
}

/// None where an instruction belongs to the loop and to what leads into it, since code was copied.
fn loop_point(
    summary: &FunctionSummary,
    index: usize,
    (within, at_most): (Option<Within>, u64),
) -> Option<FlowPoint> {
    let (flow, found) = (&summary.flow, &summary.forest.loops[index]);
    // A call over a veneer, which other callers share, is seen where it is called.
    let last = |block: usize| match &flow.blocks[block] {
        Block {
            transfer: Some(ControlTransfer::CallFor(..)),
            node: Node { copy, .. },
            ..
        } if *copy != 0 => Some(*copy),
        block => block.instructions.last().map(|(at, _)| *at),
    };
    let into = (0..flow.blocks.len()).filter(|block| {
        !found.blocks.contains(block) && successors(flow, *block).any(|next| next == found.header)
    });
    let entries: Vec<u32> = into.filter_map(last).collect();
    let latches = found.latches.iter().copied();
    let repeats: Vec<u32> = latches.clone().filter_map(last).collect();
    let resuming = latches.filter(|block| flow.blocks[*block].resumes().is_some());
    if entries.iter().any(|entry| repeats.contains(entry)) {
        return None;
    }
    Some(FlowPoint::Loop {
        header: flow.blocks[found.header].node.address,
        at_call: found.header == 0,
        entries,
        calls: resuming.filter_map(last).collect(),
        repeats,
        within,
        at_most,
    })
}

/// Is this the end of a block whose targets are not in the instruction, and which does not return?
fn is_indirect(block: &Block) -> bool {
    let direct = block.instructions.last().is_some_and(|(_, instruction)| {
        matches!(
            instruction.operation,
            Operation::Branch { .. } | Operation::LongBranchSuffix { .. }
        )
    });
    let moves = !matches!(block.transfer, None | Some(ControlTransfer::Return));
    moves && !direct
}

/// Targets of this function's indirect branches.
fn branch_facts(program: &Program<'_>, summary: &FunctionSummary) -> Vec<CountedFact> {
    let indirect = summary
        .flow
        .blocks
        .iter()
        .filter(|block| is_indirect(block));
    let stated = indirect.filter_map(|block| {
        let (address, _) = block.instructions.last()?;
        let (call, size) = (block.node.copy, if block.node.thumb { 2 } else { 4 });
        let of_call = program.facts.used_call_fact(call).filter(|_| call != 0);
        let fact = of_call.or_else(|| program.facts.used_call_fact(*address))?;
        let place = of_call.map_or(*address, |_| call);
        let targets = program.facts.call_targets(place)?;
        let point = FlowPoint::Branch {
            address: *address,
            targets: targets.iter().map(|target| target.0 & !1).collect(),
            returns_to: of_call.map(|_| call.wrapping_add(size)),
        };
        let mut found = counted(program, "call", fact, point);
        found.place = place_of(program, place);
        Some(found)
    });
    stated.collect()
}

/// Last instructions of the blocks from which a function returns.
fn last_instructions(summary: &FunctionSummary) -> Vec<u32> {
    let blocks = summary.flow.blocks.iter();
    let leaving = blocks.filter(|block| block.edges.iter().any(|e| e.target == Target::Return));
    let last = leaving.filter_map(|block| block.instructions.last());
    last.map(|(address, _)| *address).collect()
}

fn recursion_fact(
    program: &Program<'_>,
    entry: Entry,
    summary: &FunctionSummary,
) -> Option<CountedFact> {
    let fact = program.facts.recursion_fact(entry)?;
    let point = FlowPoint::Recursion {
        entry: entry.0,
        returns: last_instructions(summary),
        at_most: fact.depth.map_or(0, u64::from),
        calls: fact.calls?,
    };
    Some(counted(program, "recursion", fact, point))
}

/// Places that are never executed, or not by what is bounded.
fn place_facts(program: &Program<'_>) -> Vec<CountedFact> {
    let annotations = program.facts.annotations;
    let tables = [
        ("never", &annotations.never),
        ("avoided", &annotations.avoided),
    ];
    let facts = tables
        .into_iter()
        .flat_map(|(table, facts)| facts.iter().map(move |fact| (table, fact)));
    let found = facts.filter_map(|(table, fact)| {
        let addresses = program.image.addresses_of(fact);
        let point = (!addresses.is_empty()).then_some(FlowPoint::Place { addresses })?;
        Some(counted(program, table, fact, point))
    });
    found.collect()
}
