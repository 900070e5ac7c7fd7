// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Operations on registers only.

use super::encoding::*;
use super::run::{condition_holds, first, run_next, Handler, Op, Ops, Run};
use crate::alu::{shift_by_constant, shift_by_register, Shifted};
use crate::blocks::bus::BlockBus;
use crate::condition::condition_passes;
use crate::cost::{signed_cycles, unsigned_cycles};
use crate::instruction::AluOperation;

#[inline(always)]
fn operand<B: BlockBus, const KIND: u8>(run: &Run<'_, B>, op: &Op<B>) -> Shifted {
    let carry = run.state.carry != 0;
    let amount = u32::from(op.amount & 31);
    let kind = u32::from(op.mode);
    match KIND {
        CONSTANT => Shifted {
            value: op.value,
            carry,
        },
        CONSTANT_CARRY => Shifted {
            value: op.value,
            carry: op.mode != 0,
        },
        REGISTER => Shifted {
            value: run.get(op.second),
            carry,
        },
        LEFT => {
            let value = run.get(op.second);
            Shifted {
                value: value << amount,
                carry: value >> ((32 - amount) & 31) & 1 != 0,
            }
        }
        RIGHT => {
            let value = run.get(op.second);
            Shifted {
                value: value >> amount,
                carry: value >> (amount.wrapping_sub(1) & 31) & 1 != 0,
            }
        }
        RIGHT_ARITHMETIC => {
            let value = run.get(op.second);
            Shifted {
                value: ((value as i32) >> amount) as u32,
                carry: value >> (amount.wrapping_sub(1) & 31) & 1 != 0,
            }
        }
        ANY_SHIFT => shift_by_constant(kind, run.get(op.second), amount, carry),
        _ => {
            let amount = run.get(op.third) & 0xFF;
            shift_by_register(kind, run.get(op.second), amount, carry)
        }
    }
}

/// Result of the adder, or of logic with what it leaves of the flags.
struct Sum {
    value: u32,
    carry: bool,
    /// Bit 31 is V.
    overflow: u32,
}

#[inline(always)]
const fn of_value(value: u32) -> Sum {
    Sum {
        value,
        carry: false,
        overflow: 0,
    }
}

#[inline(always)]
const fn translate_at(a: u32, b: u32, carry: bool) -> Sum {
    let sum = a as u64 + b as u64 + carry as u64;
    let value = sum as u32;
    Sum {
        value,
        carry: sum >> 32 != 0,
        overflow: (a ^ value) & (b ^ value),
    }
}

/// a - b: no borrow is carry.
#[inline(always)]
const fn subtract(a: u32, b: u32) -> Sum {
    let value = a.wrapping_sub(b);
    Sum {
        value,
        carry: a >= b,
        overflow: (a ^ b) & (a ^ value),
    }
}

/// Data processing; `OPERATION` in the order of [`AluOperation`].
fn data<B: BlockBus, const OPERATION: u8, const KIND: u8, const FLAGS: bool>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    process::<B, OPERATION, KIND, FLAGS, false>(run, op);
    run_next(run, ops);
}

/// Data processing that sets flags, and the conditional branch behind it.
fn data_and_branch<B: BlockBus, const OPERATION: u8, const KIND: u8, const CONDITION: u8>(
    run: &mut Run<'_, B>,
    mut ops: Ops<'_, B>,
) {
    let Some(op) = ops.next() else {
        return;
    };
    process::<B, OPERATION, KIND, true, false>(run, op);
    first!(ops => branch);
    if condition_holds::<B, CONDITION>(run) {
        run.branch(branch, branch.value, 0);
    } else {
        run_next(run, ops);
    }
}

/// Data processing without flags whose result is kept only if the condition, in `cycles`, holds:
/// random conditions cost no branch misprediction of the host.
fn data_if<B: BlockBus, const OPERATION: u8, const KIND: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    process::<B, OPERATION, KIND, false, true>(run, op);
    run_next(run, ops);
}

#[inline(always)]
fn process<
    B: BlockBus,
    const OPERATION: u8,
    const KIND: u8,
    const FLAGS: bool,
    const CONDITIONAL: bool,
>(
    run: &mut Run<'_, B>,
    op: &Op<B>,
) {
    let Shifted { value: b, carry } = operand::<B, KIND>(run, op);
    if KIND == BY_REGISTER {
        run.state.cycles += 1;
    }
    let a = run.get(op.first);
    let carry_in = run.state.carry != 0;
    let (sum, logical) = match OPERATION {
        0x0 | 0x8 => (of_value(a & b), true),
        0x1 | 0x9 => (of_value(a ^ b), true),
        0x2 | 0xA => (subtract(a, b), false),
        0x3 => (subtract(b, a), false),
        0x4 | 0xB => (translate_at(a, b, false), false),
        0x5 => (translate_at(a, b, carry_in), false),
        0x6 => (translate_at(a, !b, carry_in), false),
        0x7 => (translate_at(b, !a, carry_in), false),
        0xC => (of_value(a | b), true),
        0xD => (of_value(b), true),
        0xE => (of_value(a & !b), true),
        _ => (of_value(!b), true),
    };
    if FLAGS {
        run.set_nz(sum.value);
        if !logical {
            run.state.carry = u32::from(sum.carry);
            run.state.overflow = sum.overflow;
        } else if KIND != CONSTANT && KIND != REGISTER {
            run.state.carry = u32::from(carry);
        }
    }
    if CONDITIONAL {
        let flags = run.state.negative >> 31 << 3
            | u32::from(run.state.zero == 0) << 2
            | run.state.carry << 1
            | run.state.overflow >> 31;
        let kept = u32::from(condition_passes(u32::from(op.cycles), flags)).wrapping_sub(1);
        let old = run.get(op.destination);
        run.set(op.destination, old & kept | sum.value & !kept);
    } else if !matches!(OPERATION, 0x8..=0xB) {
        run.set(op.destination, sum.value);
    }
}

