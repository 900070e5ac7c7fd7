// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Who called: registers of the caller from those of the callee, by the call frame information.

use gimli::{BaseAddresses, CfaRule, DebugFrame, EndianSlice, LittleEndian};
use gimli::{RegisterRule, UnwindContext, UnwindSection};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection};

const STACK_POINTER: usize = 13;
const LINK: usize = 14;
const PROGRAM_COUNTER: usize = 15;

/// The call frame information of an image.
pub(crate) struct Frames<'a>(Option<DebugFrame<EndianSlice<'a, LittleEndian>>>);

impl<'a> Frames<'a> {
    /// An image without (or with broken) debug information has none.
    pub(super) fn read(elf: &'a [u8]) -> Self {
        let file = ElfFile32::<object::LittleEndian>::parse(elf).ok();
        let data = file.and_then(|file| file.section_by_name(".debug_frame")?.data().ok());
        Self(data.map(|data| {
            let mut section = DebugFrame::new(data, LittleEndian);
            section.set_address_size(4);
            section
        }))
    }

    /// Registers of the caller, `registers[15]` being the address to which the call returns;
    /// `word` reads memory. None where nothing tells.
    pub(crate) fn caller(
        &self,
        registers: &[u32; 16],
        address: u32,
        word: impl Fn(u32) -> Option<u32>,
    ) -> Option<[u32; 16]> {
        let section = self.0.as_ref()?;
        let bases = BaseAddresses::default();
        let mut context = UnwindContext::new();
        let row = section
            .unwind_info_for_address(
                &bases,
                &mut context,
                u64::from(address),
                DebugFrame::cie_from_offset,
            )
            .ok()?;
        let CfaRule::RegisterAndOffset { register, offset } = row.cfa() else {
            return None;
        };
        let base = registers.get(usize::from(register.0))?;
        let frame = base.wrapping_add(*offset as u32);
        let mut caller = *registers;
        for (register, rule) in row.registers() {
            if let RegisterRule::Offset(offset) = rule {
                let saved = word(frame.wrapping_add(*offset as u32))?;
                *caller.get_mut(usize::from(register.0))? = saved;
            }
        }
        caller[STACK_POINTER] = frame;
        caller[PROGRAM_COUNTER] = caller[LINK];
        Some(caller)
    }
}
