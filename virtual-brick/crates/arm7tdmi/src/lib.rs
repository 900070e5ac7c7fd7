// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM7TDMI core (ARMv4T): registers, decoding, execution and bus cycles. Knows only a bus.
//!
//! The core is an interpreter that performs each bus cycle of the real core in its order, so the
//! bus counts time and an instruction costs what the memory it touches makes it cost. With a
//! memory that answers in one cycle the totals are those of the instruction cycle tables of the
//! ARM7TDMI data sheet (ARM DDI 0029E, chapter 10).
//!
//! [`Instruction`] decodes opcodes on the same formats and states their bus cycles, for analysis
//! without running.
//!
//! [`Cpu`] is plain data: it can be cloned, compared and inspected at any instruction boundary.

pub mod alu;
mod arm;
mod arm_transfer;
mod block_transfer;
mod blocks;
pub mod bus;
pub mod cost;
mod cpu;
mod decode_arm;
mod decode_thumb;
mod exceptions;
mod format;
pub mod instruction;
mod multiply;
mod pipeline;
mod registers;
mod status;
mod thumb;
mod thumb_transfer;
mod timing;

pub use blocks::{
    BlockBus, Blocks, BlocksRun, BusAccess, CodePlace, Native, NativeAnswer, NativeBlock,
    NativeExit, NativeInstruction, NativeJump, NativeMemory, NativeReach, NativeRegion,
    NativeState, PlainRead, PlainWords, BRANCHED, NOWHERE,
};
pub use bus::{Abort, Bus, Cycle, Width};
pub use cpu::{Cpu, Step};
pub use exceptions::Exception;
pub use instruction::Instruction;
pub use registers::{psr, Mode};
pub use status::condition_passes;
pub use timing::TimingProfile;
