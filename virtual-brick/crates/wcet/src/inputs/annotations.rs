// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Annotations of the user (flow facts): loop bounds, targets of calls, regions of accesses, places
//! never executed.

use crate::error::{Error, Place};
use serde::Deserialize;
use std::collections::BTreeSet;

/// Where a fact holds: `symbol` with `index` or `offset`, or `file` with `line`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fact {
    /// Name of a function.
    pub symbol: Option<String>,
    /// Number of the loop in the function, by address, from 0.
    pub index: Option<usize>,
    /// Offset of the instruction in the function.
    pub offset: Option<u32>,
    /// Name of a source file, or more of its path: whole names of folders.
    pub file: Option<String>,
    /// Line in the file.
    pub line: Option<u32>,
    /// Loop: most iterations for each entry, as the source counts them.
    pub iterations: Option<u64>,
    /// Loop: most executions of its first block for each entry, as the code counts them.
    pub header_executions: Option<u64>,
    /// Loop: holds for each loop at a place that is none of a single loop.
    pub every: bool,
    /// Loop: holds only in calls made by this function, directly or not; `*end` as in `targets`.
    pub within: Option<String>,
    /// Call: names of all functions that may be reached; `*end` for all names that end so.
    pub targets: Vec<String>,
    /// Access: name of the region.
    pub region: Option<String>,
    /// Recursion: most activations of the function in one call from outside.
    pub calls: Option<u64>,
    /// Recursion: most activations at the same time.
    pub depth: Option<u32>,
    /// Cost: most cycles of a call, without the fetches after its return.
    pub cycles: Option<u64>,
    /// Cost: cycles that each call takes besides, while the caller is suspended in it.
    pub added_cycles: Option<u64>,
    /// Why the fact holds.
    pub reason: Option<String>,
    /// Where the fact stands, for messages.
    #[serde(skip)]
    pub source: String,
}

/// A loop statement of a source, whether it says how often it is repeated or not.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Name of the source file.
    pub file: String,
    /// Its lines without those of inner loop statements.
    pub lines: BTreeSet<u32>,
    /// Number of loop statements around it.
    pub depth: u32,
    /// Most iterations for each entry.
    pub iterations: Option<u64>,
    /// Why.
    pub reason: Option<String>,
}

/// Conventions of a kernel; see `kernel`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Kernel {
    /// Address of the word that names the running thread.
    pub running_thread: Option<u32>,
    /// Functions that take the processor from their caller.
    pub context_switches: Vec<String>,
    /// Functions that enter the protected object given in r0.
    pub locks: Vec<String>,
    /// Functions that leave their caller's protected action.
    pub unlocks: Vec<String>,
    /// Functions that undo what one of `locks` did; not called where none was.
    pub unmasks: Vec<String>,
    /// Offset of the word of a protected object for which, when it is not zero, none of `locks` is
    /// called.
    pub span_offset: Option<u32>,
}

/// A word of memory that keeps its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Word {
    /// Where.
    pub address: u32,
    /// What.
    pub value: u32,
}

/// All facts of one or more annotation files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Annotations {
    /// Loop bounds.
    #[serde(default, rename = "loop")]
    pub loops: Vec<Fact>,
    /// Loop statements.
    #[serde(default, rename = "statement")]
    pub statements: Vec<Statement>,
    /// Targets of indirect calls.
    #[serde(default, rename = "call")]
    pub calls: Vec<Fact>,
    /// Regions of data accesses whose address is not known; without a place, of all of them.
    #[serde(default, rename = "access")]
    pub accesses: Vec<Fact>,
    /// Places that are never executed.
    #[serde(default, rename = "never")]
    pub never: Vec<Fact>,
    /// Places that are executed, but not in what is bounded.
    #[serde(default, rename = "avoided")]
    pub avoided: Vec<Fact>,
    /// Functions whose branches to unknown places end the analysis, as a return does.
    #[serde(default, rename = "leave")]
    pub leaves: Vec<Fact>,
    /// Functions that call themselves, with how often.
    #[serde(default, rename = "recursion")]
    pub recursions: Vec<Fact>,
    /// Cycles of a function, found in another way.
    #[serde(default, rename = "cost")]
    pub costs: Vec<Fact>,
    /// Words that keep their values.
    #[serde(default, rename = "word")]
    pub words: Vec<Word>,
    /// Conventions of the kernel.
    #[serde(default)]
    pub kernel: Kernel,
}

impl Annotations {
    /// Reads TOML text; `name` is used in messages.
    pub fn parse(text: &str, name: &str) -> Result<Self, Error> {
        let mut annotations: Self =
            toml::from_str(text).map_err(|error| Error::Input(format!("{name}: {error}")))?;
        let facts = annotations.tables_mut().into_iter();
        for fact in facts.flat_map(|(_, facts)| facts) {
            name.clone_into(&mut fact.source);
        }
        for fact in &annotations.loops {
            if fact.iterations.is_none() && fact.header_executions.is_none() {
                return Err(Error::Input(format!(
                    "{name}: [[loop]] {} needs 'iterations' or 'header_executions'",
                    fact.place()
                )));
            }
        }
        for fact in &annotations.recursions {
            if fact.symbol.is_none() || fact.calls.is_none() || fact.depth.is_none() {
                return Err(Error::Input(format!(
                    "{name}: [[recursion]] {} needs 'symbol', 'calls' and 'depth'",
                    fact.place()
                )));
            }
        }
        Ok(annotations)
    }

