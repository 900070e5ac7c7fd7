// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Multiplications. The multiplier array takes 8 bits of Rs per cycle and stops early.

use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::instruction::MultiplyKind;

/// MUL and MLA: 1S + mI, one I more to accumulate. C and V keep their values.
pub(super) fn multiply<B: Bus, const ACCUMULATE: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    cpu.advance_arm();
    let multiplier = cpu.registers.get(opcode >> 8);
    let mut result = cpu.registers.get(opcode).wrapping_mul(multiplier);
    if ACCUMULATE {
        result = result.wrapping_add(cpu.registers.get(opcode >> 12));
    }
    let kind = MultiplyKind {
        long: false,
        signed: true,
        accumulate: ACCUMULATE,
    };
    bus.internal(kind.internal_cycles(multiplier));
    if opcode & (1 << 20) != 0 {
        cpu.set_nz(result);
    }
    cpu.write_result(bus, opcode >> 16, result)
}

/// UMULL, UMLAL, SMULL and SMLAL: 1S + (m+1)I, one I more to accumulate.
pub(super) fn multiply_long<B: Bus, const SIGNED: bool, const ACCUMULATE: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    cpu.advance_arm();
    let (low, high) = (opcode >> 12, opcode >> 16);
    let (multiplicand, multiplier) = (cpu.registers.get(opcode), cpu.registers.get(opcode >> 8));
    let mut result = if SIGNED {
        (i64::from(multiplicand as i32) * i64::from(multiplier as i32)) as u64
    } else {
        u64::from(multiplicand) * u64::from(multiplier)
    };
    if ACCUMULATE {
        let high_half = u64::from(cpu.registers.get(high)) << 32;
        result = result.wrapping_add(high_half | u64::from(cpu.registers.get(low)));
    }
    let kind = MultiplyKind {
        long: true,
        signed: SIGNED,
        accumulate: ACCUMULATE,
    };
    bus.internal(kind.internal_cycles(multiplier));
    if opcode & (1 << 20) != 0 {
        let any_low_bit = u32::from(result as u32 != 0);
        cpu.set_nz((result >> 32) as u32 | any_low_bit);
    }
    let _ = cpu.write_result(bus, low, result as u32);
    cpu.write_result(bus, high, (result >> 32) as u32)
}
