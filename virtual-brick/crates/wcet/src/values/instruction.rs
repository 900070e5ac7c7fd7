// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What one instruction makes of a state, and what its cost depends on.

use crate::inputs::image::Image;
use crate::inputs::kernel::Conventions;
use crate::inputs::memory_map::MemoryMap;
use crate::values::arithmetic::{compute, second, Shifted};
use crate::values::relations::Place;
use crate::values::state::{State, ANY_FLAGS};
use crate::values::value::{Value, RUNNING};
use arm7tdmi::instruction::{
    AluOperation, BlockTransfer, DataProcessing, Instruction, Multiply, Operand, Operation,
    Transfer,
};
use arm7tdmi::Width;

/// What is known about one execution of an instruction.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// Address of the data accesses.
    pub address: Option<Value>,
    /// Value of the multiplier.
    pub multiplier: Option<Value>,
    /// What r15 was set to.
    pub target: Option<Value>,
}

/// The world around a state.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// Code and constants.
    pub image: &'a Image,
    /// Regions.
    pub map: &'a MemoryMap,
    /// Meaning of the kernel's code.
    pub conventions: &'a Conventions,
}

/// One instruction at one place.
struct Step<'a> {
    world: World<'a>,
    state: &'a mut State,
    address: u32,
    size: u32,
}

/// Executes an instruction whose condition passes.
pub fn execute(
    world: World<'_>,
    state: &mut State,
    address: u32,
    instruction: &Instruction,
) -> Effects {
    let mut step = Step {
        world,
        state,
        address,
        size: instruction.size,
    };
    let before = step.state.lowest;
    let mut effects = step.run(&instruction.operation);
    step.follow_switch(&mut effects);
    step.keep_lowest(before, &instruction.operation);
    effects
}

/// A part of a word with its sign.
fn extended(value: &Value, sign_bits: u32) -> Value {
    let signed = |part: u32| ((part << sign_bits) as i32 >> sign_bits) as u32;
    match value.elements() {
        Some(elements) => {
            Value::of_elements(elements.into_iter().map(signed).collect()).unwrap_or(Value::Top)
        }
        None => match value.bounds() {
            Some((_, high)) if high < 1 << (31 - sign_bits) => value.clone(),
            _ => Value::Top,
        },
    }
}

/// The register from which the result of an instruction differs by a known distance.
fn moved(processing: &DataProcessing, first: &Value, second: &Shifted) -> Option<(u32, u32)> {
    let (from, distance) = match (processing.operation, second.value.constant()) {
        (AluOperation::Mov, None) => (second.register?, 0),
        (AluOperation::Add, None) => (second.register?, first.constant()?),
        (AluOperation::Add, Some(more)) => (processing.first, more),
        (AluOperation::Sub, Some(less)) => (processing.first, less.wrapping_neg()),
        _ => return None,
    };
    (from < 13 && processing.destination < 13).then_some((from, distance))
}

/// Upper and lower half of a long product.
fn long_product(product: &Multiply, a: u32, b: u32, added: Option<u64>) -> (Value, Value) {
    let Some(added) = added.filter(|_| product.low.is_some()) else {
        return (Value::Top, Value::Top);
    };
    let exact = if product.kind.signed {
        (i64::from(a as i32) * i64::from(b as i32)) as u64
    } else {
        u64::from(a) * u64::from(b)
    };
    let sum = exact.wrapping_add(added);
    (
        Value::Constant((sum >> 32) as u32),
        Value::Constant(sum as u32),
    )
}

