// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Annotations looked up by address: which fact holds at a place of the image, and for which loops
//! each loop bound was used.

use crate::error::{Contradiction, Error, Place};
use crate::inputs::annotations::{Annotations, Fact};
use crate::inputs::image::{Entry, Image};
use crate::inputs::memory_map::MemoryMap;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// A loop for which a fact was used.
#[derive(Clone, Debug)]
pub struct FactUse {
    /// The loop's first instruction.
    pub place: Place,
    /// Number of the loop within its symbol.
    pub number: usize,
    /// The loop is inside of another one for which the same fact was used.
    pub nested: bool,
}

/// The user's facts about an image.
pub struct Facts<'a> {
    /// Symbols and source lines.
    pub image: &'a Image,
    /// All facts.
    pub annotations: &'a Annotations,
    /// Loops for which each loop bound was used: by its number, then by the header's address.
    pub uses: RefCell<BTreeMap<usize, BTreeMap<u32, FactUse>>>,
    /// Loop statements whose number of iterations was used, by the header's address.
    pub statement_uses: RefCell<BTreeMap<u32, usize>>,
    /// Facts that leave out places of what was looked at, as they are written.
    cutting: RefCell<BTreeSet<String>>,
    /// Branches whose targets were asked for.
    call_uses: RefCell<BTreeSet<u32>>,
    /// The first fact that the code contradicts.
    contradiction: RefCell<Option<Contradiction>>,
    map: &'a MemoryMap,
    regions: RefCell<BTreeMap<u32, Option<u8>>>,
}

impl<'a> Facts<'a> {
    /// Facts that name unknown regions or functions are errors.
    pub fn new(
        image: &'a Image,
        map: &'a MemoryMap,
        annotations: &'a Annotations,
    ) -> Result<Self, Error> {
        let mut regions = annotations
            .accesses
            .iter()
            .filter_map(|f| f.region.as_ref());
        regions.try_for_each(|region| map.find(region).map(drop))?;
        for target in annotations.calls.iter().flat_map(|fact| &fact.targets) {
            if image.functions(target).is_empty() && !target.starts_with('*') {
                return Err(Error::Input(format!(
                    "[[call]] names '{target}', no function here"
                )));
            }
        }
        Ok(Self {
            image,
            annotations,
            uses: RefCell::default(),
            statement_uses: RefCell::default(),
            contradiction: RefCell::default(),
            cutting: RefCell::default(),
            call_uses: RefCell::default(),
            map,
            regions: RefCell::default(),
        })
    }

    fn find(&self, facts: &'a [Fact], address: u32) -> Option<&'a Fact> {
        if facts.is_empty() {
            return None;
        }
        let place = self.image.place(address);
        let names = self.image.names_at(address);
        facts.iter().find(|fact| fact.matches(&place, names, None))
    }

    /// Is the place declared never to be executed?
    pub fn is_never_executed(&self, address: u32) -> bool {
        self.cuts("never", &self.annotations.never, address)
    }

    /// Is the place executed, but not in what is bounded?
    pub fn is_avoided(&self, address: u32) -> bool {
        self.cuts("outside", &self.annotations.avoided, address)
    }

    /// Does one of these facts leave a place out? Those that do are remembered.
    fn cuts(&self, table: &str, facts: &'a [Fact], address: u32) -> bool {
        let found = self.find(facts, address);
        if let Some(fact) = found {
            self.cutting.borrow_mut().insert(fact.written(table));
        }
        found.is_some()
    }

    /// Why no way on is left, if facts leave places out: those facts, for a message.
    pub fn cutting_words(&self) -> String {
        let facts = self.cutting.borrow();
        if facts.is_empty() {
            return String::new();
        }
        let facts: Vec<&str> = facts.iter().map(String::as_str).collect();
        format!(
            "; facts leave out places, one too many: {}",
            facts.join("; ")
        )
    }

    /// Does a branch to an unknown place end the analysis here?
    pub fn leaves(&self, address: u32) -> bool {
        self.find(&self.annotations.leaves, address).is_some()
    }

    /// Most activations of a recursive function in one call and at the same time.
    pub fn recursion(&self, function: Entry) -> Option<(u64, u32)> {
        let fact = self.recursion_fact(function)?;
        Some((fact.calls?, fact.depth?))
    }

    /// The fact that says so.
    pub fn recursion_fact(&self, function: Entry) -> Option<&'a Fact> {
        self.find(&self.annotations.recursions, function.0)
    }

    /// Cycles of a call that take `cycles`: no more than a fact says, and what is added.
    pub fn call_cycles(&self, function: Entry, cycles: u64) -> u64 {
        let most = self.costs(function).filter_map(|fact| fact.cycles).next();
        let added = self.added_cycles(function).unwrap_or(0);
        most.map_or(cycles, |most| most.min(cycles)) + added
    }

    /// Cycles that each call of a function takes besides.
    pub fn added_cycles(&self, function: Entry) -> Option<u64> {
        self.costs(function).find_map(|fact| fact.added_cycles)
    }

