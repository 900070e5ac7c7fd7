// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Results for people and other programs.

use crate::error::{Error, Place};
use crate::functions::function_bound::{BoundOrigin, FunctionBound};
use crate::functions::program::Program;
use serde::Serialize;
use std::collections::BTreeMap;

/// A place in the source.
#[derive(Clone, Debug, Serialize)]
pub struct Source {
    /// Address of the instruction.
    pub address: u32,
    /// Function and offset.
    pub symbol: Option<String>,
    /// File and line.
    pub line: Option<String>,
}

impl From<Place> for Source {
    fn from(place: Place) -> Self {
        Self {
            address: place.address,
            symbol: place
                .symbol
                .map(|(name, offset)| format!("{name}+{offset:#x}")),
            line: place.line.map(|(file, line)| format!("{file}:{line}")),
        }
    }
}

/// A block on the longest path.
#[derive(Clone, Debug, Serialize)]
pub struct BlockReport {
    /// Its first instruction.
    pub at: Source,
    /// Executions on the longest path.
    pub count: u64,
    /// Instructions in the block.
    pub instruction_count: usize,
    /// Cycles by edge, calls included.
    pub edge_cycles: Vec<Option<u64>>,
    /// Functions called at the end, and the bounds charged for them.
    pub calls: Vec<(String, u64)>,
}

/// A loop.
#[derive(Clone, Debug, Serialize)]
pub struct LoopReport {
    /// Its header.
    pub at: Source,
    /// Number within its symbol.
    pub index: usize,
    /// Most executions of the header for one entry.
    pub header_executions: Option<u64>,
    /// Its source.
    pub origin: BoundOrigin,
}

/// One function in the call tree.
#[derive(Clone, Debug, Serialize)]
pub struct FunctionReport {
    /// Its name.
    pub symbol: String,
    /// Calls of it on the longest path.
    pub calls: u64,
    /// Largest bound charged for one call.
    pub cycles: u64,
    /// Of a recursive function: activations in one call, each charged as the longest one.
    pub activations: Option<u64>,
    /// Its loops.
    pub loops: Vec<LoopReport>,
    /// Accesses charged as in the most expensive region because theirs is not known.
    pub unknown_accesses: usize,
    /// The blocks its longest path passes.
    pub path: Vec<BlockReport>,
}

/// The result for one function with all that it calls.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Function.
    pub symbol: String,
    /// Memory map.
    pub timing: String,
    /// Cycles from the first instruction to the end of the return.
    pub bound_cycles: u64,
    /// Stack it needs.
    pub stack_bytes: Option<u32>,
    /// Functions on the longest path.
    pub functions: Vec<FunctionReport>,
}

fn source(program: &Program<'_>, address: u32) -> Source {
    program.image.place(address).into()
}

/// Calls of each function on the longest path.
fn tree<'a>(
    bound: &'a FunctionBound,
    times: u64,
    calls: &mut BTreeMap<u32, (u64, &'a FunctionBound)>,
) {
    let entry = calls.entry(bound.entry.0).or_insert((0, bound));
    entry.0 += times;
    if entry.1.cycles < bound.cycles {
        entry.1 = bound;
    }
    for block in bound.blocks.iter().filter(|block| block.count > 0) {
        if let Some(worst) = block.calls.iter().max_by_key(|callee| callee.cycles) {
            tree(worst, times * block.count, calls);
        }
    }
}

fn function_report(program: &Program<'_>, calls: u64, bound: &FunctionBound) -> FunctionReport {
    let path = bound
        .blocks
        .iter()
        .filter(|block| block.count > 0)
        .map(|block| BlockReport {
            at: source(program, block.address),
            count: block.count,
            instruction_count: block.addresses.len(),
            edge_cycles: block.cycles.clone(),
            calls: block
                .calls
                .iter()
                .map(|callee| (program.image.name_at(callee.entry.0), callee.cycles))
                .collect(),
        });
    let loops = bound.loops.iter().map(|found| LoopReport {
        at: source(program, found.address),
        index: found.number,
        header_executions: found.header_executions,
        origin: found.origin,
    });
    FunctionReport {
        symbol: program.image.name_at(bound.entry.0),
        calls,
        cycles: bound.cycles,
        activations: program.facts.recursion(bound.entry).map(|(calls, _)| calls),
        loops: loops.collect(),
        unknown_accesses: bound
            .blocks
            .iter()
            .map(|block| block.unknown_accesses)
            .sum(),
        path: path.collect(),
    }
}

impl Report {
    /// Bounds a named function and says how.
    pub fn new(program: &Program<'_>, symbol: &str) -> Result<Self, Error> {
        let bound = program.bound_of(symbol)?;
        let cycles = bound.cycles + program.return_cycles()?;
        program.facts.check()?;
        Ok(Self::of_bound(program, symbol, &bound, cycles))
    }

    /// How a bound comes about.
    pub fn of_bound(
        program: &Program<'_>,
        symbol: &str,
        bound: &FunctionBound,
        bound_cycles: u64,
    ) -> Self {
        let mut calls = BTreeMap::new();
        tree(bound, 1, &mut calls);
        let functions = calls
            .values()
            .map(|(count, f)| function_report(program, *count, f));
        Self {
            symbol: symbol.to_owned(),
            timing: program.map.name.clone(),
            bound_cycles,
            stack_bytes: bound.stack_bytes,
            functions: functions.collect(),
        }
    }
}
