// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Multiplications. The multiplier array takes 8 bits of Rs per cycle and stops early.

use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::instruction::MultiplyKind;

/// Cycles of the array when leading ones end it early as leading zeros do.
#[inline]
pub(crate) const fn signed_cycles(multiplier: u32) -> u32 {
    let leading = if multiplier >> 31 == 0 {
        multiplier
    } else {
        !multiplier
    };
    unsigned_cycles(leading)
}

/// Cycles of the array when only leading zeros end it early.
#[inline]
pub(crate) const fn unsigned_cycles(multiplier: u32) -> u32 {
    match multiplier {
        0..=0xFF => 1,
        0x100..=0xFFFF => 2,
        0x1_0000..=0xFF_FFFF => 3,
        _ => 4,
    }
}

/// Internal cycles of a multiplication: the array's, one more for a long product, one more to
/// accumulate.
#[inline(always)]
pub(crate) const fn internal_cycles(kind: MultiplyKind, multiplier: u32) -> u32 {
    let array = if kind.signed {
        signed_cycles(multiplier)
    } else {
        unsigned_cycles(multiplier)
    };
    array + kind.long as u32 + kind.accumulate as u32
}

/// MUL and MLA: 1S + mI, one I more to accumulate. C and V keep their values.
pub(crate) fn multiply<B: Bus, const ACCUMULATE: bool>(
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
    bus.internal(internal_cycles(kind, multiplier));
    if opcode & (1 << 20) != 0 {
        cpu.set_nz(result);
    }
    cpu.write_result(bus, opcode >> 16, result)
}

/// UMULL, UMLAL, SMULL and SMLAL: 1S + (m+1)I, one I more to accumulate.
pub(crate) fn multiply_long<B: Bus, const SIGNED: bool, const ACCUMULATE: bool>(
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
    bus.internal(internal_cycles(kind, multiplier));
    if opcode & (1 << 20) != 0 {
        let any_low_bit = u32::from(result as u32 != 0);
        cpu.set_nz((result >> 32) as u32 | any_low_bit);
    }
    let _ = cpu.write_result(bus, low, result as u32);
    cpu.write_result(bus, high, (result >> 32) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn array_cycles_grow_with_each_significant_byte() {
        for (multiplier, cycles) in [(0, 1), (0xFF, 1), (0x100, 2), (0xFFFF, 2), (0x1_0000, 3)] {
            assert_eq!(unsigned_cycles(multiplier), cycles);
            assert_eq!(signed_cycles(multiplier), cycles);
            assert_eq!(signed_cycles(!multiplier), cycles);
        }
        assert_eq!(unsigned_cycles(0x0100_0000), 4);
        assert_eq!(signed_cycles(0x7FFF_FFFF), 4);
    }

    #[test]
    fn leading_ones_end_only_signed_multiplications_early() {
        assert_eq!(signed_cycles(0xFFFF_FF00), 1);
        assert_eq!(unsigned_cycles(0xFFFF_FF00), 4);
    }
}
