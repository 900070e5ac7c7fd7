// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads and stores. What a plain access cannot do goes through the bus, or is left to the
//! reference engine before the instruction has changed anything.

use super::beyond;
use super::bus::{BlockBus, PlainRead, PlainWords};
use super::run::{follow, size_of, Handler, Op, Rest, Run};
use crate::alu::shift_by_constant;
use crate::bus::Width;
use crate::instruction::BlockTransfer;

/// How the address comes about.
pub(super) const FIXED: u8 = 0;
/// `first` plus the value.
pub(super) const OFFSET: u8 = 1;
/// `first` plus `second` shifted left by the amount.
pub(super) const INDEXED: u8 = 2;
/// As the bits of the mode tell.
pub(super) const GENERAL: u8 = 3;
/// The value plus `second` shifted left by the amount: a table behind r15.
pub(super) const RELATIVE: u8 = 4;

/// Bits of the mode.
pub(super) const UP: u8 = 1 << 0;
pub(super) const BEFORE: u8 = 1 << 1;
pub(super) const WRITE_BACK: u8 = 1 << 2;
pub(super) const BY_REGISTER: u8 = 1 << 3;
/// Position of the kind of shift.
pub(super) const SHIFT: u8 = 4;

/// What is transferred.
pub(super) const WORD: u8 = 0;
pub(super) const BYTE: u8 = 1;
pub(super) const HALFWORD: u8 = 2;
pub(super) const SIGNED_BYTE: u8 = 3;
pub(super) const SIGNED_HALFWORD: u8 = 4;

pub(super) const fn width(item: u8) -> Width {
    match item {
        WORD => Width::Word,
        BYTE | SIGNED_BYTE => Width::Byte,
        _ => Width::Halfword,
    }
}

/// What a register receives.
#[inline(always)]
pub(super) const fn extended(item: u8, value: u32) -> u32 {
    match item {
        SIGNED_BYTE => value as u8 as i8 as u32,
        SIGNED_HALFWORD => value as u16 as i16 as u32,
        _ => value,
    }
}

/// Address of the access and, in general addressing, the moved base.
#[inline(always)]
fn address<B: BlockBus, const ADDRESSING: u8>(run: &Run<'_, B>, op: &Op<B>) -> (u32, u32) {
    match ADDRESSING {
        FIXED => (op.value, 0),
        OFFSET => (run.get(op.first).wrapping_add(op.value), 0),
        INDEXED => {
            let offset = run.get(op.second) << (op.amount & 31);
            (run.get(op.first).wrapping_add(offset), 0)
        }
        RELATIVE => {
            let offset = run.get(op.second) << (op.amount & 31);
            (op.value.wrapping_add(offset), 0)
        }
        _ => {
            let offset = if op.mode & BY_REGISTER == 0 {
                op.value
            } else {
                let (kind, amount) = (u32::from(op.mode >> SHIFT), u32::from(op.amount));
                shift_by_constant(kind, run.get(op.second), amount, run.state.carry != 0).value
            };
            let base = run.get(op.first);
            let moved = if op.mode & UP != 0 {
                base.wrapping_add(offset)
            } else {
                base.wrapping_sub(offset)
            };
            let used = if op.mode & BEFORE != 0 { moved } else { base };
            (used, moved)
        }
    }
}

fn load<B: BlockBus, const ITEM: u8, const ADDRESSING: u8>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    rest: Rest<'_, B>,
) {
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let Some(value) = run.bus.ram_read(at, width(ITEM)) else {
        return load_elsewhere(run, op, rest, ITEM, (at, moved));
    };
    run.state.cycles += u32::from(op.cycles);
    if ADDRESSING == GENERAL && op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run.set(op.destination, extended(ITEM, value));
    follow(run, rest);
}

/// A load that is not from RAM.
#[inline(never)]
fn load_elsewhere<B: BlockBus>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    rest: Rest<'_, B>,
    item: u8,
    (at, moved): (u32, u32),
) {
    let Some(PlainRead { value, cycles }) = run.bus.plain_read(at, width(item)) else {
        return beyond::load(run, op, item, (at, moved));
    };
    run.state.cycles += cycles + 1;
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run.set(op.destination, extended(item, value));
    follow(run, rest);
}

fn store<B: BlockBus, const ITEM: u8, const ADDRESSING: u8>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    rest: Rest<'_, B>,
) {
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let value = run.get(op.destination);
    if !run.bus.ram_write(at, width(ITEM), value) {
        return beyond::store(run, op, ITEM, (at, moved));
    }
    run.state.cycles += u32::from(op.cycles);
    run.state.after_store = op.address;
    if ADDRESSING == GENERAL && op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    follow(run, rest);
}

/// LDR to r15: a branch in ARM state.
fn load_jump<B: BlockBus, const ADDRESSING: u8>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    _rest: Rest<'_, B>,
) {
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let Some(PlainRead { value, cycles }) = run.bus.plain_read(at, Width::Word) else {
        return run.leave_before(op);
    };
    if !run.branch_to(op, value & !3) {
        return run.leave_before(op);
    }
    run.state.cycles += cycles + 1;
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
}

