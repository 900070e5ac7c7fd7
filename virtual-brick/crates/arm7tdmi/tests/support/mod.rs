// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reading and running the single-step vectors of verification/processor.
#![allow(dead_code)] // an example uses its part

pub mod archive;
pub mod counts;
pub mod memory;
pub mod single_step;
