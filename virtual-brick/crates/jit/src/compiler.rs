// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From regions to instructions of the host.

use arm7tdmi::NativeRegion;
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::{InstBuilder, MemFlags};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::Context;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};

use crate::function::offset_of_left;
use crate::machine::Machine;
use crate::region::{Layout, RegionCompiler};
use crate::table::Exit;

/// A region to be compiled.
pub(crate) struct Request {
    /// Code of other generations has been forgotten.
    pub generation: u32,
    pub region: NativeRegion,
    pub layout: Layout,
}

/// Instructions of a function, which may lie anywhere.
pub(crate) struct Instructions {
    pub bytes: Vec<u8>,
    pub alignment: u64,
}

/// What became of a request.
pub(crate) struct Made {
    pub generation: u32,
    /// Number of the region.
    pub number: u32,
    /// Address, place and cycles of the refill of each block.
    pub blocks: Vec<(u32, u32, u32)>,
    /// The exits that it adds to those of its generation.
    pub exits: Vec<Exit>,
    /// None where the compiler failed.
    pub instructions: Option<Instructions>,
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

    /// The code that takes arguments as the host passes them and hands them on to a region's.
    pub fn enter(&mut self) -> Option<Instructions> {
        self.context.clear();
        self.context.func.signature = Machine::enter_signature(&self.isa);
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
        self.instructions()
    }

    pub fn make(&mut self, request: &Request) -> Made {
        if self.generation != request.generation {
            self.generation = request.generation;
            self.exits.clear();
        }
        let known = self.exits.len();
        self.context.clear();
        self.context.func.signature = Machine::signature();
        let builder = FunctionBuilder::new(&mut self.context.func, &mut self.builder);
        let (region, layout) = (&request.region, request.layout);
        RegionCompiler::new(builder, region, layout, &mut self.exits).compile();
        let instructions = self.instructions();
        if instructions.is_none() {
            self.exits.truncate(known);
        }
        let places = region.blocks.iter();
        Made {
            generation: request.generation,
            number: region.number,
            blocks: places
                .map(|block| (block.key, block.halfword, block.refill_cycles))
                .collect(),
            exits: self.exits[known..].to_vec(),
            instructions,
        }
    }

    fn instructions(&mut self) -> Option<Instructions> {
        let mut control = ControlPlane::default();
        let compiled = self.context.compile(&*self.isa, &mut control).ok()?;
        let alignment = u64::from(compiled.buffer.alignment);
        let fixed = compiled.buffer.relocs().is_empty();
        fixed.then(|| Instructions {
            bytes: compiled.code_buffer().to_vec(),
            alignment,
        })
    }
}
