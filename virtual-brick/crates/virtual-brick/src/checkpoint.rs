// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Checkpoints: states to go back to that do not copy the trace.

use std::fmt;

use crate::brick::VirtualBrick;

/// The state of a brick at an instant, with the length of its trace in place of the trace: its
/// size does not grow with the length of the run.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    brick: Box<VirtualBrick>,
    mark: trace::Mark,
}

impl Checkpoint {
    /// When it was taken.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.brick.cycles()
    }
}

/// A checkpoint that the run has not passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPassed {
    /// When the checkpoint was taken.
    pub checkpoint_cycles: u64,
    /// The present.
    pub now_cycles: u64,
}

impl fmt::Display for NotPassed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the checkpoint of cycle {} is not in the past of this run, which is at cycle {}; go \
             back only to checkpoints of the same run",
            self.checkpoint_cycles, self.now_cycles
        )
    }
}

impl std::error::Error for NotPassed {}

impl VirtualBrick {
    /// The state now, to go back to.
    #[must_use]
    pub fn checkpoint(&mut self) -> Checkpoint {
        let trace = std::mem::take(&mut self.recorder.trace);
        let brick = Box::new(self.clone());
        self.recorder.trace = trace;
        let mark = self.recorder.trace.mark();
        Checkpoint { brick, mark }
    }

    /// Go back to a checkpoint that this run has passed; what the trace holds of later is
    /// forgotten. The run goes on from there as it did then.
    ///
    /// # Errors
    /// The run has not passed the checkpoint; nothing is changed.
    pub fn go_back(&mut self, checkpoint: &Checkpoint) -> Result<(), NotPassed> {
        let passed = self.cycles() >= checkpoint.cycles();
        if !passed || !self.recorder.trace.truncate(&checkpoint.mark) {
            return Err(NotPassed {
                checkpoint_cycles: checkpoint.cycles(),
                now_cycles: self.cycles(),
            });
        }
        let trace = std::mem::take(&mut self.recorder.trace);
        self.clone_from(&checkpoint.brick);
        self.recorder.trace = trace;
        Ok(())
    }
}
