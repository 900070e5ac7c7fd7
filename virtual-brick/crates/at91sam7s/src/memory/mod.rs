// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! SRAM, flash and the memory controller: what lies where, what an access costs, who wants to
//! know of a write. Knows no peripheral and no board.
//!
//! Map (AT91SAM7S datasheet, 6175M, chapter 8): 1 MiB windows at 0 (flash, or SRAM after the
//! remap), 0x0010_0000 (flash), 0x0020_0000 (SRAM); each memory repeats through its window.

pub(crate) mod flash;
mod interrupted_programming;
pub(crate) mod mc;
pub(crate) mod sram;

use std::fmt;

use arm7tdmi::bus::Width;

use crate::clock::Cycles;
use crate::fault::{no_register, Access, FaultKind, TransferFault};
use crate::registers::registers;
use crate::timing::TimingProfile;
use flash::{Flash, FLASH_BYTES};
use mc::Mc;
use sram::Sram;

registers! {
    MC_RCR = 0x00, MC_ASR = 0x04, MC_AASR = 0x08, MC_FMR = 0x60, MC_FCR = 0x64, MC_FSR = 0x68,
}

/// Bits of an address within one window of the memory map.
pub(crate) const WINDOW_BITS: u32 = 20;
/// Number of the window in which the SRAM always appears.
pub(crate) const SRAM_WINDOW: u32 = 2;
const SRAM_BASE: u32 = SRAM_WINDOW << WINDOW_BITS;
const SRAM_BYTES: usize = 0x1_0000;
const FLASH_BASE: u32 = 0x0010_0000;

/// An address range that is not wholly inside SRAM or flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressError {
    /// First address of the range.
    pub address: u32,
    /// Its length in bytes.
    pub length: usize,
}

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} bytes at {:#010x} are not inside SRAM (0x00200000, 64 KiB) or flash \
             (0x00100000, 256 KiB)",
            self.length, self.address
        )
    }
}

impl std::error::Error for AddressError {}

/// The memories and their controllers.
#[derive(Clone, Debug)]
pub(crate) struct Memories {
    pub(crate) sram: Sram,
    pub(crate) flash: Flash,
    pub(crate) mc: Mc,
    pub(crate) timing: TimingProfile,
    /// Window number of the SRAM's second appearance: 0 when remapped, else that of the first.
    pub(crate) sram_alias: u32,
    /// Transfers that the data controller has stored in SRAM.
    pub(crate) transfers_stored: u64,
    /// Cycles that the data controller has taken from the processor and not yet charged.
    pub(crate) stolen: Cycles,
    /// When the data controller transferred, and for which peripheral, if that is logged.
    pub(crate) transfer_log: Option<Vec<(Cycles, &'static str)>>,
}

impl Memories {
    pub(crate) fn new(timing: &TimingProfile) -> Self {
        Self {
            sram: Sram::new(),
            flash: Flash::new(timing),
            mc: Mc::default(),
            timing: *timing,
            sram_alias: SRAM_WINDOW,
            transfers_stored: 0,
            stolen: 0,
            transfer_log: None,
        }
    }

    /// Registers back to their reset values; the contents stay.
    pub(crate) fn reset(&mut self) {
        self.flash.reset(&self.timing);
        self.mc = Mc::default();
        self.sram_alias = SRAM_WINDOW;
        self.flash.remapped();
    }

    #[inline(always)]
    pub(crate) fn is_sram(&self, address: u32) -> bool {
        let window = address >> WINDOW_BITS;
        window == SRAM_WINDOW || window == self.sram_alias
    }

    /// In one of the SRAM's windows and aligned, in one comparison each.
    #[inline(always)]
    pub(crate) fn is_aligned_sram(&self, address: u32, width: Width) -> bool {
        let offset = match width {
            Width::Byte => 0,
            Width::Halfword => 1,
            Width::Word => 3,
        };
        let window = address & (!0 << WINDOW_BITS | offset);
        window == SRAM_BASE || window == self.sram_alias << WINDOW_BITS
    }

    /// The word at an address in one of the windows of SRAM or flash.
    #[inline(always)]
    pub(crate) fn word(&self, address: u32) -> u32 {
        if self.is_sram(address) {
            self.sram.word(address)
        } else {
            self.flash.word(address)
        }
    }

    /// Put bytes in SRAM or flash; the first appearances only.
    pub(crate) fn load(&mut self, address: u32, bytes: &[u8]) -> Result<(), AddressError> {
        let in_sram = in_sram(address, bytes.len())?;
        for (address, byte) in (address..).zip(bytes) {
            if in_sram {
                self.sram.load_byte(address, *byte);
            } else {
                self.flash.load_byte(address, *byte);
            }
        }
        Ok(())
    }

    /// Read as many bytes of SRAM or flash as there is room for; the first appearances only.
    pub(crate) fn peek(&self, address: u32, bytes: &mut [u8]) -> Result<(), AddressError> {
        in_sram(address, bytes.len())?;
        for (at, byte) in (address..).zip(bytes) {
            *byte = lane(self.word(at), at, Width::Byte) as u8;
        }
        Ok(())
    }

