// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flags, and the instructions that move status registers: MRS, MSR, exception return.

use crate::bus::Bus;
use crate::condition::condition_passes;
use crate::cpu::{Cpu, Step};
use crate::pipeline::MASKS_DELAYED;
use crate::registers::psr;

impl Cpu {
    /// Does `condition` (0 to 15) hold for the current flags?
    #[inline(always)]
    pub(super) fn condition_passes(&self, condition: u32) -> bool {
        let flags = self.registers.status() >> 28;
        condition_passes(condition, flags)
    }

    #[inline(always)]
    pub(super) fn carry(&self) -> bool {
        self.registers.status() & psr::C != 0
    }

    #[inline(always)]
    pub(super) fn set_nz(&mut self, result: u32) {
        let kept = self.registers.status() & !(psr::N | psr::Z);
        self.registers.set_flags(kept | nz(result));
    }

    #[inline(always)]
    pub(super) fn set_nzc(&mut self, result: u32, carry: bool) {
        let kept = self.registers.status() & !(psr::N | psr::Z | psr::C);
        let carry = u32::from(carry) << 29;
        self.registers.set_flags(kept | nz(result) | carry);
    }

    #[inline(always)]
    pub(super) fn set_nzcv(&mut self, sum: crate::alu::Sum) {
        let kept = self.registers.status() & 0x0FFF_FFFF;
        let carry_overflow = (u32::from(sum.carry) << 29) | (u32::from(sum.overflow) << 28);
        self.registers
            .set_flags(kept | nz(sum.value) | carry_overflow);
    }

    /// Exception return: CPSR := SPSR. Modes without SPSR keep their CPSR.
    pub(super) fn restore_status(&mut self) {
        if let Some(saved) = self.registers.saved_status() {
            self.registers.set_status(saved);
        }
    }

    /// Writes the fields of CPSR or SPSR that `opcode` selects (DDI 0029E, section 4.6). A write
    /// to the T bit of CPSR, which programs must not do, leaves the pipeline as it is.
    fn write_status(&mut self, opcode: u32, value: u32) {
        let fields = (opcode >> 16) & 15;
        if opcode & (1 << 22) != 0 {
            self.registers.write_saved_status(fields, value);
            return;
        }
        let old = self.registers.status();
        let new = self.registers.status_written(fields, value);
        self.registers.set_status(new);
        if self.profile.mask_change_delayed && (old ^ new) & (psr::I | psr::F) != 0 {
            self.pipeline.attention |= MASKS_DELAYED;
            self.pipeline.delayed_masks = old & (psr::I | psr::F);
        }
    }
}

#[inline(always)]
const fn nz(result: u32) -> u32 {
    (result & psr::N) | (((result == 0) as u32) << 30)
}

/// MRS Rd, CPSR or SPSR. Without an SPSR the CPSR is read.
pub(super) fn mrs<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let current = cpu.registers.status();
    let value = if opcode & (1 << 22) == 0 {
        current
    } else {
        cpu.registers.saved_status().unwrap_or(current)
    };
    cpu.advance_arm();
    cpu.write_result(bus, opcode >> 12, value)
}

/// MSR from a register.
pub(super) fn msr_register<B: Bus>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let value = cpu.registers.get(opcode);
    cpu.advance_arm();
    cpu.write_status(opcode, value);
    Step::Instruction
}

/// MSR of a rotated constant.
pub(super) fn msr_constant<B: Bus>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let value = (opcode & 0xFF).rotate_right((opcode >> 7) & 0x1E);
    cpu.advance_arm();
    cpu.write_status(opcode, value);
    Step::Instruction
}
