// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Descriptions of blocks for the compiler.

use super::block::Block;
use super::bus::BlockBus;
use super::jit::{CodeWindow, KnownTarget, RegionBlock, RegionInstruction};
use super::operations::run::{size_of, width_of};
use super::translate::{build, ends, Source};
use crate::bus::Width;
use crate::instruction::{Instruction, Operand, Operation};

/// The targets of indirect branches of the block, and of others in the same memory.
pub(super) fn code_window<B: BlockBus>(bus: &B, block: &RegionBlock) -> CodeWindow {
    let address = block.key & !3;
    let memory = bus.code_place(address).map_or(0, |place| place.memory);
    let (first_halfword, mask) = bus.code_window(memory);
    let differs = |(target, width): (u32, Width)| {
        let afar = bus.refill_cycles(address.wrapping_add(64), target, width);
        bus.refill_cycles(target, target, width) != afar
    };
    let targets = [
        (address, Width::Word),
        (address, Width::Halfword),
        (address + 2, Width::Halfword),
    ];
    CodeWindow {
        first_halfword,
        mask,
        sequence_differs: targets.into_iter().any(differs),
    }
}

/// A block with all that the compiler must know of it.
pub(super) fn describe<B: BlockBus>(
    bus: &B,
    block: &Block<B>,
    number: u32,
    source: &Source,
) -> RegionBlock {
    let (size, width, start) = (size_of(block.key), width_of(block.key), block.key & !1);
    let built = build(bus, source);
    let mut through_cycles = 0;
    let mut instructions: Vec<RegionInstruction> = Vec::with_capacity(source.instructions.len());
    for (index, instruction) in source.instructions.iter().enumerate() {
        let address = start.wrapping_add(index as u32 * size);
        through_cycles += bus.sequential_fetch_cycles(address.wrapping_add(2 * size), width);
        let before = instructions.last().map(|one| one.instruction.operation);
        instructions.push(RegionInstruction {
            instruction: *instruction,
            address,
            operation: built.starts[index],
            through_cycles,
            flags: built.live_flags[index],
            target: known_target(bus, source, (address, instruction), before),
            literal: literal(bus, source, address, instruction),
        });
    }
    let end = start.wrapping_add(source.instructions.len() as u32 * size);
    let goes_on = !source.instructions.last().is_some_and(ends);
    let next = goes_on.then(|| bus.code_place(end)).flatten();
    RegionBlock {
        number,
        key: block.key,
        halfword: source.place.halfword,
        refill_cycles: bus.refill_cycles(start.wrapping_add(64), start, width),
        worst_cycles: block.worst_cycles,
        instructions,
        next: next.map(|place| KnownTarget {
            key: end | block.key & 1,
            halfword: place.halfword,
            refill_cycles: 0,
        }),
    }
}

/// The target of a branch, as far as the instruction and the one before it give it.
fn known_target<B: BlockBus>(
    bus: &B,
    source: &Source,
    (address, instruction): (u32, &Instruction),
    before: Option<Operation>,
) -> Option<KnownTarget> {
    let (size, state) = (size_of(source.key), source.key & 1);
    let pc = address.wrapping_add(2 * size);
    let key = match (&instruction.operation, before) {
        (Operation::Branch { offset, .. }, _) => pc.wrapping_add(*offset) | state,
        (
            Operation::LongBranchSuffix { offset },
            Some(Operation::LongBranchPrefix { offset: prefix }),
        ) => {
            pc.wrapping_sub(2)
                .wrapping_add(prefix)
                .wrapping_add(*offset)
                | 1
        }
        (Operation::BranchExchange { register: 15 }, _) => pc & !3,
        _ => return None,
    };
    let (target, sequence) = (key & !1, address.wrapping_add(3 * size));
    let memory = source.place.memory;
    let refill_cycles = bus.branch_cycles(sequence, target, width_of(key), memory)?;
    let halfword = bus.target_place(target)?.halfword;
    (target != address).then_some(KnownTarget {
        key,
        halfword,
        refill_cycles,
    })
}

/// Value and cycles of a load relative to r15 from the memory that holds the code, if that is no
/// RAM.
fn literal<B: BlockBus>(
    bus: &B,
    source: &Source,
    address: u32,
    instruction: &Instruction,
) -> Option<(u32, u32)> {
    let Operation::Transfer(transfer) = &instruction.operation else {
        return None;
    };
    let Operand::Constant { value, .. } = transfer.offset else {
        return None;
    };
    let pc = address.wrapping_add(2 * size_of(source.key)) & !3;
    let at = if transfer.add {
        pc.wrapping_add(value)
    } else {
        pc.wrapping_sub(value)
    };
    let loads = transfer.load && transfer.base == 15;
    let same_memory = bus.code_place(at)?.memory == source.place.memory;
    if !loads || !same_memory || bus.ram_read(at & !3, Width::Word).is_some() {
        return None;
    }
    let plain = bus.plain_read(at, transfer.width)?;
    Some((plain.value, plain.cycles))
}
