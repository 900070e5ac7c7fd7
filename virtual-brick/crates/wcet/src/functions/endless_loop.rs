// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where code stays that never returns.

use crate::error::{Error, Place};
use crate::functions::program::Program;
use crate::inputs::image::Entry;
use std::collections::BTreeSet;

/// A loop without an exit in a function that never returns, or in one of those that it calls, which
/// are looked at after it; the function's begin if there is no such loop. None if it may return.
pub fn endless_loop(program: &Program<'_>, entry: Entry) -> Result<Option<Place>, Error> {
    if program.summary(entry, entry.0)?.returns {
        return Ok(None);
    }
    let (mut open, mut seen) = (vec![entry], BTreeSet::new());
    while !open.is_empty() {
        for function in std::mem::take(&mut open) {
            let summary = program.summary(function, function.0)?;
            if summary.returns || !seen.insert(function) {
                continue;
            }
            let reached = |block: usize| summary.states[block].is_some();
            let loops = summary.forest.loops.iter();
            let mut endless = loops
                .filter(|found| found.exit_count == 0 && reached(found.header))
                .map(|found| summary.flow.blocks[found.header].node.address);
            if let Some(address) = endless.next() {
                return Ok(Some(program.image.place(address)));
            }
            let blocks = summary.flow.blocks.iter().enumerate();
            let called = blocks.filter(|(block, _)| reached(*block));
            open.extend(called.flat_map(|(_, block)| &block.calls));
        }
    }
    Ok(Some(program.image.place(entry.0)))
}
