// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Code of all regions and where it is entered.

use std::collections::VecDeque;
use std::fmt;

use arm7tdmi::{
    Native, NativeAnswer, NativeExit, NativeMemory, NativeRegion, NativeState, BRANCHED, NOWHERE,
};

use crate::compiler::{Compiler, Made, Request};
use crate::machine::{host, Machine};
use crate::region::Layout;
use crate::table::{entry, no_entries, no_entry, AfterStore, Entry, Exit};
use crate::workshop::Workshop;

/// Places of code that can have entries: all halfwords of RAM and flash.
const PLACES: usize = 0x8000 + 0x2_0000;
/// Words of RAM that the code is made for.
const WORDS: usize = 0x4000;
/// With so much code, all is forgotten and begins again.
const BYTES_MAX: usize = 8 << 20;

/// When code is made of what has become worth it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// Before the run goes on.
    AtOnce,
    /// By a thread, while the blocks' own operations go on.
    Beside,
}

/// Makes, keeps and runs code of the host.
pub struct Translator {
    machine: Machine,
    /// Per place of code, once there is code.
    table: Box<[Entry]>,
    exits: Vec<Exit>,
    worthwhile_runs: u32,
    making: Making,
    compiler: Compiler,
    workshop: Option<Workshop>,
    /// Code and requests of others are forgotten.
    generation: u32,
    /// What has been made and not been settled.
    made: VecDeque<Made>,
}

impl fmt::Debug for Translator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Translator")
            .field("bytes", &self.machine.bytes())
            .finish_non_exhaustive()
    }
}

impl Translator {
    /// Without code yet, of which some is made of a block after so many runs of its operations;
    /// none where the host is not one that code can be made for.
    pub fn new(worthwhile_runs: u32, making: Making) -> Option<Self> {
        let fits = cfg!(all(target_pointer_width = "64", target_endian = "little"));
        let isa = host().filter(|_| fits)?;
        Some(Self::with(Machine::new(isa), worthwhile_runs, making))
    }

    fn with(machine: Machine, worthwhile_runs: u32, making: Making) -> Self {
        Self {
            compiler: Compiler::new(machine.isa().clone()),
            machine,
            table: Box::default(),
            exits: Vec::new(),
            worthwhile_runs,
            making,
            workshop: None,
            generation: 0,
            made: VecDeque::new(),
        }
    }

    /// Table and way in, which all code needs.
    fn prepare(&mut self) -> Option<()> {
        if self.table.is_empty() {
            self.table = no_entries(PLACES);
        }
        if !self.machine.can_enter() {
            let instructions = self.compiler.enter()?;
            self.machine.define_enter(&instructions)?;
        }
        Some(())
    }

    fn ask(&mut self, request: Request) -> NativeAnswer {
        self.gather(false);
        if self.making == Making::Beside && self.workshop.is_none() {
            let mut compiler = Compiler::new(self.machine.isa().clone());
            self.workshop = Workshop::open(move |request| compiler.make(request));
        }
        if let Some(workshop) = &self.workshop {
            return match workshop.ask(request) {
                true => NativeAnswer::Comes,
                false => NativeAnswer::NotNow,
            };
        }
        // The host gives no thread, or none was wanted.
        self.making = Making::AtOnce;
        let made = self.compiler.make(&request);
        self.made.push_back(made);
        NativeAnswer::Comes
    }

    /// The answers of this generation that have come; waits for one on demand.
    fn gather(&mut self, waits: bool) {
        loop {
            let waits = waits && self.made.is_empty();
            let Some(made) = self.workshop.as_mut().and_then(|shop| shop.answer(waits)) else {
                return;
            };
            if made.generation == self.generation {
                self.made.push_back(made);
            }
        }
    }

    fn install(&mut self, made: &Made) -> Option<()> {
        let code = self.machine.define(made.instructions.as_ref()?)?;
        for (index, &(key, halfword, refill_cycles)) in made.blocks.iter().enumerate() {
            if let Some(place) = self.table.get_mut(halfword as usize) {
                *place = entry(key, refill_cycles as u16, index as u16, code.address());
            }
        }
        Some(())
    }
}

impl Native for Translator {
    fn fresh(&self) -> Box<dyn Native> {
        let machine = Machine::new(self.machine.isa().clone());
        Box::new(Self::with(machine, self.worthwhile_runs, self.making))
    }

    fn worthwhile_runs(&self) -> u32 {
        self.worthwhile_runs
    }

    fn translate(&mut self, region: NativeRegion, memory: &NativeMemory<'_>) -> NativeAnswer {
        let fits = memory.words.len() == WORDS && memory.marks.len() == WORDS;
        if !fits || self.prepare().is_none() {
            return NativeAnswer::Never;
        }
        let layout = Layout {
            address: memory.address,
            words: WORDS as u32,
            table: self.table.as_ptr() as usize,
        };
        self.ask(Request {
            generation: self.generation,
            region,
            layout,
        })
    }

    fn finished(&mut self, waits: bool) -> Option<u32> {
        self.gather(waits);
        self.made.front().map(|made| made.number)
    }

    fn settle(&mut self, wanted: bool) -> bool {
        let Some(made) = self.made.pop_front() else {
            return false;
        };
        self.exits.extend_from_slice(&made.exits);
        wanted && self.install(&made).is_some()
    }

    fn forget(&mut self, halfword: u32) {
        if let Some(entry) = self.table.get_mut(halfword as usize) {
            *entry = no_entry(halfword as usize);
        }
    }

    fn forget_all(&mut self) {
        self.generation = self.generation.wrapping_add(1);
        self.workshop.take_if(|workshop| workshop.is_lost());
        if let Some(workshop) = &self.workshop {
            workshop.want_only(self.generation);
        }
        self.made.clear();
        self.table = Box::default();
        self.exits.clear();
        self.machine.clear();
    }

    fn bytes(&self) -> usize {
        self.machine.bytes()
    }

    fn is_spent(&self) -> bool {
        let lost = self.workshop.as_ref().is_some_and(Workshop::is_lost);
        lost || self.machine.bytes() >= BYTES_MAX
    }

    fn run(
        &mut self,
        halfword: u32,
        state: &mut NativeState,
        memory: NativeMemory<'_>,
    ) -> NativeExit {
        let NativeMemory { words, marks, .. } = memory;
        let entry = self
            .table
            .get(halfword as usize)
            .filter(|entry| entry[1] != 0 && words.len() == WORDS && marks.len() == WORDS);
        let exit = entry
            .and_then(|entry| self.machine.run(entry, &self.table, state, words, marks))
            .and_then(|exit| self.exits.get(exit as usize));
        let Some(exit) = exit else {
            return NativeExit {
                block: u32::MAX,
                operation: BRANCHED,
            };
        };
        state.next = exit.next;
        state.left -= exit.pending_cycles;
        match exit.after_store {
            AfterStore::Not => state.after_store = NOWHERE,
            AfterStore::At(address) => state.after_store = address,
            AfterStore::Told => {}
        }
        NativeExit {
            block: exit.block,
            operation: exit.operation,
        }
    }
}
