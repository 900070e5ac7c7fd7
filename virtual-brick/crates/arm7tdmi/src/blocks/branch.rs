// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Branches, ends of blocks, and conditions of single operations.

use super::bus::BlockBus;
use super::run::{follow, holds, Handler, Op, Register, Rest, Run};

/// B, and the conditional branches when their condition holds: target with the state in the value.
pub(super) fn branch<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    run.branch(op, op.value, 0);
}

/// BL.
pub(super) fn branch_link<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    run.set(Register::R14, op.address.wrapping_add(4));
    run.branch(op, op.value, 0);
}

/// Both halves of the Thumb BL; the address is the second half's.
pub(super) fn long_branch<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    run.set(Register::R14, op.address.wrapping_add(2) | 1);
    run.branch(op, op.value, 0);
}

/// A branch to itself. With interrupts masked the reference engine looks at it.
pub(super) fn spin<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    if run.masked() {
        return run.leave_before(op);
    }
    run.spun = true;
    run.branch(op, op.value, 0);
}

/// BX to `second`.
pub(super) fn exchange<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    let value = run.get(op.second);
    let target = if value & 1 == 0 { value & !3 } else { value };
    if !run.branch_to(op, target) {
        run.leave_before(op);
    }
}

/// MOV to r15 from `second`.
pub(super) fn jump<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    let size = 4 >> (run.state.next & 1);
    let target = run.get(op.second) & !(size - 1) | run.state.next & 1;
    if !run.branch_to(op, target) {
        run.leave_before(op);
    }
}

/// Return from an exception to `first` less the value.
pub(super) fn return_to<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    let target = run.get(op.first).wrapping_sub(op.value);
    if run.return_to(op, target) {
        run.restore_status();
    } else {
        run.leave_before(op);
    }
}

/// The second half of a Thumb BL whose first half is not before it.
pub(super) fn long_branch_suffix<B: BlockBus>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    _rest: Rest<'_, B>,
) {
    let target = run.get(Register::R14).wrapping_add(op.value) | 1;
    if run.branch_to(op, target) {
        run.set(Register::R14, op.address.wrapping_add(2) | 1);
    } else {
        run.leave_before(op);
    }
}

/// An instruction for the reference engine.
pub(super) fn leave<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    run.leave_before(op);
}

/// The end of a block that goes on behind it.
pub(super) fn fall_through<B: BlockBus>(run: &mut Run<'_, B>, op: &Op<B>, _rest: Rest<'_, B>) {
    run.state.cycles += u32::from(op.before);
    run.state.next = op.value;
}

fn branch_if<B: BlockBus, const CONDITION: u8>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
    rest: Rest<'_, B>,
) {
    if holds::<B, CONDITION>(run) {
        run.branch(op, op.value, 0);
    } else {
        follow(run, rest);
    }
}

/// Passes over the next operation unless the condition holds.
fn only_if<B: BlockBus, const CONDITION: u8>(
    run: &mut Run<'_, B>,
    _op: &Op<B>,
    mut rest: Rest<'_, B>,
) {
    if !holds::<B, CONDITION>(run) {
        rest.next();
    }
    follow(run, rest);
}

macro_rules! by_condition {
    ($condition:expr, $handler:ident, [$($number:literal)*]) => {
        match $condition {
            $($number => $handler::<B, $number>,)*
            _ => $handler::<B, 15>,
        }
    };
}

/// The handler of a conditional branch.
pub(super) const fn branch_if_handler<B: BlockBus>(condition: u32) -> Handler<B> {
    by_condition!(condition, branch_if, [0 1 2 3 4 5 6 7 8 9 10 11 12 13])
}

/// The handler that stands before a conditional operation.
pub(super) const fn only_if_handler<B: BlockBus>(condition: u32) -> Handler<B> {
    by_condition!(condition, only_if, [0 1 2 3 4 5 6 7 8 9 10 11 12 13])
}
