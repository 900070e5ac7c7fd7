// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reading and running the single-step vectors of conformance/cpu.

pub mod archive;
pub mod single_step;
