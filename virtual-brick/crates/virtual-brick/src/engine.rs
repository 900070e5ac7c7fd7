// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The ways to execute instructions, which differ in speed only.

use arm7tdmi::{BlockBus, Blocks};
use serde::Deserialize;

use crate::configuration::Configuration;

/// Which engine executes instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// Blocks, and code of the host for those that run often, where the host is one that code can
    /// be made for.
    #[default]
    Fast,
    /// Decoded blocks where nothing can fall into them, else the reference.
    Blocks,
    /// One instruction after the other, each access through the bus.
    Reference,
}

/// Runs of a block's operations before code of the host is made of it. To make it costs as much as
/// some thousand runs, but another thread does it, and what runs so often goes on running.
pub(crate) const JIT_THRESHOLD_RUNS: u32 = 200;

impl Engine {
    /// Decoded blocks as the engine uses them, none yet.
    pub(crate) fn blocks<B: BlockBus>(self, configuration: &Configuration) -> Blocks<B> {
        match self {
            Self::Fast => native_blocks(configuration),
            Self::Blocks | Self::Reference => Blocks::default(),
        }
    }
}

#[cfg(not(feature = "jit"))]
fn native_blocks<B: BlockBus>(_configuration: &Configuration) -> Blocks<B> {
    Blocks::default()
}

#[cfg(feature = "jit")]
fn native_blocks<B: BlockBus>(configuration: &Configuration) -> Blocks<B> {
    let making = if configuration.jit_synchronous {
        jit::Making::AtOnce
    } else {
        jit::Making::Beside
    };
    let after_runs = configuration.jit_threshold_runs;
    jit::Translator::new(after_runs, making).map_or_else(Blocks::default, |translator| {
        Blocks::with_native(Box::new(translator))
    })
}
