// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycles of basic blocks and the longest path over them.

pub mod block_cost;
pub mod critical_section;
pub mod longest_path;
