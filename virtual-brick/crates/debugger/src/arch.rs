// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The registers as GDB numbers them, with the banks of all modes besides the visible ones.
//!
//! Numbers 0 to 15 and 25 (CPSR) are those of GDB's feature `org.gnu.gdb.arm.core`; the banked
//! registers follow from 26 in a feature of our own.

use std::num::NonZeroUsize;

use arm7tdmi::Mode;
use gdbstub::arch::{Arch, RegId, Registers};
use gdbstub_arch::arm::ArmBreakpointKind;

/// Registers r0 to r15 and the CPSR.
pub(crate) const CORE: usize = 17;
/// Position of the CPSR among them.
pub(crate) const CPSR: usize = 16;
/// Position of the program counter.
pub(crate) const PC: usize = 15;
const CPSR_NUMBER: usize = 25;
const FIRST_BANKED: usize = 26;
const WORD: usize = 4;

/// A register that only one mode sees: r8 to r14, or the SPSR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Banked {
    Register(Mode, u32),
    Status(Mode),
}

/// The banked registers in the order of their numbers.
pub(crate) const BANKED: [Banked; 22] = [
    Banked::Register(Mode::User, 13),
    Banked::Register(Mode::User, 14),
    Banked::Register(Mode::Supervisor, 13),
    Banked::Register(Mode::Supervisor, 14),
    Banked::Status(Mode::Supervisor),
    Banked::Register(Mode::Abort, 13),
    Banked::Register(Mode::Abort, 14),
    Banked::Status(Mode::Abort),
    Banked::Register(Mode::Undefined, 13),
    Banked::Register(Mode::Undefined, 14),
    Banked::Status(Mode::Undefined),
    Banked::Register(Mode::Irq, 13),
    Banked::Register(Mode::Irq, 14),
    Banked::Status(Mode::Irq),
    Banked::Register(Mode::Fiq, 8),
    Banked::Register(Mode::Fiq, 9),
    Banked::Register(Mode::Fiq, 10),
    Banked::Register(Mode::Fiq, 11),
    Banked::Register(Mode::Fiq, 12),
    Banked::Register(Mode::Fiq, 13),
    Banked::Register(Mode::Fiq, 14),
    Banked::Status(Mode::Fiq),
];

/// The virtual brick's processor as GDB sees it.
pub enum Brick {}

/// All registers; none where a value is not known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BrickRegisters {
    pub(crate) core: [Option<u32>; CORE],
    pub(crate) banked: [Option<u32>; BANKED.len()],
}

/// Which register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrickRegister {
    /// Position among r0 to r15 and CPSR.
    Core(usize),
    /// Position among the banked registers.
    Banked(usize),
}

impl RegId for BrickRegister {
    fn from_raw_id(id: usize) -> Option<(Self, Option<NonZeroUsize>)> {
        let register = match id {
            0..=PC => Self::Core(id),
            CPSR_NUMBER => Self::Core(CPSR),
            _ => {
                let position = id.checked_sub(FIRST_BANKED)?;
                (position < BANKED.len()).then_some(Self::Banked(position))?
            }
        };
        Some((register, NonZeroUsize::new(WORD)))
    }
}

impl Registers for BrickRegisters {
    type ProgramCounter = u32;

    fn pc(&self) -> u32 {
        self.core[PC].unwrap_or(0)
    }

    fn gdb_serialize(&self, mut write_byte: impl FnMut(Option<u8>)) {
        for register in self.core.iter().chain(&self.banked) {
            match register {
                Some(value) => value
                    .to_le_bytes()
                    .iter()
                    .for_each(|byte| write_byte(Some(*byte))),
                None => (0..WORD).for_each(|_| write_byte(None)),
            }
        }
    }

    fn gdb_deserialize(&mut self, bytes: &[u8]) -> Result<(), ()> {
        let registers = self.core.iter_mut().chain(&mut self.banked);
        let mut words = bytes.chunks_exact(WORD);
        for (register, word) in registers.zip(&mut words) {
            *register = word.try_into().ok().map(u32::from_le_bytes);
        }
        let complete = bytes.len() == WORD * (CORE + BANKED.len());
        complete.then_some(()).ok_or(())
    }
}

impl Arch for Brick {
    type Usize = u32;
    type Registers = BrickRegisters;
    type RegId = BrickRegister;
    type BreakpointKind = ArmBreakpointKind;

    fn target_description_xml() -> Option<&'static str> {
        Some(include_str!("target.xml"))
    }
}

/// RAM, flash in pages of 256 bytes, the memory that appears at address 0, and the peripherals.
pub(crate) const MEMORY_MAP: &str = r#"<?xml version="1.0"?>
<!DOCTYPE memory-map PUBLIC "+//IDN gnu.org//DTD GDB Memory Map V1.0//EN"
 "http://sourceware.org/gdb/gdb-memory-map.dtd">
<memory-map>
<memory type="ram" start="0x00000000" length="0x00100000"/>
<memory type="flash" start="0x00100000" length="0x00040000">
<property name="blocksize">0x100</property>
</memory>
<memory type="ram" start="0x00200000" length="0x00010000"/>
<memory type="ram" start="0xfff00000" length="0x000ff000"/>
<memory type="ram" start="0xfffff000" length="0x00000f00"/>
</memory-map>
"#;
