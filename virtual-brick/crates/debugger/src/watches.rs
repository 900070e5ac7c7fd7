// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Watchpoints on memory and on registers of peripherals.
//!
//! GDB itself judges a watchpoint for writes: it goes on without a word when the value that it
//! reads is the old one. Memory is therefore compared here too. A register of a peripheral often
//! cannot be read back, so a write to it is reported as a signal with a line on GDB's console.

use gdbstub::target::ext::breakpoints::WatchKind;
use virtual_brick::{Access, VirtualBrick};

/// Below this address lies what the remap shows: flash, or after the remap the RAM.
const ALIAS_END: u32 = 0x10_0000;
const RAM: u32 = 0x20_0000;
const RAM_MASK: u32 = 0xFFFF;

/// Memory or registers that are watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Watch {
    pub address: u32,
    pub length: u32,
    pub kind: WatchKind,
}

impl Watch {
    fn matches(&self, access: Access) -> bool {
        let kind = match self.kind {
            WatchKind::Write => access.written.is_some(),
            WatchKind::Read => access.written.is_none(),
            WatchKind::ReadWrite => true,
        };
        // The bus ignores the low bits of an address that is no multiple of the width.
        let first = u64::from(unaliased(access.address & !(access.width_bytes - 1)));
        let watched = u64::from(unaliased(self.address));
        kind && first < watched + u64::from(self.length)
            && watched < first + u64::from(access.width_bytes)
    }

    /// Bytes of RAM or flash; none where registers of peripherals are watched.
    pub(crate) fn memory(&self, brick: &VirtualBrick) -> Option<Vec<u8>> {
        let length = self.length as usize;
        brick.read_memory(unaliased(self.address), length).ok()
    }
}

/// The RAM appears at address 0 after the remap and repeats itself.
fn unaliased(address: u32) -> u32 {
    if address < ALIAS_END || address >> 20 == RAM >> 20 {
        RAM | address & RAM_MASK
    } else {
        address
    }
}

/// How watched bytes were accessed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HitKind {
    /// The processor accessed memory.
    Memory,
    /// The processor accessed a register of a peripheral.
    Register(Access),
    /// The peripheral data controller wrote memory.
    Transfer,
}

/// A watchpoint that was hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Watched {
    pub watch: Watch,
    meeting: HitKind,
}

impl Watched {
    /// GDB would go on without a word if this were reported as a watchpoint.
    pub(crate) fn needs_signal(&self) -> bool {
        self.watch.kind == WatchKind::Write && matches!(self.meeting, HitKind::Register(_))
    }

    /// What GDB does not show by itself.
    pub(crate) fn notice(&self) -> Option<String> {
        match self.meeting {
            HitKind::Memory => None,
            HitKind::Register(Access {
                address,
                width_bytes,
                written: Some(value),
            }) => {
                let digits = 2 * width_bytes as usize;
                let value = u64::from(value) & ((1 << (8 * width_bytes)) - 1);
                Some(format!(
                    "watched register: the program writes 0x{value:0digits$x} to 0x{address:08x}\n"
                ))
            }
            HitKind::Register(Access { address, .. }) => Some(format!(
                "watched register: the program reads 0x{address:08x}\n"
            )),
            HitKind::Transfer => Some(
                "watched memory: written by the peripheral data controller, not by the program\n"
                    .to_owned(),
            ),
        }
    }
}

/// Finds out around each step whether a watchpoint was hit. A write of memory that leaves the
/// value as it was is none.
#[derive(Clone, Debug)]
pub(crate) struct WatchState {
    watches: Vec<(Watch, Option<Vec<u8>>)>,
    accesses: Vec<Access>,
    transfers: u64,
}

impl WatchState {
    pub(crate) fn new(watches: &[Watch], brick: &VirtualBrick) -> Self {
        let watches = watches.iter().map(|watch| (*watch, watch.memory(brick)));
        Self {
            watches: watches.collect(),
            accesses: Vec::new(),
            transfers: brick.memory_transfers(),
        }
    }

    pub(crate) fn access(&mut self, access: Access) {
        let watches = &self.watches;
        if watches.iter().any(|(watch, _)| watch.matches(access)) {
            self.accesses.push(access);
        }
    }

    /// The watchpoint that was hit since this was last asked.
    #[inline]
    pub(crate) fn hit(&mut self, brick: &VirtualBrick) -> Option<Watched> {
        if self.accesses.is_empty() && self.transfers == brick.memory_transfers() {
            return None;
        }
        self.find(brick)
    }

    #[cold]
    fn find(&mut self, brick: &VirtualBrick) -> Option<Watched> {
        let accesses = std::mem::take(&mut self.accesses);
        let transferred = self.transfers != brick.memory_transfers();
        self.transfers = brick.memory_transfers();
        let mut hit = None;
        for (watch, value) in &mut self.watches {
            let access = accesses.iter().find(|access| watch.matches(**access));
            let now = watch.memory(brick);
            let in_memory = now.is_some();
            let changed = std::mem::replace(value, now) != *value;
            let writes = watch.kind != WatchKind::Read;
            let meeting = match access {
                Some(access) if !in_memory => HitKind::Register(*access),
                Some(_) if changed || watch.kind != WatchKind::Write => HitKind::Memory,
                None if changed && transferred && writes => HitKind::Transfer,
                _ => continue,
            };
            hit.get_or_insert(Watched {
                watch: *watch,
                meeting,
            });
        }
        hit
    }
}
