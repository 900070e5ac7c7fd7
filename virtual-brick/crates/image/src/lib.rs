// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A linked program for 32-bit little-endian ARM, read from an ELF file: segments, sections,
//! symbols, source lines, call frames and the types of its variables; places at which its flow is
//! counted.

mod error;
mod flow_points;
mod frames;
mod header;
mod lines;
mod scalar;
mod segments;
mod symbols;
mod types;
mod variables;

use std::sync::{Arc, OnceLock};

use gimli::{EndianSlice, LittleEndian};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection};

pub use error::ImageError;
pub use flow_points::{FlowPoint, Within};
pub use frames::Frames;
pub use lines::{Line, Lines};
pub use scalar::ScalarKind;
pub use segments::{Section, Segment};
pub use symbols::{Content, Function, Symbol, Symbols};
pub use variables::Variable;

type Elf<'data> = ElfFile32<'data, object::LittleEndian>;
type Reader<'data> = EndianSlice<'data, LittleEndian>;

/// The section of the debug information, empty when the file does not have it.
fn debug_section<'data>(file: &Elf<'data>, id: gimli::SectionId) -> Reader<'data> {
    let found = file.section_by_name(id.name());
    let data = found.and_then(|section| section.data().ok());
    EndianSlice::new(data.unwrap_or_default(), LittleEndian)
}

fn debug_information<'data>(
    file: &Elf<'data>,
) -> Result<gimli::Dwarf<Reader<'data>>, gimli::Error> {
    gimli::Dwarf::load(|id| Ok(debug_section(file, id)))
}

/// A program ready to be loaded.
#[derive(Clone, Debug)]
pub struct Image {
    elf: Arc<[u8]>,
    segments: Vec<Segment>,
    entry: u32,
    symbols: Symbols,
    lines: OnceLock<Lines>,
}

impl Image {
    /// Read an ELF file.
    ///
    /// # Errors
    /// The file is truncated, is no executable for 32-bit little-endian ARM, has nothing to load
    /// or its entry lies outside of what is loaded.
    pub fn parse(elf: &[u8]) -> Result<Self, ImageError> {
        header::check(elf)?;
        let file: Elf<'_> = ElfFile32::parse(elf).map_err(ImageError::malformed)?;
        let segments = segments::read(&file)?;
        let entry = segments::entry(&file, &segments)?;
        Ok(Self {
            elf: elf.into(),
            segments,
            entry,
            symbols: Symbols::read(&file),
            lines: OnceLock::new(),
        })
    }

    /// A program as its bytes in memory, from `address` on; it starts there, in ARM state.
    ///
    /// # Errors
    /// There are no bytes, or more than there are addresses.
    pub fn binary(bytes: &[u8], address: u32) -> Result<Self, ImageError> {
        Ok(Self {
            elf: [].into(),
            segments: vec![segments::binary(bytes, address)?],
            entry: address,
            symbols: Symbols::default(),
            lines: OnceLock::new(),
        })
    }

    /// Segments by their physical (load) address.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Sections that are loaded with contents, in the order of the file.
    #[must_use]
    pub fn sections(&self) -> Vec<Section<'_>> {
        self.file()
            .map_or_else(Vec::new, |file| segments::sections(&file))
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

    /// The line table, empty when the debug information is missing or broken.
    #[must_use]
    pub fn lines(&self) -> &Lines {
        self.lines
            .get_or_init(|| self.read_lines().unwrap_or_default())
    }

    /// The line table, read anew.
    ///
    /// # Errors
    /// The debug information is broken; a file without any has an empty table.
    pub fn read_lines(&self) -> Result<Lines, ImageError> {
        self.file()
            .map_or_else(|| Ok(Lines::default()), |file| Lines::read(&file))
    }

    /// The call frame information, read anew.
    #[must_use]
    pub fn frames(&self) -> Frames<'_> {
        Frames::new(
            self.file()
                .map(|file| debug_section(&file, gimli::SectionId::DebugFrame)),
        )
    }

    /// Find a global object by name: `counter`, `functional_Y.correctedvoltage` or, for Ada,
    /// `Tasks.Counter`. The type is known when the file has debug information.
    ///
    /// # Errors
    /// No such symbol or component.
    pub fn variable(&self, path: &str) -> Result<Variable, ImageError> {
        variables::resolve(self.file().as_ref(), &self.symbols, path)
    }

    fn file(&self) -> Option<Elf<'_>> {
        ElfFile32::parse(&*self.elf).ok()
    }
}
