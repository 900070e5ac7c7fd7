// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is known at one point of a function: registers, words of the frame, flags.

use crate::elapsed::Elapsed;
use crate::values::comparison::Comparison;
use crate::values::flags::ANY_FLAGS;
use crate::values::memory_contents::Contents;
use crate::values::quotients::Quotient;
use crate::values::relations::{Location, Relations};
use crate::values::spans::{ShiftedCopy, Span};
use crate::values::value::Value;
use crate::values::words::Words;

/// Knowledge at one point. Stack offsets count from the stack pointer at the function's entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// r0 to r14; r15 is not kept.
    pub registers: Box<[Value; 15]>,
    /// Registers and words that differ by a known distance, whatever they hold.
    pub relations: Relations,
    /// Registers with quotients by constants and what they come from.
    pub quotients: Vec<Quotient>,
    /// Registers that differ by one of a few distances.
    pub spans: Vec<Span>,
    /// Registers that hold what other ones hold, shifted.
    pub shifted: Vec<ShiftedCopy>,
    /// Known words of the stack.
    pub stack_words: Words<Value>,
    /// Bit n is set when the flags may be n (NZCV as a number).
    pub flags: u16,
    /// What the flags come from, if it is a comparison.
    pub comparison: Option<Comparison>,
    /// The register with the result whose sign and zero the flags N and Z are.
    pub tested: Option<u32>,
    /// The address of a stack word may be in memory or another function's registers.
    pub escaped: bool,
    /// The stack pointer before it was exchanged for another thread's.
    pub suspended_pointer: Option<i32>,
    /// Urgencies of the protected actions that were entered and not left, outermost first.
    pub urgencies: Vec<u32>,
    /// The lowest that the stack pointer can be.
    pub lowest_pointer: Option<i32>,
    /// Words of the stack to which a store wrote the stack pointer, and what it was: that of a
    /// frame before an object whose size is computed. If such a word is loaded into r13, nothing
    /// but a store there has changed it.
    pub saved_pointers: Words<i32>,
    /// How many objects are entered by a function of the kernel that masks interrupts for it.
    pub mask_count: Option<u32>,
    /// Urgency of the running thread or handler, where it is known.
    pub urgency: Option<u32>,
    /// Bits 7 to 0 of the program status in ARM state: mode and masks.
    pub control: Option<u32>,
    /// The words of memory, where nothing else writes to them.
    pub memory: Option<Contents>,
    /// Longest path to here.
    pub elapsed: Elapsed,
}

/// Mode and masks of interrupts.
const CONTROL_BITS: u32 = 0xDF;

/// Most nested protected actions that are distinguished.
const NESTING: usize = 8;

/// A protected action of this urgency is entered.
pub fn enter(urgencies: &mut Vec<u32>, urgency: u32) {
    if urgencies.len() < NESTING {
        urgencies.push(urgency);
    }
}

/// Stands for an urgency that is not known: none is higher.
pub const ANY_URGENCY: u32 = u32::MAX;

/// The longer of both, level by level the higher.
fn joined_urgencies(a: &[u32], b: &[u32]) -> Vec<u32> {
    let (longer, shorter) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let levels = longer.iter().enumerate();
    levels
        .map(|(level, urgency)| shorter.get(level).map_or(*urgency, |o| *urgency.max(o)))
        .collect()
}

/// A stack pointer that may be one of several: how deep it is, is kept apart from it.
fn pointer_of_frame(value: Value) -> Value {
    match value {
        Value::StackBetween(..) => Value::StackAny,
        value => value,
    }
}

impl State {
    /// At the entry of a function, with what is known about r0 to r3.
    pub fn entry(arguments: &[Value; 4]) -> Self {
        let mut registers: Box<[Value; 15]> =
            Box::new(std::array::from_fn(|number| Value::entry(number as u32)));
        for (register, argument) in registers.iter_mut().zip(arguments) {
            if !argument.is_unknown() {
                register.clone_from(argument);
            }
        }
        registers[13] = Value::Stack(0);
        Self {
            registers,
            relations: Relations::default(),
            quotients: Vec::new(),
            spans: Vec::new(),
            shifted: Vec::new(),
            stack_words: Words::default(),
            flags: ANY_FLAGS,
            comparison: None,
            tested: None,
            escaped: false,
            suspended_pointer: None,
            urgencies: Vec::new(),
            lowest_pointer: Some(0),
            saved_pointers: Words::default(),
            mask_count: Some(0),
            urgency: None,
            control: None,
            memory: None,
            elapsed: Elapsed::default(),
        }
    }

