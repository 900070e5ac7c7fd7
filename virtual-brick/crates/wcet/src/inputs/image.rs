// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the analysis needs from an ELF file: code, constants, symbols, mapping symbols, lines.

use crate::error::{Error, Place};
use crate::inputs::lines::Lines;
use arm7tdmi::Instruction;
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind};
use std::collections::BTreeMap;

const SHF_WRITE: u64 = 1;
const SHF_ALLOC: u64 = 2;
const SHF_EXECINSTR: u64 = 4;

struct Section {
    start: u32,
    bytes: Vec<u8>,
    writable: bool,
    executable: bool,
}

/// What a mapping symbol says about the bytes that follow (ELF for the Arm architecture, 5.5.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Arm,
    Thumb,
    Data,
}

/// A function by its symbol.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Function {
    names: Vec<String>,
    size: u32,
    thumb: bool,
}

/// An executable in memory.
pub struct Image {
    sections: Vec<Section>,
    functions: BTreeMap<u32, Function>,
    objects: BTreeMap<String, (u32, u32)>,
    mapping: BTreeMap<u32, Content>,
    lines: Lines,
}

fn loaded(section: &object::read::elf::ElfSection32<'_, '_>) -> Option<Section> {
    let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
        return None;
    };
    let present = !matches!(
        section.kind(),
        SectionKind::UninitializedData | SectionKind::Other | SectionKind::Metadata
    );
    let sh_flags = sh_flags.0;
    let allocated = sh_flags & SHF_ALLOC != 0;
    if !present || !allocated {
        return None;
    }
    Some(Section {
        start: section.address() as u32,
        bytes: section.data().ok()?.to_vec(),
        writable: sh_flags & SHF_WRITE != 0,
        executable: sh_flags & SHF_EXECINSTR != 0,
    })
}

impl Image {
    /// Reads a 32-bit little-endian ELF file.
    pub fn read(bytes: &[u8]) -> Result<Self, Error> {
        let file: ElfFile32<'_> =
            ElfFile32::parse(bytes).map_err(|error| Error::Input(format!("ELF file: {error}")))?;
        let mut image = Self {
            sections: file.sections().filter_map(|s| loaded(&s)).collect(),
            functions: BTreeMap::new(),
            objects: BTreeMap::new(),
            mapping: BTreeMap::new(),
            lines: Lines::read(&file)?,
        };
        for symbol in file.symbols().filter(|symbol| !symbol.is_undefined()) {
            let (Ok(name), address) = (symbol.name(), symbol.address() as u32) else {
                continue;
            };
            if let Some(content) = mapping_symbol(name) {
                image.mapping.insert(address, content);
            } else if symbol.kind() == SymbolKind::Text {
                image.add_function(name, address, symbol.size() as u32);
            } else if symbol.kind() == SymbolKind::Data {
                let place = (address, symbol.size() as u32);
                image.objects.entry(name.to_owned()).or_insert(place);
            }
        }
        Ok(image)
    }

    fn add_function(&mut self, name: &str, address: u32, size: u32) {
        let entry = self.functions.entry(address & !1).or_insert(Function {
            names: Vec::new(),
            size: 0,
            thumb: address & 1 != 0,
        });
        entry.names.push(name.to_owned());
        entry.names.sort();
        entry.size = entry.size.max(size);
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
        let content = self.mapping.range(..=address).next_back();
        let fits = match content {
            Some((_, Content::Data)) => false,
            Some((start, Content::Arm)) => !thumb || *start < section.start,
            Some((start, Content::Thumb)) => thumb || *start < section.start,
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

    /// Address and state of a function.
    pub fn function(&self, name: &str) -> Option<(u32, bool)> {
        let found = self.functions.iter();
        let mut named = found.filter(|(_, f)| f.names.iter().any(|known| known == name));
        named.next().map(|(address, f)| (*address, f.thumb))
    }

    /// Address and size of a variable.
    pub fn object(&self, name: &str) -> Option<(u32, u32)> {
        self.objects.get(name).copied()
    }

    /// Is this the first instruction of a function?
    pub fn starts_function(&self, address: u32) -> bool {
        self.functions.contains_key(&address)
    }

    /// All names of the function an address lies in.
    pub fn names_at(&self, address: u32) -> Vec<&str> {
        self.containing(address)
            .map(|(_, f)| f.names.iter().map(String::as_str).collect())
            .unwrap_or_default()
    }

    fn containing(&self, address: u32) -> Option<(u32, &Function)> {
        let (start, function) = self.functions.range(..=address).next_back()?;
        let end = start.saturating_add(function.size.max(1));
        (function.size == 0 || address < end).then_some((*start, function))
    }

    /// Function and offset, file and line.
    pub fn place(&self, address: u32) -> Place {
        Place {
            address,
            symbol: self
                .containing(address)
                .and_then(|(start, f)| Some((f.names.first()?.clone(), address - start))),
            line: self.lines.at(address),
        }
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

    /// Names, addresses and states of all functions, by address.
    pub fn functions(&self) -> impl Iterator<Item = (&str, u32, bool)> {
        self.functions.iter().filter_map(|(address, function)| {
            Some((function.names.first()?.as_str(), *address, function.thumb))
        })
    }
}

fn mapping_symbol(name: &str) -> Option<Content> {
    let kind = match name.get(..2)? {
        "$a" => Content::Arm,
        "$t" => Content::Thumb,
        "$d" => Content::Data,
        _ => return None,
    };
    let plain = name.len() == 2 || name.as_bytes().get(2) == Some(&b'.');
    plain.then_some(kind)
}
