// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reproducible inputs that reach the corners of integer and float arithmetic.

/// A sequence of 32-bit numbers (xorshift).
pub struct Random(u32);

impl Random {
    pub fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9) | 1)
    }

    pub fn word(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Integers of all magnitudes and signs.
    pub fn integer(&mut self) -> u32 {
        let shift = self.word() & 31;
        (self.word() as i32 >> shift) as u32
    }

    /// Bits of a float: normal near one another, denormal, zero, infinite, not a number.
    pub fn float(&mut self) -> u32 {
        let sign = self.word() & 0x8000_0000;
        let mantissa = match self.word() & 3 {
            0 => 0,
            1 => self.word() & 0x007F_FFFF,
            2 => 1 << (self.word() % 23),
            _ => 0x007F_FFFF >> (self.word() % 23),
        };
        let exponent = match self.word() & 7 {
            0 => 0,
            1 => self.word() & 0xFF,
            2 => 254,
            3 if self.word() & 3 == 0 => 255,
            _ => 120 + (self.word() & 15),
        };
        sign | exponent << 23 | mantissa
    }
}
