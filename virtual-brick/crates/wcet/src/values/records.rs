// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What all executions of an instruction or a block have in common: the joined knowledge on which
//! the costs of blocks are based.

use crate::elapsed::Elapsed;
use crate::inputs::image::Entry;
use crate::values::value::Value;
use std::collections::BTreeSet;

/// What all executions of an instruction have in common.
#[derive(Clone, Debug, Default)]
pub struct InstructionRecord {
    /// Flags that are possible before it.
    pub flags: u16,
    /// Most expensive read.
    pub read_cycles: u64,
    /// Most expensive write.
    pub write_cycles: u64,
    /// Most internal cycles, with what they and the accesses add to the next fetch.
    pub internal_cycles: u32,
    /// Some address was not known to lie in one region.
    pub unknown_address: bool,
}

/// What all executions of a block have in common.
#[derive(Clone, Debug, Default)]
pub struct BlockRecord {
    /// One for each instruction.
    pub instructions: Vec<InstructionRecord>,
    /// Edges that some execution takes.
    pub feasible: Vec<bool>,
    /// r0 to r3 at the call.
    pub arguments: Option<[Value; 4]>,
    /// Deepest stack in bytes below the function's entry; `None` when not known.
    pub depth_bytes: Option<u32>,
    /// The instruction at which the depth was known and is not any more.
    pub depth_lost: Option<u32>,
    /// Depth at the call.
    pub call_depth_bytes: Option<u32>,
    /// Depth with what is called, in the contexts of the calls.
    pub callee_depth_bytes: Option<u32>,
    /// Highest urgency of a protected action that the block is in, at least in part.
    pub urgency: Option<u32>,
    /// Longest call at its end, where calls are analysed in their context.
    pub callee_elapsed: Option<Elapsed>,
    /// Functions that are really called at its end.
    pub callees: BTreeSet<Entry>,
}

impl BlockRecord {
    /// Depth with a callee that takes so many bytes for any state; if that has no bound, in the
    /// contexts of the calls.
    #[must_use]
    pub fn depth_of_call(&self, stack_bytes: Option<u32>) -> Option<u32> {
        let any = self.call_depth_bytes.zip(stack_bytes);
        any.map(|(here, below)| here + below)
            .or(self.callee_depth_bytes)
    }
}