    /// Refuse a range that is not wholly in the first appearance of SRAM or flash.
    pub(crate) fn check_range(&self, address: u32, length: usize) -> Result<(), AddressError> {
        in_sram(address, length).map(|_| ())
    }

    /// Read one aligned word of SRAM or flash; the first appearances only.
    pub(crate) fn peek_word(&self, address: u32) -> Result<u32, AddressError> {
        let address = address & !3;
        in_sram(address, 4)?;
        Ok(self.word(address))
    }

    /// Record every processor write to the SRAM word at `address`.
    pub(crate) fn watch(&mut self, address: u32) -> Result<(), AddressError> {
        if !in_sram(address & !3, 4)? {
            return Err(AddressError { address, length: 4 });
        }
        self.sram.watch(address);
        Ok(())
    }

    fn steal(&mut self, peripheral: &'static str, at: Cycles) {
        self.stolen += self.timing.pdc_steal_cycles;
        if let Some(log) = &mut self.transfer_log {
            log.push((at, peripheral));
        }
    }

    /// A transfer of the data controller from SRAM or flash.
    pub(crate) fn transfer_from(
        &mut self,
        peripheral: &'static str,
        pointer: u32,
        width: Width,
        at: Cycles,
    ) -> Result<u32, TransferFault> {
        self.steal(peripheral, at);
        if !self.is_sram(pointer) && !is_flash(pointer) {
            return Err(TransferFault {
                kind: FaultKind::TransferAddress { peripheral },
                pointer,
                written: None,
            });
        }
        Ok(lane(self.word(pointer), pointer, width))
    }

    /// A transfer of the data controller to SRAM.
    pub(crate) fn transfer_to(
        &mut self,
        peripheral: &'static str,
        pointer: u32,
        width: Width,
        value: u32,
        at: Cycles,
    ) -> Result<(), TransferFault> {
        if !self.is_sram(pointer) {
            return Err(TransferFault {
                kind: FaultKind::TransferAddress { peripheral },
                pointer,
                written: Some(value),
            });
        }
        self.sram.write(at, pointer, width, value);
        self.transfers_stored += 1;
        self.steal(peripheral, at);
        Ok(())
    }

    /// Read a register of the memory controller or the flash controller.
    pub(crate) fn read_register(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        match offset {
            MC_RCR | MC_FCR => Ok(0),
            MC_ASR => Ok(self.mc.read_abort_status()),
            MC_AASR => Ok(self.mc.abort_address()),
            MC_FMR => Ok(self.flash.mode()),
            MC_FSR => Ok(self.flash.read_status(now)),
            _ => no_register("MC", offset),
        }
    }

    /// Write a register of the memory controller or the flash controller.
    pub(crate) fn write_register(&mut self, offset: u32, value: u32, now: Cycles) -> Access {
        match offset {
            MC_RCR => {
                let before = self.mc.remapped;
                self.mc.write_remap(value);
                self.sram_alias = if self.mc.remapped { 0 } else { SRAM_WINDOW };
                if self.mc.remapped != before {
                    self.flash.remapped();
                }
            }
            MC_FMR => self.flash.set_mode(value, &self.timing),
            MC_FCR => self.flash.command(now, value)?,
            MC_ASR | MC_AASR | MC_FSR => {}
            _ => return no_register("MC", offset),
        }
        Ok(())
    }
}

/// Command and number of the page or bit, when this write is a command to the flash controller.
pub(crate) fn flash_command(offset: u32, value: u32) -> Option<(u8, u16)> {
    (offset == MC_FCR).then_some(((value & 0xF) as u8, (value >> 8 & 0x3FF) as u16))
}

/// In the flash windows, given that the address is not in SRAM.
#[inline(always)]
pub(crate) fn is_flash(address: u32) -> bool {
    address >> WINDOW_BITS < SRAM_WINDOW
}

#[inline(always)]
pub(crate) fn misaligned(address: u32, width: Width) -> bool {
    match width {
        Width::Byte => false,
        Width::Halfword => address & 1 != 0,
        Width::Word => address & 3 != 0,
    }
}

/// What the core's byte lanes show of `word`.
#[inline(always)]
pub(crate) fn lane(word: u32, address: u32, width: Width) -> u32 {
    match width {
        Width::Byte => word >> ((address & 3) * 8) & 0xFF,
        Width::Halfword => word >> ((address & 2) * 8) & 0xFFFF,
        Width::Word => word,
    }
}

/// True for a range in SRAM, false for one in flash; the first appearances only.
fn in_sram(address: u32, length: usize) -> Result<bool, AddressError> {
    let inside = |base: u32, size: usize| {
        address >= base
            && length <= size
            && (address - base) as usize <= size.saturating_sub(length)
    };
    if inside(SRAM_BASE, SRAM_BYTES) {
        Ok(true)
    } else if inside(FLASH_BASE, FLASH_BYTES) {
        Ok(false)
    } else {
        Err(AddressError { address, length })
    }
}
