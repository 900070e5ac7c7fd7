// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The digest of a trace: SHA-256 (FIPS 180-4) over one canonical encoding.
//!
//! Encoding, all numbers little endian, lengths and counts as u64: the tag; per name space its
//! count, then each name as length and UTF-8; count of events, then each packed event; count of
//! signals, then each signal as name, count of samples, and per sample u64 cycles and the bits of
//! the f64. Every NaN is written as the one quiet NaN 0x7FF8000000000000, because processors differ
//! in the payload they give.

use std::fmt;

use sha2::{Digest as _, Sha256};

use crate::names::NameSpace;
use crate::record::Trace;
use crate::signals::Signal;

const TAG: &[u8] = b"ravenbrick trace 1\n";
const CANONICAL_NAN: u64 = 0x7FF8_0000_0000_0000;
/// Length from which bytes are passed on to the hash.
const PIECE_BYTES: usize = 0x2000;

/// A SHA-256 value; displays as 64 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest([u8; 32]);

impl Digest {
    /// SHA-256 of bytes, such as those of a file.
    #[must_use]
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Bytes on their way to the hash, which takes few large pieces faster than many small ones.
struct Encoder {
    hash: Sha256,
    waiting: Vec<u8>,
}

impl Encoder {
    fn new() -> Self {
        Self {
            hash: Sha256::new(),
            waiting: Vec::with_capacity(2 * PIECE_BYTES),
        }
    }

    #[inline]
    fn add(&mut self, bytes: &[u8]) {
        self.waiting.extend_from_slice(bytes);
        if self.waiting.len() >= PIECE_BYTES {
            self.pass_on();
        }
    }

    /// Many bytes, which need no copy.
    fn add_piece(&mut self, bytes: &[u8]) {
        self.pass_on();
        self.hash.update(bytes);
    }

    fn pass_on(&mut self) {
        self.hash.update(&self.waiting);
        self.waiting.clear();
    }

    fn count(&mut self, number: usize) {
        self.add(&(number as u64).to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.add(text.as_bytes());
    }

    fn samples(&mut self, signal: Signal<'_>) {
        self.text(signal.name);
        self.count(signal.values.len());
        for (at_cycles, value) in signal.at_cycles.iter().zip(signal.values) {
            let bits = if value.is_nan() {
                CANONICAL_NAN
            } else {
                value.to_bits()
            };
            let sample = u128::from(*at_cycles) | u128::from(bits) << 64;
            self.add(&sample.to_le_bytes());
        }
    }

    fn finish(mut self) -> Digest {
        self.pass_on();
        Digest(self.hash.finalize().into())
    }
}

impl Trace {
    /// Digest of everything recorded so far; equal records give equal digests on every machine.
    #[must_use]
    pub fn digest(&self) -> Digest {
        let mut encoder = Encoder::new();
        encoder.add(TAG);
        for space in NameSpace::ALL {
            let names = self.names().all(space);
            encoder.count(names.len());
            names.iter().for_each(|name| encoder.text(name));
        }
        encoder.count(self.events().len());
        encoder.add_piece(self.events().packed());
        encoder.count(self.signals().len());
        self.signals()
            .iter()
            .for_each(|signal| encoder.samples(signal));
        encoder.finish()
    }
}
