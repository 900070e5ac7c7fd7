// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads and stores. An access that is not plain goes through the bus, or the block is left before
//! the instruction has changed anything.

use super::encoding::*;
use super::run::{first, run_next, size_of, Handler, Op, Ops, Run};
use super::slow_path;
use crate::alu::shift_by_constant;
use crate::blocks::bus::{BlockBus, PlainRead, PlainWords};
use crate::bus::Width;

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
            let offset = if op.mode & REGISTER_OFFSET == 0 {
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

fn load<B: BlockBus, const ITEM: u8, const ADDRESSING: u8>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let Some(value) = run.bus.ram_read(at, width(ITEM)) else {
        return load_outside_ram::<B, ITEM>(run, ops, (at, moved));
    };
    run.state.cycles += u32::from(op.cycles);
    if ADDRESSING == GENERAL && op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run.set(op.destination, extended(ITEM, value));
    run_next(run, ops);
}

/// A load that is not from RAM.
#[inline(never)]
fn load_outside_ram<B: BlockBus, const ITEM: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
    (at, moved): (u32, u32),
) {
    first!(ops => op);
    let Some(PlainRead { value, cycles }) = run.bus.plain_read(at, width(ITEM)) else {
        return load_register::<B, ITEM>(run, ops, (at, moved));
    };
    run.accessed_outside_ram(op, moved, cycles + 1);
    run.set(op.destination, extended(ITEM, value));
    run_next(run, ops);
}

/// A load that is not from memory.
#[inline(never)]
fn load_register<B: BlockBus, const ITEM: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
    (at, moved): (u32, u32),
) {
    first!(ops => op);
    let passed = run.passed_at(op);
    let read = (ITEM == WORD).then(|| run.bus.register_read(at, passed));
    let Some((value, steady)) = read.flatten() else {
        return slow_path::load::<B, ITEM>(run, ops, (at, moved));
    };
    run.reads_steadily &= steady;
    run.accessed_outside_ram(op, moved, run.bus.register_cycles() + 1);
    run.set(op.destination, value);
    run_next(run, ops);
}

impl<B: BlockBus> Run<'_, B> {
    #[inline(always)]
    fn accessed_outside_ram(&mut self, op: &Op<B>, moved: u32, cycles: u32) {
        self.state.cycles += cycles;
        self.outside_ram_at = self.state.cycles;
        if op.mode & WRITE_BACK != 0 {
            self.set(op.first, moved);
        }
    }
}

fn store<B: BlockBus, const ITEM: u8, const ADDRESSING: u8>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let value = run.get(op.destination);
    if !run.bus.ram_write(at, width(ITEM), value) {
        return store_outside_ram::<B, ITEM>(run, ops, (at, moved));
    }
    run.state.cycles += u32::from(op.cycles);
    run.state.after_store = op.address;
    if ADDRESSING == GENERAL && op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run_next(run, ops);
}

/// A store that is not a plain one to RAM.
#[inline(never)]
fn store_outside_ram<B: BlockBus, const ITEM: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
    (at, moved): (u32, u32),
) {
    first!(ops => op);
    let (value, passed) = (run.get(op.destination), run.passed_at(op));
    if ITEM != WORD || !run.bus.register_write(at, value, passed) {
        return slow_path::store::<B, ITEM>(run, ops, (at, moved));
    }
    run.accessed_outside_ram(op, moved, run.bus.register_cycles());
    run.state.after_store = op.address;
    run_next(run, ops);
}

/// LDR to r15: a branch in ARM state.
fn load_branch<B: BlockBus, const ADDRESSING: u8>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let (at, moved) = address::<B, ADDRESSING>(run, op);
    let Some(PlainRead { value, cycles }) = run.bus.plain_read(at, Width::Word) else {
        return run.exit_before(op);
    };
    if !run.branch_to(op, value & !3) {
        return run.exit_before(op);
    }
    run.state.cycles += cycles + 1;
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
}

/// The handler of a load to r15.
pub(in crate::blocks) fn load_branch_handler<B: BlockBus>(addressing: u8) -> Handler<B> {
    let of_addressing: [Handler<B>; 5] = instances!(load_branch::<B, [0 1 2 3 4]>);
    of_addressing[usize::from(addressing)]
}

fn load_item<B: BlockBus, const ITEM: u8>(addressing: u8) -> Handler<B> {
    let of_addressing: [Handler<B>; 5] = instances!(load::<B, ITEM, [0 1 2 3 4]>);
    of_addressing[usize::from(addressing)]
}

fn store_item<B: BlockBus, const ITEM: u8>(addressing: u8) -> Handler<B> {
    let of_addressing: [Handler<B>; 5] = instances!(store::<B, ITEM, [0 1 2 3 4]>);
    of_addressing[usize::from(addressing)]
}

/// The handler of a single load.
pub(in crate::blocks) fn load_handler<B: BlockBus>(item: u8, addressing: u8) -> Handler<B> {
    let of_item: [fn(u8) -> Handler<B>; 5] = instances!(load_item::<B, [0 1 2 3 4]>);
    of_item[usize::from(item)](addressing)
}

/// The handler of a single store; the signed items are those of loads only.
pub(in crate::blocks) fn store_handler<B: BlockBus>(item: u8, addressing: u8) -> Handler<B> {
    let of_item: [fn(u8) -> Handler<B>; 3] = instances!(store_item::<B, [0 1 2]>);
    of_item[usize::from(item)](addressing)
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

/// The end of a multiple load.
pub(in crate::blocks) const FALLS_THROUGH: u8 = 0;
/// r15 is in the list.
pub(in crate::blocks) const BRANCHES: u8 = 1;
/// r15 is in the list, and CPSR is restored.
pub(in crate::blocks) const RETURNS: u8 = 2;

/// LDM.
pub(in crate::blocks) fn load_block<B: BlockBus, const FINISH: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    let (at, moved) = block_address(run, op);
    let count = u32::from(op.amount);
    if FINISH != FALLS_THROUGH {
        let plain = run.bus.plain_words(at, count);
        let Some(&last) = plain.and_then(|plain| plain.words.last()) else {
            return run.exit_before(op);
        };
        let size = size_of(run.state.next);
        let branched = if FINISH == RETURNS {
            run.return_to(op, last)
        } else {
            run.branch_to(op, last & !(size - 1) | run.state.next & 1)
        };
        if !branched {
            return run.exit_before(op);
        }
    }
    let Some(PlainWords { words, cycles }) = run.bus.plain_words(at, count) else {
        return run.exit_before(op);
    };
    run.state.cycles += 1 + count * cycles;
    run.state.registers[op.first as usize] = moved;
    let mut list = op.value & 0xFFFF;
    for &word in words {
        run.state.registers[(list.trailing_zeros() & 15) as usize] = word;
        list &= list.wrapping_sub(1);
    }
    match FINISH {
        FALLS_THROUGH => run_next(run, ops),
        RETURNS => run.restore_status(),
        _ => {}
    }
}

/// STM.
pub(in crate::blocks) fn store_block<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let (at, moved) = block_address(run, op);
    let count = u32::from(op.amount);
    let Some(PlainWords { words, cycles }) = run.bus.plain_words_mut(at, count) else {
        return run.exit_before(op);
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
    run_next(run, ops);
}
