// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The region of the memory map in which an abstract address lies.

use crate::inputs::memory_map::MemoryMap;
use crate::values::value::Value;

impl MemoryMap {
    /// The region all possible addresses lie in, if there is only one.
    pub fn of_value(&self, value: &Value) -> Option<u8> {
        match value {
            Value::Region(region) => Some(*region),
            place if place.in_stack() => self.find(&self.stack).ok(),
            number => {
                let (low, high) = number.bounds()?;
                let region = self.at(low)?;
                (high <= self.regions[usize::from(region)].last).then_some(region)
            }
        }
    }

    /// The region a value points into, if it is one that addresses are derived from.
    pub fn pointer_region(&self, value: &Value) -> Option<u8> {
        match value {
            Value::Region(region) => Some(*region),
            Value::Constant(_) | Value::Set(_) | Value::Range(..) => {
                let region = self.of_value(value)?;
                let found = &self.regions[usize::from(region)];
                found.holds_pointers.then_some(region)
            }
            _ => None,
        }
    }
}