    /// The program status, where its lower bits are known.
    pub fn status(&self) -> Value {
        let Some(control) = self.control else {
            return Value::Top;
        };
        let flags = (0..16).filter(|flags| self.flags >> flags & 1 != 0);
        let words = flags.map(|flags| flags << 28 | control);
        Value::of_elements(words.collect()).unwrap_or(Value::Top)
    }

    /// Writes fields of the program status.
    pub fn set_status(&mut self, status: &Value, control: bool, flags: bool) {
        let elements = status.elements();
        if control {
            let lower = elements.iter().flatten().map(|word| word & CONTROL_BITS);
            let same = lower.clone().min() == lower.clone().max();
            self.control = lower.max().filter(|_| same);
        }
        if flags {
            let each = elements.iter().flatten().map(|word| 1 << (word >> 28));
            self.flags = elements
                .as_ref()
                .map_or(ANY_FLAGS, |_| each.fold(0, |a, b| a | b));
            self.comparison = None;
            self.tested = None;
        }
    }

    /// The same with stack offsets counted from a place that lies `by` higher.
    pub fn rebase_stack(&mut self, by: i32) {
        if by == 0 {
            return;
        }
        let moved = |value: &mut Value| match value {
            Value::Stack(offset) => *offset = offset.wrapping_sub(by),
            Value::StackBetween(low, high) => {
                *value = match (low.checked_sub(by), high.checked_sub(by)) {
                    (Some(low), Some(high)) => Value::StackBetween(low, high),
                    _ => Value::StackAny,
                };
            }
            Value::MinusStack(offset) => *offset = offset.wrapping_add(by),
            _ => {}
        };
        self.registers.iter_mut().for_each(moved);
        self.stack_words.values_mut().for_each(moved);
        self.stack_words.rebase(by);
        let pointers = self.saved_pointers.values_mut();
        pointers.for_each(|pointer| *pointer = pointer.wrapping_sub(by));
        self.saved_pointers.rebase(by);
        if let Some(comparison) = &mut self.comparison {
            moved(&mut comparison.left.1);
            moved(&mut comparison.right.1);
        }
        for place in [&mut self.suspended_pointer, &mut self.lowest_pointer]
            .into_iter()
            .flatten()
        {
            *place = place.wrapping_sub(by);
        }
    }

    /// Stack below the function's entry, where it is known.
    pub fn depth_bytes(&self) -> Option<u32> {
        let depth = |offset: i32| u32::try_from(-i64::from(offset)).ok();
        match self.registers[13] {
            Value::Stack(offset) => Some(depth(offset).unwrap_or(0)),
            _ => self
                .lowest_pointer
                .or(self.suspended_pointer)
                .and_then(depth),
        }
    }

    /// The thread enters a protected action of this urgency.
    pub fn enter(&mut self, urgency: u32) {
        enter(&mut self.urgencies, urgency);
    }

    /// The thread gets a new urgency: an odd one is that of a protected action, any other one
    /// that from before the last was entered.
    pub fn set_urgency(&mut self, urgency: Option<u32>) {
        self.urgency = urgency;
        match urgency {
            Some(known) if known % 2 == 1 => self.enter(known),
            _ if self.urgencies.is_empty() => self.enter(ANY_URGENCY),
            _ => {
                self.urgencies.pop();
            }
        }
    }