/// The handler of a load to r15.
pub(super) const fn jump_handler<B: BlockBus>(addressing: u8) -> Handler<B> {
    match addressing {
        FIXED => load_jump::<B, FIXED>,
        OFFSET => load_jump::<B, OFFSET>,
        INDEXED => load_jump::<B, INDEXED>,
        RELATIVE => load_jump::<B, RELATIVE>,
        _ => load_jump::<B, GENERAL>,
    }
}

const fn load_item<B: BlockBus, const ITEM: u8>(addressing: u8) -> Handler<B> {
    match addressing {
        RELATIVE => load::<B, ITEM, RELATIVE>,
        FIXED => load::<B, ITEM, FIXED>,
        OFFSET => load::<B, ITEM, OFFSET>,
        INDEXED => load::<B, ITEM, INDEXED>,
        _ => load::<B, ITEM, GENERAL>,
    }
}

const fn store_item<B: BlockBus, const ITEM: u8>(addressing: u8) -> Handler<B> {
    match addressing {
        RELATIVE => store::<B, ITEM, RELATIVE>,
        FIXED => store::<B, ITEM, FIXED>,
        OFFSET => store::<B, ITEM, OFFSET>,
        INDEXED => store::<B, ITEM, INDEXED>,
        _ => store::<B, ITEM, GENERAL>,
    }
}

/// The handler of a single load.
pub(super) const fn load_handler<B: BlockBus>(item: u8, addressing: u8) -> Handler<B> {
    match item {
        WORD => load_item::<B, WORD>(addressing),
        BYTE => load_item::<B, BYTE>(addressing),
        HALFWORD => load_item::<B, HALFWORD>(addressing),
        SIGNED_BYTE => load_item::<B, SIGNED_BYTE>(addressing),
        _ => load_item::<B, SIGNED_HALFWORD>(addressing),
    }
}

/// The handler of a single store.
pub(super) const fn store_handler<B: BlockBus>(item: u8, addressing: u8) -> Handler<B> {
    match item {
        WORD => store_item::<B, WORD>(addressing),
        BYTE => store_item::<B, BYTE>(addressing),
        _ => store_item::<B, HALFWORD>(addressing),
    }
}

/// A multiple transfer in the value of an operation: the list, then what is added to the base for
/// the first address, and what for its new value.
pub(super) const fn packed(block: &BlockTransfer) -> u32 {
    let size = block.size_bytes as i32;
    let (lowest, moved) = if block.up { (0, size) } else { (-size, -size) };
    let start = if block.before == block.up {
        lowest + 4
    } else {
        lowest
    };
    let moved = if block.write_back { moved } else { 0 };
    block.list | (start as u32 & 0xFF) << 16 | (moved as u32) << 24
}

/// First address of a multiple transfer and the moved base.
#[inline(always)]
fn block_address<B: BlockBus>(run: &Run<'_, B>, op: &Op<B>) -> (u32, u32) {
    let base = run.get(op.first);
    let start = (op.value << 8) as i32 >> 24;
    let moved = op.value as i32 >> 24;
    (
        base.wrapping_add(start as u32),
        base.wrapping_add(moved as u32),
    )
}

/// What a multiple load does at its end.
pub(super) const GOES_ON: u8 = 0;
/// r15 is in the list.
pub(super) const BRANCHES: u8 = 1;
/// r15 is in the list, and CPSR is restored.
pub(super) const RETURNS: u8 = 2;

/// LDM.
pub(super) fn load_block<B: BlockBus, const FINISH: u8>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    rest: Rest<'_, B>,
) {
    let (at, moved) = block_address(run, op);
    let count = u32::from(op.amount);
    if FINISH != GOES_ON {
        let plain = run.bus.plain_words(at, count);
        let Some(&last) = plain.and_then(|plain| plain.words.last()) else {
            return run.leave_before(op);
        };
        let size = size_of(run.state.next);
        let branched = if FINISH == RETURNS {
            run.return_to(op, last)
        } else {
            run.branch_to(op, last & !(size - 1) | run.state.next & 1)
        };
        if !branched {
            return run.leave_before(op);
        }
    }
    let Some(PlainWords { words, cycles }) = run.bus.plain_words(at, count) else {
        return run.leave_before(op);
    };
    run.state.cycles += 1 + count * cycles;
    run.state.registers[op.first as usize] = moved;
    let mut list = op.value & 0xFFFF;
    for &word in words {
        run.state.registers[(list.trailing_zeros() & 15) as usize] = word;
        list &= list.wrapping_sub(1);
    }
    match FINISH {
        GOES_ON => follow(run, rest),
        RETURNS => run.restore_status(),
        _ => {}
    }
}

/// STM.
pub(super) fn store_block<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, rest: Rest<'_, B>) {
    let (at, moved) = block_address(run, op);
    let count = u32::from(op.amount);
    let Some(PlainWords { words, cycles }) = run.bus.plain_words_mut(at, count) else {
        return run.leave_before(op);
    };
    let mut list = op.value & 0xFFFF;
    let mut words = words.iter_mut();
    if let Some(word) = words.next() {
        *word = run.state.registers[(list.trailing_zeros() & 15) as usize];
        list &= list.wrapping_sub(1);
    }
    run.state.registers[op.first as usize] = moved;
    for word in words {
        *word = run.state.registers[(list.trailing_zeros() & 15) as usize];
        list &= list.wrapping_sub(1);
    }
    run.state.cycles += count * cycles;
    run.state.after_store = op.address;
    follow(run, rest);
}
