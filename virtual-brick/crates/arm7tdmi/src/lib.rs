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

/// Instances of a generic function, one for each value of its last constant argument.
macro_rules! instances {
    ($function:ident::<$($fixed:ident,)* [$($value:literal)*]>) => {
        instances!(@ $function [$($value)*] ($($fixed),*))
    };
    (@ $function:ident [$($value:literal)*] $fixed:tt) => {
        [$(instances!(@@ $function $value $fixed)),*]
    };
    (@@ $function:ident $value:literal ($($fixed:ident),*)) => {
        $function::<$($fixed,)* $value>
    };
}

pub mod alu;
mod blocks;
pub mod bus;
mod condition;
pub mod cost;
mod cpu;
mod decode;
mod exception;
mod execute;
pub mod instruction;
mod pipeline;
mod registers;
mod timing;

pub use blocks::{
    BlockBus, Blocks, BlocksRun, BusAccess, CodeExit, CodePlace, CodeWindow, CompileAnswer,
    GuestState, Jit, KnownTarget, PlainRead, PlainWords, RamView, Region, RegionBlock,
    RegionInstruction, EXIT_BY_BRANCH, NO_ADDRESS,
};
pub use bus::{Abort, Bus, Cycle, Width};
pub use condition::condition_passes;
pub use cpu::{Cpu, Step};
pub use exception::Exception;
pub use instruction::Instruction;
pub use registers::{psr, Mode};
pub use timing::TimingProfile;
