// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Ends of a run that the processor does not report: exceptions without a handler, and loops that
//! nothing can leave.

use arm7tdmi::{psr, BlockBus, Cpu, Exception, Mode, Step};

use crate::assembly::Machine;
use crate::stop::StopReason;
use image::Image;

/// The eight exception vectors lie below this address.
const VECTORS_END: u32 = 0x20;
/// Contents of memory that was never written: RAM and erased flash.
const UNSET: [u32; 2] = [0, u32::MAX];

/// Why and how a run cannot go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DeadEnd {
    pub reason: StopReason,
    pub message: String,
}

/// How the processor came to a vector.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    step: Step,
    from: u32,
    /// r0 to r14 and the status on arrival.
    state: [u32; 16],
}

/// Looks for dead ends after each step that may lead to one.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeadEndDetector {
    arrival: Option<Arrival>,
    /// State of the core when it last came back to the instruction it left.
    repeated: Option<Cpu>,
    /// Last exception that a correct program does not raise, and the instruction that raised it.
    abnormal: Option<(Exception, u32)>,
}

impl DeadEndDetector {
    /// The step from the instruction at `before` to that at `after` may have led to a dead end.
    #[inline]
    pub(crate) fn needs_check(&self, before: u32, after: u32) -> bool {
        (after == before) | (after < VECTORS_END) | self.arrival.is_some()
    }

    /// Instructions were executed without a check: none of them was at an unset vector.
    pub(crate) fn instructions_skipped(&mut self) {
        self.arrival = None;
    }

    /// The core came back to the same instruction with interrupts enabled.
    pub(crate) fn interruptible_loop(&mut self) {
        self.repeated = None;
    }

    /// Check such a step; a dead end when the run cannot go on.
    pub(crate) fn check(
        &mut self,
        before: u32,
        step: Step,
        cpu: &Cpu,
        chip: &Machine,
        image: &Image,
    ) -> Option<DeadEnd> {
        let after = cpu.next_instruction_address();
        if after < VECTORS_END || self.arrival.is_some() {
            let dead_end = self.at_vector(before, step, cpu, chip, image);
            if dead_end.is_some() {
                return dead_end;
            }
        }
        if after == before {
            return self.endless_loop(cpu, image);
        }
        None
    }

    /// Near the vectors: remember an arrival, and find out that the vector arrived at is unset.
    fn at_vector(
        &mut self,
        before: u32,
        step: Step,
        cpu: &Cpu,
        chip: &Machine,
        image: &Image,
    ) -> Option<DeadEnd> {
        let arrival = self.arrival.take();
        let after = cpu.next_instruction_address();
        if let Step::Exception(exception) = step {
            self.note_abnormal(exception, cpu);
            self.arrival = Some(Arrival {
                step,
                from: before,
                state: state(cpu),
            });
        } else if before >= VECTORS_END && after < VECTORS_END {
            self.arrival = Some(Arrival {
                step,
                from: before,
                state: state(cpu),
            });
        }
        let arrival = arrival?;
        let passed_by = step == Step::Instruction
            && before < VECTORS_END
            && after == before + 4
            && state(cpu) == arrival.state;
        if !passed_by {
            return None;
        }
        let word = chip.code_word(before);
        if !UNSET.contains(&word) {
            return None;
        }
        let cause = self.cause(arrival, image);
        let message =
            format!("{cause}, and the vector {before:#010X} holds no instruction but {word:#010X}");
        Some(DeadEnd {
            reason: StopReason::Fault,
            message,
        })
    }

    fn note_abnormal(&mut self, exception: Exception, cpu: &Cpu) {
        let thumb = cpu.spsr().is_some_and(|status| status & psr::T != 0);
        let back = match exception {
            Exception::UndefinedInstruction if thumb => 2,
            Exception::UndefinedInstruction | Exception::PrefetchAbort => 4,
            Exception::DataAbort => 8,
            _ => return,
        };
        self.abnormal = Some((exception, cpu.register(14).wrapping_sub(back)));
    }

    fn cause(&self, arrival: Arrival, image: &Image) -> String {
        match (arrival.step, self.abnormal) {
            (Step::Exception(exception), Some((abnormal, at))) if exception == abnormal => {
                format!("{} at {}", name(exception), place(image, at))
            }
            (Step::Exception(exception), _) => {
                format!("{} before {}", name(exception), place(image, arrival.from))
            }
            (Step::Instruction, _) => format!("jump from {}", place(image, arrival.from)),
        }
    }

    /// The core came back to the same instruction. With interrupts masked and the same state of
    /// the core as the last time, this goes on for ever.
    fn endless_loop(&mut self, cpu: &Cpu, image: &Image) -> Option<DeadEnd> {
        let status = cpu.cpsr();
        let abnormal_mode = matches!(cpu.mode(), Some(Mode::Undefined | Mode::Abort));
        let masked = status & psr::I != 0 && (status & psr::F != 0 || abnormal_mode);
        if !masked || self.repeated.as_ref() != Some(cpu) {
            self.repeated = masked.then(|| cpu.clone());
            return None;
        }
        let here = place(image, cpu.next_instruction_address());
        let (reason, message) = match self.abnormal {
            Some((exception, at)) if abnormal_mode => (
                StopReason::Fault,
                format!(
                    "{} at {}; its handler loops at {here}",
                    name(exception),
                    place(image, at)
                ),
            ),
            _ => {
                let message = format!("the processor loops at {here} with interrupts masked");
                (StopReason::Halted, message)
            }
        };
        Some(DeadEnd { reason, message })
    }
}

fn state(cpu: &Cpu) -> [u32; 16] {
    let mut state = cpu.registers();
    state[15] = cpu.cpsr();
    state
}

fn name(exception: Exception) -> &'static str {
    match exception {
        Exception::Reset => "reset",
        Exception::UndefinedInstruction => "undefined instruction",
        Exception::SoftwareInterrupt => "software interrupt",
        Exception::PrefetchAbort => "fetch from an address without memory (prefetch abort)",
        Exception::DataAbort => "access to an address without memory (data abort)",
        Exception::Irq => "interrupt",
        Exception::Fiq => "fast interrupt",
    }
}

/// An address of code with the nearest symbol.
pub(crate) fn place(image: &Image, address: u32) -> String {
    match image.symbols().nearest_code(address) {
        Some((symbol, 0)) => format!("{address:#010X} ({symbol})"),
        Some((symbol, offset)) => format!("{address:#010X} ({symbol} + {offset:#X})"),
        None => format!("{address:#010X}"),
    }
}
