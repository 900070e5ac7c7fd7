// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Condition codes (DDI 0029E, section 4.2).

/// Bit `flags` (NZCV as a number) of entry `condition` tells whether the condition passes.
const CONDITIONS: [u16; 16] = condition_table();

/// Does the condition hold for these flags?
#[inline(always)]
pub(crate) const fn passes(condition: u32, n: bool, z: bool, c: bool, v: bool) -> bool {
    match condition {
        0x0 => z,
        0x1 => !z,
        0x2 => c,
        0x3 => !c,
        0x4 => n,
        0x5 => !n,
        0x6 => v,
        0x7 => !v,
        0x8 => c && !z,
        0x9 => !c || z,
        0xA => n == v,
        0xB => n != v,
        0xC => !z && n == v,
        0xD => z || n != v,
        0xE => true,
        _ => false,
    }
}

const fn condition_table() -> [u16; 16] {
    let mut table = [0; 16];
    let mut condition = 0;
    while condition < 16 {
        let mut flags = 0;
        while flags < 16 {
            let (n, z) = (flags & 8 != 0, flags & 4 != 0);
            let (c, v) = (flags & 2 != 0, flags & 1 != 0);
            if passes(condition as u32, n, z, c, v) {
                table[condition] |= 1 << flags;
            }
            flags += 1;
        }
        condition += 1;
    }
    table
}

/// Does `condition` (0 to 15) hold for `flags` (NZCV as a number, N the highest bit)?
#[inline]
pub const fn condition_passes(condition: u32, flags: u32) -> bool {
    (CONDITIONS[(condition & 15) as usize] >> (flags & 15)) & 1 != 0
}
