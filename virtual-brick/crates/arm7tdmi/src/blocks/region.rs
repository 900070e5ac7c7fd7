// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Blocks that are worth code of the host: which belong together, and running that code.

use super::bus::BlockBus;
use super::native::{
    NativeAnswer, NativeBlock, NativeInstruction, NativeJump, NativeReach, NativeRegion, BRANCHED,
    NOWHERE,
};
use super::run::{size_of, width_of, Run};
use super::source::{ends, read_source, Source};
use super::translate::{build, Block};
use super::{execute_part, Blocks};
use crate::bus::Width;
use crate::instruction::{Instruction, Operand, Operation};

/// Blocks that are made into code together at most.
const BLOCKS_MAX: usize = 16;
/// A block joins a region if it ran at least this part of the runs that make code worthwhile.
const JOINS_PART: u16 = 2;
/// So many entries in a row did nothing.
const FUTILE_ENTRIES: u8 = 4;
pub(super) const NO_REGION: u32 = u32::MAX;

/// What a block knows of code made of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nativeness {
    /// Place of the block.
    pub halfword: u32,
    /// Runs of its operations in the present age, with half of those before.
    pub heat: u16,
    /// When that was counted last.
    pub age: u16,
    /// Entries into the engine when it was looked for code last.
    pub looked: u32,
    /// Entries in a row that did nothing.
    pub futile: u8,
    /// Code of the host is entered here.
    pub enters: bool,
    /// The region that it was made into code with.
    pub region: u32,
}

impl Nativeness {
    pub const fn none(halfword: u32) -> Self {
        Self {
            halfword,
            heat: 0,
            age: 0,
            looked: 0,
            futile: 0,
            enters: false,
            region: NO_REGION,
        }
    }
}

impl<B: BlockBus> Blocks<B> {
    /// Bytes of the host's code made of blocks so far.
    pub fn native_bytes(&self) -> usize {
        self.native.as_ref().map_or(0, |native| native.bytes())
    }

    /// Asks for code of a block that has become worth it, and takes what has been made by now. A
    /// block that runs again and again without leaving the engine waits for its code.
    #[cold]
    #[inline(never)]
    pub(super) fn look_for_native(&mut self, bus: &mut B, number: u32) {
        let (entries, worthwhile_runs) = (self.entries, self.worthwhile_runs);
        let Some(block) = self.blocks.get_mut(number as usize) else {
            return;
        };
        let busy = block.native.looked == entries;
        block.native.looked = entries;
        let region = block.native.region;
        if block.native.heat == worthwhile_runs {
            self.ask_native(bus, number);
        }
        if self.unsettled != 0 {
            self.take_native((busy && region != NO_REGION).then_some(region));
        }
    }

    /// Asks for code of a block and of those around it.
    fn ask_native(&mut self, bus: &mut B, number: u32) {
        if self.native.as_ref().is_some_and(|native| native.is_spent()) {
            self.forget_native();
        }
        let blocks = self.related(bus, number);
        let Some(first) = blocks.first() else {
            return;
        };
        let known = self.regions.len() as u32;
        let numbers: Box<[u32]> = blocks.iter().map(|block| block.number).collect();
        let region = NativeRegion {
            number: known,
            reach: reach(bus, first),
            ram_cycles: bus.ram_cycles(),
            blocks,
        };
        let (Some(native), Some(memory)) = (&mut self.native, bus.native_memory()) else {
            return;
        };
        match native.translate(region, &memory) {
            NativeAnswer::Comes => self.expect_native(known, numbers),
            NativeAnswer::NotNow => self.blocks[number as usize].native.heat = 0,
            NativeAnswer::Never => {}
        }
    }

    fn expect_native(&mut self, region: u32, numbers: Box<[u32]>) {
        for &number in &numbers {
            if let Some(block) = self.blocks.get_mut(number as usize) {
                block.native.region = region;
            }
        }
        self.regions.push(numbers);
        self.unsettled += 1;
    }

