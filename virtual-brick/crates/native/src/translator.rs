// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Code of all regions and where it is entered.

use std::fmt;

use arm7tdmi::{Native, NativeExit, NativeMemory, NativeRegion, NativeState, BRANCHED};
use cranelift_codegen::ir::{types, InstBuilder, MemFlags};
use cranelift_codegen::Context;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};

use crate::function::offset_of_left;
use crate::machine::{host, Machine};
use crate::region::{Layout, RegionCompiler};
use crate::table::{entry, no_entries, no_entry, AfterStore, Entry, Exit};

/// Places of code that can have entries: all halfwords of RAM and flash.
const PLACES: usize = 0x8000 + 0x2_0000;
/// Words of RAM that the code is made for.
const WORDS: usize = 0x4000;
/// With so much code, all is forgotten and begins again.
const BYTES_MAX: usize = 8 << 20;
/// No instruction has this address.
const NOWHERE: u32 = u32::MAX;

/// Makes, keeps and runs code of the host.
pub struct Translator {
    machine: Machine,
    /// Per place of code, once there is code.
    table: Box<[Entry]>,
    exits: Vec<Exit>,
    worthwhile_runs: u32,
    context: Context,
    builder: FunctionBuilderContext,
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
    pub fn new(worthwhile_runs: u32) -> Option<Self> {
        let fits = cfg!(all(target_pointer_width = "64", target_endian = "little"));
        let isa = host().filter(|_| fits)?;
        Some(Self::with(Machine::new(isa), worthwhile_runs))
    }

    fn with(machine: Machine, worthwhile_runs: u32) -> Self {
        Self {
            machine,
            table: Box::default(),
            exits: Vec::new(),
            worthwhile_runs,
            context: Context::new(),
            builder: FunctionBuilderContext::new(),
        }
    }

    /// The code that takes arguments as the host passes them and hands them on to a region's.
    fn define_enter(&mut self) -> Option<()> {
        self.context.clear();
        self.context.func.signature = self.machine.enter_signature();
        let mut builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_all_blocks();
        let arguments = builder.block_params(block).to_vec();
        let (&code, arguments) = arguments.split_last()?;
        let signature = builder.import_signature(Machine::signature());
        let call = builder.ins().call_indirect(signature, code, arguments);
        let (left, exit) = match builder.inst_results(call) {
            [left, exit] => (*left, *exit),
            _ => return None,
        };
        let state = *arguments.first()?;
        builder
            .ins()
            .store(MemFlags::trusted(), left, state, offset_of_left());
        builder.ins().return_(&[exit]);
        builder.finalize();
        self.machine.define_enter(&mut self.context)
    }

    fn compile(&mut self, region: &NativeRegion, address: u32) -> Option<()> {
        if self.table.is_empty() {
            self.table = no_entries(PLACES);
        }
        if !self.machine.can_enter() {
            self.define_enter()?;
        }
        self.context.clear();
        self.context.func.signature = Machine::signature();
        let layout = Layout {
            address,
            words: WORDS as u32,
            table: self.table.as_ptr() as usize,
        };
        let builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let pointer = self.machine.isa().pointer_type();
        debug_assert_eq!(pointer, types::I64);
        RegionCompiler::new(builder, region, layout, &mut self.exits).compile();
        let code = self.machine.define(&mut self.context)?;
        for (index, block) in region.blocks.iter().enumerate() {
            if let Some(place) = self.table.get_mut(block.halfword as usize) {
                let refill_cycles = block.refill_cycles as u16;
                *place = entry(block.key, refill_cycles, index as u16, code.address());
            }
        }
        Some(())
    }
}

impl Native for Translator {
    fn fresh(&self) -> Box<dyn Native> {
        let machine = Machine::new(self.machine.isa().clone());
        Box::new(Self::with(machine, self.worthwhile_runs))
    }

    fn worthwhile_runs(&self) -> u32 {
        self.worthwhile_runs
    }

    fn translate(&mut self, region: &NativeRegion, memory: &NativeMemory<'_>) -> bool {
        let fits = memory.words.len() == WORDS && memory.marks.len() == WORDS;
        fits && self.compile(region, memory.address).is_some()
    }

    fn forget(&mut self, halfword: u32) {
        if let Some(entry) = self.table.get_mut(halfword as usize) {
            *entry = no_entry(halfword as usize);
        }
    }

    fn forget_all(&mut self) {
        self.table = Box::default();
        self.exits.clear();
        self.machine.clear();
    }

    fn is_full(&self) -> bool {
        self.machine.bytes() >= BYTES_MAX
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
