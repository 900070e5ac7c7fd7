// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Signals: physical quantities sampled together, one row per sampling instant.

use crate::error::TraceError;

/// A signal and its samples.
#[derive(Clone, Debug)]
struct Series {
    name: String,
    first_row: usize,
    values: Vec<f64>,
}

/// View of one signal: `at_cycles` and `values` have the same length.
#[derive(Clone, Copy, Debug)]
pub struct Signal<'a> {
    /// Name, for example `motor.B.angle`.
    pub name: &'a str,
    /// Sampling instants in cycles.
    pub at_cycles: &'a [u64],
    /// Samples in SI units.
    pub values: &'a [f64],
}

/// All signals; they share the column of instants.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    at_cycles: Vec<u64>,
    series: Vec<Series>,
    total: usize,
}

impl Signals {
    pub(crate) fn declare(&mut self, name: &str) -> usize {
        if let Some(index) = self.series.iter().position(|series| series.name == name) {
            return index;
        }
        self.series.push(Series {
            name: name.to_owned(),
            first_row: self.at_cycles.len(),
            values: Vec::new(),
        });
        self.series.len() - 1
    }

    pub(crate) fn sample(
        &mut self,
        at_cycles: u64,
        values: &[f64],
        limit: usize,
    ) -> Result<(), TraceError> {
        let (expected, given) = (self.series.len(), values.len());
        if expected != given {
            return Err(TraceError::WrongSampleLength { expected, given });
        }
        if self.total + given > limit {
            return Err(TraceError::TooManySignalValues { limit });
        }
        if let Some(&previous_cycles) = self.at_cycles.last() {
            if at_cycles < previous_cycles {
                return Err(TraceError::OutOfOrder {
                    previous_cycles,
                    at_cycles,
                });
            }
        }
        self.at_cycles.push(at_cycles);
        self.total += given;
        for (series, &value) in self.series.iter_mut().zip(values) {
            series.values.push(value);
        }
        Ok(())
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.at_cycles.len()
    }

    /// Forget all but the first `rows` rows and the first `series` signals.
    pub(crate) fn truncate(&mut self, rows: usize, series: usize) {
        self.at_cycles.truncate(rows);
        self.series.truncate(series);
        for series in &mut self.series {
            series.first_row = series.first_row.min(rows);
            series.values.truncate(rows - series.first_row);
        }
        self.total = self.series.iter().map(|series| series.values.len()).sum();
    }

    /// Number of declared signals.
    #[must_use]
    pub fn len(&self) -> usize {
        self.series.len()
    }

    /// No signal is declared.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }

    /// The signals in the order of declaration.
    pub fn iter(&self) -> impl Iterator<Item = Signal<'_>> {
        self.series.iter().map(|series| Signal {
            name: &series.name,
            at_cycles: &self.at_cycles[series.first_row..],
            values: &series.values,
        })
    }

    /// The signal of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Signal<'_>> {
        self.iter().find(|signal| signal.name == name)
    }
}
