// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Whole functions with all that they call: the recursion over the call graph.

pub mod bound;
pub mod context_sensitive_calls;
pub mod effects;
pub mod endless_loop;
pub mod execution;
pub mod function_bound;
pub mod function_summary;
pub mod program;
pub mod remaining_time;
pub mod summary;
