// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::expect_used, clippy::panic)]

mod behaviour;
mod cost;
mod single_step;
mod support;
