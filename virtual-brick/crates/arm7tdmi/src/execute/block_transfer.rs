// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Multiple loads and stores, shared by both states (DDI 0029E, section 4.11).

use crate::bus::{Bus, Cycle, Width};
use crate::cpu::{Cpu, Step};
use crate::decode::format::list_and_size;
use crate::registers::Mode;

/// A multiple transfer with its addresses resolved.
pub(super) struct Block {
    /// Number of the base register.
    pub(super) base: u32,
    /// Registers transferred, one bit each; never empty.
    pub(super) list: u32,
    /// Lowest address; the lowest register goes there.
    pub(super) start: u32,
    /// New value of the base register, if it is written back. With r15 as base, which programs
    /// must not use, the pipeline stays as it is.
    pub(super) end_base: Option<u32>,
    /// Transfer the registers of user mode; write-back then goes to them too.
    pub(super) user_bank: bool,
    /// Restore CPSR from SPSR at the end.
    pub(super) restores_status: bool,
}

impl Cpu {
    fn block_register(&self, block: &Block, number: u32) -> u32 {
        if block.user_bank {
            self.registers.get_in(Mode::User, number)
        } else {
            self.registers.get(number)
        }
    }

    fn set_block_register(&mut self, block: &Block, number: u32, value: u32) {
        if block.user_bank {
            self.registers.set_in(Mode::User, number, value);
        } else {
            self.registers.set(number, value);
        }
    }

    /// STM: (n-1)S + 2N. The base is written back after the first transfer, so a base that is
    /// first in the list is stored unchanged and elsewhere with its new value.
    #[inline]
    pub(super) fn store_block<B: Bus>(&mut self, bus: &mut B, block: &Block) -> Step {
        let (mut list, mut address) = (block.list, block.start);
        let mut cycle = Cycle::Nonsequential;
        let mut result = Ok(());
        while list != 0 {
            let value = self.block_register(block, list.trailing_zeros());
            result = result.and(bus.write(address, Width::Word, value, cycle));
            if let (Cycle::Nonsequential, Some(base)) = (cycle, block.end_base) {
                self.set_block_register(block, block.base, base);
            }
            cycle = Cycle::Sequential;
            address = address.wrapping_add(4);
            list &= list - 1;
        }
        self.finish_store(bus, result)
    }

    /// LDM: nS + N + I, with r15 in the list N + S more. A loaded base wins over write-back.
    /// After an abort no register changes any more and the base keeps or gets its end value.
    #[inline]
    pub(super) fn load_block<B: Bus>(&mut self, bus: &mut B, block: &Block) -> Step {
        let (mut list, mut address) = (block.list, block.start);
        let mut cycle = Cycle::Nonsequential;
        let mut result = Ok(0);
        let end_base = block
            .end_base
            .unwrap_or(self.block_register(block, block.base));
        self.set_block_register(block, block.base, end_base);
        while list != 0 {
            let number = list.trailing_zeros();
            let read = bus.read(address, Width::Word, cycle);
            result = result.and(read);
            if let (Ok(value), 0..=14) = (result, number) {
                self.set_block_register(block, number, value);
            }
            cycle = Cycle::Sequential;
            address = address.wrapping_add(4);
            list &= list - 1;
        }
        bus.internal(1);
        match result {
            Ok(last) if block.list & (1 << 15) != 0 => {
                if block.restores_status {
                    self.restore_status();
                }
                self.branch(bus, last);
                Step::Instruction
            }
            Ok(_) => Step::Instruction,
            Err(_) => {
                self.set_block_register(block, block.base, end_base);
                self.enter_data_abort(bus)
            }
        }
    }
}

/// LDM and STM in ARM state.
pub(super) fn block_data_transfer<B: Bus, const LOAD: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let flag = |bit: u32| opcode & (1 << bit) != 0;
    let (before, up, status, write_back) = (flag(24), flag(23), flag(22), flag(21));
    let base = (opcode >> 16) & 15;
    let (list, size) = list_and_size(opcode);
    let old_base = cpu.registers.get(base);
    let (lowest, end) = if up {
        (old_base, old_base.wrapping_add(size))
    } else {
        let lowest = old_base.wrapping_sub(size);
        (lowest, lowest)
    };
    let returns = LOAD && list & (1 << 15) != 0;
    let block = Block {
        base,
        list,
        start: if before == up {
            lowest.wrapping_add(4)
        } else {
            lowest
        },
        end_base: write_back.then_some(end),
        user_bank: status && !returns,
        restores_status: status && returns,
    };
    cpu.advance_arm();
    if LOAD {
        cpu.load_block(bus, &block)
    } else {
        cpu.store_block(bus, &block)
    }
}
