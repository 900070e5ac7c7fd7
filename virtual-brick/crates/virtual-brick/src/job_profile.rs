// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The instructions that a thread executes in chosen windows of the run, with their cycles. The run
//! stays the same; outside of the windows nothing is looked at.

use arm7tdmi::Step;

use crate::brick::VirtualBrick;

/// Most instructions that are kept for a window.
const STEPS_MAX: usize = 4_000_000;

/// A thread and a time, such as a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileWindow {
    /// Position of the thread.
    pub thread: usize,
    /// From the first instruction that begins then or later.
    pub begin_cycles: u64,
    /// To the last that begins before.
    pub end_cycles: u64,
}

impl From<(usize, u64, u64)> for ProfileWindow {
    fn from((thread, begin_cycles, end_cycles): (usize, u64, u64)) -> Self {
        Self {
            thread,
            begin_cycles,
            end_cycles,
        }
    }
}

/// An executed instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileStep {
    /// Where.
    pub address: u32,
    /// Its time, with what transfers took.
    pub cycles: u32,
    /// Transfers of the data controller meanwhile, if these are logged.
    pub transfers: u32,
}

/// The windows and what happened in them so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct JobProfile {
    windows: Vec<(ProfileWindow, Vec<ProfileStep>)>,
}

impl JobProfile {
    /// The next begin or end of a window.
    pub(crate) fn next_change_cycles(&self, now: u64) -> u64 {
        let windows = self.windows.iter();
        let instants = windows.flat_map(|(window, _)| [window.begin_cycles, window.end_cycles]);
        let later = instants.filter(|instant| *instant > now);
        later.min().unwrap_or(u64::MAX)
    }

    /// Is the present within a window?
    pub(crate) fn is_active(&self, now: u64) -> bool {
        let mut windows = self.windows.iter();
        windows.any(|(window, _)| (window.begin_cycles..window.end_cycles).contains(&now))
    }
}

/// What is known before a step.
pub(crate) struct BeforeStep {
    at_cycles: u64,
    address: u32,
    thread: Option<usize>,
    transfers: usize,
}

impl VirtualBrick {
    /// Note the instructions of these threads and times from now on; see
    /// [`VirtualBrick::profiled`].
    pub fn profile(&mut self, windows: impl Iterator<Item = ProfileWindow>) {
        self.job_profile.windows = windows.map(|window| (window, Vec::new())).collect();
    }

    /// The instructions of each window so far, those of interrupts left out.
    #[must_use]
    pub fn profiled(&self) -> Vec<&[ProfileStep]> {
        let windows = self.job_profile.windows.iter();
        windows.map(|(_, steps)| steps.as_slice()).collect()
    }

    #[cold]
    pub(crate) fn before_profiled_step(&self) -> BeforeStep {
        BeforeStep {
            at_cycles: self.chip.now(),
            address: self.cpu.next_instruction_address(),
            thread: self.executing_thread(),
            transfers: self.chip.logged_transfers().len(),
        }
    }

    #[cold]
    pub(crate) fn after_profiled_step(&mut self, before: &BeforeStep, step: Step) {
        if step != Step::Instruction {
            return;
        }
        let transfers = self.chip.logged_transfers().len() - before.transfers;
        let now = self.chip.now();
        for (window, steps) in &mut self.job_profile.windows {
            let inside = (window.begin_cycles..window.end_cycles).contains(&before.at_cycles);
            if inside && before.thread == Some(window.thread) && steps.len() < STEPS_MAX {
                steps.push(ProfileStep {
                    address: before.address,
                    cycles: (now.min(window.end_cycles) - before.at_cycles) as u32,
                    transfers: transfers as u32,
                });
            }
        }
    }
}
