// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Compiling programs, running them on the core, and hunting for their longest time.

#![allow(dead_code)] // each test binary uses its part

pub mod machine;
pub mod random;
pub mod toolchain;
