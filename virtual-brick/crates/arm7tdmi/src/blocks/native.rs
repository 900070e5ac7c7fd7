// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a maker of code of the host is told of blocks, and what that code sees of the processor.
//!
//! Such code runs whole blocks, one after the other. Before an operation that it cannot do it
//! stops, and the blocks' own operations go on there.

use std::fmt;

use crate::instruction::Instruction;

/// In place of the index of an operation: the block was left with a branch.
pub const BRANCHED: u32 = u32::MAX;
/// In place of the address of an instruction: none.
pub const NOWHERE: u32 = u32::MAX;

/// The processor while blocks run: general registers, flags apart from each other, cycles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NativeState {
    /// r0 to r15; r15 has no meaning here.
    pub registers: [u32; 16],
    /// Bit 31 is N.
    pub negative: u32,
    /// Zero means Z.
    pub zero: u32,
    /// C: 0 or 1.
    pub carry: u32,
    /// Bit 31 is V.
    pub overflow: u32,
    /// Cycles passed since the bus was told the time.
    pub cycles: u32,
    /// Address to go on at; bit 0 tells Thumb state.
    pub next: u32,
    /// Address of the store that was executed last, if no branch came after it; else [`NOWHERE`].
    pub after_store: u32,
    /// Cycles left until the code has to return.
    pub left: u32,
}

/// Where code of the host has returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NativeExit {
    /// Number of the block.
    pub block: u32,
    /// Operation of the block before which it was left, or [`BRANCHED`].
    pub operation: u32,
}

/// RAM as code of the host sees it.
#[derive(Debug)]
pub struct NativeMemory<'a> {
    /// Address of the first word.
    pub address: u32,
    /// All words.
    pub words: &'a mut [u32],
    /// Of each word: somebody wants to know when it is written.
    pub marks: &'a [u8],
}

/// A branch to a known target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NativeJump {
    /// Address; bit 0 tells Thumb state.
    pub key: u32,
    /// Place of the target.
    pub halfword: u32,
    /// Cycles of the fetches there.
    pub refill_cycles: u32,
}

/// Where branches whose target is known only at run time can go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NativeReach {
    /// Number of the first halfword that can be reached.
    pub first_halfword: u32,
    /// The address, in halfwords, has these bits of the distance.
    pub mask: u32,
    /// A branch to where fetches would have gone on has another cost.
    pub sequence_differs: bool,
}

/// One instruction of a block.
#[derive(Clone, Copy, Debug)]
pub struct NativeInstruction {
    /// What it does.
    pub instruction: Instruction,
    /// Where it lies.
    pub address: u32,
    /// Index of its first operation in the block.
    pub operation: u32,
    /// Cycles of the block's fetches before it.
    pub before_cycles: u32,
    /// Cycles of the block's fetches up to and with its own.
    pub through_cycles: u32,
    /// Somebody sees the flags that it sets.
    pub flags: bool,
    /// Its target, if that is known.
    pub jump: Option<NativeJump>,
    /// Value and cycles of a load from memory that holds code and cannot be written.
    pub literal: Option<(u32, u32)>,
}

/// One block.
#[derive(Clone, Debug)]
pub struct NativeBlock {
    /// Its number.
    pub number: u32,
    /// Address; bit 0 tells Thumb state.
    pub key: u32,
    /// Place of its first instruction.
    pub halfword: u32,
    /// Cycles of the fetches after a branch to it.
    pub refill_cycles: u32,
    /// Most cycles it can take.
    pub worst_cycles: u32,
    /// Its instructions.
    pub instructions: Vec<NativeInstruction>,
    /// The block that it goes on with behind its last instruction.
    pub next: Option<NativeJump>,
}

/// Blocks that are made into code together.
#[derive(Clone, Debug)]
pub struct NativeRegion {
    /// Its number, until all is forgotten.
    pub number: u32,
    /// The blocks; the first was the cause.
    pub blocks: Vec<NativeBlock>,
    /// Where its branches can go.
    pub reach: NativeReach,
    /// Cycles of an access to RAM.
    pub ram_cycles: u32,
}

/// What becomes of a request for code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NativeAnswer {
    /// It is settled later.
    Comes,
    /// Too much is asked for at present.
    NotNow,
    /// There is none for these blocks.
    Never,
}

/// Makes code of the host from blocks, keeps and runs it.
///
/// The code does what the operations of the blocks do, and stops where it cannot. It is entered
/// only at blocks, and only if [`NativeState::left`] is not less than the block's worst.
pub trait Native: fmt::Debug + Send + Sync {
    /// One like this without code.
    fn fresh(&self) -> Box<dyn Native>;
    /// Times that a block runs before code is made of it.
    fn worthwhile_runs(&self) -> u32;
    /// Asks for code for the blocks of a region.
    fn translate(&mut self, region: NativeRegion, memory: &NativeMemory<'_>) -> NativeAnswer;
    /// Number of the region that is the next to be settled, if one is by now; else it is waited for
    /// on demand, and none comes if none was asked for.
    fn finished(&mut self, waits: bool) -> Option<u32>;
    /// Takes the code of that region, in place of what is entered at its blocks, or lets it go;
    /// false if it is not entered.
    fn settle(&mut self, wanted: bool) -> bool;
    /// The block there is entered no more.
    fn forget(&mut self, halfword: u32);
    /// Nothing is entered any more.
    fn forget_all(&mut self);
    /// Bytes of the code that is kept; what is entered no more counts until all is forgotten.
    fn bytes(&self) -> usize;
    /// It is time to forget all: so much code was made, or what was asked for will not come.
    fn is_spent(&self) -> bool;
    /// Runs the block at a place of which there is code, and those that follow.
    fn run(
        &mut self,
        halfword: u32,
        state: &mut NativeState,
        memory: NativeMemory<'_>,
    ) -> NativeExit;
}
