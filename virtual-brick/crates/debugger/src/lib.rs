// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! GDB remote server over the facade: source-level debugging of a program on the virtual brick,
//! forwards and backwards in time.
//!
//! The run is deterministic, so the past is found by running again from a checkpoint with the
//! same inputs. What the user changes by hand is remembered with its instant and made again; a
//! change made in the past begins another future.

mod arch;
mod backwards;
mod checkpoints;
mod execution;
mod loading;
mod monitor;
mod peripherals;
mod screen;
mod server;
mod stops;
mod target;
mod tasks;
mod timeline;
mod watches;

pub use arch::{Brick, BrickRegister, BrickRegisters};
pub use server::{session, Server, SessionEnd};
pub use target::DebugTarget;
