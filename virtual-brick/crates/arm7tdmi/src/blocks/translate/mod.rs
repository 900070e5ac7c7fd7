// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From opcodes to blocks: the instructions of a block, their data flow, their operations.

mod analysis;
mod builder;
mod data;
mod source;
mod transfer;

pub(super) use builder::{build, translate};
pub(super) use source::{ends, read_source, Source, BYTES_MAX};
