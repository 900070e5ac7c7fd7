// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is loaded where, checked against the memory map (AT91SAM7S256 datasheet, section 8).

use object::read::elf::ProgramHeader;
use object::{elf, LittleEndian, Object};

use super::error::ImageError;
use super::Elf;

const RAM_START: u32 = 0x0020_0000;
/// The boot monitor keeps the RAM below: nothing can be loaded there.
const RAM_LOAD_START: u32 = 0x0020_2000;
const RAM_END: u32 = 0x0021_0000;
const FLASH_START: u32 = 0x0010_0000;
const FLASH_END: u32 = 0x0014_0000;

/// Bytes to load at an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Physical address.
    pub address: u32,
    /// Contents.
    pub bytes: Vec<u8>,
}

/// Kind of image, decided from the segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// Loaded into RAM and started at its entry by the boot monitor.
    Ram,
    /// Programmed into flash and started at power-on.
    Flash,
}

/// Segments with contents; every segment's memory is checked.
pub(super) fn read(file: &Elf<'_>) -> Result<Vec<Segment>, ImageError> {
    let mut segments = Vec::new();
    for header in file.elf_program_headers() {
        if header.p_type(LittleEndian) != elf::PT_LOAD || header.p_memsz(LittleEndian) == 0 {
            continue;
        }
        check_run_time_memory(header.p_vaddr(LittleEndian), header.p_memsz(LittleEndian))?;
        let bytes = header.data(LittleEndian, file.data()).map_err(|()| {
            let length = file.data().len();
            ImageError::Truncated {
                length,
                missing: "the contents of a segment are",
            }
        })?;
        if bytes.is_empty() {
            continue;
        }
        let address = header.p_paddr(LittleEndian);
        check_load_memory(address, bytes.len() as u32)?;
        segments.push(Segment {
            address,
            bytes: bytes.to_vec(),
        });
    }
    segments.sort_by_key(|segment| segment.address);
    Ok(segments)
}

/// The one segment of a file without headers.
pub(super) fn binary(bytes: &[u8], address: u32) -> Result<Vec<Segment>, ImageError> {
    if bytes.is_empty() {
        return Err(ImageError::Empty);
    }
    let length = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
    check_load_memory(address, length)?;
    Ok(vec![Segment {
        address,
        bytes: bytes.to_vec(),
    }])
}

/// RAM or flash: a flash image has at least one segment in flash and none loaded into RAM.
pub(super) fn placement(segments: &[Segment]) -> Result<Placement, ImageError> {
    let first = segments.first().ok_or(ImageError::Empty)?;
    let last = segments.last().ok_or(ImageError::Empty)?;
    match (in_flash(first.address), in_flash(last.address)) {
        (true, true) => Ok(Placement::Flash),
        (false, false) => Ok(Placement::Ram),
        _ => Err(ImageError::Malformed {
            detail: "segments are to be loaded both into flash and into RAM; give initialised \
                     data a load address in flash"
                .to_owned(),
        }),
    }
}

/// The entry, when it lies in loaded contents.
pub(super) fn entry(file: &Elf<'_>, segments: &[Segment]) -> Result<u32, ImageError> {
    let entry = file.entry() as u32;
    let address = u64::from(entry & !1);
    let inside = segments.iter().any(|segment| {
        let start = u64::from(segment.address);
        address >= start && address < start + segment.bytes.len() as u64
    });
    if inside {
        Ok(entry)
    } else {
        Err(ImageError::EntryOutside { entry })
    }
}

fn in_flash(address: u32) -> bool {
    (FLASH_START..FLASH_END).contains(&address)
}

fn check_load_memory(address: u32, length: u32) -> Result<(), ImageError> {
    if in_flash(address) {
        fits("flash", FLASH_START, FLASH_END, address, length)
    } else if (RAM_LOAD_START..RAM_END).contains(&address) {
        fits("RAM", RAM_LOAD_START, RAM_END, address, length)
    } else {
        Err(ImageError::SegmentOutside { address, length })
    }
}

/// Where a segment lies while the program runs: RAM below the load area and the remapped
/// vectors at 0 are allowed here.
fn check_run_time_memory(address: u32, length: u32) -> Result<(), ImageError> {
    if in_flash(address) {
        fits("flash", FLASH_START, FLASH_END, address, length)
    } else if (RAM_START..RAM_END).contains(&address) {
        fits("RAM", RAM_LOAD_START, RAM_END, address, length)
    } else if address < RAM_END - RAM_START {
        fits("RAM", 0, RAM_END - RAM_START, address, length)
    } else {
        Err(ImageError::SegmentOutside { address, length })
    }
}

fn fits(
    memory: &'static str,
    start: u32,
    end: u32,
    address: u32,
    length: u32,
) -> Result<(), ImageError> {
    let over = (u64::from(address) + u64::from(length)).saturating_sub(u64::from(end));
    if over > 0 {
        return Err(ImageError::TooLarge {
            memory,
            capacity: end - start,
            over,
        });
    }
    Ok(())
}