    /// The thread gave up the processor with its stack pointer at `pointer` and has it again.
    /// Where it goes on.
    pub fn resume(&mut self, pointer: i32) -> Option<u32> {
        let place = self.stack_words.get(pointer)?.constant()?;
        for number in (0..13).chain([14]) {
            self.set(number, Value::Top);
        }
        self.set(13, Value::Stack(pointer.wrapping_add(4)));
        self.flags = ANY_FLAGS;
        self.comparison = None;
        self.tested = None;
        self.control = None;
        self.urgency = None;
        self.suspended_pointer = None;
        Some(place)
    }

    /// Writes a register and invalidates what depended on its old value.
    pub fn set(&mut self, number: u32, mut value: Value) {
        if let Some(comparison) = &mut self.comparison {
            let sides = [&mut comparison.left.0, &mut comparison.right.0];
            for side in sides.into_iter().chain([&mut comparison.result]) {
                if *side == Some(number) {
                    *side = None;
                }
            }
            comparison.moved = comparison.moved.filter(|(held, _)| *held != number);
        }
        self.tested = self.tested.filter(|held| *held != number);
        self.relations.invalidate(Location::Register(number));
        self.quotients.retain(|held| held.register != number);
        self.spans
            .retain(|span| span.place != number && span.base != number);
        self.shifted
            .retain(|copy| copy.register != number && copy.from != number);
        if number == 13 {
            self.lowest_pointer = value.stack_offsets().map(|(lowest, _)| lowest);
            value = pointer_of_frame(value);
        }
        if let Some(register) = self.registers.get_mut(number as usize) {
            *register = value;
        }
    }

    /// By how much a register differs from the minuend of the last comparison.
    pub fn distance_to_minuend(&self, number: u32) -> Option<u32> {
        let comparison = self.comparison.as_ref()?;
        let moved = comparison.moved.filter(|(held, _)| *held == number);
        let left = (comparison.left.0 == Some(number)).then_some(0);
        left.or(moved.map(|(_, distance)| distance))
    }

    /// Writes an unknown value that the instruction at `address` produces; what it produced
    /// before loses its name.
    pub fn set_unknown(&mut self, number: u32, address: u32) {
        let stale = |value: &Value| matches!(value, Value::Based(base, _) if *base == address);
        for register in self.registers.iter_mut().filter(|value| stale(value)) {
            *register = Value::Top;
        }
        self.stack_words.retain(|_, value| !stale(value));
        if let Some(comparison) = &mut self.comparison {
            for side in [&mut comparison.left, &mut comparison.right] {
                if stale(&side.1) {
                    side.1 = Value::Top;
                }
            }
        }
        self.set(number, Value::Based(address, 0));
    }

    /// Least state above both.
    pub fn join(&self, other: &Self) -> Self {
        self.combine(other, Value::join)
    }

    /// Like `join`, and growing ranges give up at once, so that repetition ends; sets of up to
    /// `set_limit` elements may grow.
    pub fn widen(
        &self,
        new: &Self,
        set_limit: usize,
        pointer_region: impl Fn(&Value) -> Option<u8>,
    ) -> Self {
        let mut wider = self.combine(new, |old, new| {
            if new.below(old) {
                return old.clone();
            }
            let joined = old.join(new);
            if matches!(&joined, Value::Set(elements) if elements.len() <= set_limit) {
                return joined;
            }
            let joined = match joined {
                Value::StackBetween(..) => Value::StackAny,
                joined => joined,
            };
            if joined.in_stack() || joined == Value::Top {
                let same = pointer_region(old).filter(|r| pointer_region(new) == Some(*r));
                return same.map_or(joined, Value::Region);
            }
            pointer_region(&joined).map_or(Value::Top, Value::Region)
        });
        wider.lowest_pointer = wider
            .lowest_pointer
            .filter(|_| wider.lowest_pointer == self.lowest_pointer);
        wider
    }

