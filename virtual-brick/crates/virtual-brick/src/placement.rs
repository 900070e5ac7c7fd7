// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Memory for which a program is linked, checked against the memory map (AT91SAM7S256 datasheet,
//! section 8).

use std::fmt;
use std::ops::Range;

use at91sam7s::AddressError;
use image::Image;

const RAM_START: u32 = 0x0020_0000;
const RAM_END: u32 = 0x0021_0000;
const FLASH_START: u32 = 0x0010_0000;
const FLASH_END: u32 = 0x0014_0000;

/// Kind of image, decided from the segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placement {
    /// Loaded into RAM and started at its entry, by the boot monitor or, where that keeps the first
    /// 8 KB for itself, by a debug probe: both leave the chip in the same state.
    Ram,
    /// Programmed into flash and started at power-on.
    Flash,
}

/// An image that does not fit the brick's memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlacementError {
    /// A segment lies outside the memory that the brick has for programs.
    SegmentOutside {
        /// First address of the segment.
        address: u32,
        /// Bytes in memory.
        length: u32,
    },
    /// A segment runs over the end of its memory.
    TooLarge {
        /// `RAM` or `flash`.
        memory: &'static str,
        /// Bytes that memory offers to programs.
        capacity: u32,
        /// Bytes over the end.
        over: u64,
    },
    /// Some segments are loaded into flash, others into RAM.
    FlashAndRam,
    /// The chip has no memory there.
    NoMemory(AddressError),
}

impl fmt::Display for PlacementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SegmentOutside { address, length } => write!(
                f,
                "a segment of {length} bytes at {address:#010X} lies outside the memory for \
                 programs: RAM 0x00200000 to 0x0020FFFF, flash 0x00100000 to 0x0013FFFF; \
                 link with one of the brick's linker scripts"
            ),
            Self::TooLarge {
                memory,
                capacity,
                over,
            } => write!(
                f,
                "the image is {over} bytes too large for the {capacity} bytes of {memory}"
            ),
            Self::FlashAndRam => f.write_str(
                "the image loads segments both into flash and into RAM; give initialised data a \
                 load address in flash",
            ),
            Self::NoMemory(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for PlacementError {}

/// RAM or flash: a flash image has at least one segment in flash and none loaded into RAM.
pub(crate) fn of(image: &Image) -> Result<Placement, PlacementError> {
    let (mut flash, mut ram) = (false, false);
    for segment in image.segments() {
        check_run_time_memory(segment.virtual_address, segment.memory_size)?;
        if !segment.bytes.is_empty() {
            check_load_memory(segment.address, segment.bytes.len() as u32)?;
            flash |= in_flash(segment.address);
            ram |= !in_flash(segment.address);
        }
    }
    match (flash, ram) {
        (true, true) => Err(PlacementError::FlashAndRam),
        (true, false) => Ok(Placement::Flash),
        (false, _) => Ok(Placement::Ram),
    }
}

fn in_flash(address: u32) -> bool {
    (FLASH_START..FLASH_END).contains(&address)
}

fn check_load_memory(address: u32, length: u32) -> Result<(), PlacementError> {
    if in_flash(address) {
        fits("flash", FLASH_START..FLASH_END, address, length)
    } else if (RAM_START..RAM_END).contains(&address) {
        fits("RAM", RAM_START..RAM_END, address, length)
    } else {
        Err(PlacementError::SegmentOutside { address, length })
    }
}

/// Where a segment lies while the program runs: the remapped vectors at 0 are allowed here.
fn check_run_time_memory(address: u32, length: u32) -> Result<(), PlacementError> {
    if address < RAM_END - RAM_START {
        fits("RAM", 0..RAM_END - RAM_START, address, length)
    } else {
        check_load_memory(address, length)
    }
}

fn fits(
    memory: &'static str,
    addresses: Range<u32>,
    address: u32,
    length: u32,
) -> Result<(), PlacementError> {
    let end = u64::from(address) + u64::from(length);
    let over = end.saturating_sub(u64::from(addresses.end));
    if over > 0 {
        return Err(PlacementError::TooLarge {
            memory,
            capacity: addresses.end - addresses.start,
            over,
        });
    }
    Ok(())
}