    /// The tables of facts about places, by their names.
    pub fn tables(&self) -> [(&'static str, &[Fact]); 8] {
        [
            ("loop", &self.loops),
            ("call", &self.calls),
            ("access", &self.accesses),
            ("never", &self.never),
            ("avoided", &self.avoided),
            ("leave", &self.leaves),
            ("recursion", &self.recursions),
            ("cost", &self.costs),
        ]
    }

    fn tables_mut(&mut self) -> [(&'static str, &mut Vec<Fact>); 8] {
        [
            ("loop", &mut self.loops),
            ("call", &mut self.calls),
            ("access", &mut self.accesses),
            ("never", &mut self.never),
            ("avoided", &mut self.avoided),
            ("leave", &mut self.leaves),
            ("recursion", &mut self.recursions),
            ("cost", &mut self.costs),
        ]
    }

    /// Adds the facts of another file; the first that matches a place counts.
    pub fn extend(&mut self, other: Self) {
        self.loops.extend(other.loops);
        self.statements.extend(other.statements);
        self.calls.extend(other.calls);
        self.accesses.extend(other.accesses);
        self.never.extend(other.never);
        self.avoided.extend(other.avoided);
        self.leaves.extend(other.leaves);
        self.recursions.extend(other.recursions);
        self.costs.extend(other.costs);
        self.words.extend(other.words);
        let (kernel, more) = (&mut self.kernel, other.kernel);
        kernel.running_thread = kernel.running_thread.or(more.running_thread);
        kernel.context_switches.extend(more.context_switches);
        kernel.locks.extend(more.locks);
        kernel.unlocks.extend(more.unlocks);
        kernel.unmasks.extend(more.unmasks);
        kernel.span_offset = kernel.span_offset.or(more.span_offset);
    }
}

impl Fact {
    /// Does the fact hold here? `names` are all names of the function at the place, `index` the
    /// number of the loop.
    pub fn matches(&self, place: &Place, names: &[String], index: Option<usize>) -> bool {
        let by_symbol = self.symbol.as_deref().is_some_and(|symbol| {
            let offset = place.symbol.as_ref().map(|(_, offset)| *offset);
            names.iter().any(|name| name == symbol)
                && self.index.is_none_or(|wanted| index == Some(wanted))
                && self.offset.is_none_or(|wanted| offset == Some(wanted))
        });
        let by_line = self.file.as_deref().is_some_and(|wanted| {
            place.line.as_ref().is_some_and(|(file, line)| {
                is_of_path(file, wanted) && self.line.is_none_or(|number| number == *line)
            })
        });
        by_symbol || by_line
    }

    /// The place as it is written.
    pub fn place(&self) -> String {
        let mut parts = Vec::new();
        let texts = [("symbol", &self.symbol), ("file", &self.file)];
        for (key, text) in texts {
            parts.extend(text.iter().map(|text| format!("{key} = \"{text}\"")));
        }
        let offset = self.offset.map(u64::from);
        let index = self.index.map(|index| index as u64);
        let numbers = [
            ("index", index),
            ("offset", offset),
            ("line", self.line.map(u64::from)),
        ];
        for (key, number) in numbers {
            parts.extend(number.iter().map(|number| format!("{key} = {number}")));
        }
        parts.join(", ")
    }

    /// The fact of a table as it is written, with its file.
    pub fn written(&self, table: &str) -> String {
        let numbers = [
            ("iterations", self.iterations),
            ("header_executions", self.header_executions),
            ("calls", self.calls),
            ("depth", self.depth.map(u64::from)),
        ];
        let mut text = format!("{}: [[{table}]] {}", self.source, self.place());
        if let Some(function) = &self.within {
            text += &format!(", within = \"{function}\"");
        }
        let stated = numbers.iter().filter_map(|(key, n)| Some((key, (*n)?)));
        stated.for_each(|(key, number)| text += &format!(", {key} = {number}"));
        text
    }

    /// A fact without any place holds everywhere.
    pub fn is_general(&self) -> bool {
        self.symbol.is_none() && self.file.is_none()
    }
}

impl Statement {
    /// Is this line of this file one of the statement's?
    pub fn has(&self, file: &str, line: u32) -> bool {
        self.lines.contains(&line) && is_of_path(file, &self.file)
    }
}

/// Is `wanted` the end of a path, in whole names?
pub fn is_of_path(path: &str, wanted: &str) -> bool {
    let rest = path.strip_suffix(wanted);
    rest.is_some_and(|folder| folder.is_empty() || folder.ends_with('/'))
}
