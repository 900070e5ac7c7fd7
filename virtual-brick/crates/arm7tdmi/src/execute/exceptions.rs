// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Entry into exceptions: return addresses, modes and cycles (DDI 0029E, section 3.9).

use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::exception::Exception;
use crate::pipeline::Pipeline;
use crate::registers::psr;

impl Cpu {
    /// Drives nRESET: supervisor mode, ARM state, interrupts disabled, next instruction at 0.
    /// r14_svc and SPSR_svc receive the interrupted state; the other registers keep their values.
    pub fn reset(&mut self) {
        let interrupted = self.next_instruction_address();
        self.save_and_switch(Exception::Reset, interrupted);
        self.pipeline = Pipeline::empty();
        self.set_pc(Exception::Reset.vector());
    }

    /// Entry ahead of the next instruction: one fetch is lost, then two from the vector.
    pub(super) fn enter_from_boundary<B: Bus>(
        &mut self,
        bus: &mut B,
        exception: Exception,
    ) -> Exception {
        self.fetch_and_discard(bus);
        let return_address = self.next_instruction_address().wrapping_add(4);
        self.enter(bus, exception, return_address);
        exception
    }

    /// Entry at the end of a load or store that was aborted; r15 has already advanced. The
    /// return address is the instruction's + 8.
    #[cold]
    pub(crate) fn enter_data_abort<B: Bus>(&mut self, bus: &mut B) -> Step {
        self.fetch_and_discard(bus);
        let size = if self.thumb() { 2 } else { 4 };
        let aborted = self.next_instruction_address().wrapping_sub(size);
        self.enter(bus, Exception::DataAbort, aborted.wrapping_add(8));
        Step::Exception(Exception::DataAbort)
    }

    /// Last two cycles of SWI: the return address is the following instruction's.
    pub(super) fn enter_software_interrupt<B: Bus>(&mut self, bus: &mut B) -> Step {
        let exception = Exception::SoftwareInterrupt;
        self.enter(bus, exception, self.following_instruction());
        Step::Exception(exception)
    }

    /// Rest of an undefined instruction: internal cycles, then the vector.
    pub(super) fn enter_undefined<B: Bus>(&mut self, bus: &mut B) -> Step {
        let exception = Exception::UndefinedInstruction;
        bus.internal(self.profile.undefined_internal_cycles);
        self.enter(bus, exception, self.following_instruction());
        Step::Exception(exception)
    }

    /// Address after the instruction in execution, before r15 has advanced.
    fn following_instruction(&self) -> u32 {
        let size = if self.thumb() { 2 } else { 4 };
        self.next_instruction_address().wrapping_add(size)
    }

    fn enter<B: Bus>(&mut self, bus: &mut B, exception: Exception, return_address: u32) {
        self.save_and_switch(exception, return_address);
        self.branch_arm(bus, exception.vector());
    }

    fn save_and_switch(&mut self, exception: Exception, return_address: u32) {
        let interrupted = self.registers.status();
        let kept = interrupted & !(psr::MODE | psr::T);
        let status = kept | exception.mode().bits() | exception.masks();
        self.registers.set_status(status);
        self.registers.set_saved_status(interrupted);
        self.registers.set(14, return_address);
    }
}
