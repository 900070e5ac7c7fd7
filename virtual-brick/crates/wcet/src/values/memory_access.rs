// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads and stores: words of the stack, words of memory, constants of the image, and what the
//! kernel's variables mean.

use crate::values::arithmetic::compute;
use crate::values::instruction::{Effects, Step};
use crate::values::operand::{shifter_operand, ShifterOperand};
use crate::values::relations::Location;
use crate::values::value::{Value, RUNNING};
use arm7tdmi::instruction::{AluOperation, BlockTransfer, DataProcessing, Operand, Transfer};
use arm7tdmi::Width;

/// A part of a word with its sign.
fn extended(value: &Value, sign_bits: u32) -> Value {
    let signed = |part: u32| ((part << sign_bits) as i32 >> sign_bits) as u32;
    match value.elements() {
        Some(elements) => {
            Value::of_elements(elements.into_iter().map(signed).collect()).unwrap_or(Value::Top)
        }
        None => match value.bounds() {
            Some((_, high)) if high < 1 << (31 - sign_bits) => value.clone(),
            _ if sign_bits > 0 => Value::Signed(i32::MIN >> sign_bits, i32::MAX >> sign_bits),
            _ => Value::Top,
        },
    }
}

impl Step<'_> {
    fn address_sum(&self, base: &Value, offset: Value, add: bool) -> Value {
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
        let operand = ShifterOperand {
            value: offset,
            carry: None,
            register: None,
        };
        compute(
            self.state,
            self.environment.map,
            &processing,
            base.clone(),
            operand,
        )
        .value
    }

    pub fn transfer(&mut self, effects: &mut Effects, transfer: &Transfer) {
        let base = match (self.read(transfer.base), transfer.base) {
            (Value::Constant(pc), 15) => Value::Constant(pc & !3),
            (value, _) => value,
        };
        let offset = shifter_operand(self.state, transfer.offset, |n| self.read(n)).value;
        let moved = self.address_sum(&base, offset.clone(), transfer.add);
        let distance = offset.constant().map(|distance| match transfer.add {
            true => distance,
            false => distance.wrapping_neg(),
        });
        let address = if transfer.before { moved.clone() } else { base };
        effects.address = Some(address.clone());
        if transfer.load {
            let loaded = self.load(&address, transfer.width, transfer.signed);
            let saved = match (transfer.register, &address) {
                (13, Value::Stack(word)) if loaded == Value::Top => {
                    self.state.saved_pointers.get(*word).copied()
                }
                _ => None,
            };
            let loaded = saved.map_or(loaded, Value::Stack);
            if transfer.write_back {
                self.move_base(transfer.base, moved, distance);
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
                        .stack_words
                        .insert(*offset, Value::Based(self.address, 0));
                }
            }
        } else {
            let stored = self.stored(transfer.register);
            let known = stored.constant().is_some();
            let saved = match (&address, &stored) {
                (Value::Stack(word), Value::Stack(pointer)) if stored == self.read(13) => {
                    Some((*word, *pointer))
                }
                _ => None,
            };
            self.store(&address, transfer.width, stored);
            if let Some((word, pointer)) = saved {
                self.state.saved_pointers.insert(word, pointer);
            }
            if !known {
                self.relate(transfer, &address);
            }
            if transfer.write_back {
                self.move_base(transfer.base, moved, distance);
            }
        }
    }

    /// The base register moves behind or before what was transferred.
    fn move_base(&mut self, base: u32, moved: Value, distance: Option<u32>) {
        let known = moved.constant().is_some() || moved == Value::Top;
        match distance.filter(|_| !known && base < 13) {
            Some(distance) => self.move_register(&mut Effects::default(), base, moved, distance),
            None => self.state.set(base, moved),
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
        let (register, word) = (Location::Register(transfer.register), Location::Word(word));
        let relations = &mut self.state.relations;
        if transfer.load {
            relations.note(register, word, 0);
        } else {
            relations.note(word, register, 0);
        }
    }

    pub fn block_transfer(&mut self, effects: &mut Effects, block: &BlockTransfer) {
        let base = self.read(block.base);
        let size = Value::Constant(block.size_bytes);
        let end = self.address_sum(&base, size, block.up);
        let lowest_pointer = if block.up { base } else { end.clone() };
        let first = u32::from(block.before == block.up);
        effects.address = Some(lowest_pointer.clone());
        let distance = match block.up {
            true => block.size_bytes,
            false => block.size_bytes.wrapping_neg(),
        };
        if block.write_back && block.load {
            self.move_base(block.base, end.clone(), Some(distance));
        }
        let listed = (0..16).filter(|number| block.list >> number & 1 != 0);
        for (index, number) in listed.enumerate() {
            let offset = Value::Constant(4 * (first + index as u32));
            let address = self.address_sum(&lowest_pointer, offset, true);
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
                    self.move_base(block.base, end.clone(), Some(distance));
                }
            }
        }
    }

    fn load(&self, address: &Value, width: Width, signed: bool) -> Value {
        if let Value::Stack(offset) = address {
            let aligned = width == Width::Word && offset % 4 == 0;
            if let Some(value) = self.state.stack_words.get(*offset).filter(|_| aligned) {
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
        let conventions = self.environment.conventions;
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
                    .or_else(|| self.environment.image.constant(*address, size))
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

    /// What r13 becomes by a move: the pointer that was saved in the word of the stack from which
    /// the register was loaded. Thumb code loads r13 in no other way.
    pub fn restored_pointer(&self, moved: Value) -> Value {
        if !matches!(moved, Value::Based(..)) {
            return moved;
        }
        let words = self.state.stack_words.iter();
        let mut loaded = words.filter(|(_, value)| **value == moved);
        let saved = loaded.find_map(|(word, _)| self.state.saved_pointers.get(word));
        saved.map_or(moved, |pointer| Value::Stack(*pointer))
    }

    pub fn store(&mut self, address: &Value, width: Width, value: Value) {
        match address {
            Value::Constant(address) => self
                .state
                .relations
                .invalidate(Location::Word(address & !3)),
            _ => self.state.relations.invalidate_words(),
        }
        if let (Some(memory), false) = (&mut self.state.memory, address.in_stack()) {
            let size = match width {
                Width::Byte => 1,
                Width::Halfword => 2,
                Width::Word => 4,
            };
            memory.store(address, size, &value);
        }
        let conventions = self.environment.conventions;
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
                self.state.saved_pointers.remove(word);
                if width == Width::Word && word == *offset && value != Value::Top {
                    self.state.stack_words.insert(word, value);
                } else {
                    self.state.stack_words.remove(word);
                }
                return;
            }
            Value::StackBetween(low, high) => {
                self.state.invalidate_between(*low, high.saturating_add(3));
            }
            Value::Based(RUNNING, 0) if width == Width::Word => {
                self.state.set_urgency(value.constant());
            }
            Value::Based(RUNNING, _) => {}
            Value::StackAny => {
                self.state.escaped = true;
                self.state.invalidate_frame();
            }
            Value::Top | Value::Based(..) if self.state.escaped => self.state.invalidate_frame(),
            _ => {}
        }
        let of_stack = value.in_stack() || matches!(value, Value::MinusStack(_));
        self.state.escaped |= of_stack && *address != Value::StackAny;
    }
}
