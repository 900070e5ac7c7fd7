// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The register file: 16 visible registers, the banks behind them and the status registers.

/// Bits of the program status registers (DDI 0029E, section 3.8).
pub mod psr {
    /// Negative.
    pub const N: u32 = 1 << 31;
    /// Zero.
    pub const Z: u32 = 1 << 30;
    /// Carry, or not borrow.
    pub const C: u32 = 1 << 29;
    /// Overflow.
    pub const V: u32 = 1 << 28;
    /// IRQ disabled.
    pub const I: u32 = 1 << 7;
    /// FIQ disabled.
    pub const F: u32 = 1 << 6;
    /// Thumb state.
    pub const T: u32 = 1 << 5;
    /// Mode field.
    pub const MODE: u32 = 0x1F;
    /// Highest bit of the mode field: always set, as the core has no 26-bit modes.
    pub const M4: u32 = 1 << 4;
    /// Bits that exist; all others read as zero.
    pub const IMPLEMENTED: u32 = 0xF000_00FF;
}

/// Processor modes with the value of their mode field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Unprivileged.
    User = 0x10,
    /// Fast interrupt.
    Fiq = 0x11,
    /// Interrupt.
    Irq = 0x12,
    /// Supervisor: reset and software interrupts.
    Supervisor = 0x13,
    /// Prefetch and data aborts.
    Abort = 0x17,
    /// Undefined instructions.
    Undefined = 0x1B,
    /// Privileged, with the registers of user mode.
    System = 0x1F,
}

impl Mode {
    /// The mode of a status register value; `None` for the field values ARM leaves undefined.
    #[inline]
    pub const fn from_psr(value: u32) -> Option<Self> {
        match value & psr::MODE {
            0x10 => Some(Self::User),
            0x11 => Some(Self::Fiq),
            0x12 => Some(Self::Irq),
            0x13 => Some(Self::Supervisor),
            0x17 => Some(Self::Abort),
            0x1B => Some(Self::Undefined),
            0x1F => Some(Self::System),
            _ => None,
        }
    }

    /// Value of the mode field.
    #[inline]
    pub const fn bits(self) -> u32 {
        self as u32
    }
}

/// Bytes of the status register that the four field bits of MSR select.
#[inline]
const fn field_mask(fields: u32) -> u32 {
    // Each of the four bits moves to the lowest bit of its byte.
    ((fields & 0xF).wrapping_mul(0x0020_4081) & 0x0101_0101) * 0xFF
}

/// Index of the bank of r13 and r14; undefined mode numbers use the user bank.
#[inline]
const fn bank_of(status: u32) -> usize {
    BANK_OF_MODE[(status & psr::MODE) as usize] as usize
}

const BANK_OF_MODE: [u8; 32] = {
    let mut banks = [USER_BANK as u8; 32];
    banks[Mode::Fiq as usize] = FIQ_BANK as u8;
    banks[Mode::Irq as usize] = 2;
    banks[Mode::Supervisor as usize] = 3;
    banks[Mode::Abort as usize] = 4;
    banks[Mode::Undefined as usize] = 5;
    banks
};

const USER_BANK: usize = 0;
const FIQ_BANK: usize = 1;
const BANKS: usize = 6;

/// Where a register of some mode is kept.
enum Place {
    Visible(usize),
    OtherHigh(usize),
    Bank(usize, usize),
}

/// Registers of all modes. The entries of the active bank are in `visible`; their places in the
/// banks hold zero, so that equal states compare equal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RegisterFile {
    visible: [u32; 16],
    /// r8 to r12 of the side that is not visible: FIQ's, or in FIQ mode those of all others.
    other_high: [u32; 5],
    stack_and_link: [[u32; 2]; BANKS],
    status: u32,
    /// SPSR per bank; the entry of the user bank stays zero.
    saved_status: [u32; BANKS],
}

impl RegisterFile {
    /// The state that reset leaves: supervisor mode, ARM state, interrupts disabled.
    pub(crate) const fn new() -> Self {
        Self {
            visible: [0; 16],
            other_high: [0; 5],
            stack_and_link: [[0; 2]; BANKS],
            status: psr::I | psr::F | Mode::Supervisor.bits(),
            saved_status: [0; BANKS],
        }
    }

    /// The same registers with another r15.
    pub(crate) const fn with_pc(mut self, value: u32) -> Self {
        self.visible[15] = value;
        self
    }

    /// Register `number` (its low four bits) as the current mode sees it.
    #[inline(always)]
    pub(crate) fn get(&self, number: u32) -> u32 {
        self.visible[(number & 15) as usize]
    }

    /// Writes register `number` (its low four bits) as the current mode sees it.
    #[inline(always)]
    pub(crate) fn set(&mut self, number: u32, value: u32) {
        self.visible[(number & 15) as usize] = value;
    }

