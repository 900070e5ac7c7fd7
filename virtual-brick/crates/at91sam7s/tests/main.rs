// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[macro_use]
mod common;

mod bits;
mod brown_out;
mod characters;
mod converter;
mod errata;
mod interrupts;
mod memory;
mod pins;
mod pulse_width;
mod real_time_timer;
mod registers;
mod serial;
mod sound;
mod system;
mod timers;
mod two_wire;
mod usb;
mod with_core;
