// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What one instruction makes of a state, and what its cost depends on.

use crate::inputs::facts::Facts;
use crate::inputs::image::Image;
use crate::inputs::kernel::KernelConventions;
use crate::inputs::memory_map::MemoryMap;
use crate::values::arithmetic::compute;
use crate::values::flags::ANY_FLAGS;
use crate::values::interval;
use crate::values::operand::{shifter_operand, ShifterOperand};
use crate::values::quotients::narrowed;
use crate::values::relations::Location;
use crate::values::spans::ShiftedCopy;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::instruction::{
    AluOperation, DataProcessing, Instruction, Multiply, Operand, Operation,
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

/// What is given around a state.
#[derive(Clone, Copy)]
pub struct Environment<'a> {
    /// Code and constants.
    pub image: &'a Image,
    /// Regions.
    pub map: &'a MemoryMap,
    /// Meaning of the kernel's code.
    pub conventions: &'a KernelConventions,
    /// The user's facts about accesses.
    pub facts: Option<&'a Facts<'a>>,
}

/// One instruction at one place.
pub struct Step<'a> {
    pub environment: Environment<'a>,
    pub state: &'a mut State,
    pub address: u32,
    size: u32,
}

/// Executes an instruction whose condition passes.
pub fn execute(
    environment: Environment<'_>,
    state: &mut State,
    address: u32,
    instruction: &Instruction,
) -> Effects {
    let mut step = Step {
        environment,
        state,
        address,
        size: instruction.size,
    };
    let before = step.state.lowest_pointer;
    let mut effects = step.run(&instruction.operation);
    step.apply_context_switch(&mut effects);
    step.track_lowest_pointer(before, &instruction.operation);
    effects
}

/// The register from which the result of an instruction differs by a known distance.
fn moved(
    processing: &DataProcessing,
    first: &Value,
    second: &ShifterOperand,
) -> Option<(u32, u32)> {
    let (from, distance) = match (processing.operation, second.value.constant()) {
        (AluOperation::Mov, None) => (second.register?, 0),
        (AluOperation::Add, None) => (second.register?, first.constant()?),
        (AluOperation::Add, Some(more)) => (processing.first, more),
        (AluOperation::Sub, Some(less)) => (processing.first, less.wrapping_neg()),
        _ => return None,
    };
    (from < 13 && processing.destination < 13).then_some((from, distance))
}

/// The address from which a sum differs by a number that is not known exactly.
fn span(
    map: &MemoryMap,
    processing: &DataProcessing,
    first: &Value,
    second: &Value,
) -> Option<(u32, Value)> {
    let is_number = |value: &Value| {
        value.bounds().is_some()
            && value.constant().is_none()
            && map.pointer_region(value).is_none()
    };
    let adds = processing.operation == AluOperation::Add;
    (adds && !is_number(first) && is_number(second)).then(|| (processing.first, second.clone()))
}

/// Upper and lower half of a long product of two numbers plus another one.
fn long_product(
    product: &Multiply,
    a: &Value,
    b: &Value,
    added: &(Value, Value),
) -> (Value, Value) {
    let signed = product.kind.signed;
    let (mut low, mut high) = interval::product(a.integers(signed), b.integers(signed));
    if product.kind.accumulate {
        let (upper, lower) = (added.0.integers(signed), added.1.integers(false));
        low += (upper.0 << 32) + lower.0;
        high += (upper.1 << 32) + lower.1;
    }
    (
        Value::of_interval(low >> 32, high >> 32),
        Value::of_interval(low, high),
    )
}

