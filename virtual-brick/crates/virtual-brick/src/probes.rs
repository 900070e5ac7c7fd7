// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Probes: scalar objects of the program read from outside.

use crate::threads::Memory;
use image::{Image, ImageError, ScalarKind};

/// A scalar object and the bytes last read from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name as asked for.
    pub path: String,
    /// Address.
    pub address: u32,
    /// How its bytes are read.
    pub kind: ScalarKind,
    bytes: [u8; 8],
}

impl Probe {
    pub(crate) fn new(
        image: &Image,
        path: &str,
        kind: Option<ScalarKind>,
    ) -> Result<Self, ImageError> {
        let variable = image.variable(path)?;
        let kind = kind
            .or(variable.kind)
            .ok_or_else(|| ImageError::UnknownType {
                path: path.to_owned(),
                size: variable.size,
            })?;
        Ok(Self {
            path: path.to_owned(),
            address: variable.address,
            kind,
            bytes: [0; 8],
        })
    }

    /// Read the bytes now; an object in no memory reads as zero.
    pub(crate) fn sample(&mut self, memory: &impl Memory) {
        let size = self.kind.size() as usize;
        if !memory.read(self.address, &mut self.bytes[..size]) {
            self.bytes = [0; 8];
        }
    }

    /// The number read, as a float.
    #[must_use]
    pub fn as_float(&self) -> f64 {
        self.kind.to_f64(&self.bytes)
    }

    /// The number read, as an integer; a float gives its bits.
    #[must_use]
    pub fn as_integer(&self) -> i64 {
        self.kind.to_i64(&self.bytes)
    }
}
