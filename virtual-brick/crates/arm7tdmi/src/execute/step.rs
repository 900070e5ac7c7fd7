// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One step: an instruction, or the entry into an exception at its boundary.

use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::exception::Exception;
use crate::pipeline::{DECODE_ABORTED, EXECUTE_ABORTED, MASKS_DELAYED, REFILL};
use crate::registers::psr;

impl Cpu {
    /// Executes one instruction or enters one exception, with all its bus cycles.
    #[inline(always)]
    pub fn step<B: Bus>(&mut self, bus: &mut B) -> Step {
        if self.pipeline.attention != 0 || bus.irq() || bus.fiq() {
            if let Some(exception) = self.boundary(bus) {
                return Step::Exception(exception);
            }
        }
        if self.registers.status() & psr::T == 0 {
            self.execute_arm(bus)
        } else {
            self.execute_thumb(bus)
        }
    }

    /// The unusual cases at an instruction boundary, in the order of their priority.
    #[cold]
    #[inline(never)]
    fn boundary<B: Bus>(&mut self, bus: &mut B) -> Option<Exception> {
        let masks = if self.pipeline.attention & MASKS_DELAYED == 0 {
            self.registers.status()
        } else {
            self.pipeline.attention &= !MASKS_DELAYED;
            std::mem::take(&mut self.pipeline.delayed_masks)
        };
        if self.pipeline.attention & REFILL != 0 {
            self.refill(bus);
        }
        if masks & psr::F == 0 && bus.fiq() {
            return Some(self.enter_from_boundary(bus, Exception::Fiq));
        }
        if masks & psr::I == 0 && bus.irq() {
            return Some(self.enter_from_boundary(bus, Exception::Irq));
        }
        if self.pipeline.attention & EXECUTE_ABORTED != 0 {
            return Some(self.enter_from_boundary(bus, Exception::PrefetchAbort));
        }
        if self.pipeline.attention & DECODE_ABORTED != 0 {
            self.pipeline.attention = EXECUTE_ABORTED;
        }
        None
    }
}
