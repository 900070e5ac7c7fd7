// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The instructions of a block, and where it ends.

use super::analysis::is_idempotent;
use crate::blocks::bus::{BlockBus, CodePlace};
use crate::blocks::operations::run::{size_of, width_of};
use crate::bus::Width;
use crate::instruction::{Instruction, Operation, ALWAYS};
use crate::timing::TimingProfile;

/// A block has at most so many instructions.
const INSTRUCTIONS_MAX: usize = 32;
/// A block covers at most so many bytes, with the two instructions behind it that may count.
pub(in crate::blocks) const BYTES_MAX: u32 = 4 * (INSTRUCTIONS_MAX as u32 + 2);
/// A block is ended when it can take this many cycles.
const CYCLES_MAX: u32 = 160;

/// The instructions of a block with their costs.
pub(in crate::blocks) struct Source {
    pub key: u32,
    pub place: CodePlace,
    pub instructions: Vec<Instruction>,
    /// Most cycles up to the end of each.
    pub worst_cycles: Vec<u32>,
}

fn decode<B: BlockBus>(bus: &B, address: u32, width: Width) -> Instruction {
    let word = bus.code_word(address);
    match width {
        Width::Word => Instruction::arm(word),
        _ => Instruction::thumb((word >> (8 * (address & 2))) as u16),
    }
}

/// Control never continues behind the instruction.
pub(in crate::blocks) fn ends(instruction: &Instruction) -> bool {
    let operation = match &instruction.operation {
        Operation::DataProcessing(processing) => {
            processing.destination == 15 && !processing.operation.compares()
        }
        Operation::Transfer(transfer) => transfer.load && transfer.register == 15,
        Operation::BlockTransfer(block) => block.load && block.list >> 15 != 0 || block.status,
        Operation::LoadAddress { .. }
        | Operation::Multiply(_)
        | Operation::LongBranchPrefix { .. } => false,
        Operation::ReadStatus { destination, .. } => *destination == 15,
        _ => true,
    };
    operation && instruction.condition == ALWAYS
}

/// The instructions from `key` on, as far as one block can have them.
pub(in crate::blocks) fn read_source<B: BlockBus>(bus: &B, key: u32, place: CodePlace) -> Source {
    let (start, size, width) = (key & !1, size_of(key), width_of(key));
    let most = bus.access_cycles_max();
    let mut source = Source {
        key,
        place,
        instructions: Vec::with_capacity(INSTRUCTIONS_MAX),
        worst_cycles: Vec::with_capacity(INSTRUCTIONS_MAX),
    };
    let mut worst = 0;
    while source.instructions.len() < INSTRUCTIONS_MAX && worst < CYCLES_MAX {
        let offset = size * source.instructions.len() as u32;
        // The instruction and its fetch two ahead lie behind the block in the same memory.
        let ahead = start.wrapping_add(offset + 2 * size);
        let expected = CodePlace {
            halfword: place.halfword + offset / 2 + size,
            ..place
        };
        if bus.code_place(ahead) != Some(expected) {
            break;
        }
        let address = start.wrapping_add(offset);
        if bus.observes_arrival(address) {
            break;
        }
        let instruction = decode(bus, address, width);
        source.instructions.push(instruction);
        let fetch_cycles = bus.sequential_fetch_cycles(ahead, width);
        worst += most_cycles(&instruction, fetch_cycles, most);
        source.worst_cycles.push(worst);
        if ends(&instruction) || closes_idle_loop(size, &source.instructions) {
            return source;
        }
    }
    // A block without a branch at its end does not end with a store, unless it has only stores.
    let last = source
        .instructions
        .iter()
        .rposition(|one| !one.operation.stores());
    let length = last.map_or(usize::MAX, |last| last + 1);
    source.instructions.truncate(length);
    source.worst_cycles.truncate(length);
    source
}

/// The last of these instructions branches back to the first until memory or a register changes.
fn closes_idle_loop(size: u32, instructions: &[Instruction]) -> bool {
    let behind = instructions.len() as u32 + 1;
    let back = instructions.last().is_some_and(|last| {
        matches!(last.operation, Operation::Branch { offset, link: false }
            if offset == (size * behind).wrapping_neg())
    });
    back && is_idempotent(instructions)
}

/// Most cycles of an instruction whose fetch takes so many, where no other fetch and no plain
/// access takes more than `most`.
fn most_cycles(instruction: &Instruction, fetch_cycles: u32, most: u32) -> u32 {
    let cycles = instruction.cycles(TimingProfile::default());
    let data = cycles.reads.count() + cycles.writes.count();
    cycles.internal_max + fetch_cycles + most * (2 * cycles.refills + data)
}