    /// r15 as the instruction in execution sees it.
    #[inline(always)]
    pub(crate) fn pc(&self) -> u32 {
        self.visible[15]
    }

    #[inline(always)]
    pub(crate) fn set_pc(&mut self, value: u32) {
        self.visible[15] = value;
    }

    #[inline(always)]
    pub(crate) fn status(&self) -> u32 {
        self.status
    }

    /// Changes condition codes only: the bank in view stays.
    #[inline(always)]
    pub(crate) fn set_flags(&mut self, status: u32) {
        self.status = status;
    }

    /// Writes the whole CPSR and brings the bank of the new mode into view.
    pub(crate) fn set_status(&mut self, value: u32) {
        let mut visible = self.visible;
        self.switch(value, &mut visible);
        self.visible = visible;
    }

    /// Writes the whole CPSR; the registers in view are kept in `visible`.
    pub(crate) fn switch(&mut self, value: u32, visible: &mut [u32; 16]) {
        let value = value | psr::M4;
        let (old, new) = (bank_of(self.status), bank_of(value));
        self.status = value;
        if old == new {
            return;
        }
        if old == FIQ_BANK || new == FIQ_BANK {
            for (visible, other) in visible[8..13].iter_mut().zip(&mut self.other_high) {
                std::mem::swap(visible, other);
            }
        }
        self.stack_and_link[old] = [visible[13], visible[14]];
        [visible[13], visible[14]] = std::mem::take(&mut self.stack_and_link[new]);
    }

    /// CPSR with the fields that MSR selects replaced (DDI 0029E, section 4.6). User mode writes
    /// the flags only.
    #[inline]
    pub(crate) fn status_written(&self, fields: u32, value: u32) -> u32 {
        let mut mask = psr::IMPLEMENTED & field_mask(fields);
        if Mode::from_psr(self.status) == Some(Mode::User) {
            mask &= 0xF000_0000;
        }
        self.status & !mask | value & mask
    }

    /// Writes the fields of the current mode's SPSR that MSR selects; no effect without one.
    pub(crate) fn write_saved_status(&mut self, fields: u32, value: u32) {
        let mask = psr::IMPLEMENTED & field_mask(fields);
        if let Some(saved) = self.saved_status() {
            self.set_saved_status(saved & !mask | value & mask);
        }
    }

    /// SPSR of the current mode; `None` in user and system mode.
    #[inline]
    pub(crate) fn saved_status(&self) -> Option<u32> {
        match bank_of(self.status) {
            USER_BANK => None,
            bank => Some(self.saved_status[bank]),
        }
    }

    /// Writes the SPSR of the current mode; no effect in user and system mode.
    pub(crate) fn set_saved_status(&mut self, value: u32) {
        let bank = bank_of(self.status);
        if bank != USER_BANK {
            self.saved_status[bank] = value;
        }
    }

    /// Where `mode` keeps register `number` (0 to 14) at present.
    fn place(&self, mode: Mode, number: u32) -> Place {
        let number = (number & 15) as usize;
        let (current, wanted) = (bank_of(self.status), bank_of(mode.bits()));
        let high_differs = (current == FIQ_BANK) != (wanted == FIQ_BANK);
        match number {
            8..=12 if high_differs => Place::OtherHigh(number - 8),
            13 | 14 if current != wanted => Place::Bank(wanted, number - 13),
            _ => Place::Visible(number),
        }
    }

    /// Register `number` as `mode` would see it.
    pub(crate) fn get_in(&self, mode: Mode, number: u32) -> u32 {
        match self.place(mode, number) {
            Place::Visible(index) => self.visible[index],
            Place::OtherHigh(index) => self.other_high[index],
            Place::Bank(bank, index) => self.stack_and_link[bank][index],
        }
    }

    /// Writes register `number` as `mode` would see it.
    pub(crate) fn set_in(&mut self, mode: Mode, number: u32, value: u32) {
        match self.place(mode, number) {
            Place::Visible(index) => self.visible[index] = value,
            Place::OtherHigh(index) => self.other_high[index] = value,
            Place::Bank(bank, index) => self.stack_and_link[bank][index] = value,
        }
    }

    /// SPSR of `mode`; `None` for user and system mode.
    pub(crate) fn saved_status_of(&self, mode: Mode) -> Option<u32> {
        match bank_of(mode.bits()) {
            USER_BANK => None,
            bank => Some(self.saved_status[bank]),
        }
    }

    /// Writes the SPSR of `mode`; no effect for user and system mode.
    pub(crate) fn set_saved_status_of(&mut self, mode: Mode, value: u32) {
        let bank = bank_of(mode.bits());
        if bank != USER_BANK {
            self.saved_status[bank] = value;
        }
    }

    pub(crate) fn visible(&self) -> [u32; 16] {
        self.visible
    }

    /// Writes all registers as the current mode sees them.
    pub(crate) fn set_visible(&mut self, registers: &[u32; 16]) {
        self.visible = *registers;
    }
}
