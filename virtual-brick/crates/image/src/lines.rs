// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Source lines by address, from the line number programs (DWARF 5, section 6.2).

use std::collections::BTreeMap;
use std::ops::Range;

use gimli::{Dwarf, IncompleteLineProgram, LineProgramHeader, Unit};
use object::{Object, ObjectSection, SectionKind};

use crate::error::ImageError;
use crate::{debug_information, Elf, Reader};

/// Where the code at an address comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// Path of the source file, as the compiler was given it.
    pub file: &'a str,
    /// Line, from 1.
    pub line: u32,
    /// Column, from 1; 0 when unknown.
    pub column: u32,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    file: usize,
    /// 0 for code of no line.
    line: u32,
    column: u32,
}

/// The line table of an image. The file also has rows of sections that the linker discarded, from
/// address 0 on: only addresses in the image's code have lines.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    files: Vec<String>,
    rows: BTreeMap<u32, Row>,
    code: Vec<Range<u32>>,
}

impl Lines {
    pub(crate) fn read(file: &Elf<'_>) -> Result<Self, ImageError> {
        let code = file.sections().filter(|s| s.kind() == SectionKind::Text);
        let end = |start: u64, size| start.saturating_add(size) as u32;
        let mut lines = Self {
            code: code
                .map(|s| s.address() as u32..end(s.address(), s.size()))
                .collect(),
            ..Self::default()
        };
        debug_information(file)
            .and_then(|dwarf| lines.add_units(&dwarf))
            .map_err(ImageError::debug_information)?;
        Ok(lines)
    }

    fn add_units(&mut self, dwarf: &Dwarf<Reader<'_>>) -> Result<(), gimli::Error> {
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
        dwarf: &Dwarf<Reader<'_>>,
        unit: &Unit<Reader<'_>>,
        program: IncompleteLineProgram<Reader<'_>>,
    ) -> Result<(), gimli::Error> {
        let mut known = BTreeMap::new();
        let mut sequence: BTreeMap<u32, Row> = BTreeMap::new();
        let mut rows = program.rows();
        while let Some((header, row)) = rows.next_row()? {
            let address = row.address() as u32;
            let mut entry = Row {
                file: 0,
                line: 0,
                column: 0,
            };
            if row.end_sequence() {
                sequence.remove(&address);
                if !sequence.is_empty() {
                    self.rows.extend(std::mem::take(&mut sequence));
                    self.rows.entry(address).or_insert(entry);
                }
                continue;
            }
            let number = row.file_index();
            if let (None, Some(file)) = (known.get(&number), row.file(header)) {
                self.files.push(path(dwarf, unit, header, file)?);
                known.insert(number, self.files.len() - 1);
            }
            if let (Some(file), Some(line)) = (known.get(&number), row.line()) {
                entry.file = *file;
                entry.line = line.get() as u32;
                entry.column = match row.column() {
                    gimli::ColumnType::LeftEdge => 0,
                    gimli::ColumnType::Column(column) => column.get() as u32,
                };
            }
            sequence.insert(address, entry);
        }
        Ok(())
    }

    /// Addresses at which source lines begin, in order, each with its line.
    pub fn begins(&self) -> impl Iterator<Item = (u32, Line<'_>)> {
        let addresses = self.rows.keys();
        addresses.filter_map(|address| Some((*address, self.at(*address)?)))
    }

    /// The source line of the instruction at an address.
    #[must_use]
    pub fn at(&self, address: u32) -> Option<Line<'_>> {
        self.code.iter().find(|range| range.contains(&address))?;
        let (_, row) = self.rows.range(..=address).next_back()?;
        (row.line != 0).then_some(Line {
            file: self.files.get(row.file)?,
            line: row.line,
            column: row.column,
        })
    }
}

/// Path of a source file: under its directory, which is under that of the compilation.
fn path(
    dwarf: &Dwarf<Reader<'_>>,
    unit: &Unit<Reader<'_>>,
    header: &LineProgramHeader<Reader<'_>>,
    file: &gimli::FileEntry<Reader<'_>>,
) -> Result<String, gimli::Error> {
    let mut path = unit.comp_dir.map_or_else(String::new, |directory| {
        directory.to_string_lossy().into_owned()
    });
    // Number 0 is the directory of the compilation.
    let directory = file
        .directory(header)
        .filter(|_| file.directory_index() != 0);
    for part in directory.into_iter().chain([file.path_name()]) {
        let part = dwarf.attr_string(unit, part)?.to_string_lossy();
        if part.starts_with('/') {
            path.clear();
        } else if !path.is_empty() && !path.ends_with('/') {
            path.push('/');
        }
        path.push_str(&part);
    }
    Ok(path)
}
