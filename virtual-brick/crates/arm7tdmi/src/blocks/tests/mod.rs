// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Unit tests of the fast engine, on a small machine and with a compiler that compiles nothing.
#![allow(clippy::unwrap_used)]

mod execution;
mod invalidation;
mod machine;
mod random_programs;
mod regions;
mod translation;