impl Step<'_> {
    fn read(&self, number: u32) -> Value {
        match self.state.registers.get(number as usize) {
            Some(value) => value.clone(),
            None => Value::Constant(self.address.wrapping_add(2 * self.size)),
        }
    }

    /// What a store writes of a register: r15 is then another instruction further.
    fn stored(&self, number: u32) -> Value {
        match (self.read(number), number) {
            (Value::Constant(pc), 15) => Value::Constant(pc.wrapping_add(self.size)),
            (value, _) => value,
        }
    }

    /// Writes a register; r15 becomes the target.
    fn write(&mut self, effects: &mut Effects, number: u32, value: Value) {
        if number == 15 {
            effects.target = Some(value);
        } else if value == Value::Top {
            if let (13, Value::Stack(pointer)) = (number, &self.state.registers[13]) {
                self.state.parked = Some(*pointer);
            }
            self.state.set_fresh(number, self.address);
        } else {
            self.state.set(number, value);
        }
    }

    /// Where the thread goes on after the processor went to another one.
    fn follow_switch(&mut self, effects: &mut Effects) {
        let Some(target) = &effects.target else {
            return;
        };
        let parks = &self.world.conventions.parks;
        let pointer = match (target, &self.state.registers[13]) {
            (Value::Constant(address), Value::Stack(pointer)) if parks.contains(address) => {
                Some(*pointer)
            }
            (Value::Constant(_), _) => None,
            _ => self.state.parked,
        };
        if let Some(place) = pointer.and_then(|pointer| self.state.resume(pointer)) {
            effects.target = Some(Value::Constant(place));
        }
    }

    /// The stack pointer moved down by at most a known distance.
    fn keep_lowest(&mut self, before: Option<i32>, operation: &Operation) {
        if !matches!(self.state.registers[13], Value::StackAny) {
            return;
        }
        let distance = match operation {
            Operation::DataProcessing(DataProcessing {
                operation: AluOperation::Sub,
                destination: 13,
                first: 13,
                second: operand,
                ..
            }) => {
                let moved = second(self.state, *operand, |n| self.read(n)).value;
                moved.bounds().map(|(_, high)| high)
            }
            Operation::BlockTransfer(block) if block.base == 13 && !block.up => {
                Some(block.size_bytes)
            }
            _ if self.state.lowest.is_some() => Some(0),
            _ => None,
        };
        let lowest = before.zip(distance.and_then(|d| i32::try_from(d).ok()));
        self.state.lowest = lowest.and_then(|(old, distance)| old.checked_sub(distance));
    }

    fn unknown_flags(&mut self) {
        self.state.flags = ANY_FLAGS;
        self.state.comparison = None;
    }

    fn run(&mut self, operation: &Operation) -> Effects {
        let mut effects = Effects::default();
        match operation {
            Operation::DataProcessing(processing) => self.process(&mut effects, processing),
            Operation::LoadAddress {
                destination,
                offset,
            } => {
                let base = self.address.wrapping_add(4) & !3;
                let value = Value::Constant(base.wrapping_add(*offset));
                self.state.set(*destination, value);
            }
            Operation::Multiply(product) => self.multiply(&mut effects, product),
            Operation::Transfer(transfer) => self.transfer(&mut effects, transfer),
            Operation::Swap {
                destination,
                base,
                source,
                ..
            } => {
                let address = self.read(*base);
                let stored = self.read(*source);
                self.store(&address, Width::Byte, stored);
                self.state.forget_memory();
                effects.address = Some(address);
                self.write(&mut effects, *destination, Value::Top);
            }
            Operation::BlockTransfer(block) => self.block(&mut effects, block),
            Operation::Branch { link, offset } => {
                let target = self
                    .address
                    .wrapping_add(2 * self.size)
                    .wrapping_add(*offset);
                effects.target = Some(Value::Constant(target));
                if *link {
                    self.state
                        .set(14, Value::Constant(self.address.wrapping_add(4)));
                }
            }
            Operation::BranchExchange { register } => effects.target = Some(self.read(*register)),
            Operation::LongBranchPrefix { offset } => {
                let partial = self.address.wrapping_add(4).wrapping_add(*offset);
                self.state.set(14, Value::Constant(partial));
            }
            Operation::LongBranchSuffix { offset } => {
                let partial = self.read(14).constant();
                effects.target = partial.map(|p| Value::Constant(p.wrapping_add(*offset)));
                let link = self.address.wrapping_add(2) | 1;
                self.state.set(14, Value::Constant(link));
            }
            Operation::ReadStatus { .. } | Operation::WriteStatus { .. } => {
                self.status(&mut effects, operation);
            }
            Operation::SoftwareInterrupt | Operation::Undefined => {}
        }
        effects
    }

    /// MRS and MSR; the saved status says nothing about the current one.
    fn status(&mut self, effects: &mut Effects, operation: &Operation) {
        match operation {
            Operation::ReadStatus { destination, saved } => {
                let status = if *saved {
                    Value::Top
                } else {
                    self.state.status()
                };
                self.write(effects, *destination, status);
            }
            Operation::WriteStatus {
                saved: false,
                control,
                flags,
                operand,
            } => {
                let status = second(self.state, *operand, |n| self.read(n)).value;
                self.state.set_status(&status, *control, *flags);
            }
            _ => {}
        }
    }

    fn process(&mut self, effects: &mut Effects, processing: &DataProcessing) {
        let late = matches!(processing.second, Operand::ShiftedByRegister { .. });
        let read = |number: u32| match (self.read(number), number, late) {
            (Value::Constant(pc), 15, true) => Value::Constant(pc.wrapping_add(4)),
            (value, _, _) => value,
        };
        let operand = second(self.state, processing.second, read);
        let first = read(processing.first);
        let moved = moved(processing, &first, &operand);
        let outcome = compute(self.state, self.world.map, processing, first, operand);
        let destination = processing.destination;
        if processing.sets_flags {
            self.state.flags = outcome.flags;
            self.state.comparison = outcome.comparison;
        }
        if !processing.operation.compares() {
            self.write_moved(effects, destination, outcome.value, moved);
            if let (true, Some(comparison)) = (processing.sets_flags, &mut self.state.comparison) {
                comparison.result = Some(destination);
            }
        }
    }

    /// Writes a result with what relates it to the register that `moved` names.
    fn write_moved(
        &mut self,
        effects: &mut Effects,
        destination: u32,
        value: Value,
        moved: Option<(u32, u32)>,
    ) {
        let known = value.constant().is_some();
        let place = Place::Register(destination);
        match moved.filter(|_| !known) {
            Some((from, distance)) if from == destination => {
                let mut relations = self.state.relations.clone();
                let compared = self.state.compared(from);
                self.write(effects, from, value);
                relations.move_by(place, distance);
                self.state.relations = relations;
                if let (Some(more), Some(comparison)) = (compared, &mut self.state.comparison) {
                    comparison.moved = Some((from, more.wrapping_add(distance)));
                }
            }
            Some((from, distance)) => {
                self.write(effects, destination, value);
                let relations = &mut self.state.relations;
                relations.note(place, Place::Register(from), distance);
            }
            None => self.write(effects, destination, value),
        }
    }

    fn multiply(&mut self, effects: &mut Effects, product: &Multiply) {
        let (a, b) = (
            self.read(product.multiplicand),
            self.read(product.multiplier),
        );
        let addend = match product.addend {
            Some(register) => self.read(register).constant(),
            None => Some(0),
        };
        let low = product.low.map(|register| (register, self.read(register)));
        let (value, lower) = match (a.constant(), b.constant(), addend) {
            (Some(a), Some(b), Some(c)) if low.is_none() => (
                Value::Constant(a.wrapping_mul(b).wrapping_add(c)),
                Value::Top,
            ),
            (Some(a), Some(b), _) => {
                let added = match (product.kind.accumulate, &low) {
                    (false, _) => Some(0),
                    (true, Some((_, low))) => {
                        let high = self.read(product.destination).constant();
                        let pair = high.zip(low.constant());
                        pair.map(|(high, low)| u64::from(high) << 32 | u64::from(low))
                    }
                    (true, None) => None,
                };
                long_product(product, a, b, added)
            }
            _ => (Value::Top, Value::Top),
        };
        effects.multiplier = Some(b);
        if let Some((register, _)) = low {
            self.state.set(register, lower);
        }
        self.write(effects, product.destination, value);
        if product.sets_flags {
            self.unknown_flags();
        }
    }

    fn plus(&self, base: &Value, offset: Value, add: bool) -> Value {
        let processing = DataProcessing {
            operation: if add {
                AluOperation::Add
            } else {
                AluOperation::Sub
            },
            sets_flags: false,
            destination: 0,
            first: 0,
            second: Operand::constant(0),
        };
        let operand = Shifted {
            value: offset,
            carry: None,
            register: None,
        };
        compute(
            self.state,
            self.world.map,
            &processing,
            base.clone(),
            operand,
        )
        .value
    }

    fn transfer(&mut self, effects: &mut Effects, transfer: &Transfer) {
        let base = match (self.read(transfer.base), transfer.base) {
            (Value::Constant(pc), 15) => Value::Constant(pc & !3),
            (value, _) => value,
        };
        let offset = second(self.state, transfer.offset, |n| self.read(n)).value;
        let moved = self.plus(&base, offset, transfer.add);
        let address = if transfer.before { moved.clone() } else { base };
        effects.address = Some(address.clone());
        if transfer.load {
            let loaded = self.load(&address, transfer.width, transfer.signed);
            if transfer.write_back {
                self.state.set(transfer.base, moved);
            }
            let unknown = loaded == Value::Top && transfer.register != 15;
            let known = loaded.constant().is_some();
            self.write(effects, transfer.register, loaded);
            if !known {
                self.relate(transfer, &address);
            }
            if let (Value::Stack(offset), true, Width::Word) = (&address, unknown, transfer.width) {
                if offset % 4 == 0 {
                    self.state
                        .slots
                        .insert(*offset, Value::Based(self.address, 0));
                }
            }
        } else {
            let stored = self.stored(transfer.register);
            let known = stored.constant().is_some();
            self.store(&address, transfer.width, stored);
            if !known {
                self.relate(transfer, &address);
            }
            if transfer.write_back {
                self.state.set(transfer.base, moved);
            }
        }
    }

    /// A register and a word of memory hold the same after one was copied to the other.
    fn relate(&mut self, transfer: &Transfer, address: &Value) {
        let word = address.constant().filter(|word| word % 4 == 0);
        let (Some(word), Width::Word, 0..13) = (word, transfer.width, transfer.register) else {
            return;
        };
        if self.state.memory.is_none() {
            return;
        }
        let (register, word) = (Place::Register(transfer.register), Place::Word(word));
        let relations = &mut self.state.relations;
        if transfer.load {
            relations.note(register, word, 0);
        } else {
            relations.note(word, register, 0);
        }
    }

    fn block(&mut self, effects: &mut Effects, block: &BlockTransfer) {
        let base = self.read(block.base);
        let size = Value::Constant(block.size_bytes);
        let end = self.plus(&base, size, block.up);
        let lowest = if block.up { base } else { end.clone() };
        let first = u32::from(block.before == block.up);
        effects.address = Some(lowest.clone());
        if block.write_back && block.load {
            self.state.set(block.base, end.clone());
        }
        let listed = (0..16).filter(|number| block.list >> number & 1 != 0);
        for (index, number) in listed.enumerate() {
            let distance = Value::Constant(4 * (first + index as u32));
            let address = self.plus(&lowest, distance, true);
            if block.load {
                let loaded = self.load(&address, Width::Word, false);
                if number == 15 {
                    effects.target = Some(loaded);
                } else {
                    self.state.set(number, loaded);
                }
            } else {
                let stored = self.stored(number);
                self.store(&address, Width::Word, stored);
                // The base moves behind the first transfer.
                if block.write_back && index == 0 {
                    self.state.set(block.base, end.clone());
                }
            }
        }
    }

    fn load(&self, address: &Value, width: Width, signed: bool) -> Value {
        if let Value::Stack(offset) = address {
            let aligned = width == Width::Word && offset % 4 == 0;
            if let Some(value) = self.state.slots.get(offset).filter(|_| aligned) {
                return value.clone();
            }
        }
        let (size, sign_bits) = match width {
            Width::Byte => (1, 24),
            Width::Halfword => (2, 16),
            Width::Word => (4, 0),
        };
        if let Some(memory) = &self.state.memory {
            if let Some(value) = memory.load(address, size).filter(|v| *v != Value::Top) {
                return if signed {
                    extended(&value, sign_bits)
                } else {
                    value
                };
            }
        }
        let conventions = self.world.conventions;
        if address
            .constant()
            .is_some_and(|a| conventions.running == Some(a))
        {
            return Value::Based(RUNNING, 0);
        }
        if let (Value::Based(RUNNING, 0), Width::Word, Some(urgency)) =
            (address, width, self.state.urgency)
        {
            return Value::Constant(urgency);
        }
        let constants = address.elements().and_then(|addresses| {
            let found = addresses.iter().map(|address| {
                let aligned = address % size == 0;
                let kept = conventions.words.get(address).copied();
                let value = kept
                    .filter(|_| size == 4)
                    .or_else(|| self.world.image.constant(*address, size))
                    .filter(|_| aligned)?;
                Some(if signed {
                    ((value << sign_bits) as i32 >> sign_bits) as u32
                } else {
                    value
                })
            });
            Value::of_elements(found.collect::<Option<Vec<_>>>()?)
        });
        match constants {
            Some(value) => value,
            None if size == 4 => Value::Top,
            None => {
                let part = Value::range(0, u32::MAX >> sign_bits);
                if signed {
                    extended(&part, sign_bits)
                } else {
                    part
                }
            }
        }
    }

    fn store(&mut self, address: &Value, width: Width, value: Value) {
        match address {
            Value::Constant(address) => self.state.relations.forget(Place::Word(address & !3)),
            _ => self.state.relations.forget_words(),
        }
        if let (Some(memory), false) = (&mut self.state.memory, address.in_stack()) {
            let size = match width {
                Width::Byte => 1,
                Width::Halfword => 2,
                Width::Word => 4,
            };
            memory.store(address, size, &value);
        }
        let conventions = self.world.conventions;
        if address
            .constant()
            .is_some_and(|a| conventions.running == Some(a))
        {
            let named = value.constant();
            let urgency = named.and_then(|named| conventions.words.get(&named));
            self.state.urgency = urgency.copied();
        }
        match address {
            Value::Stack(offset) => {
                let word = offset & !3;
                if width == Width::Word && word == *offset && value != Value::Top {
                    self.state.slots.insert(word, value);
                } else {
                    self.state.slots.remove(&word);
                }
                return;
            }
            Value::Based(RUNNING, 0) if width == Width::Word => {
                self.state.set_urgency(value.constant());
            }
            Value::Based(RUNNING, _) => {}
            Value::StackAny => {
                self.state.escaped = true;
                self.state.forget_frame();
            }
            Value::Top | Value::Based(..) if self.state.escaped => self.state.forget_frame(),
            _ => {}
        }
        let of_stack = value.in_stack() || matches!(value, Value::MinusStack(_));
        self.state.escaped |= of_stack && *address != Value::StackAny;
    }
}