    fn costs(&self, function: Entry) -> impl Iterator<Item = &Fact> {
        let place = self.image.place(function.0);
        let names = self.image.names_at(function.0);
        let facts = self.annotations.costs.iter();
        facts.filter(move |fact| fact.matches(&place, names, None))
    }

    /// Functions that an indirect branch may reach.
    pub fn call_targets(&self, address: u32) -> Option<Vec<Entry>> {
        let fact = self.find(&self.annotations.calls, address)?;
        self.call_uses.borrow_mut().insert(address);
        let names = fact.targets.iter();
        Some(names.flat_map(|name| self.image.functions(name)).collect())
    }

    /// The fact that names the targets of the branch here, if it was asked for.
    pub fn used_call_fact(&self, address: u32) -> Option<&'a Fact> {
        let used = self.call_uses.borrow().contains(&address);
        self.find(&self.annotations.calls, address).filter(|_| used)
    }

    /// Region of an access.
    pub fn region(&self, address: u32) -> Option<u8> {
        if self.annotations.accesses.is_empty() {
            return None;
        }
        *self.regions.borrow_mut().entry(address).or_insert_with(|| {
            let accesses = &self.annotations.accesses;
            let general = || accesses.iter().find(|fact| fact.is_general());
            let fact = self.find(accesses, address).or_else(general)?;
            self.map.find(fact.region.as_ref()?).ok()
        })
    }

    /// The loop statement whose number of iterations was used for a loop, as a fact.
    pub fn statement_fact(&self, header: u32) -> Option<Fact> {
        let which = *self.statement_uses.borrow().get(&header)?;
        let statement = &self.annotations.statements[which];
        Some(Fact {
            file: Some(statement.file.clone()),
            line: statement.lines.first().copied(),
            iterations: statement.iterations,
            source: "pragma Annotate".into(),
            ..Fact::default()
        })
    }

    /// Notes that the code contradicts the bound of a loop, `allowed` header executions, while
    /// these functions are active. A bound for every loop of a place may hold all the same, as long
    /// as the function returns on another way: the one through this loop may be none in truth.
    pub fn note_contradiction(&self, header: u32, allowed: u64, active: &[Entry], returns: bool) {
        let holds = |fact: &Fact| {
            let within = self.image.within(fact);
            within.is_none_or(|callers| callers.iter().any(|f| active.contains(f)))
        };
        let loops = &self.annotations.loops;
        let uses = self.uses.borrow();
        let used = uses
            .iter()
            .filter(|(which, uses)| uses.contains_key(&header) && holds(&loops[**which]))
            .map(|(which, _)| &loops[*which])
            .min_by_key(|fact| fact.within.is_none());
        if returns && used.is_some_and(|fact| fact.every) {
            return;
        }
        let statement = || self.statement_fact(header);
        let fact = used.cloned().or_else(statement);
        let fact = fact.map(|fact| fact.written("loop"));
        let callers = active.split_last().map_or(&[][..], |(_, callers)| callers);
        let mut known = self.contradiction.borrow_mut();
        known.get_or_insert_with(|| Contradiction {
            fact: fact.unwrap_or_default(),
            allowed,
            place: self.image.place(header),
            callers: callers.iter().map(|f| self.image.name_at(f.0)).collect(),
        });
    }

    /// Refuses facts that the code contradicts, and loop bounds that were used for several loops
    /// without saying that they hold for each.
    pub fn check(&self) -> Result<(), Error> {
        if let Some(found) = self.contradiction.borrow().clone() {
            return Err(Error::Contradiction(Box::new(found)));
        }
        for (which, loops) in self.uses.borrow().iter() {
            let fact = &self.annotations.loops[*which];
            let named = fact.line.is_some() || fact.index.is_some();
            let nested = loops.values().any(|found| found.nested);
            let places: BTreeSet<_> = loops.values().map(FactUse::source_place).collect();
            if fact.every || !(nested || (!named && places.len() > 1)) {
                continue;
            }
            let each: Vec<String> = loops.values().map(FactUse::to_string).collect();
            return Err(Error::Input(format!(
                "{}: [[loop]] {} holds for {} loops: {}; give each its own with 'line', or with \
                 'symbol' and 'index', or add 'every = true' if the number holds for each of them",
                fact.source,
                fact.place(),
                loops.len(),
                each.join(", ")
            )));
        }
        Ok(())
    }
}

impl FactUse {
    /// File and line where they are known, so that copies of one loop count once.
    fn source_place(&self) -> (Option<&(String, u32)>, u32) {
        let line = self.place.line.as_ref();
        (line, line.map_or(self.place.address, |_| 0))
    }
}

impl std::fmt::Display for FactUse {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some((file, line)) = &self.place.line {
            write!(f, "{file}:{line}, ")?;
        }
        let symbol = self.place.symbol.as_ref();
        let symbol = symbol.map_or("?", |(name, _)| name);
        write!(f, "loop {} of {symbol}", self.number)
    }
}
