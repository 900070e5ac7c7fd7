// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Facts that hold nowhere in the program: a misspelt name, a file or line without code.

use crate::inputs::annotations::{Annotations, Fact};
use crate::inputs::image::Image;
use serde::Serialize;

/// A fact that matches nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnmatchedFact {
    /// Name of its file.
    pub file: String,
    /// Its table.
    pub table: &'static str,
    /// Its number in the table, from 0.
    pub index: usize,
    /// The field that matches nothing.
    pub field: &'static str,
    /// Why.
    pub reason: String,
}

/// Facts of one file that match nothing in the image.
pub fn unmatched_facts(annotations: &Annotations, image: &Image) -> Vec<UnmatchedFact> {
    let tables = annotations.tables().into_iter();
    let rows = tables.flat_map(|(table, facts)| {
        let numbered = facts.iter().enumerate();
        numbered.map(move |(index, fact)| (table, index, fact))
    });
    let found = rows.filter_map(|(table, index, fact)| {
        let (field, reason) = mismatch(fact, image)?;
        Some(UnmatchedFact {
            file: fact.source.clone(),
            table,
            index,
            field,
            reason,
        })
    });
    found.collect()
}

/// The field that matches nothing, and why.
fn mismatch(fact: &Fact, image: &Image) -> Option<(&'static str, String)> {
    let is_missing = |name: &&String| image.function(name).is_none();
    let symbol = fact.symbol.as_ref().filter(is_missing);
    let is_none = |name: &&String| image.functions(name).is_empty();
    let within = fact.within.as_ref().filter(is_none);
    for (field, name) in [("symbol", symbol), ("within", within)] {
        if let Some(name) = name {
            return Some((field, format!("the image has no function '{name}'")));
        }
    }
    let file = fact.file.as_deref()?;
    let lines = image.lines_of(file);
    if lines.is_empty() {
        return Some(("file", format!("the image has no code of a file '{file}'")));
    }
    let line = fact.line.filter(|line| !lines.contains(line))?;
    let near = [lines.range(..line).next_back(), lines.range(line..).next()];
    let near: Vec<String> = near.into_iter().flatten().map(u32::to_string).collect();
    let reason = format!(
        "line {line} of {file} has no code; the next lines with code are {}",
        near.join(" and ")
    );
    Some(("line", reason))
}
