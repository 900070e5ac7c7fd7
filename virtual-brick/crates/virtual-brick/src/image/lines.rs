// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Source lines by address, from the debug information.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use addr2line::Context;
use gimli::{Dwarf, EndianArcSlice, LittleEndian};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection, SectionKind};

type Table = Context<EndianArcSlice<LittleEndian>>;

/// The line table of an image. It also has rows of sections that the linker discarded, from
/// address 0 on: only addresses in the image's code have lines.
pub struct Lines {
    table: Option<Table>,
    code: Vec<Range<u64>>,
}

impl Lines {
    /// Read the line table; an image without (or with broken) debug information has no lines.
    pub(super) fn read(elf: &[u8]) -> Self {
        let Ok(file) = ElfFile32::<object::LittleEndian>::parse(elf) else {
            return Self {
                table: None,
                code: Vec::new(),
            };
        };
        let code = file.sections().filter(|s| s.kind() == SectionKind::Text);
        let code = code.map(|s| s.address()..s.address() + s.size()).collect();
        let section = |id: gimli::SectionId| -> Result<_, gimli::Error> {
            let found = file.section_by_name(id.name());
            let data = found.and_then(|section| section.data().ok());
            let bytes: Arc<[u8]> = data.unwrap_or_default().into();
            Ok(EndianArcSlice::new(bytes, LittleEndian))
        };
        let table = Dwarf::load(section).and_then(Context::from_dwarf).ok();
        Self { table, code }
    }

    /// File and line of the instruction at an address.
    #[must_use]
    pub fn at(&self, address: u32) -> Option<(&str, u32)> {
        let (file, line, _) = self.with_column(address)?;
        Some((file, line))
    }

    /// File, line and column (0: unknown) of the instruction at an address.
    pub(crate) fn with_column(&self, address: u32) -> Option<(&str, u32, u32)> {
        let address = u64::from(address);
        let table = self.table.as_ref()?;
        self.code.iter().find(|range| range.contains(&address))?;
        let location = table.find_location(address).ok()??;
        Some((location.file?, location.line?, location.column.unwrap_or(0)))
    }
}

impl fmt::Debug for Lines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Lines").field(&self.table.is_some()).finish()
    }
}
