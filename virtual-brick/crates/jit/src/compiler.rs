// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From regions to machine code of the host.

use arm7tdmi::Region;
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::{InstBuilder, MemFlags};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::Context;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};

use crate::entry_table::Exit;
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
    /// None where the compiler failed.
    pub code: Option<HostCode>,
}

/// Compiles one region after the other.
pub(crate) struct Compiler {
    isa: OwnedTargetIsa,
    context: Context,
    builder: FunctionBuilderContext,
    generation: u32,
    exits: Vec<Exit>,
}

impl Compiler {
    pub fn new(isa: OwnedTargetIsa) -> Self {
        Self {
            isa,
            context: Context::new(),
            builder: FunctionBuilderContext::new(),
            generation: 0,
            exits: Vec::new(),
        }
    }

    /// The function that Rust calls: it passes its arguments on to a region's code.
    pub fn compile_entry_function(&mut self) -> Option<HostCode> {
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

    pub fn compile(&mut self, request: &CompileRequest) -> CompiledRegion {
        if self.generation != request.generation {
            self.generation = request.generation;
            self.exits.clear();
        }
        let first_exit = self.exits.len();
        self.context.clear();
        self.context.func.signature = region_signature();
        let builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let (region, layout) = (&request.region, request.layout);
        RegionCompiler::new(builder, region, layout, &mut self.exits).compile();
        let code = self.finish();
        if code.is_none() {
            self.exits.truncate(first_exit);
        }
        let blocks = region.blocks.iter();
        CompiledRegion {
            generation: request.generation,
            number: region.number,
            blocks: blocks
                .map(|block| (block.key, block.halfword, block.refill_cycles))
                .collect(),
            exits: self.exits[first_exit..].to_vec(),
            code,
        }
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
