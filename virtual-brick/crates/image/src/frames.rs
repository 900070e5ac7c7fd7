// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Registers of the caller from those of the callee, by the call frame information (DWARF 5,
//! section 6.4).

use gimli::{BaseAddresses, CfaRule, DebugFrame, RegisterRule, UnwindContext, UnwindSection};

use crate::Reader;

const STACK_POINTER: usize = 13;
const LINK: usize = 14;
const PROGRAM_COUNTER: usize = 15;

/// The call frame information of an image; without any, no caller is known.
pub struct Frames<'a>(Option<DebugFrame<Reader<'a>>>);

impl<'a> Frames<'a> {
    pub(crate) fn new(section: Option<Reader<'a>>) -> Self {
        Self(section.map(|data| {
            let mut section = DebugFrame::from(data);
            section.set_address_size(4);
            section
        }))
    }

    /// Registers of the caller, `registers[15]` being the address to which the call returns;
    /// `word` reads memory. None without frame information for
    /// `address`.
    #[must_use]
    pub fn caller(
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
