// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! First look at the ELF header (System V ABI, chapter 4; machine 40 from ELF for the ARM
//! architecture), to say in a sentence what a wrong file is.

use crate::error::ImageError;

const HEADER_LENGTH: usize = 52;
const MAGIC: &[u8] = b"\x7FELF";
const MACHINE_ARM: u16 = 40;
const TYPE_EXECUTABLE: u16 = 2;

pub(crate) fn check(elf: &[u8]) -> Result<(), ImageError> {
    let length = elf.len();
    if !elf.starts_with(&MAGIC[..length.min(MAGIC.len())]) {
        return Err(ImageError::NotElf);
    }
    let header = elf.get(..HEADER_LENGTH).ok_or(ImageError::Truncated {
        length,
        missing: "the ELF header is",
    })?;
    let machine = half(header, 18);
    let wrong = |found: String| Err(ImageError::WrongMachine { found });
    match (header[4], header[5], machine, half(header, 16)) {
        (2, _, _, _) => wrong("64-bit".to_owned()),
        (1, 2, _, _) => wrong("big-endian".to_owned()),
        (1, 1, MACHINE_ARM, TYPE_EXECUTABLE) => Ok(()),
        (1, 1, MACHINE_ARM, 1) => wrong("an object file that was not linked".to_owned()),
        (1, 1, MACHINE_ARM, kind) => wrong(format!("of ELF type {kind}, not an executable")),
        (1, 1, machine, _) => wrong(format!("for ELF machine {machine}, ARM is 40")),
        (class, data, _, _) => wrong(format!("of ELF class {class} and data encoding {data}")),
    }
}

fn half(header: &[u8], offset: usize) -> u16 {
    u16::from_le_bytes([header[offset], header[offset + 1]])
}
