// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The program under analysis: instructions, constants and places of its ELF file.

use crate::error::{Error, Place};
use crate::inputs::annotations::{is_of_path, Fact};
use arm7tdmi::Instruction;
use image::Content;
use std::collections::BTreeSet;

/// Entry of a function: address and state (Thumb or not).
pub type Entry = (u32, bool);

struct Section {
    start: u32,
    bytes: Vec<u8>,
    writable: bool,
    executable: bool,
}

/// An executable in memory.
pub struct Image {
    file: image::Image,
    sections: Vec<Section>,
    lines: image::Lines,
}

impl Image {
    /// Reads a linked 32-bit little-endian ELF file for ARM.
    pub fn read(elf: &[u8]) -> Result<Self, Error> {
        let wrong = |error: image::ImageError| Error::Input(format!("ELF file: {error}"));
        Self::of_file(image::Image::parse(elf).map_err(wrong)?).map_err(wrong)
    }

    pub(crate) fn of_file(file: image::Image) -> Result<Self, image::ImageError> {
        let sections = file.sections().into_iter().map(|section| Section {
            start: section.address,
            bytes: section.bytes.to_vec(),
            writable: section.writable,
            executable: section.executable,
        });
        Ok(Self {
            sections: sections.collect(),
            lines: file.read_lines()?,
            file,
        })
    }

    fn section(&self, address: u32) -> Option<(&Section, usize)> {
        self.sections.iter().find_map(|section| {
            let offset = address.checked_sub(section.start)? as usize;
            (offset < section.bytes.len()).then_some((section, offset))
        })
    }

    fn bytes<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        let (section, offset) = self.section(address)?;
        section.bytes.get(offset..)?.first_chunk().copied()
    }

    /// A number that no store changes: from a section that is not writable.
    pub fn constant(&self, address: u32, size: u32) -> Option<u32> {
        let (section, _) = self.section(address)?;
        if section.writable {
            return None;
        }
        match size {
            1 => self.bytes::<1>(address).map(|[byte]| u32::from(byte)),
            2 => self
                .bytes::<2>(address & !1)
                .map(|b| u32::from(u16::from_le_bytes(b))),
            _ => self.bytes::<4>(address & !3).map(u32::from_le_bytes),
        }
    }

    /// The instruction at an address, unless there is none or data.
    pub fn instruction(&self, address: u32, thumb: bool) -> Option<Instruction> {
        let (section, _) = self.section(address)?;
        let fits = match self.file.symbols().content_at(address) {
            Some((_, Content::Data)) => false,
            Some((start, content)) => thumb == (content == Content::Thumb) || start < section.start,
            None => true,
        };
        if !section.executable || !fits {
            return None;
        }
        Some(if thumb {
            Instruction::thumb(u16::from_le_bytes(self.bytes(address)?))
        } else {
            Instruction::arm(u32::from_le_bytes(self.bytes(address)?))
        })
    }

    /// Address and state (Thumb or not) of a function.
    pub fn function(&self, name: &str) -> Option<Entry> {
        let mut functions = self.file.symbols().functions().iter();
        let named = functions.find(|(_, f)| f.names.iter().any(|known| known == name));
        named.map(|(address, function)| (*address, function.thumb))
    }

    /// Functions with this name; one that begins with `*` stands for all names that end so, with
    /// or without the number by which GNAT tells overloaded subprograms apart.
    pub fn functions(&self, name: &str) -> Vec<Entry> {
        let Some(end) = name.strip_prefix('*') else {
            return self.function(name).into_iter().collect();
        };
        let ends = |known: &String| {
            let digits = known.trim_end_matches(|c: char| c.is_ascii_digit());
            let plain = if digits.len() < known.len() {
                digits.strip_suffix("__").unwrap_or(known)
            } else {
                known
            };
            plain.ends_with(end)
        };
        let functions = self.file.symbols().functions().iter();
        let named = functions.filter(|(_, function)| function.names.iter().any(ends));
        named.map(|(address, f)| (*address, f.thumb)).collect()
    }

    /// Functions in whose calls alone a fact holds; none if it holds in any.
    pub fn within(&self, fact: &Fact) -> Option<Vec<Entry>> {
        let name = fact.within.as_deref()?;
        Some(self.functions(name))
    }

    /// Address and size of a variable.
    pub fn variable(&self, name: &str) -> Option<(u32, u32)> {
        let symbol = self.file.symbols().get(name)?;
        Some((symbol.address, symbol.size)).filter(|(address, _)| !self.starts_function(*address))
    }

    /// Is this the first instruction of a function?
    pub fn starts_function(&self, address: u32) -> bool {
        self.file.symbols().functions().contains_key(&address)
    }

    /// All names of the function an address lies in.
    pub fn names_at(&self, address: u32) -> &[String] {
        let function = self.file.symbols().function_at(address);
        function.map_or(&[], |(_, function)| &function.names)
    }

    /// The alphabetically first name of the function an address lies in; else the address.
    pub fn name_at(&self, address: u32) -> String {
        let names = self.names_at(address).iter();
        names
            .min()
            .map_or_else(|| format!("{address:#010x}"), String::clone)
    }

    /// Function and offset, file name and line.
    pub fn place(&self, address: u32) -> Place {
        let function = self.file.symbols().function_at(address);
        let line = self.lines.at(address);
        Place {
            address,
            symbol: function
                .and_then(|(start, f)| Some((f.names.iter().min()?.clone(), address - start))),
            line: line.map(|line| {
                let name = line.file.rsplit('/').next().unwrap_or_default();
                (name.to_owned(), line.line)
            }),
        }
    }

    /// Lines with code of a source file, by its name as facts give it.
    pub fn lines_of(&self, file: &str) -> BTreeSet<u32> {
        let begins = self.lines.begins().map(|(address, _)| self.place(address));
        let lines = begins.filter_map(|place| place.line);
        let its = lines.filter(|(path, _)| is_of_path(path, file));
        its.map(|(_, line)| line).collect()
    }

    /// Instructions at which the place of a fact begins: of a function the first, or the one with
    /// the fact's offset; of a line all at which it begins.
    pub fn addresses_of(&self, fact: &Fact) -> Vec<u32> {
        if let Some(name) = &fact.symbol {
            let entries = self.functions(name).into_iter();
            let offset = fact.offset.unwrap_or(0);
            return entries.map(|(address, _)| address + offset).collect();
        }
        let begins = self.lines.begins().map(|(address, _)| address);
        let its = begins.filter(|address| fact.matches(&self.place(*address), &[], None));
        its.collect()
    }

    /// First address and bytes of everything that is loaded.
    pub fn contents(&self) -> impl Iterator<Item = (u32, &[u8])> {
        let sections = self.sections.iter();
        sections.map(|section| (section.start, section.bytes.as_slice()))
    }

    /// First addresses of all sections with code.
    pub fn code_sections(&self) -> impl Iterator<Item = u32> + '_ {
        let code = self.sections.iter().filter(|section| section.executable);
        code.map(|section| section.start)
    }
}