    /// Takes what has been made by now, and waits until a certain region is settled. What has
    /// changed in the meantime is let go.
    #[cold]
    #[inline(never)]
    pub(super) fn take_native(&mut self, mut awaited: Option<u32>) {
        while let Some(native) = &mut self.native {
            if native.is_spent() {
                self.forget_native();
                return;
            }
            let waits = awaited.is_some() && self.unsettled != 0;
            let Some(region) = native.finished(waits) else {
                return;
            };
            awaited = awaited.filter(|&awaited| awaited != region);
            self.unsettled -= 1;
            let numbers = self.regions.get(region as usize);
            let numbers = numbers.map(|numbers| &**numbers).unwrap_or_default();
            let enters = native.settle(!numbers.is_empty());
            for &number in numbers {
                if let Some(block) = self.blocks.get_mut(number as usize) {
                    block.native.enters = enters;
                }
            }
        }
    }

    /// The block and those that it leads to, as far as they run often enough.
    fn related(&self, bus: &B, number: u32) -> Vec<NativeBlock> {
        let mut wanted = vec![number];
        let mut found: Vec<NativeBlock> = Vec::new();
        let mut next = 0;
        while let Some(&number) = wanted.get(next) {
            next += 1;
            let Some(native) = self.described(bus, number) else {
                continue;
            };
            let jumps = native.instructions.iter().filter_map(|one| one.jump);
            let mut keys: Vec<u32> = jumps.chain(native.next).map(|jump| jump.key).collect();
            keys.extend(self.blocks[number as usize].links.map(|link| link.0));
            found.push(native);
            for number in keys.into_iter().filter_map(|key| self.at(bus, key)) {
                if wanted.len() < BLOCKS_MAX && !wanted.contains(&number) && self.joins(number) {
                    wanted.push(number);
                }
            }
        }
        found
    }

    /// Number of the block at `key`, if it is known.
    fn at(&self, bus: &B, key: u32) -> Option<u32> {
        let place = bus.code_place(key & !1)?;
        let number = self.starts.get(place.halfword as usize)?.checked_sub(1)?;
        self.known(number, key).map(|_| number)
    }

    fn joins(&self, number: u32) -> bool {
        let native = &self.blocks[number as usize].native;
        native.region == NO_REGION && native.heat >= self.worthwhile_runs / JOINS_PART
    }

    /// The block as code is made of it; none where that is of no use.
    fn described(&self, bus: &B, number: u32) -> Option<NativeBlock> {
        let block = self.blocks.get(number as usize)?;
        if block.native.region != NO_REGION {
            return None;
        }
        let place = bus.target_place(block.key & !1)?;
        let source = read_source(bus, block.key, place);
        let native = describe(bus, block, number, &source);
        let mut jumps = native.instructions.iter().filter_map(|one| one.jump);
        let waits = block.repeats && jumps.any(|jump| jump.key == block.key);
        (!waits).then_some(native)
    }

    /// The region's blocks have changed, or are not entered any more.
    pub(super) fn forget_region(&mut self, region: u32) {
        let numbers = self.regions.get_mut(region as usize).map(std::mem::take);
        for number in numbers.unwrap_or_default() {
            if let Some(block) = self.blocks.get_mut(number as usize) {
                let halfword = block.native.halfword;
                block.native = Nativeness::none(halfword);
                if let Some(native) = &mut self.native {
                    native.forget(halfword);
                }
            }
        }
    }

    /// Forgets all code of the host; the blocks stay.
    pub(super) fn forget_native(&mut self) {
        self.regions.clear();
        self.unsettled = 0;
        for block in &mut self.blocks {
            block.native = Nativeness::none(block.native.halfword);
        }
        if let Some(native) = &mut self.native {
            native.forget_all();
        }
    }

