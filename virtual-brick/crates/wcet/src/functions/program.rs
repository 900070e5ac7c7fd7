// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A whole program: functions, their summaries, and bounds for what is known at their calls.

use crate::error::Error;
use crate::functions::bound::{bound_recursive, bound_summary, recursive_call, FunctionBound};
use crate::functions::summary::{summarise, Summary};
use crate::graph::control_flow::{Entry, Flow};
use crate::graph::loop_forest::Forest;
use crate::inputs::annotations::{Annotations, Fact};
use crate::inputs::image::Image;
use crate::inputs::kernel::Conventions;
use crate::inputs::memory_map::MemoryMap;
use crate::loops::flow_facts::Uses;
use crate::values::block::any_arguments;
use crate::values::instruction::World;
use crate::values::state::{State, ANY_URGENCY};
use crate::values::value::Value;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Argument sets for which one function is bounded separately; beyond, for any arguments.
const CONTEXTS: usize = 256;

type Arguments = [Value; 4];

/// A bound, or why there is none; looking for one that is not there takes longest.
pub type Known = Result<Rc<FunctionBound>, Error>;

/// A program under analysis.
pub struct Program<'a> {
    /// Code and symbols.
    pub image: &'a Image,
    /// Regions and costs.
    pub map: &'a MemoryMap,
    /// Meaning of the kernel's code.
    pub conventions: Conventions,
    /// Nothing but the program writes to memory, and it begins as the image says.
    pub closed: bool,
    /// Facts about the program.
    pub annotations: &'a Annotations,
    /// Where the facts about loops were used.
    pub uses: RefCell<Uses>,
    summaries: RefCell<BTreeMap<Entry, Rc<Summary>>>,
    bounds: RefCell<BTreeMap<Entry, BTreeMap<Arguments, Known>>>,
    regions: RefCell<BTreeMap<u32, Option<u8>>>,
    open: RefCell<Vec<(Entry, u32)>>,
    bounding: RefCell<Vec<Entry>>,
    steps: Cell<u64>,
}

impl<'a> Program<'a> {
    /// A program with the user's facts about it. Facts that name unknown regions or functions
    /// are errors.
    pub fn new(
        image: &'a Image,
        map: &'a MemoryMap,
        annotations: &'a Annotations,
    ) -> Result<Self, Error> {
        map.find(&map.stack)?;
        for region in annotations
            .accesses
            .iter()
            .filter_map(|fact| fact.region.as_ref())
        {
            map.find(region)?;
        }
        for target in annotations.calls.iter().flat_map(|fact| &fact.targets) {
            if image.function(target).is_none() {
                return Err(Error::Input(format!(
                    "[[call]] names '{target}', no function here"
                )));
            }
        }
        Ok(Self {
            image,
            map,
            conventions: Conventions::new(image, annotations),
            closed: false,
            annotations,
            uses: RefCell::default(),
            summaries: RefCell::default(),
            bounds: RefCell::default(),
            regions: RefCell::default(),
            open: RefCell::default(),
            bounding: RefCell::default(),
            steps: Cell::default(),
        })
    }