impl Step<'_> {
    pub fn read(&self, number: u32) -> Value {
        match self.state.registers.get(number as usize) {
            Some(value) => value.clone(),
            None => Value::Constant(self.address.wrapping_add(2 * self.size)),
        }
    }

    /// What a store writes of a register: r15 is then another instruction further.
    pub fn stored(&self, number: u32) -> Value {
        match (self.read(number), number) {
            (Value::Constant(pc), 15) => Value::Constant(pc.wrapping_add(self.size)),
            (value, _) => value,
        }
    }

    /// Writes a register; r15 becomes the target.
    pub fn write(&mut self, effects: &mut Effects, number: u32, value: Value) {
        if number == 15 {
            effects.target = Some(value);
        } else if value == Value::Top {
            if let (13, Value::Stack(pointer)) = (number, &self.state.registers[13]) {
                self.state.suspended_pointer = Some(*pointer);
            }
            self.state.set_unknown(number, self.address);
        } else {
            self.state.set(number, value);
        }
    }

    /// Where the thread goes on after the processor went to another one.
    fn apply_context_switch(&mut self, effects: &mut Effects) {
        let Some(target) = &effects.target else {
            return;
        };
        let context_switches = &self.environment.conventions.context_switches;
        let pointer = match (target, &self.state.registers[13]) {
            (Value::Constant(address), Value::Stack(pointer))
                if context_switches.contains(address) =>
            {
                Some(*pointer)
            }
            (Value::Constant(_), _) => None,
            _ => self.state.suspended_pointer,
        };
        if let Some(place) = pointer.and_then(|pointer| self.state.resume(pointer)) {
            effects.target = Some(Value::Constant(place));
        }
    }

    /// The stack pointer that may be one of several moved down by at most a known distance.
    fn track_lowest_pointer(&mut self, before: Option<i32>, operation: &Operation) {
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
                let moved = shifter_operand(self.state, *operand, |n| self.read(n)).value;
                moved.bounds().map(|(_, high)| high)
            }
            Operation::BlockTransfer(block_transfer)
                if block_transfer.base == 13 && !block_transfer.up =>
            {
                Some(block_transfer.size_bytes)
            }
            _ => return,
        };
        let lowest_pointer = before.zip(distance.and_then(|d| i32::try_from(d).ok()));
        self.state.lowest_pointer =
            lowest_pointer.and_then(|(old, distance)| old.checked_sub(distance));
    }

    fn unknown_flags(&mut self) {
        self.state.flags = ANY_FLAGS;
        self.state.comparison = None;
        self.state.tested = None;
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
                self.state.invalidate_memory();
                effects.address = Some(address);
                self.write(&mut effects, *destination, Value::Top);
            }
            Operation::BlockTransfer(block_transfer) => {
                self.block_transfer(&mut effects, block_transfer)
            }
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
                let status = shifter_operand(self.state, *operand, |n| self.read(n)).value;
                self.state.set_status(&status, *control, *flags);
            }
            _ => {}
        }
    }

    fn process(&mut self, effects: &mut Effects, processing: &DataProcessing) {
        let processing = &self.state.with_shifted_itself(processing);
        let late = matches!(processing.second, Operand::ShiftedByRegister { .. });
        let read = |number: u32| match (self.read(number), number, late) {
            (Value::Constant(pc), 15, true) => Value::Constant(pc.wrapping_add(4)),
            (value, _, _) => value,
        };
        let operand = shifter_operand(self.state, processing.second, read);
        let first = read(processing.first);
        let moved = moved(processing, &first, &operand);
        let span = span(self.environment.map, processing, &first, &operand.value);
        let (quotient, known) = self.state.quotient_of(processing);
        let outcome = compute(self.state, self.environment.map, processing, first, operand);
        let destination = processing.destination;
        if processing.sets_flags {
            self.state.flags = outcome.flags;
            self.state.comparison = outcome.comparison;
            self.state.tested = None;
        }
        if !processing.operation.compares() {
            let value = match destination {
                13 => self.restored_pointer(outcome.value),
                _ => narrowed(outcome.value, known),
            };
            self.write_moved(effects, destination, value, moved);
            let moves = processing.operation == AluOperation::Mov;
            if let (
                true,
                Operand::Shifted {
                    register: from,
                    kind,
                    amount,
                },
            ) = (moves, processing.second)
            {
                self.state.note_shifted(ShiftedCopy {
                    register: destination,
                    from,
                    kind,
                    amount,
                });
            }
            if let Some((base, distance)) = span {
                self.state.note_span(destination, base, &distance);
            }
            if let (Some(quotient), 0..13) = (quotient, destination) {
                self.state.note_quotient(destination, quotient);
            }
            if let (true, Some(comparison)) = (processing.sets_flags, &mut self.state.comparison) {
                comparison.result = Some(destination);
            }
            if processing.sets_flags && destination < 13 {
                self.state.tested = Some(destination);
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
        let place = Location::Register(destination);
        match moved.filter(|_| !known) {
            Some((from, distance)) if from == destination => {
                let compared = self.state.distance_to_minuend(from);
                self.move_register(effects, from, value, distance);
                if let (Some(more), Some(comparison)) = (compared, &mut self.state.comparison) {
                    comparison.moved = Some((from, more.wrapping_add(distance)));
                }
            }
            Some((from, distance)) => {
                let spans = self.state.spans_moved(destination, from, distance);
                self.write(effects, destination, value);
                self.state.spans.extend(spans);
                let relations = &mut self.state.relations;
                relations.note(place, Location::Register(from), distance);
            }
            None => self.write(effects, destination, value),
        }
    }

    /// Writes a register that becomes a distance more than it was.
    pub fn move_register(
        &mut self,
        effects: &mut Effects,
        number: u32,
        value: Value,
        distance: u32,
    ) {
        let mut relations = self.state.relations.clone();
        let spans = self.state.spans_moved(number, number, distance);
        self.write(effects, number, value);
        relations.move_by(Location::Register(number), distance);
        self.state.relations = relations;
        self.state.spans.extend(spans);
    }

    fn multiply(&mut self, effects: &mut Effects, product: &Multiply) {
        let (a, b) = (
            self.read(product.multiplicand),
            self.read(product.multiplier),
        );
        let low = product.low.map(|register| (register, self.read(register)));
        let (value, lower) = match &low {
            Some((_, low)) => {
                let added = (self.read(product.destination), low.clone());
                long_product(product, &a, &b, &added)
            }
            None => {
                let addend = product.addend.map(|register| self.read(register));
                let (more, most) = addend.map_or((0, 0), |value| value.interval());
                let (low, high) = interval::product(a.interval(), b.interval());
                (Value::of_interval(low + more, high + most), Value::Top)
            }
        };
        if let Some((register, _)) = low {
            self.state.set(register, lower);
        }
        let factors = (a, b.clone());
        effects.multiplier = Some(b);
        self.write(effects, product.destination, value);
        self.state
            .note_product(self.address, product, (&factors.0, &factors.1));
        if product.sets_flags {
            self.unknown_flags();
            self.state.tested = Some(product.destination).filter(|_| product.low.is_none());
        }
    }
}