    /// Runs code of the host from a block on, and the operations before which it stopped. The
    /// block that was left; none when the budget ends there.
    pub(super) fn run_native(
        &mut self,
        run: &mut Run<'_, B>,
        number: u32,
        budget: u32,
    ) -> Option<u32> {
        let halfword = self.blocks.get(number as usize)?.native.halfword;
        let (begun, after_store) = (run.state.cycles, run.state.after_store);
        let (native, memory) = (self.native.as_mut()?, run.bus.native_memory()?);
        run.state.left = budget - begun;
        run.state.after_store = NOWHERE;
        let exit = native.run(halfword, &mut run.state, memory);
        run.state.cycles = budget - run.state.left;
        if run.state.cycles == begun {
            run.state.after_store = after_store;
            self.note_futile(number);
        }
        if exit.operation == BRANCHED {
            return Some(exit.block);
        }
        let block = self.blocks.get(exit.block as usize)?;
        if exit.operation == 0 && run.state.cycles + block.worst > budget {
            let left = budget - run.state.cycles;
            return execute_part(run, block, left).then_some(exit.block);
        }
        let mut ops = block.ops.get(exit.operation as usize..)?.iter();
        if let Some(op) = ops.next() {
            (op.handler)(run, op, ops);
        }
        Some(exit.block)
    }

    fn note_futile(&mut self, number: u32) {
        if let Some(block) = self.blocks.get_mut(number as usize) {
            block.native.futile += 1;
            block.native.enters = block.native.futile < FUTILE_ENTRIES;
        }
    }
}

/// Where branches of the block can go, and those of others in the same memory.
fn reach<B: BlockBus>(bus: &B, block: &NativeBlock) -> NativeReach {
    let address = block.key & !3;
    let region = bus.code_place(address).map_or(0, |place| place.region);
    let (first_halfword, mask) = bus.code_reach(region);
    let differs = |(target, width): (u32, Width)| {
        let afar = bus.refill_cycles(address.wrapping_add(64), target, width);
        bus.refill_cycles(target, target, width) != afar
    };
    let targets = [
        (address, Width::Word),
        (address, Width::Halfword),
        (address + 2, Width::Halfword),
    ];
    NativeReach {
        first_halfword,
        mask,
        sequence_differs: targets.into_iter().any(differs),
    }
}

fn describe<B: BlockBus>(bus: &B, block: &Block<B>, number: u32, source: &Source) -> NativeBlock {
    let (size, width, start) = (size_of(block.key), width_of(block.key), block.key & !1);
    let built = build(bus, source);
    let mut through_cycles = 0;
    let mut instructions: Vec<NativeInstruction> = Vec::with_capacity(source.instructions.len());
    for (index, instruction) in source.instructions.iter().enumerate() {
        let address = start.wrapping_add(index as u32 * size);
        let before_cycles = through_cycles;
        through_cycles += bus.sequential_fetch_cycles(address.wrapping_add(2 * size), width);
        let before = instructions.last().map(|one| one.instruction.operation);
        instructions.push(NativeInstruction {
            instruction: *instruction,
            address,
            operation: built.starts[index],
            before_cycles,
            through_cycles,
            flags: built.needed[index],
            jump: jump(bus, source, (address, instruction), before),
            literal: literal(bus, source, address, instruction),
        });
    }
    let end = start.wrapping_add(source.instructions.len() as u32 * size);
    let goes_on = !source.instructions.last().is_some_and(ends);
    let next = goes_on.then(|| bus.code_place(end)).flatten();
    NativeBlock {
        number,
        key: block.key,
        halfword: source.place.halfword,
        refill_cycles: bus.refill_cycles(start.wrapping_add(64), start, width),
        worst_cycles: block.worst,
        instructions,
        next: next.map(|place| NativeJump {
            key: end | block.key & 1,
            halfword: place.halfword,
            refill_cycles: 0,
        }),
    }
}

/// The branch to a target that is known from the instruction and the one before it.
fn jump<B: BlockBus>(
    bus: &B,
    source: &Source,
    (address, instruction): (u32, &Instruction),
    before: Option<Operation>,
) -> Option<NativeJump> {
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
    let region = source.place.region;
    let refill_cycles = bus.branch_cycles(sequence, target, width_of(key), region)?;
    let halfword = bus.target_place(target)?.halfword;
    (target != address).then_some(NativeJump {
        key,
        halfword,
        refill_cycles,
    })
}

/// What a load relative to r15 brings from the memory that holds the code, if that is no RAM.
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
    let same_memory = bus.code_place(at)?.region == source.place.region;
    if !loads || !same_memory || bus.ram_read(at & !3, Width::Word).is_some() {
        return None;
    }
    let plain = bus.plain_read(at, transfer.width)?;
    Some((plain.value, plain.cycles))
}
