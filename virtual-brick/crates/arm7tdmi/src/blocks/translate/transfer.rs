// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads and stores.

use super::builder::Builder;
use crate::blocks::bus::BlockBus;
use crate::blocks::operations::encoding::*;
use crate::blocks::operations::run::Register;
use crate::blocks::operations::transfer::{
    load_block, load_branch_handler, load_handler, store_block, store_handler, BRANCHES,
    FALLS_THROUGH, RETURNS,
};
use crate::bus::Width;
use crate::instruction::{BlockTransfer, Operand, Transfer};

impl<B: BlockBus> Builder<'_, B> {
    pub(super) fn transfer(&mut self, transfer: &Transfer) {
        let pc_moves = transfer.base == 15 && transfer.moves_base();
        let jumps = transfer.register == 15;
        let jumps_without_word = jumps && !(transfer.load && transfer.width == Width::Word);
        if jumps_without_word || pc_moves || transfer.offset.reads(15) {
            return self.exit();
        }
        let addressing = self.addressing(transfer);
        let item = match (transfer.width, transfer.signed) {
            (Width::Word, _) => WORD,
            (Width::Byte, false) => BYTE,
            (Width::Halfword, false) => HALFWORD,
            (Width::Byte, true) => SIGNED_BYTE,
            (Width::Halfword, true) => SIGNED_HALFWORD,
        };
        let Some((addressing, value, second, amount, mode)) = addressing else {
            return self.exit();
        };
        let ram_cycles = self.bus.ram_cycles() as u8;
        let op = self.push(if jumps {
            load_branch_handler(addressing)
        } else if transfer.load {
            load_handler(item, addressing)
        } else {
            store_handler(item, addressing)
        });
        (op.value, op.second, op.amount, op.mode) = (value, second, amount, mode);
        op.destination = Register::number(transfer.register);
        op.first = Register::number(transfer.base);
        op.cycles = ram_cycles + u8::from(transfer.load);
    }

    /// Addressing, value, second register, amount and mode of a transfer.
    fn addressing(&self, transfer: &Transfer) -> Option<(u8, u32, Register, u8, u8)> {
        let simple = transfer.before && !transfer.write_back;
        let signed = |value: u32| {
            if transfer.add {
                value
            } else {
                value.wrapping_neg()
            }
        };
        match transfer.offset {
            Operand::Constant { value, .. } if transfer.base == 15 => {
                let at = (self.pc() & !3).wrapping_add(signed(value));
                Some((FIXED, at, Register::R0, 0, 0))
            }
            Operand::Shifted {
                register,
                kind: 0,
                amount,
            } if transfer.base == 15 && simple && transfer.add => {
                let (pc, register) = (self.pc() & !3, Register::number(register));
                Some((RELATIVE, pc, register, amount as u8, 0))
            }
            _ if transfer.base == 15 => None,
            Operand::Constant { value, .. } if simple => {
                Some((OFFSET, signed(value), Register::R0, 0, 0))
            }
            Operand::Shifted {
                register,
                kind: 0,
                amount,
            } if simple && transfer.add => {
                let register = Register::number(register);
                Some((INDEXED, 0, register, amount as u8, 0))
            }
            Operand::Constant { value, .. } => {
                let mode = mode_of(transfer, 0);
                Some((GENERAL, value, Register::R0, 0, mode))
            }
            Operand::Shifted {
                register,
                kind,
                amount,
            } => {
                let mode = REGISTER_OFFSET | (kind as u8) << SHIFT;
                let mode = mode_of(transfer, mode);
                let register = Register::number(register);
                Some((GENERAL, 0, register, amount as u8, mode))
            }
            Operand::ShiftedByRegister { .. } => None,
        }
    }

    pub(super) fn block_transfer(&mut self, block: &BlockTransfer) {
        let stores_pc = !block.load && block.list >> 15 != 0;
        let odd = block.size_bytes != 4 * block.list.count_ones();
        let returns = block.load && block.list >> 15 != 0;
        if block.status && !returns || block.base == 15 || stores_pc || odd {
            return self.exit();
        }
        let op = self.push(match (block.load, returns, block.status) {
            (false, ..) => store_block,
            (true, false, _) => load_block::<B, { FALLS_THROUGH }>,
            (true, true, false) => load_block::<B, { BRANCHES }>,
            (true, true, true) => load_block::<B, { RETURNS }>,
        });
        op.value = packed(block);
        op.first = Register::number(block.base);
        op.amount = block.list.count_ones() as u8;
    }
}
