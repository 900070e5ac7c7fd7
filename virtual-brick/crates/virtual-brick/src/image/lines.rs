// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Source lines by address, from the debug information.

use std::fmt;
use std::sync::Arc;

use addr2line::Context;
use gimli::{Dwarf, EndianArcSlice, LittleEndian};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection};

/// The line table of an image.
pub struct Lines(Option<Context<EndianArcSlice<LittleEndian>>>);

impl Lines {
    /// Read the line table; an image without (or with broken) debug information has no lines.
    pub(super) fn read(elf: &[u8]) -> Self {
        let Ok(file) = ElfFile32::<object::LittleEndian>::parse(elf) else {
            return Self(None);
        };
        let section = |id: gimli::SectionId| -> Result<_, gimli::Error> {
            let found = file.section_by_name(id.name());
            let data = found.and_then(|section| section.data().ok());
            let bytes: Arc<[u8]> = data.unwrap_or_default().into();
            Ok(EndianArcSlice::new(bytes, LittleEndian))
        };
        let context = Dwarf::load(section).and_then(Context::from_dwarf);
        Self(context.ok())
    }

    /// File and line of the instruction at an address.
    #[must_use]
    pub fn at(&self, address: u32) -> Option<(&str, u32)> {
        let location = self.0.as_ref()?.find_location(u64::from(address));
        let location = location.ok()??;
        Some((location.file?, location.line?))
    }
}

impl fmt::Debug for Lines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Lines").field(&self.0.is_some()).finish()
    }
}
