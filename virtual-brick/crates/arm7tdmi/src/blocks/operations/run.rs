// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One decoded operation, and the state while operations run.

use crate::blocks::bus::BlockBus;
use crate::blocks::state::{GuestState, NO_ADDRESS};
use crate::bus::Width;
use crate::condition::passes;
use crate::registers::{psr, RegisterFile};

/// Operations of a block, one behind the other.
pub(in crate::blocks) type Ops<'a, B> = std::slice::Iter<'a, Op<B>>;

/// Executes the first of these operations and those behind it; of none, it does nothing.
pub(in crate::blocks) type Handler<B> = fn(&mut Run<'_, B>, Ops<'_, B>);

/// The first of these operations; returns where there is none.
macro_rules! first {
    ($ops:ident => $op:ident) => {
        let Some($op) = $ops.as_slice().first() else {
            return;
        };
    };
}
pub(in crate::blocks) use first;

/// Number of a register, of which the compiler knows the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(in crate::blocks) enum Register {
    R0,
    R1,
    R2,
    R3,
    R4,
    R5,
    R6,
    R7,
    R8,
    R9,
    R10,
    R11,
    R12,
    R13,
    R14,
    R15,
}

impl Register {
    const ALL: [Self; 16] = [
        Self::R0,
        Self::R1,
        Self::R2,
        Self::R3,
        Self::R4,
        Self::R5,
        Self::R6,
        Self::R7,
        Self::R8,
        Self::R9,
        Self::R10,
        Self::R11,
        Self::R12,
        Self::R13,
        Self::R14,
        Self::R15,
    ];

    /// By the low four bits of a number.
    pub const fn number(number: u32) -> Self {
        Self::ALL[(number & 15) as usize]
    }
}

/// One operation of a block.
pub(in crate::blocks) struct Op<B: BlockBus> {
    /// Handler of the operation behind it.
    pub next: Handler<B>,
    /// Address of its instruction.
    pub address: u32,
    /// Constant operand, offset, target or register list.
    pub value: u32,
    /// Cycles of the block's fetches before this instruction.
    pub before: u16,
    /// Cycles of the block's fetches up to and with this instruction's; of a branch to a known
    /// target, with those at the target.
    pub through: u16,
    pub destination: Register,
    pub first: Register,
    pub second: Register,
    /// A third register.
    pub third: Register,
    pub amount: u8,
    /// Bits that the handler knows.
    pub mode: u8,
    /// Cycles of a load or store when it accesses RAM, besides the fetches; else a condition.
    pub cycles: u8,
    /// Most cycles from the block's beginning to the next place, behind this operation, at which
    /// the block can be left.
    pub worst: u16,
}

/// In place of [`GuestState::next`] while operations run: no branch yet. No block is here, in Thumb
/// state at the next address.
pub(in crate::blocks) const NO_TARGET: u32 = u32::MAX - 1;

/// In place of interrupt masks: none of them.
pub(in crate::blocks) const NO_MASKS: u32 = u32::MAX;

/// In place of the most cycles of a block that an access through the bus ends.
pub(in crate::blocks) const ENDS_AT_ACCESS: u32 = u32::MAX;

/// How the operations of a block ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::blocks) enum End {
    /// Behind the last one, or with a branch.
    Reached,
    /// The instruction at `next` needs the reference engine.
    Refused,
    /// The bus made an access; it has been told the time behind the instruction.
    Accessed,
    /// The bus aborted an access; the exception follows.
    Aborted,
    /// Masks, mode or bank may have changed.
    Status,
}

/// The processor while blocks run.
pub(in crate::blocks) struct Run<'a, B: BlockBus> {
    pub state: GuestState,
    pub end: End,
    /// Some instruction was executed.
    pub ran: bool,
    /// Cycles that the bus was told of.
    pub passed_cycles: u64,
    /// The call ends at this time of the bus.
    pub limit: u64,
    /// Cycles, from the last that the bus was told of, in which nothing is due.
    pub budget: u32,
    /// Most cycles of the block that runs; [`ENDS_AT_ACCESS`] if each access ends it.
    pub worst_cycles: u32,
    /// Of the block's fetches, the bus was told of so many cycles with an access in the block.
    pub told_cycles: u32,
    /// [`GuestState::cycles`] behind the last access outside of RAM.
    pub outside_ram_at: u32,
    /// The registers that were read would read the same again.
    pub reads_steadily: bool,
    /// Opcodes of the pipeline from before an access through the bus, which may change memory.
    pub fetched: Option<[u32; 2]>,
    /// Masks that still count at the next boundary, from before an MSR; else [`NO_MASKS`].
    pub delayed: u32,
    /// An MSR has its effect on interrupts one instruction later.
    pub delays_masks: bool,
    /// An instruction that branches to itself ran.
    pub branched_to_itself: bool,
    /// Number of the memory that holds the code.
    pub memory: u8,
    /// Registers of the other modes and the status but for its flags.
    pub file: &'a mut RegisterFile,
    pub bus: &'a mut B,
}

/// Continues behind the first of these operations. A block's last operation does not call this.
#[inline(always)]
pub(in crate::blocks) fn run_next<B: BlockBus>(run: &mut Run<'_, B>, mut ops: Ops<'_, B>) {
    if let Some(op) = ops.next() {
        (op.next)(run, ops);
    }
}