    fn combine(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Self {
        let same = self.comparison == other.comparison;
        let mut escaped = self.escaped || other.escaped;
        let held = |mine: &Quotient| {
            let others = other.quotients.iter();
            others.filter_map(|theirs| mine.join(theirs, &join)).next()
        };
        let quotients = self.quotients.iter().filter_map(held).collect();
        let mut joined = |a: &Value, b: &Value| {
            let value = join(a, b);
            escaped |= !value.in_stack() && (a.in_stack() || b.in_stack());
            value
        };
        let mut registers = Box::new(std::array::from_fn(|n| {
            joined(&self.registers[n], &other.registers[n])
        }));
        registers[13] = pointer_of_frame(std::mem::replace(&mut registers[13], Value::Top));
        let stack_words = self.stack_words.common(&other.stack_words, |mine, theirs| {
            Some(joined(mine, theirs)).filter(|value| *value != Value::Top)
        });
        let left_alone = |stack_words: &Words<Value>, others: &Words<Value>| {
            let mut words = stack_words.iter();
            words.any(|(offset, value)| value.in_stack() && others.get(offset).is_none())
        };
        escaped |= left_alone(&self.stack_words, &other.stack_words)
            || left_alone(&other.stack_words, &self.stack_words);
        Self {
            registers,
            relations: self.relations.common(&other.relations),
            quotients,
            spans: self.common_spans(other, &join),
            shifted: {
                let both = self.shifted.iter().filter(|s| other.shifted.contains(s));
                both.copied().collect()
            },
            stack_words,
            flags: self.flags | other.flags,
            comparison: if same { self.comparison.clone() } else { None },
            tested: self.tested.filter(|_| self.tested == other.tested),
            escaped,
            suspended_pointer: self
                .suspended_pointer
                .filter(|_| self.suspended_pointer == other.suspended_pointer),
            urgencies: joined_urgencies(&self.urgencies, &other.urgencies),
            mask_count: self
                .mask_count
                .filter(|_| self.mask_count == other.mask_count),
            urgency: self.urgency.filter(|_| self.urgency == other.urgency),
            control: self.control.filter(|_| self.control == other.control),
            lowest_pointer: self
                .lowest_pointer
                .zip(other.lowest_pointer)
                .map(|(a, b)| a.min(b)),
            saved_pointers: self
                .saved_pointers
                .common(&other.saved_pointers, |mine, theirs| {
                    (mine == theirs).then_some(*mine)
                }),
            memory: self
                .memory
                .as_ref()
                .zip(other.memory.as_ref())
                .map(|(a, b)| a.combine(b, &join)),
            elapsed: self.elapsed.longer(&other.elapsed),
        }
    }

    /// After a call of a function that does not preserve the registers in `changed`.
    pub fn havoc_call(&mut self, changed: u16) {
        if let Value::Stack(pointer) = self.registers[13] {
            self.stack_words.retain(|offset, _| offset >= pointer);
            self.saved_pointers.retain(|offset, _| offset >= pointer);
        }
        let passed = self.registers[..4].iter().any(Value::in_stack);
        self.set(14, Value::Top);
        for number in (0..13).filter(|number| changed >> number & 1 != 0) {
            self.set(number, Value::Top);
        }
        self.flags = ANY_FLAGS;
        self.comparison = None;
        self.tested = None;
        self.control = None;
        self.urgency = None;
        if self.escaped || passed {
            self.invalidate_frame();
        }
        self.escaped |= passed;
        self.invalidate_memory();
    }

    /// Any word of memory may be written.
    pub fn invalidate_memory(&mut self) {
        self.relations.invalidate_words();
        if let Some(memory) = &mut self.memory {
            memory.invalidate();
        }
    }

    /// A store somewhere between two offsets: what was there may stay.
    pub fn invalidate_between(&mut self, low: i32, high: i32) {
        let (first, last) = (low & !3, high & !3);
        let of_stack = |value: &Value| value.in_stack() || matches!(value, Value::MinusStack(_));
        let (escaped, words) = (&mut self.escaped, &mut self.stack_words);
        words.retain(|offset, value| {
            let lost = (first..=last).contains(&offset);
            *escaped |= lost && of_stack(value);
            !lost
        });
    }

    /// A store somewhere in the frame: every number in it is unknown. Saved registers and return
    /// addresses stay: a program that overwrites them has no bound anyway.
    pub fn invalidate_frame(&mut self) {
        self.stack_words.retain(|_, value| value.is_saved());
    }
}
