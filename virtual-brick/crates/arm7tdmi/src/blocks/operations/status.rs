// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Status registers: MRS, MSR, returns from exceptions. An instruction that
//! changes masks, mode or bank ends its block, since afterwards an interrupt can be due.

use super::run::{first, run_next, size_of, End, Op, Ops, Run, NO_MASKS};
use crate::blocks::bus::BlockBus;
use crate::blocks::state::NO_ADDRESS;
use crate::registers::psr;

/// Bits of the mode of an operation on a status register.
pub(in crate::blocks) const OF_CONSTANT: u8 = 1 << 5;
/// The fields that MSR writes.
const FIELDS: u8 = 0xF;

/// MRS of CPSR.
pub(in crate::blocks) fn read_status<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let status = run.status();
    run.set(op.destination, status);
    run_next(run, ops);
}

/// MRS of SPSR.
pub(in crate::blocks) fn read_saved_status<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let status = run.file.saved_status().unwrap_or_else(|| run.status());
    run.set(op.destination, status);
    run_next(run, ops);
}

fn value_to_write<B: BlockBus>(run: &Run<'_, B>, op: &Op<B>) -> u32 {
    if op.mode & OF_CONSTANT != 0 {
        op.value
    } else {
        run.get(op.second)
    }
}

/// MSR to SPSR.
pub(in crate::blocks) fn write_saved_status<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let value = value_to_write(run, op);
    run.file
        .write_saved_status(u32::from(op.mode & FIELDS), value);
    run_next(run, ops);
}

/// MSR to CPSR; the reference engine changes the state bit, which programs must not do.
pub(in crate::blocks) fn write_status<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let value = value_to_write(run, op);
    let old = run.status();
    run.file.set_flags(old);
    let new = run.file.status_written(u32::from(op.mode & FIELDS), value);
    if (old ^ new) & psr::T != 0 {
        return run.exit_before(op);
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
    /// A branch to `target` that restores CPSR from SPSR; false when the reference engine must
    /// make it, and nothing has changed.
    pub(in crate::blocks) fn return_to(&mut self, op: &Op<B>, target: u32) -> bool {
        let Some(saved) = self.file.saved_status() else {
            return false;
        };
        let state = u32::from(saved & psr::T != 0);
        self.branch_to(op, target & !(size_of(state) - 1) | state)
    }

    /// The end of a return from an exception: registers and masks of the mode that continues.
    pub(in crate::blocks) fn restore_status(&mut self) {
        self.file.set_flags(self.status());
        if let Some(saved) = self.file.saved_status() {
            self.set_status(saved);
        }
        self.delayed = NO_MASKS;
        self.state.after_store = NO_ADDRESS;
        self.end = End::Status;
    }

    /// The register file has everything that the run has changed, but for r15.
    pub(in crate::blocks) fn store_status(&mut self) {
        let status = self.status();
        self.file.set_visible(&self.state.registers);
        self.file.set_flags(status);
    }

    fn set_status(&mut self, status: u32) {
        self.file.switch(status, &mut self.state.registers);
        self.load_flags();
    }
}
