// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What reaches beyond registers and memory: accesses through the bus, status registers, returns
//! from exceptions. Each ends its block, since afterwards anything can be due.

use super::bus::{BlockBus, BusAccess};
use super::native::NOWHERE;
use super::run::{follow, size_of, End, Op, Rest, Run, NO_MASKS};
use super::transfer::{extended, width, WRITE_BACK};
use crate::bus::{Cycle, Width};
use crate::registers::psr;

/// Bits of the mode of an operation on a status register.
pub(super) const OF_CONSTANT: u8 = 1 << 5;
/// The fields that MSR writes.
const FIELDS: u8 = 0xF;

/// A load that only the bus can make.
#[cold]
#[inline(never)]
pub(super) fn load<B: BlockBus>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    item: u8,
    (at, moved): (u32, u32),
) {
    if !run.begin_access(op, at, width(item), false) {
        return;
    }
    let loaded = run.bus.read(at, width(item), Cycle::Nonsequential);
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run.bus.internal(1);
    match loaded {
        Ok(value) => run.set(op.destination, extended(item, value)),
        Err(_) => run.end = End::Aborted,
    }
}

/// A store that only the bus can make.
#[cold]
#[inline(never)]
pub(super) fn store<B: BlockBus>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    item: u8,
    (at, moved): (u32, u32),
) {
    let value = run.get(op.destination);
    if !run.begin_access(op, at, width(item), true) {
        return;
    }
    let stored = run.bus.write(at, width(item), value, Cycle::Nonsequential);
    run.state.after_store = op.address;
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    if stored.is_err() {
        run.end = End::Aborted;
    }
}

/// MRS of CPSR.
pub(super) fn read_status<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, rest: Rest<'_, B>) {
    let status = run.status();
    run.set(op.destination, status);
    follow(run, rest);
}

/// MRS of SPSR.
pub(super) fn read_saved_status<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, rest: Rest<'_, B>) {
    let status = run.file.saved_status().unwrap_or_else(|| run.status());
    run.set(op.destination, status);
    follow(run, rest);
}

fn value_to_write<B: BlockBus>(run: &Run<'_, B>, op: &Op<B>) -> u32 {
    if op.mode & OF_CONSTANT != 0 {
        op.value
    } else {
        run.get(op.second)
    }
}

/// MSR to SPSR.
pub(super) fn write_saved_status<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, rest: Rest<'_, B>) {
    let value = value_to_write(run, op);
    run.file
        .write_saved_status(u32::from(op.mode & FIELDS), value);
    follow(run, rest);
}

/// MSR to CPSR; the reference engine changes the state bit, which programs must not do.
pub(super) fn write_status<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    let value = value_to_write(run, op);
    let old = run.status();
    run.file.set_flags(old);
    let new = run.file.status_written(u32::from(op.mode & FIELDS), value);
    if (old ^ new) & psr::T != 0 {
        return run.leave_before(op);
    }
    run.set_status(new);
    let changed = (old ^ new) & (psr::I | psr::F) != 0;
    run.delayed = if changed && run.delays_masks {
        old & (psr::I | psr::F)
    } else {
        NO_MASKS
    };
    run.state.cycles += u32::from(op.through);
    run.state.next = op.address.wrapping_add(4);
    run.end = End::Status;
}

impl<B: BlockBus> Run<'_, B> {
    /// Time and pipeline as they are when the access of this instruction begins; false when the
    /// reference engine must make it, and the block has ended before it.
    #[inline(always)]
    fn begin_access(&mut self, op: &Op<B>, address: u32, width: Width, write: bool) -> bool {
        let passed = self.state.cycles + u32::from(op.through);
        let access = self.bus.access_between(address, width, write, passed);
        if access == BusAccess::Refused {
            self.leave_before(op);
            return false;
        }
        let (state, size) = (self.state.next & 1, size_of(self.state.next));
        self.state.next = op.address.wrapping_add(size) | state;
        if access == BusAccess::Unsettling {
            self.fetched = Some(super::opcodes(self.bus, self.state.next));
        }
        self.bus.continue_at(op.address.wrapping_add(3 * size));
        self.bus.pass(passed);
        self.state.cycles = 0;
        self.ran = true;
        self.end = End::Accessed;
        true
    }

    /// A branch to `target` that restores CPSR from SPSR; false when the reference engine must
    /// make it, and nothing has changed.
    pub(super) fn return_to(&mut self, op: &Op<B>, target: u32) -> bool {
        let Some(saved) = self.file.saved_status() else {
            return false;
        };
        let state = u32::from(saved & psr::T != 0);
        self.branch_to(op, target & !(size_of(state) - 1) | state)
    }

    /// Behind a return: the registers and masks of the mode that goes on.
    pub(super) fn restore_status(&mut self) {
        self.file.set_flags(self.status());
        if let Some(saved) = self.file.saved_status() {
            self.set_status(saved);
        }
        self.delayed = NO_MASKS;
        self.state.after_store = NOWHERE;
        self.end = End::Status;
    }

    /// The register file has everything that the run has changed, but for r15.
    pub(super) fn store_status(&mut self) {
        let status = self.status();
        self.file.set_visible(&self.state.registers);
        self.file.set_flags(status);
    }

    fn set_status(&mut self, status: u32) {
        self.file.switch(status, &mut self.state.registers);
        self.load_flags();
    }
}
