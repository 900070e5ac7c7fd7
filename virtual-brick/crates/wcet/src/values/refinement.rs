// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Refinement of a state by the outcome of a branch: a condition that passes or fails narrows the
//! operands of the comparison that set the flags, and all that is related to them.

use crate::values::comparison::{Comparison, Order};
use crate::values::flags::{difference_flags, passing};
use crate::values::relations::{narrowed, Location};
use crate::values::state::State;
use crate::values::value::{Value, RUNNING};
use arm7tdmi::instruction::ALWAYS;

/// Combinations of flags with N, and with Z.
const NEGATIVE: u16 = 0xFF00;
const ZERO: u16 = 0xF0F0;

impl State {
    /// Whether a condition passes, where the flags are known.
    pub fn decided(&self, condition: u32) -> Option<bool> {
        let known = self.flags.is_power_of_two();
        known.then(|| self.flags & passing(condition) != 0)
    }

    /// The states where a condition fails and where it passes; none where it cannot.
    pub fn split(self, condition: u32) -> (Option<Self>, Option<Self>) {
        if condition == ALWAYS {
            return (None, Some(self));
        }
        match self.decided(condition) {
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
            state.refine_operands(&comparison)?;
        }
        state.refine_tested()?;
        Some(state)
    }

    /// Narrows a result by what the possible flags say about its sign and whether it is zero.
    fn refine_tested(&mut self) -> Option<()> {
        let Some(number) = self.tested else {
            return Some(());
        };
        let possible = |mask: u16| self.flags & mask != 0;
        let (low, high) = match (
            possible(NEGATIVE),
            possible(!NEGATIVE & !ZERO),
            possible(ZERO),
        ) {
            (true, false, false) => (i32::MIN, -1),
            (true, false, true) => (i32::MIN, 0),
            (false, positive, zero) => (i32::from(!zero), if positive { i32::MAX } else { 0 }),
            (true, true, zero) => return self.refine_not_zero(number, zero),
        };
        let value = &self.registers[number as usize];
        if value.bounds().is_none() && *value != Value::Top {
            return Some(());
        }
        let known = value.within_signed(low, high)?;
        self.refine_register(number, &known);
        Some(())
    }

    /// A result that may be negative or positive, perhaps zero.
    fn refine_not_zero(&mut self, number: u32, zero: bool) -> Option<()> {
        let value = &self.registers[number as usize];
        let known = match value {
            _ if zero => return Some(()),
            _ if value.bounds().is_some() => value.without(0)?,
            _ => return Some(()),
        };
        self.refine_register(number, &known);
        Some(())
    }

    /// Narrows both sides of a comparison by what the possible flags say about their order.
    /// An operand that is not known to be a number says nothing about the other.
    fn refine_operands(&mut self, comparison: &Comparison) -> Option<()> {
        self.narrow_spans(comparison.left.0, comparison.right.0)?;
        if let Some(constant) = comparison.right.1.constant() {
            self.filter_elements(comparison.left.0, 0, constant)?;
            self.filter_elements(comparison.result, constant, constant)?;
            if let Some((register, distance)) = comparison.moved {
                self.filter_elements(Some(register), distance.wrapping_neg(), constant)?;
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
        self.narrow_signed(&comparison.right, right)?;
        if self.flags & ZERO == 0 {
            self.exclude(comparison.left.0, &comparison.right.1)?;
            self.exclude(comparison.right.0, &comparison.left.1)?;
        }
        Some(())
    }

    /// A register does not hold this, if it is a constant.
    fn exclude(&mut self, register: Option<u32>, value: &Value) -> Option<()> {
        let held = register.and_then(|number| self.registers.get(number as usize));
        if let (Some(number), Some(held), Some(constant)) = (register, held, value.constant()) {
            if held.bounds().is_some() {
                let known = held.without(constant)?;
                self.refine_register(number, &known);
            }
        }
        Some(())
    }

    /// Keeps the values of a register, if they are few, with which the difference of the value
    /// plus `offset` and a constant gives possible flags.
    fn filter_elements(&mut self, register: Option<u32>, offset: u32, constant: u32) -> Option<()> {
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
        self.refine_register(number as u32, &kept);
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
        let known = side.0.and_then(|n| self.registers.get(n as usize)).cloned();
        let value = known.unwrap_or_else(|| side.1.clone());
        if low >= 0 || high < 0 {
            return self.narrow(&(side.0, value), (low as u32, high as u32));
        }
        if (low, high) == (i32::MIN, i32::MAX) || value.bounds().is_none() && !value.is_unknown() {
            return Some(());
        }
        self.narrow_to(&(side.0, value), |value| value.within_signed(low, high))
    }

    fn narrow(&mut self, side: &(Option<u32>, Value), (low, high): (u32, u32)) -> Option<()> {
        self.narrow_to(side, |value| value.within(low, high))
    }

    /// Narrows what an operand is known to be, wherever it is held if it was not known.
    fn narrow_to(
        &mut self,
        (register, value): &(Option<u32>, Value),
        within: impl Fn(&Value) -> Option<Value>,
    ) -> Option<()> {
        if matches!(value, Value::Based(RUNNING, _)) {
            return Some(());
        }
        if matches!(value, Value::Based(..)) {
            let known = within(&Value::Top)?;
            if known == Value::Top {
                return Some(());
            }
            self.replace(value, &known);
            if let Some(number) = register {
                self.refine_register(*number, &known);
            }
            return Some(());
        }
        let narrowed = within(value)?;
        if let Some(number) = register {
            self.refine_register(*number, &narrowed);
        }
        Some(())
    }

    /// Learns what an unknown value is, wherever it is held.
    fn replace(&mut self, unknown: &Value, known: &Value) {
        let registers = self.registers.iter_mut();
        for value in registers
            .chain(self.stack_words.values_mut())
            .filter(|value| *value == unknown)
        {
            value.clone_from(known);
        }
    }

    /// What a register holds, and with it those that are related to it.
    fn refine_register(&mut self, number: u32, value: &Value) {
        let related: Vec<_> = self.relations.of(Location::Register(number)).collect();
        for (place, distance) in related {
            match place {
                Location::Register(other) => {
                    let known = &mut self.registers[other as usize];
                    if let Some(narrower) = narrowed(known, value, distance) {
                        *known = narrower;
                    }
                }
                Location::Word(address) => self.refine_word(address, value, distance),
            }
        }
        if let Some(register) = self.registers.get_mut(number as usize) {
            register.clone_from(value);
        }
        self.refine_shifted(number, value);
    }

    fn refine_word(&mut self, address: u32, value: &Value, distance: u32) {
        let Some(memory) = &mut self.memory else {
            return;
        };
        let place = Value::Constant(address);
        let known = memory.load(&place, 4).unwrap_or(Value::Top);
        if let Some(narrower) = narrowed(&known, value, distance) {
            memory.store(&place, 4, &narrower);
        }
    }
}
