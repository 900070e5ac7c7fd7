// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reads the members of a .tar.xz archive.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

const BLOCK: usize = 512;
const NAME: std::ops::Range<usize> = 0..100;
const SIZE: std::ops::Range<usize> = 124..136;

/// One file of an archive.
pub struct Member {
    pub name: String,
    pub content: Vec<u8>,
}

/// All regular files of the archive, in its order.
pub fn read(path: &Path) -> Result<Vec<Member>, String> {
    let file = File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut tar = Vec::new();
    lzma_rs::xz_decompress(&mut BufReader::new(file), &mut tar)
        .map_err(|error| format!("{}: {error}", path.display()))?;
    members(&tar).map_err(|error| format!("{}: {error}", path.display()))
}

/// Walks the headers of a ustar archive (POSIX.1-1988): name, octal size, content in blocks.
fn members(tar: &[u8]) -> Result<Vec<Member>, String> {
    let mut members = Vec::new();
    let mut position = 0;
    while let Some(header) = tar.get(position..position + BLOCK) {
        if header[0] == 0 {
            break;
        }
        let name = text(&header[NAME]);
        let size = usize::from_str_radix(&text(&header[SIZE]), 8)
            .map_err(|error| format!("size of member {name}: {error}"))?;
        position += BLOCK;
        let content = tar
            .get(position..position + size)
            .ok_or_else(|| format!("member {name} is cut off"))?
            .to_vec();
        position += size.div_ceil(BLOCK) * BLOCK;
        members.push(Member { name, content });
    }
    Ok(members)
}

fn text(field: &[u8]) -> String {
    let end = field
        .iter()
        .position(|&byte| byte == 0)
        .unwrap_or(field.len());
    String::from_utf8_lossy(&field[..end]).trim().to_owned()
}
