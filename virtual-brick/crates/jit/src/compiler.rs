// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From regions to machine code of the host.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::OnceLock;

use arm7tdmi::Region;
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::{InstBuilder, MemFlags};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::Context;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};

use crate::code_memory::host_isa;
use crate::entry_table::{Exit, Exits};
use crate::function::CYCLES_LEFT_OFFSET;
use crate::host_code::{entry_signature, region_signature, HostCode};
use crate::region::{Layout, RegionCompiler};

/// A request to compile a region.
pub(crate) struct CompileRequest {
    /// Code of other generations is invalid.
    pub generation: u32,
    pub region: Region,
    pub layout: Layout,
}

/// The answer to a request.
pub(crate) struct CompiledRegion {
    pub generation: u32,
    /// Number of the region.
    pub number: u32,
    /// Key, halfword and cycles of the refill of each block.
    pub blocks: Vec<(u32, u32, u32)>,
    /// The exits that it adds to those of its generation.
    pub exits: Vec<Exit>,
    /// None where the compiler failed, or the generation is invalid.
    pub code: Option<HostCode>,
}

impl CompiledRegion {
    pub fn without_code(request: &CompileRequest) -> Self {
        let blocks = request.region.blocks.iter();
        Self {
            generation: request.generation,
            number: request.region.number,
            blocks: blocks
                .map(|block| (block.key, block.halfword, block.refill_cycles))
                .collect(),
            exits: Vec::new(),
            code: None,
        }
    }
}

/// The generation of code that an engine wants, and how many exits that has by now.
#[derive(Debug, Default)]
pub(crate) struct Generation(AtomicU64);

impl Generation {
    /// Begins the next one.
    pub fn advance(&self) {
        let next = self.current().wrapping_add(1);
        self.0.store(u64::from(next) << 32, Ordering::Relaxed);
    }

    pub fn current(&self) -> u32 {
        (self.0.load(Ordering::Relaxed) >> 32) as u32
    }

    /// Exits of a generation; none if another is wanted.
    fn exits_of(&self, generation: u32) -> Option<u32> {
        let both = self.0.load(Ordering::Relaxed);
        ((both >> 32) as u32 == generation).then_some(both as u32)
    }

    /// The generation has so many exits after `first`; false if another is wanted by now.
    fn add_exits(&self, generation: u32, first: u32, count: usize) -> bool {
        let before = u64::from(generation) << 32 | u64::from(first);
        let after = before + count as u64;
        let (set, failed) = (Ordering::Relaxed, Ordering::Relaxed);
        self.0.compare_exchange(before, after, set, failed).is_ok()
    }
}

/// The function that Rust calls: it passes its arguments on to a region's code. The same for all
/// engines; none where the compiler failed.
pub(crate) fn entry_function() -> Option<&'static HostCode> {
    static CODE: OnceLock<Option<HostCode>> = OnceLock::new();
    let compile = || Compiler::new(host_isa()?).compile_entry_function();
    CODE.get_or_init(compile).as_ref()
}

/// Compiles one region after the other.
pub(crate) struct Compiler {
    isa: OwnedTargetIsa,
    context: Context,
    builder: FunctionBuilderContext,
}

impl Compiler {
    pub fn new(isa: OwnedTargetIsa) -> Self {
        Self {
            isa,
            context: Context::new(),
            builder: FunctionBuilderContext::new(),
        }
    }

    fn compile_entry_function(&mut self) -> Option<HostCode> {
        self.context.clear();
        self.context.func.signature = entry_signature(&self.isa);
        let mut builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_all_blocks();
        let arguments = builder.block_params(block).to_vec();
        let (&code, arguments) = arguments.split_last()?;
        let signature = builder.import_signature(region_signature());
        let call = builder.ins().call_indirect(signature, code, arguments);
        let (left, exit) = match builder.inst_results(call) {
            [left, exit] => (*left, *exit),
            _ => return None,
        };
        let (state, flags) = (*arguments.first()?, MemFlags::trusted());
        builder.ins().store(flags, left, state, CYCLES_LEFT_OFFSET);
        builder.ins().return_(&[exit]);
        builder.finalize();
        self.finish()
    }

    /// Compiles the region, if its engine wants its generation.
    pub fn compile(&mut self, request: &CompileRequest, wanted: &Generation) -> CompiledRegion {
        let mut compiled = CompiledRegion::without_code(request);
        let Some(first) = wanted.exits_of(request.generation) else {
            return compiled;
        };
        let mut exits = Exits {
            first,
            exits: Vec::new(),
        };
        self.context.clear();
        self.context.func.signature = region_signature();
        let builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let (region, layout) = (&request.region, request.layout);
        RegionCompiler::new(builder, region, layout, &mut exits).compile();
        let code = self.finish();
        if code.is_some() && wanted.add_exits(request.generation, first, exits.exits.len()) {
            compiled.exits = exits.exits;
            compiled.code = code;
        }
        compiled
    }

    fn finish(&mut self) -> Option<HostCode> {
        let mut control = ControlPlane::default();
        let compiled = self.context.compile(&*self.isa, &mut control).ok()?;
        let alignment = u64::from(compiled.buffer.alignment);
        let is_position_independent = compiled.buffer.relocs().is_empty();
        is_position_independent.then(|| HostCode {
            bytes: compiled.code_buffer().to_vec(),
            alignment,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use arm7tdmi::{CodeWindow, KnownTarget, RegionBlock};

    use super::*;

    /// A region of one block, from which control goes on.
    fn request(generation: u32) -> CompileRequest {
        let target = |key| KnownTarget {
            key,
            halfword: key / 2,
            refill_cycles: 2,
        };
        CompileRequest {
            generation,
            region: Region {
                number: 0,
                blocks: vec![RegionBlock {
                    number: 0,
                    key: 0,
                    halfword: 0,
                    refill_cycles: 2,
                    worst_cycles: 1,
                    instructions: Vec::new(),
                    next: Some(target(4)),
                }],
                window: CodeWindow {
                    first_halfword: 0,
                    mask: 0xF,
                    sequence_differs: false,
                },
                ram_cycles: 1,
            },
            layout: Layout {
                ram_address: 0x20_0000,
                ram_words: 4,
                table_address: 16,
            },
        }
    }

    #[test]
    fn exits_are_numbered_behind_those_of_the_regions_before() {
        let (mut compiler, wanted) = (Compiler::new(host_isa().unwrap()), Generation::default());
        let exits = |compiled: CompiledRegion| compiled.exits.len() as u32;
        let first = exits(compiler.compile(&request(0), &wanted));
        assert!(first != 0 && wanted.exits_of(0) == Some(first));
        let second = exits(compiler.compile(&request(0), &wanted));
        assert_eq!(wanted.exits_of(0), Some(first + second));
        wanted.advance();
        assert_eq!((wanted.exits_of(0), wanted.exits_of(1)), (None, Some(0)));
    }

    #[test]
    fn a_region_of_another_generation_has_no_code() {
        let (mut compiler, wanted) = (Compiler::new(host_isa().unwrap()), Generation::default());
        wanted.advance();
        let compiled = compiler.compile(&request(0), &wanted);
        assert!(compiled.code.is_none() && compiled.exits.is_empty());
        assert!(compiler.compile(&request(1), &wanted).code.is_some());
        // The engine wants another one while a region is compiled.
        let before = wanted.exits_of(1).unwrap();
        wanted.advance();
        assert!(!wanted.add_exits(1, before, 3));
        assert_eq!(wanted.exits_of(2), Some(0));
    }
}
