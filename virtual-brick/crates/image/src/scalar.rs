// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Scalars in memory.

use std::fmt;
use std::str::FromStr;

/// How the bytes of a scalar are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarKind {
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 64 bits.
    I64,
    /// Unsigned, 64 bits.
    U64,
    /// IEEE 754 binary32.
    F32,
    /// IEEE 754 binary64.
    F64,
}

impl ScalarKind {
    const NAMES: [(&'static str, Self); 10] = [
        ("i8", Self::I8),
        ("u8", Self::U8),
        ("i16", Self::I16),
        ("u16", Self::U16),
        ("i32", Self::I32),
        ("u32", Self::U32),
        ("i64", Self::I64),
        ("u64", Self::U64),
        ("f32", Self::F32),
        ("f64", Self::F64),
    ];

    /// Bytes in memory.
    #[must_use]
    pub const fn size(self) -> u32 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(crate) fn integer(size: u64, signed: bool) -> Option<Self> {
        match (size, signed) {
            (1, true) => Some(Self::I8),
            (1, false) => Some(Self::U8),
            (2, true) => Some(Self::I16),
            (2, false) => Some(Self::U16),
            (4, true) => Some(Self::I32),
            (4, false) => Some(Self::U32),
            (8, true) => Some(Self::I64),
            (8, false) => Some(Self::U64),
            _ => None,
        }
    }

    /// The number in `bytes` (little endian) as a float; 64-bit integers are rounded.
    /// Missing bytes count as zero.
    #[must_use]
    pub fn to_f64(self, bytes: &[u8]) -> f64 {
        match self {
            Self::F32 => f64::from(f32::from_bits(word(bytes, 4) as u32)),
            Self::F64 => f64::from_bits(word(bytes, 8)),
            Self::U64 => word(bytes, 8) as f64,
            _ => self.to_i64(bytes) as f64,
        }
    }

    /// The bits in `bytes` (little endian) as an integer, sign-extended when signed; a float
    /// gives its bits.
    #[must_use]
    pub fn to_i64(self, bytes: &[u8]) -> i64 {
        let raw = word(bytes, self.size() as usize);
        match self {
            Self::I8 => i64::from(raw as i8),
            Self::I16 => i64::from(raw as i16),
            Self::I32 => i64::from(raw as i32),
            _ => raw as i64,
        }
    }

    /// The bytes (little endian) of a number; none when this kind cannot hold it. A binary32
    /// holds the nearest number.
    #[must_use]
    pub fn to_bytes(self, value: f64) -> Option<Vec<u8>> {
        let bytes = match self {
            Self::F32 => (value as f32).to_le_bytes().to_vec(),
            Self::F64 => value.to_le_bytes().to_vec(),
            _ => (value as i128).to_le_bytes()[..self.size() as usize].to_vec(),
        };
        let held = self.to_f64(&bytes);
        let exact = held == value || self == Self::F32;
        (held.is_finite() && exact).then_some(bytes)
    }
}

impl fmt::Display for ScalarKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMES
            .iter()
            .find(|(_, kind)| kind == self)
            .map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

impl FromStr for ScalarKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::NAMES
            .iter()
            .find(|(name, _)| *name == text)
            .map(|(_, kind)| *kind)
            .ok_or_else(|| {
                let known: Vec<&str> = Self::NAMES.iter().map(|(name, _)| *name).collect();
                format!("unknown kind `{text}`; known: {}", known.join(", "))
            })
    }
}

fn word(bytes: &[u8], size: usize) -> u64 {
    let mut raw = [0; 8];
    for (to, from) in raw.iter_mut().zip(bytes.iter().take(size)) {
        *to = *from;
    }
    u64::from_le_bytes(raw)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_becomes_the_bytes_that_are_read_as_it() {
        for (kind, value) in [
            (ScalarKind::I8, -128.0),
            (ScalarKind::U16, 65_535.0),
            (ScalarKind::I64, -1e15),
            (ScalarKind::F32, 0.25),
            (ScalarKind::F64, 0.1),
        ] {
            let bytes = kind.to_bytes(value).unwrap_or_default();
            assert_eq!(
                (bytes.len() as u32, kind.to_f64(&bytes)),
                (kind.size(), value)
            );
        }
    }

    #[test]
    fn a_number_that_does_not_fit_has_no_bytes() {
        for (kind, value) in [
            (ScalarKind::I8, 128.0),
            (ScalarKind::U8, -1.0),
            (ScalarKind::U32, 0.5),
            (ScalarKind::F32, 1e39),
            (ScalarKind::F64, f64::NAN),
        ] {
            assert_eq!(kind.to_bytes(value), None, "{kind} {value}");
        }
    }
}
