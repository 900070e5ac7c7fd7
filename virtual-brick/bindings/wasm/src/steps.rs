// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Steps: to the next instruction, source line or end of a job.

use trace::EventKind;
use virtual_brick::{Access, Lines, StepObserver, VirtualBrick};

/// How far to step.
#[derive(Debug)]
pub enum Step<'a> {
    /// One instruction.
    Instruction,
    /// Until the processor reaches another source line.
    Line(&'a Lines),
    /// Until a job ends: of this thread, or of any.
    Job(Option<u32>),
}

/// Ends a run where the step ends.
pub struct Stepper<'a> {
    step: Step<'a>,
    start_line: Option<(String, u32)>,
    events_seen: usize,
}

impl<'a> Stepper<'a> {
    pub fn new(brick: &VirtualBrick, step: Step<'a>) -> Self {
        let start_line = match &step {
            Step::Line(lines) => line(brick, lines),
            _ => None,
        };
        Self {
            step,
            start_line,
            events_seen: brick.trace().events().len(),
        }
    }

    fn job_ended(&mut self, brick: &VirtualBrick, thread: Option<u32>) -> bool {
        let events = brick.trace().events();
        let first = std::mem::replace(&mut self.events_seen, events.len());
        let mut ends = events.iter_from(first);
        ends.any(|event| {
            event.kind == EventKind::Completion && thread.is_none_or(|t| t == event.subject)
        })
    }
}

fn line(brick: &VirtualBrick, lines: &Lines) -> Option<(String, u32)> {
    let (file, line) = lines.at(brick.processor().next_instruction_address())?;
    Some((file.to_owned(), line))
}

impl StepObserver for Stepper<'_> {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        false
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, brick: &VirtualBrick, _step: virtual_brick::CpuStep) -> bool {
        match self.step {
            Step::Instruction => true,
            Step::Line(lines) => {
                let address = brick.processor().next_instruction_address();
                lines.at(address).is_some_and(|(file, line)| {
                    self.start_line.as_ref().map(|(f, l)| (f.as_str(), *l)) != Some((file, line))
                })
            }
            Step::Job(thread) => self.job_ended(brick, thread),
        }
    }
}
