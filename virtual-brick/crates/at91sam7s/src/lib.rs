// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! AT91SAM7S256: memory map and on-chip peripherals. Knows the board only as pins and lines.
//!
//! [`Chip`] owns the memories, the peripherals, the board and time, and is the bus of the core.
//! Time is counted in cycles of the 48.05 MHz master clock from power-on ([`board::Cycles`]).
//! While the processor runs from a slower clock each of its cycles is charged the rounded ratio
//! of the two clocks; the peripherals keep counting the 48.05 MHz clock.

mod adc;
mod aic;
mod boot;
mod bus;
mod chip;
mod code;
mod dbgu;
mod event;
mod fault;
mod flash;
mod mc;
mod pdc;
mod pin_log;
mod pins;
mod pio;
mod pit;
mod pmc;
mod pwmc;
mod registers;
mod rstc;
mod rtt;
mod spi;
mod sram;
mod ssc;
mod streams;
mod tc;
mod timing;
mod torn;
mod twi;
mod udp;
mod usart;
mod wdt;

pub mod board;

pub use chip::{AddressError, Chip};
pub use fault::{Fault, FaultKind};
pub use pin_log::LoggedPins;
pub use rstc::ResetCause;
pub use sram::WatchHit;
pub use timing::{ChipConfiguration, CodeBufferLoss, FlashCost, TimingProfile};

/// Numerator of the master clock in Hz: 18.432 MHz crystal, times 73, over 14 and 2.
pub const MASTER_CLOCK_HZ_NUMERATOR: u64 = 336_384_000;
/// Denominator of the master clock in Hz.
pub const MASTER_CLOCK_HZ_DENOMINATOR: u64 = 7;
/// Nominal frequency of the slow clock (internal RC oscillator).
pub const SLOW_CLOCK_HZ: u64 = 32_768;

/// Master clock cycles in `count` periods of the nominal slow clock, rounded down.
pub(crate) const fn slow_clock_cycles(count: u64) -> board::Cycles {
    count * MASTER_CLOCK_HZ_NUMERATOR / (MASTER_CLOCK_HZ_DENOMINATOR * SLOW_CLOCK_HZ)
}

/// Master clock cycles in `count` microseconds, rounded down.
pub(crate) const fn microseconds_cycles(count: u64) -> board::Cycles {
    count * MASTER_CLOCK_HZ_NUMERATOR / (MASTER_CLOCK_HZ_DENOMINATOR * 1_000_000)
}

/// A time that never comes.
pub(crate) const NEVER: board::Cycles = board::Cycles::MAX;
