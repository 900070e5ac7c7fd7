// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The engines that execute instructions. They differ in speed only.

use arm7tdmi::{BlockBus, Blocks};
use serde::Deserialize;

use crate::configuration::Configuration;

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

/// Compile threshold: runs of a block before it is compiled. To compile it costs as much as some
/// thousand runs, but another thread does it, and a block that runs so often goes on running.
pub(crate) const JIT_THRESHOLD_RUNS: u32 = 200;

impl Engine {
    /// An empty cache of decoded blocks, as this engine uses it.
    pub(crate) fn blocks<B: BlockBus>(self, configuration: &Configuration) -> Blocks<B> {
        match self {
            Self::Fast => blocks_with_jit(configuration),
            Self::Blocks | Self::Reference => Blocks::default(),
        }
    }
}

#[cfg(not(feature = "jit"))]
fn blocks_with_jit<B: BlockBus>(_configuration: &Configuration) -> Blocks<B> {
    Blocks::default()
}

#[cfg(feature = "jit")]
fn blocks_with_jit<B: BlockBus>(configuration: &Configuration) -> Blocks<B> {
    let mode = if configuration.jit_synchronous {
        jit::CompileMode::Synchronous
    } else {
        jit::CompileMode::Background
    };
    let jit = jit::JitEngine::new(configuration.jit_threshold_runs, mode);
    jit.map_or_else(Blocks::default, |jit| Blocks::with_jit(Box::new(jit)))
}
