// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The engines that execute instructions. They differ in speed only.

use arm7tdmi::{BlockBus, Blocks};
use serde::Deserialize;

/// Which engine executes instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// Interpreted blocks, and JIT code for hot ones where the build and the host support it.
    #[default]
    Fast,
    /// Interpreted blocks where no event can occur in them, else the reference engine.
    Blocks,
    /// One instruction after the other, each access through the bus.
    Reference,
}

/// Compile threshold: runs of a block before its compilation is requested, which the budget of the
/// run may postpone.
pub(crate) const JIT_THRESHOLD_RUNS: u32 = 200;

impl Engine {
    /// An empty cache of decoded blocks, as this engine uses it.
    /// JIT code is compiled after `threshold_runs` of a block, in the run itself if `synchronous`.
    pub(crate) fn blocks<B: BlockBus>(self, threshold_runs: u32, synchronous: bool) -> Blocks<B> {
        match self {
            Self::Fast => blocks_with_jit(threshold_runs, synchronous),
            Self::Blocks | Self::Reference => Blocks::default(),
        }
    }
}

#[cfg(not(feature = "jit"))]
fn blocks_with_jit<B: BlockBus>(_threshold_runs: u32, _synchronous: bool) -> Blocks<B> {
    Blocks::default()
}

#[cfg(feature = "jit")]
fn blocks_with_jit<B: BlockBus>(threshold_runs: u32, synchronous: bool) -> Blocks<B> {
    let mode = if synchronous {
        jit::CompileMode::Synchronous
    } else {
        jit::CompileMode::Background
    };
    let jit = jit::JitEngine::new(threshold_runs, mode);
    jit.map_or_else(Blocks::default, |jit| Blocks::with_jit(Box::new(jit)))
}
