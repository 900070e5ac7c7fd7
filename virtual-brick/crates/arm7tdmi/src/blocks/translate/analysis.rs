// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Data flow in a block: liveness of flags, idle loops.

use crate::instruction::{AluOperation, Instruction, Operand, Operation, ALWAYS};

const N: u8 = 8;
const Z: u8 = 4;
const C: u8 = 2;
const V: u8 = 1;
const ALL: u8 = N | Z | C | V;

/// Flags of one instruction as sets of N, Z, C, V.
#[derive(Clone, Copy, Debug, Default)]
struct Flags {
    reads: u8,
    /// Written if the condition passes.
    writes: u8,
    /// Of these, certainly replaced.
    replaces: u8,
    /// The block can be left at the instruction, where every flag counts.
    exits: bool,
}

const fn condition_reads(condition: u32) -> u8 {
    match condition {
        0x0 | 0x1 => Z,
        0x2 | 0x3 => C,
        0x4 | 0x5 => N,
        0x6 | 0x7 => V,
        0x8 | 0x9 => C | Z,
        0xA | 0xB => N | V,
        0xC | 0xD => N | Z | V,
        _ => 0,
    }
}

fn flags(instruction: &Instruction) -> Flags {
    let mut flags = match &instruction.operation {
        Operation::DataProcessing(processing) => {
            let mut flags = Flags::default();
            let arithmetic = matches!(
                processing.operation,
                AluOperation::Sub
                    | AluOperation::Rsb
                    | AluOperation::Add
                    | AluOperation::Adc
                    | AluOperation::Sbc
                    | AluOperation::Rsc
                    | AluOperation::Cmp
                    | AluOperation::Cmn
            );
            let with_carry = matches!(
                processing.operation,
                AluOperation::Adc | AluOperation::Sbc | AluOperation::Rsc
            );
            if with_carry || reads_carry(processing.second) {
                flags.reads |= C;
            }
            if processing.sets_flags {
                let (certain, possible) = if arithmetic {
                    (C | V, C | V)
                } else {
                    carry_out(processing.second)
                };
                flags.writes = N | Z | possible;
                flags.replaces = N | Z | certain;
            }
            let second = processing.second.reads(15);
            flags.exits = processing.destination == 15
                || processing.first == 15
                || second
                || processing.takes_large_frame();
            flags
        }
        Operation::Multiply(product) => {
            let written = if product.sets_flags { N | Z } else { 0 };
            Flags {
                writes: written,
                replaces: written,
                exits: product.uses(15),
                ..Flags::default()
            }
        }
        Operation::LoadAddress { .. } | Operation::LongBranchPrefix { .. } => Flags::default(),
        _ => Flags {
            exits: true,
            ..Flags::default()
        },
    };
    if instruction.condition != ALWAYS {
        flags.reads |= condition_reads(instruction.condition);
        flags.replaces = 0;
    }
    flags
}

const fn reads_carry(second: Operand) -> bool {
    match second {
        Operand::Constant { .. } => false,
        Operand::Shifted { kind, amount, .. } => kind == 3 && amount == 0,
        Operand::ShiftedByRegister { .. } => true,
    }
}

/// Does the shifter give a carry: certainly, possibly?
const fn carry_out(second: Operand) -> (u8, u8) {
    match second {
        Operand::Constant { carry: None, .. }
        | Operand::Shifted {
            kind: 0, amount: 0, ..
        } => (0, 0),
        Operand::Constant { .. } | Operand::Shifted { .. } => (C, C),
        Operand::ShiftedByRegister { .. } => (0, C),
    }
}

/// For each instruction of a block: are the flags that it sets observed?
pub(in crate::blocks) fn live_flags(instructions: &[Instruction]) -> Vec<bool> {
    let mut live = ALL;
    let mut observed = vec![false; instructions.len()];
    for (instruction, observed) in instructions.iter().zip(&mut observed).rev() {
        let flags = flags(instruction);
        *observed = flags.writes & live != 0;
        live = live & !flags.replaces | flags.reads;
        if flags.exits {
            live = ALL;
        }
    }
    observed
}

/// For each instruction of a block: are all flags behind it those of the processor, if only those
/// in `live_flags` are computed?
pub(in crate::blocks) fn complete_flags(
    instructions: &[Instruction],
    live_flags: &[bool],
) -> Vec<bool> {
    let mut stale = 0;
    let complete = instructions
        .iter()
        .zip(live_flags)
        .map(|(instruction, &live)| {
            let flags = flags(instruction);
            stale = if live {
                stale & !flags.replaces
            } else {
                stale | flags.writes
            };
            stale == 0
        });
    complete.collect()
}

/// Registers as sets. Bit 15 does not count, as r15 is constant at each instruction.
struct Registers {
    reads: u32,
    writes: u32,
}

fn of_operand(operand: Operand) -> u32 {
    match operand {
        Operand::Constant { .. } => 0,
        Operand::Shifted { register, .. } => 1 << register,
        Operand::ShiftedByRegister {
            register, amount, ..
        } => 1 << register | 1 << amount,
    }
}

/// Registers of the instructions that can be in an idle loop; none for others.
fn registers(instruction: &Instruction) -> Option<Registers> {
    let (reads, writes) = match &instruction.operation {
        Operation::DataProcessing(processing) if processing.destination != 15 => {
            let first = if processing.operation.moves() {
                0
            } else {
                1 << processing.first
            };
            let written = if processing.operation.compares() {
                0
            } else {
                1 << processing.destination
            };
            (first | of_operand(processing.second), written)
        }
        Operation::Transfer(transfer)
            if transfer.load && !transfer.write_back && transfer.register != 15 =>
        {
            let read = 1 << transfer.base | of_operand(transfer.offset);
            (read, 1 << transfer.register)
        }
        Operation::LoadAddress { destination, .. } => (0, 1 << destination),
        Operation::Branch { link: false, .. } => (0, 0),
        _ => return None,
    };
    let kept = if instruction.condition == ALWAYS {
        0
    } else {
        writes
    };
    Some(Registers {
        reads: reads | kept,
        writes,
    })
}

/// Do the instructions, run twice, leave the same state as run once, if memory does not change?
/// This holds if nothing is read and later written.
pub(in crate::blocks) fn is_idempotent(instructions: &[Instruction]) -> bool {
    let (mut read, mut written) = (0, 0);
    let (mut flags_read, mut flags_written, mut flags_replaced) = (0, 0, 0);
    for instruction in instructions {
        let Some(registers) = registers(instruction) else {
            return false;
        };
        read |= registers.reads & !written;
        written |= registers.writes;
        let flags = flags(instruction);
        flags_read |= flags.reads & !flags_replaced;
        flags_read |= flags.writes & !flags.replaces & !flags_replaced;
        flags_written |= flags.writes;
        flags_replaced |= flags.replaces;
    }
    read & written & 0x7FFF == 0 && flags_read & flags_written == 0
}
