// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Steps: to the next instruction, source line or end of a job.

use trace::EventKind;
use virtual_brick::{Access, Line, StepObserver, VirtualBrick};

/// How far to step.
#[derive(Debug)]
pub enum Step {
    /// One instruction.
    Instruction,
    /// Until the processor reaches another source line.
    Line,
    /// Until the processor reaches another line of generated C.
    Controller,
    /// Until a job ends: of this thread, or of any.
    Job(Option<u32>),
}

/// Ends a run where the step ends.
pub struct Stepper {
    step: Step,
    start_line: Option<(String, u32)>,
    events_seen: usize,
}

impl Stepper {
    pub fn new(brick: &VirtualBrick, step: Step) -> Self {
        let start_line = match &step {
            Step::Line | Step::Controller => line(brick).map(|at| (at.file.to_owned(), at.line)),
            _ => None,
        };
        Self {
            step,
            start_line,
            events_seen: brick.trace().events().len(),
        }
    }

    /// The source line of the next instruction, when it is another than at the start.
    fn other_line<'a>(&self, brick: &'a VirtualBrick) -> Option<Line<'a>> {
        let start = self.start_line.as_ref().map(|(f, l)| (f.as_str(), *l));
        line(brick).filter(|at| start != Some((at.file, at.line)))
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

fn line(brick: &VirtualBrick) -> Option<Line<'_>> {
    let address = brick.processor().next_instruction_address();
    brick.image().lines().at(address)
}

/// Whether a source is C that a design generated.
fn is_generated(file: &str) -> bool {
    file.ends_with(".c") && file.split('/').rev().nth(1) == Some("generated")
}

impl StepObserver for Stepper {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        false
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, brick: &VirtualBrick, _step: virtual_brick::CpuStep) -> bool {
        match self.step {
            Step::Instruction => true,
            Step::Line => self.other_line(brick).is_some(),
            Step::Controller => self
                .other_line(brick)
                .is_some_and(|at| is_generated(at.file)),
            Step::Job(thread) => self.job_ended(brick, thread),
        }
    }
}
