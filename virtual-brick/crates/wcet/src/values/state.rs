// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is known at one point of a function: registers, words of the frame, flags.

use crate::values::arithmetic::difference_flags;
use crate::values::memory_contents::Contents;
use crate::values::relations::{narrowed, Place, Relations};
use crate::values::value::{Value, RUNNING};
use arm7tdmi::condition_passes;
use arm7tdmi::instruction::ALWAYS;
use std::collections::BTreeMap;

/// Every combination of N, Z, C and V.
pub const ANY_FLAGS: u16 = 0xFFFF;

/// Two operands whose difference set the flags, and the registers that still hold them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The minuend.
    pub left: (Option<u32>, Value),
    /// The subtrahend.
    pub right: (Option<u32>, Value),
    /// The register that holds the difference.
    pub result: Option<u32>,
    /// A register that holds the minuend plus a distance.
    pub moved: Option<(u32, u32)>,
}

/// Cycles on the longest way to a point, counted where calls are followed; two states that differ
/// in nothing else are equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Elapsed(pub u64);

impl PartialEq for Elapsed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Elapsed {}

/// Stands for a way without a bound.
pub const ENDLESS: u64 = u64::MAX;

/// Knowledge at one point. Stack offsets count from the stack pointer at the function's entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// r0 to r14; r15 is not kept.
    pub registers: Box<[Value; 15]>,
    /// Registers and words that differ by a known distance, whatever they hold.
    pub relations: Relations,
    /// Known words of the stack.
    pub slots: BTreeMap<i32, Value>,
    /// Bit n is set when the flags may be n (NZCV as a number).
    pub flags: u16,
    /// What the flags come from, if it is a comparison.
    pub comparison: Option<Comparison>,
    /// The address of a stack word may be in memory or another function's registers.
    pub escaped: bool,
    /// The stack pointer before it was exchanged for another thread's.
    pub parked: Option<i32>,
    /// Urgencies of the protected actions that were entered and not left, outermost first.
    pub urgencies: Vec<u32>,
    /// The lowest that the stack pointer can be.
    pub lowest: Option<i32>,
    /// How many objects are entered by a function of the kernel that masks interrupts for it.
    pub masks: Option<u32>,
    /// Urgency of the running thread or handler, where it is known.
    pub urgency: Option<u32>,
    /// Bits 7 to 0 of the program status in ARM state: mode and masks.
    pub control: Option<u32>,
    /// The words of memory, where nothing else writes to them.
    pub memory: Option<Contents>,
    /// Longest way to here.
    pub elapsed: Elapsed,
}

/// Mode and masks of interrupts.
const CONTROL_BITS: u32 = 0xDF;

/// Most nested protected actions that are kept apart.
const NESTING: usize = 8;

/// A protected action of this urgency is entered.
pub fn enter(urgencies: &mut Vec<u32>, urgency: u32) {
    if urgencies.len() < NESTING {
        urgencies.push(urgency);
    }
}

/// Stands for an urgency that is not known: none is higher.
pub const ANY_URGENCY: u32 = u32::MAX;

/// What flags say about the operands of the comparison that set them.
struct Order {
    at_least: bool,
    at_most: bool,
    different: bool,
}

impl Order {
    fn new(flags: u16, at_least: impl Fn(u16) -> bool) -> Self {
        let all = |test: &dyn Fn(u16) -> bool| (0..16).all(|f| flags >> f & 1 == 0 || test(f));
        Self {
            at_least: all(&at_least),
            at_most: all(&|f| !at_least(f) || f & 4 != 0),
            different: all(&|f| f & 4 == 0),
        }
    }

    fn unsigned(flags: u16) -> Self {
        Self::new(flags, |f| f & 2 != 0)
    }

    fn signed(flags: u16) -> Self {
        Self::new(flags, |f| (f >> 3 ^ f) & 1 == 0)
    }

    /// Bounds of both sides narrowed by the order. `None` when nothing is left.
    fn apply<T: Ord + Copy>(
        &self,
        left: (T, T),
        right: (T, T),
        less: impl Fn(T) -> Option<T>,
        more: impl Fn(T) -> Option<T>,
    ) -> Option<((T, T), (T, T))> {
        let (mut a, mut b) = (left, right);
        let strict = self.different;
        if self.at_least {
            a.0 = a.0.max(if strict { more(right.0)? } else { right.0 });
            b.1 = b.1.min(if strict { less(left.1)? } else { left.1 });
        }
        if self.at_most {
            a.1 = a.1.min(if strict { less(right.1)? } else { right.1 });
            b.0 = b.0.max(if strict { more(left.0)? } else { left.0 });
        }
        (a.0 <= a.1 && b.0 <= b.1).then_some((a, b))
    }
}

