// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random ARM and Thumb opcodes, and which of them the architecture leaves predictable.

use super::{Random, BASES, BYTES, DATA};
use arm7tdmi::instruction::{Operand, Operation, ALWAYS};
use arm7tdmi::Instruction;

/// Where an instruction may access memory; `None` for one that is not to be executed.
pub fn reach(instruction: &Instruction) -> Option<(u32, u32)> {
    let writes = |number: u32| number < 13 && number != BASES[0];
    let of_base = |base: u32| match base {
        13 => Some((DATA + BYTES, DATA + 2 * BYTES)),
        base => BASES.contains(&base).then_some((DATA, DATA + BYTES)),
    };
    let by_register = |operand: Operand| match operand {
        Operand::ShiftedByRegister { amount, .. } => amount == 15 || operand.reads(15),
        _ => false,
    };
    match instruction.operation {
        _ if instruction.condition > ALWAYS => None,
        Operation::DataProcessing(one) => {
            let good = one.operation.compares() || writes(one.destination);
            (good && !by_register(one.second)).then_some((0, 0))
        }
        Operation::LoadAddress { destination, .. } => writes(destination).then_some((0, 0)),
        Operation::Multiply(one) => {
            let good = writes(one.destination) && !one.uses(15) && one.low.is_none_or(writes);
            (good && one.low != Some(one.destination)).then_some((0, 0))
        }
        Operation::Transfer(one) => {
            let twice =
                one.moves_base() && (one.register == one.base || one.offset.reads(one.base));
            let good = !one.load || writes(one.register);
            let stack_moves = one.base == 13 && one.moves_base();
            of_base(one.base).filter(|_| good && !twice && !stack_moves)
        }
        Operation::BlockTransfer(one) => {
            let twice = one.load && one.write_back && one.list >> one.base & 1 != 0;
            let good = one.list >> 13 == 0 && !one.status && one.list & 1 << BASES[0] == 0;
            let stack_moves = one.base == 13 && one.write_back;
            of_base(one.base).filter(|_| good && !twice && !stack_moves)
        }
        Operation::Swap {
            destination,
            source,
            base,
            ..
        } => {
            let good = writes(destination) && source < 15 && base != destination;
            of_base(base).filter(|_| good && base != source)
        }
        Operation::ReadStatus { destination, saved } => {
            (!saved && writes(destination)).then_some((0, 0))
        }
        Operation::WriteStatus {
            saved,
            control,
            flags,
            operand,
        } => {
            let good = !saved && !control && flags && !operand.reads(15);
            good.then_some((0, 0))
        }
        _ => None,
    }
}

/// An ARM opcode of a kind that compilers use.
pub fn arm(random: &mut Random) -> u32 {
    let bits = random.word();
    let condition = if bits & 1 == 0 {
        14
    } else {
        random.word() % 15
    };
    let small = random.word() % 9;
    let number = |random: &mut Random| random.word() % 8;
    let (first, destination) = (number(random) << 16, number(random) << 12);
    let base = if bits & 2 == 0 {
        6 + (bits >> 2 & 1)
    } else {
        13
    } << 16;
    let offset = (random.word() % 7 * 4) & if bits & 8 == 0 { 0xC } else { 0x1F };
    let body = match random.word() % 16 {
        0..=2 => 0x0200_0000 | bits & 0x01F0_0000 | first | destination | small,
        3 => 0x0200_0000 | bits & 0x01F0_0FFF | first | destination,
        4..=6 => bits & 0x01F0_0000 | first | destination | number(random),
        7 if bits & 4 == 0 => bits & 0x01F0_0060 | first | destination | number(random),
        7 => bits & 0x01F0_0FE0 | first | destination | number(random),
        8 => bits & 0x01F0_0F60 | 0x10 | first | destination | number(random),
        9 => bits & 0x00FF_FF0F & !0x0000_8808 | 0x90,
        10 if small == 0 => 0x0500_F000 | base | offset,
        10 | 11 => 0x0400_0000 | bits & 0x01F0_0000 | base | destination | offset,
        12 => 0x0040_0090 | bits & 0x01B0_0060 | base | destination | offset,
        13 => 0x0800_0000 | bits & 0x01B0_00FF | base,
        14 if bits & 0xC0 == 0 => {
            0x0100_0090 | bits & 0x0040_0000 | base | destination | (small % 8)
        }
        14 => 0x0128_F000 | number(random),
        _ => 0x010F_0000 | destination,
    };
    condition << 28 | body
}

/// A Thumb opcode of one of the formats 1 to 5, 7 to 12 and 15 (DDI 0029E, chapter 5).
pub fn thumb(random: &mut Random) -> u32 {
    let bits = random.word();
    let base = (6 + (bits >> 16 & 1)) << 3;
    match random.word() % 12 {
        0..=2 => bits & 0x1FFF,
        3..=5 => 0x2000 | bits & 0x1F00 | (random.word() % 9),
        6 => 0x4000 | bits & 0x07FF,
        7 => 0x4600 | bits & 0xFF,
        8 => 0x6000 | bits & 0x1E07 | base | bits & 0x01C0,
        9 => 0x8000 | bits & 0x0E07 | base | bits & 0x00C0,
        10 => 0x9000 | bits & 0x0F00 | (random.word() % 4),
        _ => 0xC600 | bits & 0x08FF,
    }
}
