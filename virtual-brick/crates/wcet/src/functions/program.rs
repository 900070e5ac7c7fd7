// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A program under analysis: what is given about it, and the tables of what was found out about its
//! functions. The tables are filled by `Program::summary` (`summary`) and `Program::bound`
//! (`bound`), which recur over the call graph by way of them.

use crate::error::Error;
use crate::functions::function_bound::FunctionBound;
use crate::functions::function_summary::FunctionSummary;
use crate::inputs::annotations::Annotations;
use crate::inputs::facts::Facts;
use crate::inputs::image::{Entry, Image};
use crate::inputs::kernel::KernelConventions;
use crate::inputs::memory_map::MemoryMap;
use crate::loops::abstract_execution::{LoopFinding, UNDECIDED_LIMIT};
use crate::values::instruction::Environment;
use crate::values::value::Value;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Values of r0 to r3 at the entry of a function: the context for which it is bounded.
pub type Arguments = [Value; 4];

/// A bound, or why there is none; looking for one that is not there takes longest.
pub type BoundResult = Result<Rc<FunctionBound>, Error>;

/// A program under analysis.
pub struct Program<'a> {
    pub(crate) image: &'a Image,
    pub(crate) map: &'a MemoryMap,
    pub(crate) conventions: KernelConventions,
    pub(crate) facts: Facts<'a>,
    /// Nothing but the program writes to memory, and it begins as the image says.
    pub(crate) memory_known: bool,
    /// Bounds tell the path that attains them.
    pub(crate) paths_recorded: bool,
    /// Beginnings of names of functions, from whose calls to the end bounds tell the time.
    pub(crate) requesting: Vec<String>,
    /// Iterations in a row after which a loop that may be left everywhere gets no bound.
    pub(crate) undecided_limit: u64,
    pub(super) summaries: RefCell<BTreeMap<Entry, Rc<FunctionSummary>>>,
    pub(super) bounds: RefCell<BTreeMap<Entry, BTreeMap<Arguments, BoundResult>>>,
    /// Functions whose summary is being computed, each with the place of its call.
    pub(super) summarising: RefCell<Vec<(Entry, u32)>>,
    /// Functions whose bound is being computed.
    pub(crate) bounding: RefCell<Vec<Entry>>,
    steps: Cell<u64>,
}

impl<'a> Program<'a> {
    /// A program with the user's facts about it.
    ///
    /// # Errors
    /// A fact names an unknown region or function.
    pub fn new(
        image: &'a Image,
        map: &'a MemoryMap,
        annotations: &'a Annotations,
    ) -> Result<Self, Error> {
        map.find(&map.stack)?;
        Ok(Self {
            image,
            map,
            conventions: KernelConventions::new(image, annotations),
            facts: Facts::new(image, map, annotations)?,
            memory_known: false,
            paths_recorded: false,
            requesting: Vec::new(),
            undecided_limit: UNDECIDED_LIMIT,
            summaries: RefCell::default(),
            bounds: RefCell::default(),
            summarising: RefCell::default(),
            bounding: RefCell::default(),
            steps: Cell::default(),
        })
    }

    pub(crate) fn environment(&self) -> Environment<'_> {
        Environment {
            image: self.image,
            map: self.map,
            conventions: &self.conventions,
            facts: Some(&self.facts),
        }
    }

    /// Counts instructions that were executed on abstract values.
    pub(crate) fn note_steps(&self, steps: u64) {
        self.steps.set(self.steps.get().saturating_add(steps));
    }

    /// Notes flow facts that the code contradicts while these functions are active, the one that
    /// was executed last; does it return?
    pub(crate) fn note_contradictions(
        &self,
        summary: &FunctionSummary,
        findings: &[LoopFinding],
        active: &[Entry],
        returns: bool,
    ) {
        for (index, finding) in findings.iter().enumerate() {
            if let Some(allowed) = finding.contradiction {
                let header = summary.forest.loops[index].header;
                let address = summary.flow.blocks[header].node.address;
                self.facts
                    .note_contradiction(address, allowed, active, returns);
            }
        }
    }

    /// Instructions that were executed on abstract values so far.
    pub(crate) fn steps(&self) -> u64 {
        self.steps.get()
    }

    /// Calls `see` for each function whose summary is known.
    pub(crate) fn summaries(&self, mut see: impl FnMut(&FunctionSummary)) {
        self.summaries
            .borrow()
            .values()
            .for_each(|summary| see(summary));
    }

    /// Entry of a named function.
    pub(crate) fn function(&self, name: &str) -> Result<Entry, Error> {
        let found = self.image.function(name);
        found.ok_or_else(|| Error::Input(format!("the image has no function '{name}'")))
    }

    /// Cycles of the two fetches with which a function's caller goes on, wherever it is.
    pub(crate) fn return_cycles(&self) -> Result<u64, Error> {
        self.map.worst_refill(self.image.code_sections())
    }
}
