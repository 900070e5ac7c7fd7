// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A linked program: segments, entry, symbols and types, read from an ELF file.

mod debug_types;
mod error;
mod frames;
mod header;
mod lines;
mod segments;
mod symbols;
mod variables;

use object::read::elf::ElfFile32;
use object::LittleEndian;

pub use error::ImageError;
pub(crate) use frames::Frames;
pub use lines::Lines;
pub use segments::{Placement, Segment};
pub use symbols::{Symbol, Symbols};
pub use variables::{ScalarKind, Variable};

type Elf<'data> = ElfFile32<'data, LittleEndian>;

/// A program ready to be loaded.
#[derive(Clone, Debug)]
pub struct Image {
    elf: std::sync::Arc<[u8]>,
    segments: Vec<Segment>,
    placement: Placement,
    entry: u32,
    symbols: Symbols,
}

impl Image {
    /// Read an ELF file.
    ///
    /// # Errors
    /// The file is truncated, is no ELF file for 32-bit little-endian ARM, or its segments or
    /// entry do not fit the brick's memory.
    pub fn parse(elf: &[u8]) -> Result<Self, ImageError> {
        header::check(elf)?;
        let file: Elf<'_> = ElfFile32::parse(elf).map_err(ImageError::malformed)?;
        let segments = segments::read(&file)?;
        let placement = segments::placement(&segments)?;
        let entry = segments::entry(&file, &segments)?;
        let symbols = Symbols::read(&file);
        Ok(Self {
            elf: elf.into(),
            segments,
            placement,
            entry,
            symbols,
        })
    }

    /// A program as its bytes in memory, from `address` on; it starts there, in ARM state.
    ///
    /// # Errors
    /// The bytes do not fit the brick's memory for programs there, or there are none.
    pub fn binary(bytes: &[u8], address: u32) -> Result<Self, ImageError> {
        let segments = segments::binary(bytes, address)?;
        Ok(Self {
            elf: [].into(),
            placement: segments::placement(&segments)?,
            segments,
            entry: address,
            symbols: Symbols::default(),
        })
    }

    /// Segments with contents, by their physical (load) address.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Where the image is loaded.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// Entry address; bit 0 set means Thumb.
    #[must_use]
    pub fn entry(&self) -> u32 {
        self.entry
    }

    /// The symbol table.
    #[must_use]
    pub fn symbols(&self) -> &Symbols {
        &self.symbols
    }

    /// The line table, read anew.
    #[must_use]
    pub fn lines(&self) -> Lines {
        Lines::read(&self.elf)
    }

    /// The call frame information, read anew.
    pub(crate) fn frames(&self) -> Frames<'_> {
        Frames::read(&self.elf)
    }

    /// Find a global object by name: `counter`, `functional_Y.correctedvoltage` or, for Ada,
    /// `Tasks.Counter`. The type is known when the file has debug information.
    ///
    /// # Errors
    /// No such symbol or component.
    pub fn variable(&self, path: &str) -> Result<Variable, ImageError> {
        variables::resolve(&self.elf, &self.symbols, path)
    }
}
