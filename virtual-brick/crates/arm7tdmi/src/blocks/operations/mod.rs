// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The operations that blocks are made of: one handler for each kind of instruction and operand.

pub(super) mod branch;
pub(super) mod data;
pub(super) mod encoding;
pub(super) mod run;
mod slow_path;
pub(super) mod status;
pub(super) mod transfer;
