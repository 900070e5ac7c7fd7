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

/// A SHA-256 value; displays as 64 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest([u8; 32]);

impl Digest {
    /// The 32 bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl Trace {
    /// Digest of everything recorded so far; equal records give equal digests on every machine.
    #[must_use]
    pub fn digest(&self) -> Digest {
        let mut hash = Sha256::new();
        hash.update(TAG);
        for space in NameSpace::ALL {
            let names = self.names().all(space);
            count(&mut hash, names.len());
            names.iter().for_each(|name| text(&mut hash, name));
        }
        count(&mut hash, self.events().len());
        self.events()
            .iter()
            .for_each(|event| hash.update(event.packed()));
        count(&mut hash, self.signals().len());
        self.signals()
            .iter()
            .for_each(|signal| samples(&mut hash, signal));
        Digest(hash.finalize().into())
    }
}

fn count(hash: &mut Sha256, number: usize) {
    hash.update((number as u64).to_le_bytes());
}

fn text(hash: &mut Sha256, text: &str) {
    count(hash, text.len());
    hash.update(text.as_bytes());
}

fn samples(hash: &mut Sha256, signal: Signal<'_>) {
    text(hash, signal.name);
    count(hash, signal.values.len());
    for (at_cycles, value) in signal.at_cycles.iter().zip(signal.values) {
        let bits = if value.is_nan() {
            CANONICAL_NAN
        } else {
            value.to_bits()
        };
        hash.update(at_cycles.to_le_bytes());
        hash.update(bits.to_le_bytes());
    }
}
