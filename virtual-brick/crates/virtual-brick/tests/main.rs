// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::panic, clippy::unwrap_used)]

mod checkpoints;
mod configuration;
mod determinism;
mod engines;
mod nxt_firmware;
mod nxt_firmware_usb;
mod placement;
mod programs;
mod robustness;
mod semihosting;
mod stacks;
mod stops;
mod support;
mod threads;
