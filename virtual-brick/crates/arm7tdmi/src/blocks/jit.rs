// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The interface to a JIT compiler: the description of a region of blocks, and where its code
//! returned.

use std::fmt;

use super::bus::RamView;
use super::state::GuestState;
use crate::instruction::Instruction;

/// In place of the index of an operation: the block was left with a branch.
pub const EXIT_BY_BRANCH: u32 = u32::MAX;

/// Where JIT code returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeExit {
    /// Number of the block.
    pub block: u32,
    /// Operation of the block in front of which a side exit was taken, or [`EXIT_BY_BRANCH`].
    pub operation: u32,
}

/// The target of a branch, known when it is translated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownTarget {
    /// Address; bit 0 tells Thumb state.
    pub key: u32,
    /// Number of the halfword.
    pub halfword: u32,
    /// Cycles of the fetches there.
    pub refill_cycles: u32,
}

/// The memory in which indirect branches find their targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeWindow {
    /// Number of its first halfword.
    pub first_halfword: u32,
    /// The bits of an address, in halfwords, that give the distance from there.
    pub mask: u32,
    /// A branch to where fetches would have continued has another cost.
    pub sequence_differs: bool,
}

/// One instruction of a block.
#[derive(Clone, Copy, Debug)]
pub struct RegionInstruction {
    /// The decoded instruction.
    pub instruction: Instruction,
    /// Its address.
    pub address: u32,
    /// Index of its first operation in the block.
    pub operation: u32,
    /// Cycles of the block's fetches up to and with its own.
    pub through_cycles: u32,
    /// The flags that it sets are observed.
    pub flags: bool,
    /// Its target, if that is known.
    pub target: Option<KnownTarget>,
    /// Value and cycles of a load from memory that holds code and cannot be written.
    pub literal: Option<(u32, u32)>,
}

/// One block of a region.
#[derive(Clone, Debug)]
pub struct RegionBlock {
    /// Its number.
    pub number: u32,
    /// Address; bit 0 tells Thumb state.
    pub key: u32,
    /// Number of its first halfword.
    pub halfword: u32,
    /// Cycles of the fetches after a branch to it.
    pub refill_cycles: u32,
    /// Most cycles it can take.
    pub worst_cycles: u32,
    /// Its instructions.
    pub instructions: Vec<RegionInstruction>,
    /// The block behind its last instruction, if control goes on there.
    pub next: Option<KnownTarget>,
}

/// Blocks that are compiled together.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its number, until all code is invalidated.
    pub number: u32,
    /// The blocks; the first became hot.
    pub blocks: Vec<RegionBlock>,
    /// The targets of its indirect branches.
    pub window: CodeWindow,
    /// Cycles of an access to RAM.
    pub ram_cycles: u32,
}

/// The answer to a request for compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompileAnswer {
    /// The region will be compiled.
    Queued,
    /// Too many requests wait at present.
    Busy,
    /// There is no code for these blocks.
    Unsupported,
}

/// Compiles blocks, keeps their code and runs it.
///
/// The code does what the operations of the blocks do, and takes a side exit where it cannot. It
/// is entered only at blocks, and only if [`GuestState::cycles_left`] is not less than the block's
/// worst case.
pub trait Jit: fmt::Debug + Send + Sync {
    /// A compiler like this one, without code.
    fn new_like(&self) -> Box<dyn Jit>;
    /// Compile threshold: runs of a block before its compilation is requested.
    fn threshold_runs(&self) -> u32;
    /// Requests compilation of a region.
    fn request(&mut self, region: Region, ram: &RamView<'_>) -> CompileAnswer;
    /// Number of the next region that has been compiled, if there is one by now. With `wait`, the
    /// call waits for one; none then means that nothing was requested.
    fn next_compiled(&mut self, wait: bool) -> Option<u32>;
    /// Installs the code of that region in place of any other code of its blocks, or drops it if it
    /// is not wanted. True if it can be entered now.
    fn install(&mut self, wanted: bool) -> bool;
    /// The code of the block at this halfword is not entered any more.
    fn invalidate(&mut self, halfword: u32);
    /// No code is entered any more.
    fn invalidate_all(&mut self);
    /// Bytes of code kept; invalid code counts until all is invalidated.
    fn code_bytes(&self) -> usize;
    /// All code must be invalidated: there is too much, or the compile thread is lost.
    fn is_exhausted(&self) -> bool;
    /// Runs the code of the block at this halfword, and of those that follow.
    fn run(&mut self, halfword: u32, state: &mut GuestState, ram: RamView<'_>) -> CodeExit;
}
