// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bytes that are loaded, by segment and by section.

use object::read::elf::ProgramHeader;
use object::{elf, LittleEndian, Object, ObjectSection, SectionFlags, SectionKind};

use crate::error::ImageError;
use crate::Elf;

/// A range of memory and the bytes to load into it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Physical address, where the bytes are loaded.
    pub address: u32,
    /// Virtual address, where they lie while the program runs.
    pub virtual_address: u32,
    /// Bytes of memory; what the contents do not fill is zero.
    pub memory_size: u32,
    /// Contents, maybe none.
    pub bytes: Vec<u8>,
}

/// A section that is loaded with contents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section<'a> {
    /// Address while the program runs.
    pub address: u32,
    /// Contents.
    pub bytes: &'a [u8],
    /// Stores may change it.
    pub writable: bool,
    /// It has instructions.
    pub executable: bool,
}

pub(super) fn read(file: &Elf<'_>) -> Result<Vec<Segment>, ImageError> {
    let mut segments = Vec::new();
    for header in file.elf_program_headers() {
        let memory_size = header.p_memsz(LittleEndian);
        if header.p_type(LittleEndian) != elf::PT_LOAD || memory_size == 0 {
            continue;
        }
        let bytes = header.data(LittleEndian, file.data()).map_err(|()| {
            let length = file.data().len();
            ImageError::Truncated {
                length,
                missing: "the contents of a segment are",
            }
        })?;
        segments.push(Segment {
            address: header.p_paddr(LittleEndian),
            virtual_address: header.p_vaddr(LittleEndian),
            memory_size,
            bytes: bytes.to_vec(),
        });
    }
    if segments.iter().all(|segment| segment.bytes.is_empty()) {
        return Err(ImageError::Empty);
    }
    segments.sort_by_key(|segment| segment.address);
    Ok(segments)
}

pub(super) fn sections<'data>(file: &Elf<'data>) -> Vec<Section<'data>> {
    let loaded = file.sections().filter_map(|section| {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
            return None;
        };
        let absent = matches!(
            section.kind(),
            SectionKind::UninitializedData | SectionKind::Other | SectionKind::Metadata
        );
        let has = |flag: elf::SectionFlags| sh_flags.0 & flag.0 != 0;
        (!absent && has(elf::SHF_ALLOC)).then_some(Section {
            address: section.address() as u32,
            bytes: section.data().ok()?,
            writable: has(elf::SHF_WRITE),
            executable: has(elf::SHF_EXECINSTR),
        })
    });
    loaded.collect()
}

/// The one segment of a file without headers.
pub(super) fn binary(bytes: &[u8], address: u32) -> Result<Segment, ImageError> {
    if bytes.is_empty() {
        return Err(ImageError::Empty);
    }
    Ok(Segment {
        address,
        virtual_address: address,
        memory_size: u32::try_from(bytes.len()).map_err(ImageError::malformed)?,
        bytes: bytes.to_vec(),
    })
}

/// The entry, when it lies in loaded contents.
pub(super) fn entry(file: &Elf<'_>, segments: &[Segment]) -> Result<u32, ImageError> {
    let entry = file.entry() as u32;
    let address = entry & !1;
    let inside = segments.iter().any(|segment| {
        let offset = address.checked_sub(segment.address);
        offset.is_some_and(|offset| (offset as usize) < segment.bytes.len())
    });
    if inside {
        Ok(entry)
    } else {
        Err(ImageError::EntryOutside { entry })
    }
}
