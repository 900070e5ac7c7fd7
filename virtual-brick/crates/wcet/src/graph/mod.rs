// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The control-flow graph of one function, its loops and parts of it. Knows no values.

pub mod control_flow;
pub mod loop_forest;
pub mod node_splitting;
pub mod static_cost;
pub mod subgraph;
