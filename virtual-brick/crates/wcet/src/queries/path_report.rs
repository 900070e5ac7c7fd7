// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The worst path on the source: executions and cycles by line, calls below the line that makes
//! them. The sum over all lines and differences is the bound.

use crate::elapsed::PathTree;
use crate::functions::program::Program;
use crate::queries::report::Source;
use serde::Serialize;
use std::collections::BTreeMap;

/// A source line of one function, or an instruction without one.
#[derive(Clone, Debug, Serialize)]
pub struct LineCost {
    /// Its first instruction on the path.
    pub at: Source,
    /// Executions of its most frequent instruction.
    pub executions: u64,
    /// Cycles without calls.
    pub cycles: u64,
    /// Functions that it calls.
    pub calls: Vec<PathReport>,
}

/// A function as the worst path executes it from one line.
#[derive(Clone, Debug, Serialize)]
pub struct PathReport {
    /// Its name.
    pub symbol: String,
    /// Its first instruction.
    pub address: u32,
    /// Executions.
    pub calls: u64,
    /// Cycles of all executions, with what they call.
    pub cycles: u64,
    /// Cycles that belong to no line: what facts add, less what they exclude.
    pub difference: i64,
    /// By address.
    pub lines: Vec<LineCost>,
}

impl PathReport {
    /// The path with its source lines.
    pub fn new(program: &Program<'_>, tree: &PathTree) -> Self {
        let image = program.image;
        let key = |address: u32| {
            let place = image.place(address);
            // Without a line, an instruction stands for all of its function.
            (place.line, image.name_at(address))
        };
        let mut order = BTreeMap::new();
        let mut lines: Vec<(LineCost, BTreeMap<u32, PathTree>)> = Vec::new();
        let called = tree.callees.keys().map(|(address, _)| *address);
        let addresses = tree.instructions.keys().copied().chain(called);
        for address in addresses {
            order.entry(key(address)).or_insert_with(|| {
                lines.push((
                    LineCost {
                        at: image.place(address).into(),
                        executions: 0,
                        cycles: 0,
                        calls: Vec::new(),
                    },
                    BTreeMap::new(),
                ));
                lines.len() - 1
            });
        }
        for (address, (executions, cycles)) in &tree.instructions {
            let line = &mut lines[order[&key(*address)]].0;
            line.executions = line.executions.max(*executions);
            line.cycles += cycles;
        }
        for ((address, entry), callee) in &tree.callees {
            let calls = &mut lines[order[&key(*address)]].1;
            let all = calls.entry(*entry);
            all.or_insert_with(|| PathTree::new(*entry)).add(callee, 1);
        }
        let lines = lines.into_iter().map(|(line, calls)| LineCost {
            calls: calls
                .values()
                .map(|tree| Self::new(program, tree))
                .collect(),
            ..line
        });
        Self {
            symbol: image.name_at(tree.entry),
            address: tree.entry,
            calls: tree.calls,
            cycles: tree.cycles(),
            difference: tree.difference,
            lines: lines.collect(),
        }
    }
}
