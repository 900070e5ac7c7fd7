// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Plain values handed to Python.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use virtual_brick_facade::{Arrival, ProfileStep};

/// Why a run ended, when, and a sentence.
#[pyclass(module = "virtual_brick", frozen, get_all, eq)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stop {
    reason: &'static str,
    at_cycles: u64,
    message: String,
}

#[pymethods]
impl Stop {
    fn __repr__(&self) -> String {
        format!(
            "Stop(reason={:?}, at_cycles={}, message={:?})",
            self.reason, self.at_cycles, self.message
        )
    }
}

impl Stop {
    /// The run can go on.
    pub fn reached(&self) -> bool {
        self.reason == virtual_brick_facade::StopReason::Reached.name()
    }
}

impl From<virtual_brick_facade::Stop> for Stop {
    fn from(stop: virtual_brick_facade::Stop) -> Self {
        Self {
            reason: stop.reason.name(),
            at_cycles: stop.at_cycles,
            message: stop.message,
        }
    }
}

/// A thread of the program.
#[pyclass(module = "virtual_brick", frozen, get_all, eq)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Thread {
    name: String,
    base_priority: u32,
    stack_base: u32,
    stack_size: u32,
    stack_used: u32,
    address: u32,
    state: u32,
}

#[pymethods]
impl Thread {
    fn __repr__(&self) -> String {
        format!(
            "Thread(name={:?}, base_priority={}, stack_base={:#010x}, stack_size={}, \
             stack_used={}, address={:#010x}, state={})",
            self.name,
            self.base_priority,
            self.stack_base,
            self.stack_size,
            self.stack_used,
            self.address,
            self.state
        )
    }
}

impl From<virtual_brick_facade::Thread> for Thread {
    fn from(thread: virtual_brick_facade::Thread) -> Self {
        Self {
            name: thread.name,
            base_priority: thread.base_priority,
            stack_base: thread.stack_base,
            stack_size: thread.stack_size,
            stack_used: thread.stack_used,
            address: thread.address,
            state: thread.state,
        }
    }
}

/// Numbers one after the other.
pub(crate) fn packed<'py, T: Copy>(
    py: Python<'py>,
    numbers: &[T],
    bytes_of: fn(T) -> [u8; 8],
) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, 8 * numbers.len(), |bytes| {
        for (bytes, &number) in bytes.chunks_exact_mut(8).zip(numbers) {
            bytes.copy_from_slice(&bytes_of(number));
        }
        Ok(())
    })
}

/// Arrivals at the place of a flow fact.
pub(crate) fn packed_arrivals<'py>(py: Python<'py>, arrivals: &[Arrival]) -> Bound<'py, PyBytes> {
    let fields = |arrival: &Arrival| {
        let thread = arrival.thread.map_or(u32::MAX, |index| index as u32);
        let places = u64::from(arrival.target) << 32 | u64::from(thread);
        [arrival.at_cycles, arrival.count, places]
    };
    let numbers = arrivals.iter().flat_map(fields);
    let bytes: Vec<u8> = numbers.flat_map(u64::to_le_bytes).collect();
    PyBytes::new(py, &bytes)
}

/// Instructions of a profile.
pub(crate) fn packed_steps<'py>(py: Python<'py>, steps: &[ProfileStep]) -> Bound<'py, PyBytes> {
    let words = |step: &ProfileStep| [step.address, step.cycles, step.transfers];
    let words = steps.iter().flat_map(words);
    let bytes: Vec<u8> = words.flat_map(u32::to_le_bytes).collect();
    PyBytes::new(py, &bytes)
}
