// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The code of all regions: requests, installation, invalidation, execution.

use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;

use arm7tdmi::{
    CodeExit, CompileAnswer, GuestState, Jit, RamView, Region, EXIT_BY_BRANCH, NO_ADDRESS,
};

use crate::code_memory::{host_isa, CodeMemory, ARENA_BYTES};
use crate::compile_thread::CompileQueue;
use crate::compiler::{entry_function, CompileRequest, CompiledRegion, Compiler, Generation};
use crate::entry_table::{empty_table, entry, no_entry, AfterStore, Entry, Exit};
use crate::region::Layout;

/// Halfwords that can have entries: all of RAM and flash.
const HALFWORDS: usize = 0x8000 + 0x2_0000;
/// Words of RAM that the code is compiled for.
const RAM_WORDS: usize = 0x4000;
/// With so much code, all is invalidated: the arena is nearly full.
const BYTES_MAX: usize = ARENA_BYTES - (64 << 10);

/// When hot blocks are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompileMode {
    /// Before the run continues.
    Synchronous,
    /// By the compile thread, while the run continues with interpreted blocks.
    Background,
}

/// Compiles hot blocks, keeps their code and runs it.
pub struct JitEngine {
    memory: CodeMemory,
    /// Empty before the first code.
    table: Box<[Entry]>,
    exits: Vec<Exit>,
    threshold_runs: u32,
    mode: CompileMode,
    /// Code and requests of other generations are invalid.
    generation: Arc<Generation>,
    queue: CompileQueue,
    /// None before the first request that is served at once.
    compiler: Option<Compiler>,
    /// Regions that have been compiled and not installed yet.
    compiled: VecDeque<CompiledRegion>,
}

impl fmt::Debug for JitEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JitEngine")
            .field("code_bytes", &self.memory.bytes())
            .finish_non_exhaustive()
    }
}

impl JitEngine {
    /// An engine without code yet, which compiles a block after so many runs; none where Cranelift
    /// does not know the host.
    pub fn new(threshold_runs: u32, mode: CompileMode) -> Option<Self> {
        let fits = cfg!(all(target_pointer_width = "64", target_endian = "little"));
        let isa = host_isa().filter(|_| fits)?;
        Some(Self::with(CodeMemory::new(isa), threshold_runs, mode))
    }

    fn with(memory: CodeMemory, threshold_runs: u32, mode: CompileMode) -> Self {
        let generation = Arc::new(Generation::default());
        Self {
            memory,
            table: Box::default(),
            exits: Vec::new(),
            threshold_runs,
            mode,
            queue: CompileQueue::new(Arc::clone(&generation)),
            generation,
            compiler: None,
            compiled: VecDeque::new(),
        }
    }

    /// Makes the table and the entry function, which all code needs.
    fn prepare(&mut self) -> Option<()> {
        if self.table.is_empty() {
            self.table = empty_table(HALFWORDS);
        }
        if !self.memory.has_entry_function() {
            self.memory.define_entry_function(entry_function()?)?;
        }
        Some(())
    }

    fn submit(&mut self, mut request: CompileRequest) -> CompileAnswer {
        self.collect(false);
        if self.mode == CompileMode::Background {
            request = match self.queue.submit(request) {
                Ok(answer) => return answer,
                Err(request) => request,
            };
            self.mode = CompileMode::Synchronous;
        }
        let isa = self.memory.isa();
        let compiler = self
            .compiler
            .get_or_insert_with(|| Compiler::new(isa.clone()));
        let compiled = compiler.compile(&request, &self.generation);
        self.compiled.push_back(compiled);
        CompileAnswer::Queued
    }

    /// Takes the results of this generation from the thread; with `wait`, waits for one.
    fn collect(&mut self, wait: bool) {
        loop {
            let wait = wait && self.compiled.is_empty();
            let Some(compiled) = self.queue.result(wait) else {
                return;
            };
            if compiled.generation == self.generation.current() {
                self.compiled.push_back(compiled);
            }
        }
    }

    fn install_code(&mut self, compiled: &CompiledRegion) -> Option<()> {
        let code = self.memory.define_region(compiled.code.as_ref()?)?;
        for (index, &(key, halfword, refill_cycles)) in compiled.blocks.iter().enumerate() {
            if let Some(slot) = self.table.get_mut(halfword as usize) {
                *slot = entry(key, refill_cycles as u16, index as u16, code.value());
            }
        }
        Some(())
    }
}

impl Jit for JitEngine {
    fn new_like(&self) -> Box<dyn Jit> {
        let memory = CodeMemory::new(self.memory.isa().clone());
        Box::new(Self::with(memory, self.threshold_runs, self.mode))
    }

    fn threshold_runs(&self) -> u32 {
        self.threshold_runs
    }

    fn request(&mut self, region: Region, ram: &RamView<'_>) -> CompileAnswer {
        let fits = ram.words.len() == RAM_WORDS && ram.marks.len() == RAM_WORDS;
        if !fits || self.prepare().is_none() {
            return CompileAnswer::Unsupported;
        }
        let layout = Layout {
            ram_address: ram.address,
            ram_words: RAM_WORDS as u32,
            table_address: self.table.as_ptr() as usize,
        };
        self.submit(CompileRequest {
            generation: self.generation.current(),
            region,
            layout,
        })
    }

    fn next_compiled(&mut self, wait: bool) -> Option<u32> {
        self.collect(wait);
        self.compiled.front().map(|compiled| compiled.number)
    }

    fn install(&mut self, wanted: bool) -> bool {
        let Some(compiled) = self.compiled.pop_front() else {
            return false;
        };
        self.exits.extend_from_slice(&compiled.exits);
        wanted && self.install_code(&compiled).is_some()
    }

    fn invalidate(&mut self, halfword: u32) {
        if let Some(slot) = self.table.get_mut(halfword as usize) {
            *slot = no_entry(halfword as usize);
        }
    }

    fn invalidate_all(&mut self) {
        self.queue.leave_lost();
        self.generation.advance();
        self.compiled.clear();
        self.table = Box::default();
        self.exits.clear();
        self.memory.clear();
    }

    fn code_bytes(&self) -> usize {
        self.memory.bytes()
    }

    fn is_exhausted(&self) -> bool {
        self.queue.is_lost() || self.memory.bytes() >= BYTES_MAX
    }

    fn run(&mut self, halfword: u32, state: &mut GuestState, ram: RamView<'_>) -> CodeExit {
        let RamView { words, marks, .. } = ram;
        let entry = self
            .table
            .get(halfword as usize)
            .filter(|entry| entry[1] != 0 && words.len() == RAM_WORDS && marks.len() == RAM_WORDS);
        let exit = entry
            .and_then(|entry| self.memory.run(entry, &self.table, state, words, marks))
            .and_then(|exit| self.exits.get(exit as usize));
        let Some(exit) = exit else {
            return CodeExit {
                block: u32::MAX,
                operation: EXIT_BY_BRANCH,
            };
        };
        state.next = exit.next;
        state.cycles_left -= exit.pending_cycles;
        match exit.after_store {
            AfterStore::No => state.after_store = NO_ADDRESS,
            AfterStore::At(address) => state.after_store = address,
            AfterStore::InState => {}
        }
        CodeExit {
            block: exit.block,
            operation: exit.operation,
        }
    }
}
