// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A bounded store of checkpoints: dense where the run is, ever sparser into its past.

use virtual_brick::Checkpoint;

/// Checkpoints kept; one takes about 350 KB.
pub(crate) const CHECKPOINTS_MAX: usize = 160;

/// A checkpoint and how many interventions the run had seen.
#[derive(Clone, Debug)]
pub(crate) struct SavedCheckpoint {
    pub checkpoint: Checkpoint,
    pub interventions: usize,
}

impl SavedCheckpoint {
    pub(crate) fn cycles(&self) -> u64 {
        self.checkpoint.cycles()
    }
}

/// Checkpoints in the order of time; the first one is never given up.
#[derive(Clone, Debug)]
pub(crate) struct Checkpoints {
    kept: Vec<SavedCheckpoint>,
}

impl Checkpoints {
    pub(crate) fn new(first: SavedCheckpoint) -> Self {
        Self { kept: vec![first] }
    }

    /// The last checkpoint at or before an instant, the first one when there is none.
    pub(crate) fn at_or_before(&self, cycles: u64) -> &SavedCheckpoint {
        let after = self.kept.partition_point(|kept| kept.cycles() <= cycles);
        &self.kept[after.saturating_sub(1)]
    }

    pub(crate) fn first(&self) -> &SavedCheckpoint {
        &self.kept[0]
    }

    pub(crate) fn len(&self) -> usize {
        self.kept.len()
    }

    /// Keep a checkpoint; when there are too many, the one goes whose loss leaves the smallest
    /// gap in relation to its age, seen from `present_cycles`.
    pub(crate) fn add(&mut self, kept: SavedCheckpoint, present_cycles: u64) {
        let cycles = kept.cycles();
        let position = self.kept.partition_point(|other| other.cycles() < cycles);
        if self
            .kept
            .get(position)
            .is_some_and(|o| o.cycles() == cycles)
        {
            return;
        }
        self.kept.insert(position, kept);
        if self.kept.len() > CHECKPOINTS_MAX {
            self.drop_least_useful(present_cycles);
        }
    }

    fn drop_least_useful(&mut self, present_cycles: u64) {
        let loss = |at: usize| {
            let gap = self.kept[at + 1].cycles() - self.kept[at - 1].cycles();
            let age = present_cycles.abs_diff(self.kept[at].cycles()) + 1;
            gap as f64 / age as f64
        };
        let least = (1..self.kept.len() - 1).min_by(|a, b| loss(*a).total_cmp(&loss(*b)));
        if let Some(position) = least {
            self.kept.remove(position);
        }
    }

    /// Forget everything after an instant: another future begins there.
    pub(crate) fn forget_after(&mut self, cycles: u64) {
        let end = self.kept.partition_point(|kept| kept.cycles() <= cycles);
        self.kept.truncate(end.max(1));
    }
}
