// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Source lines by address, from DWARF.

use crate::error::Error;
use gimli::{EndianSlice, LittleEndian};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection};
use std::collections::BTreeMap;

type Reader<'a> = EndianSlice<'a, LittleEndian>;

/// Start of each row of the line table; line 0 ends a sequence.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    files: Vec<String>,
    rows: BTreeMap<u32, (usize, u32)>,
}

impl Lines {
    /// Reads the line table; a file without one has no lines.
    pub fn read(file: &ElfFile32<'_>) -> Result<Self, Error> {
        let section = |id: gimli::SectionId| -> Result<Reader<'_>, gimli::Error> {
            let found = file.section_by_name(id.name());
            let data = found.and_then(|section| section.data().ok());
            Ok(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
        };
        let mut lines = Self::default();
        gimli::Dwarf::load(section)
            .and_then(|dwarf| lines.add_units(&dwarf))
            .map_err(|error| Error::Input(format!("debug information: {error}")))?;
        Ok(lines)
    }

    fn add_units(&mut self, dwarf: &gimli::Dwarf<Reader<'_>>) -> Result<(), gimli::Error> {
        let mut units = dwarf.units();
        while let Some(header) = units.next()? {
            let unit = dwarf.unit(header)?;
            if let Some(program) = unit.line_program.clone() {
                self.add_program(dwarf, &unit, program)?;
            }
        }
        Ok(())
    }

    fn add_program(
        &mut self,
        dwarf: &gimli::Dwarf<Reader<'_>>,
        unit: &gimli::Unit<Reader<'_>>,
        program: gimli::IncompleteLineProgram<Reader<'_>>,
    ) -> Result<(), gimli::Error> {
        let mut known = BTreeMap::new();
        let mut rows = program.rows();
        while let Some((header, row)) = rows.next_row()? {
            let address = row.address() as u32;
            if row.end_sequence() {
                self.rows.entry(address).or_insert((0, 0));
                continue;
            }
            let number = row.file_index();
            let file = match (known.get(&number), row.file(header)) {
                (Some(index), _) => *index,
                (None, Some(entry)) => {
                    let name = dwarf.attr_string(unit, entry.path_name())?;
                    self.files.push(name.to_string_lossy().into_owned());
                    known.insert(number, self.files.len() - 1);
                    self.files.len() - 1
                }
                (None, None) => continue,
            };
            let line = row.line().map_or(0, |line| line.get() as u32);
            if line != 0 {
                self.rows.insert(address, (file, line));
            }
        }
        Ok(())
    }

    /// File and line of the instruction at an address.
    pub fn at(&self, address: u32) -> Option<(String, u32)> {
        let (_, (file, line)) = self.rows.range(..=address).next_back()?;
        let name = self.files.get(*file)?;
        (*line != 0).then(|| (name.clone(), *line))
    }
}
