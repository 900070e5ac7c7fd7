// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds on the iterations of loops: by abstract execution, and by flow facts of the user.

pub mod abstract_execution;
pub mod flow_facts;
