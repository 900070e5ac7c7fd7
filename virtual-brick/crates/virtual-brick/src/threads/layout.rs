// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where the fields lie in a thread's control block, told by the program itself.

use image::{Image, Symbol};

pub(super) const RUNNING: &str = "ravenbrick_running_thread";
pub(super) const FIRST: &str = "ravenbrick_first_thread";
const LAYOUT: &str = "ravenbrick_thread_layout";
const VERSION: u32 = 1;
const WORDS: usize = 11;

/// Addresses of the two list words and byte offsets of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub running_address: u32,
    pub first_address: u32,
    pub next: u32,
    pub name_address: u32,
    pub name_length: u32,
    pub base_priority: u32,
    pub state: u32,
    pub wake_time: u32,
    pub stack_base: u32,
    pub stack_size: u32,
}

impl Layout {
    /// The layout that the image states, or why threads cannot be observed.
    pub(crate) fn of(image: &Image) -> Result<Self, String> {
        let running_address = symbol(image, RUNNING)?.address;
        let first_address = symbol(image, FIRST)?.address;
        let table = symbol(image, LAYOUT)?;
        let words = words(image, table.address)
            .ok_or_else(|| format!("`{LAYOUT}` has no {WORDS} words of contents"))?;
        if words[0] != VERSION {
            return Err(format!(
                "`{LAYOUT}` has version {}, expected {VERSION}",
                words[0]
            ));
        }
        let size = words[1];
        if let Some(offset) = words[2..]
            .iter()
            .find(|&&offset| offset % 4 != 0 || offset >= size)
        {
            return Err(format!(
                "`{LAYOUT}` names offset {offset} in a block of {size} bytes"
            ));
        }
        Ok(Self {
            running_address,
            first_address,
            next: words[2],
            name_address: words[3],
            name_length: words[4],
            base_priority: words[5],
            state: words[7],
            wake_time: words[8],
            stack_base: words[9],
            stack_size: words[10],
        })
    }
}

fn symbol(image: &Image, name: &str) -> Result<Symbol, String> {
    image.symbols().get(name).ok_or_else(|| {
        format!("the image has no symbol `{name}`; it was not linked with the run-time")
    })
}

fn words(image: &Image, address: u32) -> Option<[u32; WORDS]> {
    let segment = image.segments().iter().find(|segment| {
        address >= segment.address
            && (address - segment.address) as usize + 4 * WORDS <= segment.bytes.len()
    })?;
    let bytes = &segment.bytes[(address - segment.address) as usize..];
    let mut words = [0; WORDS];
    for (word, chunk) in words.iter_mut().zip(bytes.chunks_exact(4)) {
        *word = u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
    }
    Some(words)
}
