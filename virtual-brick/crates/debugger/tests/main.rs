// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::unwrap_used)]

mod gdb;
mod hostile;
mod loading;
mod server;
#[path = "../../virtual-brick/tests/support/mod.rs"]
mod support;
mod target;
mod tasks;
mod watches;
