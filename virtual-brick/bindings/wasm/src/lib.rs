// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The virtual brick for JavaScript: numbers are cycles, structures are JSON, columns are typed
//! arrays.
//!
//! Cycles are exact as JavaScript numbers up to 2^53, which is six years of virtual time.

mod brick;
mod scope;
mod screens;
mod steps;
mod verdict;

pub use brick::VirtualBrick;