fn with_flags<B: BlockBus, const OPERATION: u8, const KIND: u8>(flags: bool) -> Handler<B> {
    if flags {
        data::<B, OPERATION, KIND, true>
    } else {
        data::<B, OPERATION, KIND, false>
    }
}

fn with_kind<B: BlockBus, const OPERATION: u8>(kind: u8, flags: bool) -> Handler<B> {
    let of_kind: [fn(bool) -> Handler<B>; 8] =
        instances!(with_flags::<B, OPERATION, [0 1 2 3 4 5 6 7]>);
    of_kind[usize::from(kind & 7)](flags)
}

/// The handler of a data processing operation.
pub(in crate::blocks) fn data_handler<B: BlockBus>(
    operation: AluOperation,
    kind: u8,
    flags: bool,
) -> Handler<B> {
    let of_operation: [fn(u8, bool) -> Handler<B>; 16] =
        instances!(with_kind::<B, [0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15]>);
    of_operation[operation as usize](kind, flags)
}

fn conditional_with_kind<B: BlockBus, const OPERATION: u8>(kind: u8) -> Option<Handler<B>> {
    let handler: Handler<B> = match kind {
        CONSTANT => data_if::<B, OPERATION, CONSTANT>,
        REGISTER => data_if::<B, OPERATION, REGISTER>,
        LEFT => data_if::<B, OPERATION, LEFT>,
        RIGHT => data_if::<B, OPERATION, RIGHT>,
        RIGHT_ARITHMETIC => data_if::<B, OPERATION, RIGHT_ARITHMETIC>,
        _ => return None,
    };
    Some(handler)
}

/// The handler of the usual conditional operations that set no flags.
pub(in crate::blocks) fn data_if_handler<B: BlockBus>(
    operation: AluOperation,
    kind: u8,
) -> Option<Handler<B>> {
    let reads_carry = matches!(
        operation,
        AluOperation::Adc | AluOperation::Sbc | AluOperation::Rsc
    );
    let of_operation: [fn(u8) -> _; 16] =
        instances!(conditional_with_kind::<B, [0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15]>);
    let handler = of_operation[operation as usize];
    (!reads_carry && !operation.compares())
        .then(|| handler(kind))
        .flatten()
}

fn with_condition<B: BlockBus, const OPERATION: u8, const KIND: u8>(
    condition: u32,
) -> Option<Handler<B>> {
    let of_condition: [Handler<B>; 14] = instances!(
        data_and_branch::<B, OPERATION, KIND, [0 1 2 3 4 5 6 7 8 9 10 11 12 13]>
    );
    of_condition.get(condition as usize).copied()
}

/// The handler of a usual comparison together with the conditional branch behind it.
pub(in crate::blocks) fn data_and_branch_handler<B: BlockBus>(
    operation: AluOperation,
    kind: u8,
    condition: u32,
) -> Option<Handler<B>> {
    match (operation, kind) {
        (AluOperation::Sub, CONSTANT) => with_condition::<B, 0x2, CONSTANT>(condition),
        (AluOperation::Sub, REGISTER) => with_condition::<B, 0x2, REGISTER>(condition),
        (AluOperation::Add, CONSTANT) => with_condition::<B, 0x4, CONSTANT>(condition),
        (AluOperation::Tst, CONSTANT) => with_condition::<B, 0x8, CONSTANT>(condition),
        (AluOperation::Cmp, CONSTANT) => with_condition::<B, 0xA, CONSTANT>(condition),
        (AluOperation::Cmp, REGISTER) => with_condition::<B, 0xA, REGISTER>(condition),
        _ => None,
    }
}

/// MUL and MLA: multiplicand in `first`, multiplier in `second`, addend in `third`.
pub(in crate::blocks) fn multiply<B: BlockBus, const ACCUMULATE: bool, const FLAGS: bool>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    let multiplier = run.get(op.second);
    let mut result = run.get(op.first).wrapping_mul(multiplier);
    if ACCUMULATE {
        result = result.wrapping_add(run.get(op.third));
    }
    run.state.cycles += signed_cycles(multiplier) + u32::from(ACCUMULATE);
    if FLAGS {
        run.set_nz(result);
    }
    run.set(op.destination, result);
    run_next(run, ops);
}

/// The long multiplications: lower half of the result in `third`; mode 1 sets flags.
pub(in crate::blocks) fn multiply_long<B: BlockBus, const SIGNED: bool, const ACCUMULATE: bool>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
) {
    first!(ops => op);
    let (multiplicand, multiplier) = (run.get(op.first), run.get(op.second));
    let (mut result, array) = if SIGNED {
        let product = i64::from(multiplicand as i32) * i64::from(multiplier as i32);
        (product as u64, signed_cycles(multiplier))
    } else {
        let product = u64::from(multiplicand) * u64::from(multiplier);
        (product, unsigned_cycles(multiplier))
    };
    if ACCUMULATE {
        let high = u64::from(run.get(op.destination)) << 32;
        result = result.wrapping_add(high | u64::from(run.get(op.third)));
    }
    run.state.cycles += array + 1 + u32::from(ACCUMULATE);
    if op.mode != 0 {
        run.set_nz((result >> 32) as u32 | u32::from(result as u32 != 0));
    }
    run.set(op.third, result as u32);
    run.set(op.destination, (result >> 32) as u32);
    run_next(run, ops);
}

/// An instruction of which only the fetch is left.
pub(in crate::blocks) fn no_operation<B: BlockBus>(run: &mut Run<'_, B>, ops: Ops<'_, B>) {
    run_next(run, ops);
}