/// The longer of both, level by level the higher.
fn joined_urgencies(a: &[u32], b: &[u32]) -> Vec<u32> {
    let (longer, shorter) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let levels = longer.iter().enumerate();
    levels
        .map(|(level, urgency)| shorter.get(level).map_or(*urgency, |o| *urgency.max(o)))
        .collect()
}

/// Combinations of flags for which each condition passes.
const PASSING: [u16; 16] = {
    let mut table = [0; 16];
    let mut index = 0;
    while index < 256 {
        let (condition, flags) = (index / 16, index % 16);
        if condition_passes(condition as u32, flags as u32) {
            table[condition] |= 1 << flags;
        }
        index += 1;
    }
    table
};

/// Combinations of flags for which a condition passes.
pub fn passing(condition: u32) -> u16 {
    PASSING.get(condition as usize).copied().unwrap_or(0)
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
            slots: BTreeMap::new(),
            flags: ANY_FLAGS,
            comparison: None,
            escaped: false,
            parked: None,
            urgencies: Vec::new(),
            lowest: Some(0),
            masks: Some(0),
            urgency: None,
            control: None,
            memory: None,
            elapsed: Elapsed(0),
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
        }
    }

    /// Adds to the cycles on the way.
    pub fn spend(&mut self, cycles: u64) {
        self.elapsed.0 = self.elapsed.0.saturating_add(cycles);
    }

    /// The same with stack offsets counted from a place that lies `by` higher.
    pub fn shift(&mut self, by: i32) {
        if by == 0 {
            return;
        }
        let moved = |value: &mut Value| match value {
            Value::Stack(offset) => *offset = offset.wrapping_sub(by),
            Value::MinusStack(offset) => *offset = offset.wrapping_add(by),
            _ => {}
        };
        self.registers.iter_mut().for_each(moved);
        let slots = std::mem::take(&mut self.slots);
        self.slots = slots
            .into_iter()
            .map(|(offset, mut value)| {
                moved(&mut value);
                (offset.wrapping_sub(by), value)
            })
            .collect();
        if let Some(comparison) = &mut self.comparison {
            moved(&mut comparison.left.1);
            moved(&mut comparison.right.1);
        }
        for place in [&mut self.parked, &mut self.lowest].into_iter().flatten() {
            *place = place.wrapping_sub(by);
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
        let place = self.slots.get(&pointer)?.constant()?;
        for number in (0..13).chain([14]) {
            self.set(number, Value::Top);
        }
        self.set(13, Value::Stack(pointer.wrapping_add(4)));
        self.flags = ANY_FLAGS;
        self.comparison = None;
        self.control = None;
        self.urgency = None;
        self.parked = None;
        Some(place)
    }

    /// Writes a register and forgets what depended on its old value.
    pub fn set(&mut self, number: u32, value: Value) {
        if let Some(comparison) = &mut self.comparison {
            let sides = [&mut comparison.left.0, &mut comparison.right.0];
            for side in sides.into_iter().chain([&mut comparison.result]) {
                if *side == Some(number) {
                    *side = None;
                }
            }
            comparison.moved = comparison.moved.filter(|(held, _)| *held != number);
        }
        self.relations.forget(Place::Register(number));
        if number == 13 {
            self.lowest = match value {
                Value::Stack(offset) => Some(offset),
                _ => None,
            };
        }
        if let Some(register) = self.registers.get_mut(number as usize) {
            *register = value;
        }
    }

    /// By how much a register differs from the minuend of the last comparison.
    pub fn compared(&self, number: u32) -> Option<u32> {
        let comparison = self.comparison.as_ref()?;
        let moved = comparison.moved.filter(|(held, _)| *held == number);
        let left = (comparison.left.0 == Some(number)).then_some(0);
        left.or(moved.map(|(_, distance)| distance))
    }

    /// What a register holds, and with it those that are related to it.
    fn learn(&mut self, number: u32, value: &Value) {
        let related: Vec<_> = self.relations.of(Place::Register(number)).collect();
        for (place, distance) in related {
            match place {
                Place::Register(other) => {
                    let known = &mut self.registers[other as usize];
                    if let Some(narrower) = narrowed(known, value, distance) {
                        *known = narrower;
                    }
                }
                Place::Word(address) => self.learn_word(address, value, distance),
            }
        }
        if let Some(register) = self.registers.get_mut(number as usize) {
            register.clone_from(value);
        }
    }

    fn learn_word(&mut self, address: u32, value: &Value, distance: u32) {
        let Some(memory) = &mut self.memory else {
            return;
        };
        let place = Value::Constant(address);
        let known = memory.load(&place, 4).unwrap_or(Value::Top);
        if let Some(narrower) = narrowed(&known, value, distance) {
            memory.store(&place, 4, &narrower);
        }
    }

    /// Writes an unknown value that the instruction at `address` produces; what it produced
    /// before loses its name.
    pub fn set_fresh(&mut self, number: u32, address: u32) {
        let stale = |value: &Value| matches!(value, Value::Based(base, _) if *base == address);
        for register in self.registers.iter_mut().filter(|value| stale(value)) {
            *register = Value::Top;
        }
        self.slots.retain(|_, value| !stale(value));
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
    /// `kept` elements may grow.
    pub fn widen(
        &self,
        new: &Self,
        kept: usize,
        pointer_region: impl Fn(&Value) -> Option<u8>,
    ) -> Self {
        let mut wider = self.combine(new, |old, new| {
            if new.below(old) {
                return old.clone();
            }
            let joined = old.join(new);
            if matches!(&joined, Value::Set(elements) if elements.len() <= kept) {
                return joined;
            }
            if joined.in_stack() || joined == Value::Top {
                let same = pointer_region(old).filter(|r| pointer_region(new) == Some(*r));
                return same.map_or(joined, Value::Region);
            }
            pointer_region(&joined).map_or(Value::Top, Value::Region)
        });
        wider.lowest = wider.lowest.filter(|_| wider.lowest == self.lowest);
        wider
    }

    fn combine(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Self {
        let same = self.comparison == other.comparison;
        let mut escaped = self.escaped || other.escaped;
        let mut joined = |a: &Value, b: &Value| {
            let value = join(a, b);
            escaped |= !value.in_stack() && (a.in_stack() || b.in_stack());
            value
        };
        let registers = Box::new(std::array::from_fn(|n| {
            joined(&self.registers[n], &other.registers[n])
        }));
        let mut slots = BTreeMap::new();
        for (offset, value) in &self.slots {
            if let Some(theirs) = other.slots.get(offset) {
                let value = joined(value, theirs);
                if value != Value::Top {
                    slots.insert(*offset, value);
                }
            }
        }
        let left_alone = |slots: &BTreeMap<i32, Value>, others: &BTreeMap<i32, Value>| {
            slots
                .iter()
                .any(|(offset, v)| v.in_stack() && !others.contains_key(offset))
        };
        escaped |= left_alone(&self.slots, &other.slots) || left_alone(&other.slots, &self.slots);
        Self {
            registers,
            relations: self.relations.common(&other.relations),
            slots,
            flags: self.flags | other.flags,
            comparison: if same { self.comparison.clone() } else { None },
            escaped,
            parked: self.parked.filter(|_| self.parked == other.parked),
            urgencies: joined_urgencies(&self.urgencies, &other.urgencies),
            masks: self.masks.filter(|_| self.masks == other.masks),
            urgency: self.urgency.filter(|_| self.urgency == other.urgency),
            control: self.control.filter(|_| self.control == other.control),
            lowest: self.lowest.zip(other.lowest).map(|(a, b)| a.min(b)),
            memory: self
                .memory
                .as_ref()
                .zip(other.memory.as_ref())
                .map(|(a, b)| a.combine(b, &join)),
            elapsed: Elapsed(self.elapsed.0.max(other.elapsed.0)),
        }
    }

    /// Whether a condition passes, where the flags are known.
    pub fn decides(&self, condition: u32) -> Option<bool> {
        let known = self.flags.is_power_of_two();
        known.then(|| self.flags & passing(condition) != 0)
    }

    /// The states where a condition fails and where it passes; none where it cannot.
    pub fn divide(self, condition: u32) -> (Option<Self>, Option<Self>) {
        if condition == ALWAYS {
            return (None, Some(self));
        }
        match self.decides(condition) {
            Some(true) => (None, Some(self)),
            Some(false) => (Some(self), None),
            None => (self.assume(condition, false), self.assume(condition, true)),
        }
    }

    /// The state where a condition passes, or fails. `None` when it cannot.
    pub fn assume(&self, condition: u32, passes: bool) -> Option<Self> {
        let mask = if passes {
            passing(condition)
        } else {
            !passing(condition)
        };
        let flags = self.flags & mask;
        if flags == 0 {
            return None;
        }
        let mut state = Self {
            flags,
            ..self.clone()
        };
        if let Some(comparison) = self.comparison.clone() {
            state.refine(&comparison)?;
        }
        Some(state)
    }

    /// Narrows both sides of a comparison by what the possible flags say about their order.
    /// An operand that is not known to be a number says nothing about the other.
    fn refine(&mut self, comparison: &Comparison) -> Option<()> {
        if let Some(constant) = comparison.right.1.constant() {
            self.keep_fitting(comparison.left.0, 0, constant)?;
            self.keep_fitting(comparison.result, constant, constant)?;
            if let Some((register, distance)) = comparison.moved {
                self.keep_fitting(Some(register), distance.wrapping_neg(), constant)?;
            }
        }
        let numbers = [&comparison.left, &comparison.right].map(|side| side.1.bounds().is_some());
        if numbers == [false, false] {
            return Some(());
        }
        let order = Order::unsigned(self.flags);
        let (left, right) = (comparison.left.1.unsigned(), comparison.right.1.unsigned());
        let (left, right) = order.apply(left, right, |v| v.checked_sub(1), |v| v.checked_add(1))?;
        self.narrow(&comparison.left, left)?;
        self.narrow(&comparison.right, right)?;
        let order = Order::signed(self.flags);
        let (left, right) = (comparison.left.1.signed(), comparison.right.1.signed());
        let (left, right) = order.apply(left, right, |v| v.checked_sub(1), |v| v.checked_add(1))?;
        self.narrow_signed(&comparison.left, left)?;
        self.narrow_signed(&comparison.right, right)
    }

    /// Keeps the values of a register, if they are few, with which the difference of the value
    /// plus `offset` and a constant gives possible flags.
    fn keep_fitting(&mut self, register: Option<u32>, offset: u32, constant: u32) -> Option<()> {
        let Some(number) = register.filter(|number| *number < 15) else {
            return Some(());
        };
        let number = number as usize;
        let Some(elements) = self.registers[number].elements() else {
            return Some(());
        };
        let fits = |element: &u32| {
            let (_, flags) = difference_flags(element.wrapping_add(offset), constant);
            self.flags >> flags & 1 != 0
        };
        let kept = elements.into_iter().filter(fits).collect();
        let kept = Value::of_elements(kept)?;
        self.learn(number as u32, &kept);
        Some(())
    }

    /// Only bounds without negative numbers are also unsigned bounds.
    fn narrow_signed(
        &mut self,
        side: &(Option<u32>, Value),
        (low, high): (i32, i32),
    ) -> Option<()> {
        if low > high {
            return None;
        }
        if low < 0 {
            return Some(());
        }
        let known = side.0.and_then(|n| self.registers.get(n as usize)).cloned();
        let value = known.unwrap_or_else(|| side.1.clone());
        self.narrow(&(side.0, value), (low as u32, high as u32))
    }

    fn narrow(&mut self, side: &(Option<u32>, Value), (low, high): (u32, u32)) -> Option<()> {
        let bounded = low > 0 || high < u32::MAX;
        if matches!(side.1, Value::Based(RUNNING, _)) {
            return Some(());
        }
        if let (Value::Based(..), true) = (&side.1, bounded) {
            let known = Value::range(low, high);
            self.replace(&side.1, &known);
            if let Some(number) = side.0 {
                self.learn(number, &known);
            }
            return Some(());
        }
        let narrowed = side.1.within(low, high)?;
        if let Some(number) = side.0 {
            self.learn(number, &narrowed);
        }
        Some(())
    }

    /// Learns what an unknown value is, wherever it is held.
    fn replace(&mut self, unknown: &Value, known: &Value) {
        let registers = self.registers.iter_mut();
        for value in registers
            .chain(self.slots.values_mut())
            .filter(|value| *value == unknown)
        {
            value.clone_from(known);
        }
    }

    /// After a call of a function that does not preserve the registers in `changed`.
    pub fn after_call(&mut self, changed: u16) {
        if let Value::Stack(pointer) = self.registers[13] {
            self.slots.retain(|offset, _| *offset >= pointer);
        }
        let passed = self.registers[..4].iter().any(Value::in_stack);
        self.set(14, Value::Top);
        for number in (0..13).filter(|number| changed >> number & 1 != 0) {
            self.set(number, Value::Top);
        }
        self.flags = ANY_FLAGS;
        self.comparison = None;
        self.control = None;
        self.urgency = None;
        if self.escaped || passed {
            self.forget_frame();
        }
        self.escaped |= passed;
        self.forget_memory();
    }

    /// Any word of memory may be written.
    pub fn forget_memory(&mut self) {
        self.relations.forget_words();
        if let Some(memory) = &mut self.memory {
            memory.forget();
        }
    }

    /// A store somewhere in the frame: every number in it is unknown. Saved registers and return
    /// addresses stay: a program that overwrites them has no bound anyway.
    pub fn forget_frame(&mut self) {
        self.slots.retain(|_, value| value.is_saved());
    }
}
