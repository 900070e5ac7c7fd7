// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! AT91SAM7S256: memory map and on-chip peripherals. Knows the board only as pins and lines.
//!
//! [`Chip`] owns the memories, the peripherals, the board and time, and is the bus of the core.
//! Time is counted in cycles of the 48.05 MHz master clock from power-on ([`board::Cycles`]).
//! While the processor runs from a slower clock each of its cycles is charged the rounded ratio
//! of the two clocks; the peripherals keep counting the 48.05 MHz clock.

mod adc;
mod chip;
mod clock;
mod errata;
mod fault;
mod memory;
mod peripherals;
mod pins;
mod registers;
mod schedule;
mod serial;
mod system;
mod timers;
mod timing;

pub mod board;

pub use chip::Chip;
pub use clock::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR, SLOW_CLOCK_HZ};
pub use errata::Errata;
pub use fault::{Fault, FaultKind};
pub use memory::sram::WatchHit;
pub use memory::AddressError;
pub use pins::pin_log::LoggedPins;
pub use system::rstc::ResetCause;
pub use timing::{ChipConfiguration, CodeBufferLoss, FlashCost, TimingProfile, TwiStopDecision};
