// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Faults of the silicon that a program on the NXT can meet, each with a switch. Those that
//! drivers of others name are on unless switched off; those that only memory of the errata chapter
//! (6175) supports, or that one revision has, are off.

use serde::Deserialize;

/// Which faults of the silicon the chip has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Errata {
    /// A read of `TWI_SR` between a missing acknowledge and TXCOMP loses NACK.
    pub twi_nack_lost: bool,
    /// Enabled or reset while TWD or TWCK is low, the TWI does nothing more until it is reset
    /// with both lines high.
    pub twi_locked_by_low_line: bool,
    /// MSDIS during a frame stops it where it is, without a stop condition and without TXCOMP.
    pub twi_disable_freezes: bool,
    /// A received byte that was not read is lost at the end of the next written byte.
    pub twi_received_byte_overwritten: bool,
    /// After one SWRST the SPI sends without its chip select; a second one in a row mends it.
    pub spi_reset_needs_two: bool,
    /// A read of any `ADC_CDRx` clears DRDY too.
    pub adc_channel_read_clears_drdy: bool,
}

impl Errata {
    /// A chip as its datasheet describes it.
    pub const NONE: Self = Self {
        twi_nack_lost: false,
        twi_locked_by_low_line: false,
        twi_disable_freezes: false,
        twi_received_byte_overwritten: false,
        spi_reset_needs_two: false,
        adc_channel_read_clears_drdy: false,
    };
}

impl Default for Errata {
    fn default() -> Self {
        Self {
            twi_nack_lost: true,
            twi_locked_by_low_line: true,
            ..Self::NONE
        }
    }
}
