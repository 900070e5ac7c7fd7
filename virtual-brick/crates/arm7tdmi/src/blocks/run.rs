// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! State while blocks run, and one decoded operation.

use super::bus::BlockBus;
use crate::bus::Width;

/// Executes one operation and those that follow it in the block.
pub(super) type Handler<B> = fn(&mut Run<'_, B>, &Op<B>, &[Op<B>]);

/// One operation of a block.
pub(super) struct Op<B: BlockBus> {
    pub handler: Handler<B>,
    /// Address of its instruction.
    pub address: u32,
    /// Constant operand, offset, target or register list.
    pub value: u32,
    /// Cycles of the block's fetches before this instruction.
    pub before: u16,
    /// Cycles of the block's fetches up to and with this instruction's.
    pub through: u16,
    pub destination: u8,
    pub first: u8,
    pub second: u8,
    pub amount: u8,
    /// Bits that the handler knows.
    pub mode: u8,
    /// Cycles besides the fetches and plain data accesses.
    pub cycles: u8,
    /// Most cycles from the block's beginning to where it can be left behind this operation.
    pub worst: u16,
}

/// No instruction has this address.
pub(super) const NOWHERE: u32 = u32::MAX;
/// No block is here; in Thumb state the next address.
pub(super) const NO_TARGET: u32 = u32::MAX - 1;

/// The processor while blocks run: general registers, flags apart from each other, cycles.
pub(super) struct Run<'a, B: BlockBus> {
    pub registers: [u32; 16],
    /// Bit 31 is N.
    pub negative: u32,
    /// Zero means Z.
    pub zero: u32,
    /// 0 or 1.
    pub carry: u32,
    /// 0 or 1.
    pub overflow: u32,
    /// Passed since the run began.
    pub cycles: u32,
    /// Address to go on at; bit 0 tells Thumb state.
    pub next: u32,
    /// The instruction at `next` needs the reference engine.
    pub leave: bool,
    /// Address after the store that was executed last, if no branch came after it.
    pub after_store: u32,
    /// An instruction that branches to itself ran.
    pub spun: bool,
    /// Interrupts are masked.
    pub masked: bool,
    pub region: u8,
    pub bus: &'a mut B,
}

/// Goes on with the next operation of the block. A block's last operation does not call this.
#[inline(always)]
pub(super) fn follow<B: BlockBus>(run: &mut Run<'_, B>, rest: &[Op<B>]) {
    if let Some((op, rest)) = rest.split_first() {
        (op.handler)(run, op, rest);
    }
}

impl<B: BlockBus> Run<'_, B> {
    #[inline(always)]
    pub fn get(&self, number: u8) -> u32 {
        self.registers[usize::from(number & 15)]
    }

    #[inline(always)]
    pub fn set(&mut self, number: u8, value: u32) {
        self.registers[usize::from(number & 15)] = value;
    }

    #[inline(always)]
    pub fn set_nz(&mut self, value: u32) {
        self.negative = value;
        self.zero = value;
    }

    /// Ends the block before an instruction that the reference engine must execute.
    #[cold]
    pub fn leave_before(&mut self, op: &Op<B>) {
        self.cycles += u32::from(op.before);
        self.next = op.address | self.next & 1;
        self.leave = true;
    }

    /// Ends the block with a branch to an address in the present state or, with bit 0 of `target`
    /// given its meaning by the caller, another.
    #[inline(always)]
    pub fn branch(&mut self, op: &Op<B>, target: u32, refill_cycles: u32) {
        self.cycles += u32::from(op.through) + refill_cycles;
        self.next = target;
        self.after_store = NOWHERE;
    }

    /// Ends the block with a branch whose target is known only now; bit 0 tells Thumb state.
    #[inline(always)]
    pub fn branch_to(&mut self, op: &Op<B>, target: u32) -> bool {
        let address = target & !1;
        let inside = self
            .bus
            .code_place(address)
            .is_some_and(|place| place.region == self.region);
        if !inside || address == op.address {
            return false;
        }
        let sequence = op.address.wrapping_add(3 * size_of(self.next));
        let refill = self.bus.refill_cycles(sequence, address, width_of(target));
        self.branch(op, target, refill);
        true
    }
}

/// Bytes of an instruction in the state that bit 0 of `key` tells.
#[inline(always)]
pub(super) const fn size_of(key: u32) -> u32 {
    4 >> (key & 1)
}

/// Width of a fetch in the state that bit 0 of `key` tells.
#[inline(always)]
pub(super) const fn width_of(key: u32) -> Width {
    if key & 1 == 0 {
        Width::Word
    } else {
        Width::Halfword
    }
}

/// Does the condition hold? 14 and 15 are not asked.
#[inline(always)]
pub(super) fn holds<B: BlockBus, const CONDITION: u8>(run: &Run<'_, B>) -> bool {
    let zero = run.zero == 0;
    let negative = run.negative >> 31;
    match CONDITION {
        0x0 => zero,
        0x1 => !zero,
        0x2 => run.carry != 0,
        0x3 => run.carry == 0,
        0x4 => negative != 0,
        0x5 => negative == 0,
        0x6 => run.overflow != 0,
        0x7 => run.overflow == 0,
        0x8 => run.carry != 0 && !zero,
        0x9 => run.carry == 0 || zero,
        0xA => negative == run.overflow,
        0xB => negative != run.overflow,
        0xC => !zero && negative == run.overflow,
        0xD => zero || negative != run.overflow,
        _ => false,
    }
}
