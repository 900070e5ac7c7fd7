// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a function still executes from a call of one of certain functions on: requests of
//! interrupts, which come no sooner.

use crate::error::Error;
use crate::functions::function_bound::{FunctionBound, RemainingTimes};
use crate::functions::program::Program;
use crate::paths::critical_section::{longest_from, merge, missing};
use crate::paths::longest_path::PathProblem;
use std::collections::BTreeSet;
use std::rc::Rc;

impl Program<'_> {
    /// The groups to which a function belongs.
    fn groups_of(&self, entry: u32) -> impl Iterator<Item = u32> + '_ {
        let names = self.image.names_at(entry);
        let belongs = move |begin: &String| names.iter().any(|name| name.starts_with(begin));
        let groups = (0..).zip(&self.requesting);
        groups.filter_map(move |(group, begin)| belongs(begin).then_some(group))
    }

    /// Those of a call of a function, of which only what it may execute is known.
    pub(super) fn remaining_in_any(&self, executed: &BTreeSet<u32>, cycles: u64) -> RemainingTimes {
        let groups = executed.iter().flat_map(|entry| self.groups_of(*entry));
        groups.map(|group| (group, cycles)).collect()
    }

    /// Those of a call of a function.
    fn remaining_in(&self, callee: &FunctionBound) -> RemainingTimes {
        let mut found = callee.remaining.clone();
        found.extend(self.groups_of(callee.entry.0).map(|g| (g, callee.cycles)));
        found
    }
}

/// Those of a function of whose blocks the calls are known, and what the longest is charged.
pub fn remaining_times(
    program: &Program<'_>,
    function: &PathProblem<'_>,
    calls: &[Vec<Rc<FunctionBound>>],
    charged: &[u64],
) -> Result<RemainingTimes, Error> {
    let mut found = RemainingTimes::new();
    for (block, callees) in calls.iter().enumerate() {
        let mut inside = RemainingTimes::new();
        for callee in callees {
            merge(&mut inside, &program.remaining_in(callee));
        }
        if inside.is_empty() {
            continue;
        }
        let call = charged[block];
        let behind = longest_from(function, block, |_| true).map_err(missing)?;
        let behind = behind.unwrap_or(0).saturating_sub(call);
        let each = inside.into_iter();
        let ends = each.map(|(group, cycles)| (group, behind.saturating_add(cycles.min(call))));
        merge(&mut found, &ends.collect());
    }
    Ok(found)
}
