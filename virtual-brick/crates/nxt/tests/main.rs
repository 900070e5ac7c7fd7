// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod bluetooth;
mod buses;
mod color;
mod common;
mod coprocessor;
mod display;
mod encoders;
mod inputs;
mod mounted_sensors;
mod sensors;
mod usb;
