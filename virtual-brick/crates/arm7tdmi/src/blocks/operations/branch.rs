// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Branches, ends of blocks, and conditions of single operations.

use super::run::{condition_holds, first, run_next, size_of, Handler, Ops, Register, Run};
use crate::blocks::bus::BlockBus;

/// B, and the conditional branches when their condition holds: target with the state in the value.
pub(in crate::blocks) fn branch<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    run.branch(op, op.value, 0);
}

/// BL.
pub(in crate::blocks) fn branch_link<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    run.set(Register::R14, op.address.wrapping_add(4));
    run.branch(op, op.value, 0);
}

/// Both halves of the Thumb BL; the address is the second half's.
pub(in crate::blocks) fn long_branch<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    run.set(Register::R14, op.address.wrapping_add(2) | 1);
    run.branch(op, op.value, 0);
}

/// A branch to itself. With interrupts masked the reference engine executes it, since it is the end
/// of the program.
pub(in crate::blocks) fn branch_to_itself<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    if run.masked() {
        return run.exit_before(op);
    }
    run.branched_to_itself = true;
    run.branch(op, op.value, 0);
}

/// BX to `second`.
pub(in crate::blocks) fn exchange<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let value = run.get(op.second);
    let target = if value & 1 == 0 { value & !3 } else { value };
    if !run.branch_to(op, target) {
        run.exit_before(op);
    }
}

/// MOV to r15 from `first`.
pub(in crate::blocks) fn jump<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let size = size_of(run.state.next);
    let target = run.get(op.first) & !(size - 1) | run.state.next & 1;
    if !run.branch_to(op, target) {
        run.exit_before(op);
    }
}

/// Return from an exception to `first` less the value.
pub(in crate::blocks) fn return_to<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let target = run.get(op.first).wrapping_sub(op.value);
    if run.return_to(op, target) {
        run.restore_status();
    } else {
        run.exit_before(op);
    }
}

/// The second half of a Thumb BL whose first half is not before it.
pub(in crate::blocks) fn long_branch_suffix<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    let target = run.get(Register::R14).wrapping_add(op.value) | 1;
    if run.branch_to(op, target) {
        run.set(Register::R14, op.address.wrapping_add(2) | 1);
    } else {
        run.exit_before(op);
    }
}

/// An instruction that the reference engine must execute.
pub(in crate::blocks) fn exit_to_reference<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    run.exit_before(op);
}

/// The end of a block without a branch.
pub(in crate::blocks) fn fall_through<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    first!(ops => op);
    run.state.cycles += u32::from(op.before);
    run.state.next = op.value;
}

fn conditional_branch_operation<B: BlockBus, const CONDITION: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    if condition_holds::<B, CONDITION>(run) {
        run.branch(op, op.value, 0);
    } else {
        run_next(run, ops);
    }
}

/// Skips the next operation unless the condition holds.
fn skip_unless<B: BlockBus, const CONDITION: u8>(run: &mut Run<'_, B>, mut ops: Ops<'_, B>) {
    if condition_holds::<B, CONDITION>(run) || ops.next().is_some() {
        run_next(run, ops);
    }
}

/// The handler of a conditional branch.
pub(in crate::blocks) fn conditional_branch_handler<B: BlockBus>(condition: u32) -> Handler<B> {
    let of_condition: [Handler<B>; 16] = instances!(
        conditional_branch_operation::<B, [0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15]>
    );
    of_condition[condition as usize & 15]
}

/// The handler that stands before a conditional operation.
pub(in crate::blocks) fn skip_unless_handler<B: BlockBus>(condition: u32) -> Handler<B> {
    let of_condition: [Handler<B>; 16] =
        instances!(skip_unless::<B, [0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15]>);
    of_condition[condition as usize & 15]
}