    /// Image and map.
    pub fn world(&self) -> World<'_> {
        World {
            image: self.image,
            map: self.map,
            conventions: &self.conventions,
        }
    }

    fn fact(&self, facts: &'a [Fact], address: u32, index: Option<usize>) -> Option<&'a Fact> {
        let place = self.image.place(address);
        let names = self.image.names_at(address);
        facts
            .iter()
            .find(|fact| fact.matches(&place, &names, index))
    }

    /// Is the place declared never to be executed?
    pub fn is_dead(&self, address: u32) -> bool {
        !self.annotations.never.is_empty()
            && self.fact(&self.annotations.never, address, None).is_some()
    }

    /// Which blocks are not executed in what is bounded.
    pub fn avoided(&self, flow: &Flow) -> Vec<bool> {
        let facts = &self.annotations.avoided;
        let is_avoided = |address: u32| self.fact(facts, address, None).is_some();
        let blocks = flow.blocks.iter();
        let marked = blocks.map(|block| {
            !facts.is_empty() && block.instructions.iter().any(|(a, _)| is_avoided(*a))
        });
        marked.collect()
    }

    /// Does a branch to an unknown place end the analysis here?
    pub fn leaves(&self, address: u32) -> bool {
        !self.annotations.leaves.is_empty()
            && self.fact(&self.annotations.leaves, address, None).is_some()
    }

    /// Most activations of a recursive function in one call and at the same time.
    pub fn given_recursion(&self, entry: Entry) -> Option<(u64, u32)> {
        let fact = self.fact(&self.annotations.recursions, entry.0, None)?;
        Some((fact.calls?, fact.depth?))
    }

    /// Most cycles of a function, as the user says.
    pub fn given_cycles(&self, entry: Entry) -> Option<u64> {
        if self.annotations.costs.is_empty() {
            return None;
        }
        self.fact(&self.annotations.costs, entry.0, None)?.cycles
    }

    /// Functions that an indirect branch may reach, as the user says.
    pub fn given_targets(&self, address: u32) -> Option<Vec<Entry>> {
        let fact = self.fact(&self.annotations.calls, address, None)?;
        let entries = fact
            .targets
            .iter()
            .filter_map(|name| self.image.function(name));
        Some(entries.collect())
    }

    /// Region of an access, as the user says.
    pub fn given_region(&self, address: u32) -> Option<u8> {
        if self.annotations.accesses.is_empty() {
            return None;
        }
        let known = self.regions.borrow().get(&address).copied();
        known.unwrap_or_else(|| {
            let region = self.sought_region(address);
            self.regions.borrow_mut().insert(address, region);
            region
        })
    }

    fn sought_region(&self, address: u32) -> Option<u8> {
        let accesses = &self.annotations.accesses;
        let fact = self
            .fact(accesses, address, None)
            .or_else(|| accesses.iter().find(|fact| fact.is_general()))?;
        self.map.find(fact.region.as_ref()?).ok()
    }

    /// Numbers of the loops of a function among those with headers in the same symbol.
    pub fn loop_numbers(&self, flow: &Flow, forest: &Forest) -> Vec<usize> {
        let mut seen: BTreeMap<Option<String>, usize> = BTreeMap::new();
        let mut known: BTreeMap<u32, usize> = BTreeMap::new();
        let headers = forest
            .loops
            .iter()
            .map(|found| flow.blocks[found.header].node.address);
        headers
            .map(|address| {
                *known.entry(address).or_insert_with(|| {
                    let symbol = self.image.place(address).symbol.map(|(name, _)| name);
                    let next = seen.entry(symbol).or_default();
                    *next += 1;
                    *next - 1
                })
            })
            .collect()
    }

    /// Summary of a function called from `site`.
    pub fn summary(&self, entry: Entry, site: u32) -> Result<Rc<Summary>, Error> {
        if let Some(known) = self.summaries.borrow().get(&entry) {
            return Ok(Rc::clone(known));
        }
        let cycle = {
            let open = self.open.borrow();
            let start = open.iter().position(|(function, _)| *function == entry);
            start.map(|start| {
                open[start + 1..]
                    .iter()
                    .map(|(_, at)| *at)
                    .collect::<Vec<_>>()
            })
        };
        if let Some(mut sites) = cycle {
            if self.closed || self.given_recursion(entry).is_some() {
                return Ok(Rc::new(Summary::of_recursion()));
            }
            sites.push(site);
            let places = sites.iter().map(|at| self.image.place(*at));
            return Err(Error::Recursion(places.collect()));
        }
        self.open.borrow_mut().push((entry, site));
        let result = summarise(self, entry);
        self.open.borrow_mut().pop();
        let summary = Rc::new(result?);
        self.summaries
            .borrow_mut()
            .insert(entry, Rc::clone(&summary));
        Ok(summary)
    }

    /// Counts instructions that were executed on abstract values.
    pub fn note_steps(&self, steps: u64) {
        self.steps.set(self.steps.get().saturating_add(steps));
    }

    /// Instructions that were executed on abstract values so far.
    pub fn steps(&self) -> u64 {
        self.steps.get()
    }

    /// Calls `see` for each function whose summary is known.
    pub fn summaries(&self, mut see: impl FnMut(Entry, &Summary)) {
        for (entry, summary) in self.summaries.borrow().iter() {
            see(*entry, summary);
        }
    }

    /// Bound of a function for what is known about its arguments, without the refill of its
    /// return.
    pub fn bound(&self, entry: Entry, arguments: &Arguments) -> Known {
        let recursive = self.given_recursion(entry).is_some();
        if self.bounding.borrow().contains(&entry) {
            if recursive {
                return Ok(Rc::new(recursive_call(entry)));
            }
            return Err(Error::Recursion(vec![self.image.place(entry.0)]));
        }
        let any = any_arguments();
        let arguments = if recursive { &any } else { arguments };
        if let Some(found) = self.known(entry, arguments) {
            return found;
        }
        let full = self.bounds.borrow().get(&entry).map_or(0, BTreeMap::len) >= CONTEXTS;
        let arguments = if full { &any } else { arguments };
        if let Some(found) = self.known(entry, arguments) {
            return found;
        }
        let found = self.sought(entry, arguments);
        let depends_on_callers = matches!(found, Err(Error::Recursion(_)));
        if !depends_on_callers {
            let mut bounds = self.bounds.borrow_mut();
            let known = bounds.entry(entry).or_default();
            known.insert(arguments.clone(), found.clone());
        }
        found
    }

    fn known(&self, entry: Entry, arguments: &Arguments) -> Option<Known> {
        self.bounds.borrow().get(&entry)?.get(arguments).cloned()
    }

    fn sought(&self, entry: Entry, arguments: &Arguments) -> Known {
        let summary = self.summary(entry, entry.0)?;
        if summary.avoided.first() == Some(&true) {
            return Err(Error::NeverReturns(self.image.place(entry.0)));
        }
        self.bounding.borrow_mut().push(entry);
        let bound = bound_summary(self, entry, &summary, self.entry_state(entry, arguments));
        self.bounding.borrow_mut().pop();
        let bound = match self.given_recursion(entry) {
            Some((calls, depth)) => bound_recursive(bound?, calls, depth),
            None => bound?,
        };
        let given = self.given_cycles(entry).unwrap_or(u64::MAX);
        let cycles = bound.cycles.min(given);
        Ok(Rc::new(FunctionBound { cycles, ..bound }))
    }

    /// What holds at the entry. The callers of functions that leave a protected action are in one.
    fn entry_state(&self, entry: Entry, arguments: &Arguments) -> State {
        let mut state = State::entry(arguments);
        if self.conventions.unlocks.contains(&entry.0) {
            state.enter(ANY_URGENCY);
            state.masks = None;
        }
        state
    }

    /// Entry of a named function.
    pub fn function(&self, name: &str) -> Result<Entry, Error> {
        let found = self.image.function(name);
        found.ok_or_else(|| Error::Input(format!("the image has no function '{name}'")))
    }

    /// Bound of a named function, called from anywhere with any arguments.
    pub fn bound_of(&self, name: &str) -> Result<Rc<FunctionBound>, Error> {
        self.bound(self.function(name)?, &any_arguments())
    }

    /// Cycles of the two fetches with which a function's caller goes on, wherever it is.
    pub fn return_cycles(&self) -> Result<u64, Error> {
        self.map.worst_refill(self.image.code_sections())
    }
}