impl<B: BlockBus> Run<'_, B> {
    /// Tells the bus of the cycles in which instructions were executed; counts from 0 again.
    #[inline(always)]
    pub fn pass(&mut self, cycles: u32) {
        self.bus.pass(cycles);
        self.passed_cycles += u64::from(cycles);
        self.ran = true;
        self.state.cycles = 0;
        self.outside_ram_at = 0;
    }

    /// Cycles from the time that the bus knows to the access of this instruction.
    #[inline(always)]
    pub fn passed_at(&self, op: &Op<B>) -> u32 {
        self.state.cycles + u32::from(op.through) - self.told_cycles
    }

    /// Cycles from the time that the bus knows until something is due. The masks of both sides of
    /// a boundary count.
    #[inline(always)]
    pub fn cycles_until_event(&self) -> u32 {
        let masks = self.file.status() & self.delayed;
        let (irq, fiq) = (masks & psr::I == 0, masks & psr::F == 0);
        self.bus.cycles_until_event(self.limit, irq, fiq)
    }

    #[inline(always)]
    pub fn get(&self, register: Register) -> u32 {
        self.state.registers[register as usize]
    }

    #[inline(always)]
    pub fn set(&mut self, register: Register, value: u32) {
        self.state.registers[register as usize] = value;
    }

    /// CPSR in ARM state.
    #[inline(always)]
    pub fn status(&self) -> u32 {
        let flags = self.state.negative >> 31 << 31
            | u32::from(self.state.zero == 0) << 30
            | self.state.carry << 29
            | self.state.overflow >> 31 << 28;
        self.file.status() & 0x0FFF_FFFF & !psr::T | flags
    }

    /// Takes the flags from the register file.
    #[inline(always)]
    pub fn load_flags(&mut self) {
        let status = self.file.status();
        self.state.negative = status & psr::N;
        self.state.zero = u32::from(status & psr::Z == 0);
        self.state.carry = status >> 29 & 1;
        self.state.overflow = status << 3;
    }

    /// Interrupts are masked.
    pub fn masked(&self) -> bool {
        self.file.status() & psr::I != 0
    }

    #[inline(always)]
    pub fn set_nz(&mut self, value: u32) {
        self.state.negative = value;
        self.state.zero = value;
    }

    /// Ends the block before an instruction that the reference engine must execute.
    #[cold]
    pub fn exit_before(&mut self, op: &Op<B>) {
        self.state.cycles += u32::from(op.before);
        self.state.next = op.address | self.state.next & 1;
        self.end = End::Refused;
    }

    /// Ends the block with a branch to an address in the present state or, with bit 0 of `target`
    /// given its meaning by the caller, another.
    #[inline(always)]
    pub fn branch(&mut self, op: &Op<B>, target: u32, refill_cycles: u32) {
        self.state.cycles += u32::from(op.through) + refill_cycles;
        self.state.next = target;
        self.state.after_store = NO_ADDRESS;
    }

    /// Ends the block with an indirect branch; bit 0 of the target tells Thumb state. False if the
    /// reference engine must make it.
    #[inline(always)]
    pub fn branch_to(&mut self, op: &Op<B>, target: u32) -> bool {
        let address = target & !1;
        let sequence = op.address.wrapping_add(3 * size_of(self.state.next));
        let width = width_of(target);
        let cycles = self
            .bus
            .branch_cycles(sequence, address, width, self.memory);
        let Some(refill) = cycles.filter(|_| address != op.address) else {
            return false;
        };
        self.branch(op, target, refill);
        true
    }
}

/// Bytes of an instruction in the state that bit 0 of `key` tells.
#[inline(always)]
pub(in crate::blocks) const fn size_of(key: u32) -> u32 {
    4 >> (key & 1)
}

/// Width of a fetch in the state that bit 0 of `key` tells.
#[inline(always)]
pub(in crate::blocks) const fn width_of(key: u32) -> Width {
    if key & 1 == 0 {
        Width::Word
    } else {
        Width::Halfword
    }
}

/// Does the condition hold? 14 and 15 are not asked.
#[inline(always)]
pub(in crate::blocks) fn condition_holds<B: BlockBus, const CONDITION: u8>(
    run: &Run<'_, B>,
) -> bool {
    let (negative, zero) = (run.state.negative >> 31 != 0, run.state.zero == 0);
    let (carry, overflow) = (run.state.carry != 0, run.state.overflow >> 31 != 0);
    passes(CONDITION as u32, negative, zero, carry, overflow)
}

/// The two opcodes that memory holds at `key`.
#[inline(always)]
pub(in crate::blocks) fn opcodes<B: BlockBus>(bus: &B, key: u32) -> [u32; 2] {
    let (address, next) = (key & !1, (key & !1).wrapping_add(size_of(key)));
    let (first, second) = (bus.code_word(address), bus.code_word(next));
    if key & 1 == 0 {
        [first, second]
    } else {
        let half = |word: u32, address: u32| word >> (8 * (address & 2)) & 0xFFFF;
        [half(first, address), half(second, next)]
    }
}
