// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where a run can show whether a fact about a program's flow holds: the instructions at which
//! loops, recursions, indirect branches and excluded places are seen.

use serde::{Deserialize, Serialize};

/// A fact about the program's flow, by the addresses of instructions.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum FlowPoint {
    /// Executions of a loop's first block for each entry.
    Loop {
        /// First instruction of the loop.
        header: u32,
        /// The loop begins where its function does, so an entry is a call.
        at_call: bool,
        /// Last instructions of the blocks from which the loop is entered.
        entries: Vec<u32>,
        /// Last instructions of the blocks that go back to its first one.
        repeats: Vec<u32>,
        /// Those of `repeats` that are calls, after which it goes on there.
        calls: Vec<u32>,
        /// Only while this function is active.
        within: Option<Within>,
        /// Executions that are allowed.
        at_most: u64,
    },
    /// Arrivals at code.
    Place {
        /// Its instructions.
        addresses: Vec<u32>,
    },
    /// Executions of instructions in one call of their function.
    Together {
        /// The function's first instruction.
        entry: u32,
        /// The instructions.
        addresses: Vec<u32>,
        /// Executions of them all that are allowed.
        at_most: u64,
    },
    /// Arrivals elsewhere than at some targets.
    Branch {
        /// The indirect branch.
        address: u32,
        /// The targets, without the bit that tells Thumb.
        targets: Vec<u32>,
        /// Where it comes back to, if it is counted for one of the calls that share it.
        #[serde(default)]
        returns_to: Option<u32>,
    },
    /// Activations of a function.
    Recursion {
        /// Its first instruction.
        entry: u32,
        /// Its last ones.
        returns: Vec<u32>,
        /// Activations at the same time that are allowed.
        at_most: u64,
        /// Activations in one call from outside that are allowed.
        calls: u64,
    },
}

/// The function within which a fact holds.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Within {
    /// Its symbol.
    pub function: String,
    /// Its first instruction.
    pub entry: u32,
    /// Its last ones.
    pub returns: Vec<u32>,
}
