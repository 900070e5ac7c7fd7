// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Recorded runs, their measures and verdicts, as Python knows them.

use measures::{Clock, Expectation, Input, Measures, Plan, Run, Screen, Stop, Thread};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use trace::{Events, Signal};

use crate::errors::raise;
use crate::values::packed;

/// Release, start and completion in cycles.
type Job = (i64, Option<i64>, Option<i64>);

/// A signal with its own copy of the samples.
struct OwnedSignal {
    name: String,
    at_cycles: Vec<u64>,
    values: Vec<f64>,
}

/// What a recording holds, ready to be measured.
#[pyclass(module = "virtual_brick", frozen)]
pub(crate) struct RecordedRun {
    clock: Clock,
    stop: Stop,
    events: Events,
    signals: Vec<OwnedSignal>,
    threads: Vec<Thread>,
    screens: Vec<Screen>,
    inputs: Vec<Input>,
}

#[pymethods]
impl RecordedRun {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        clock_hz: (u64, u64),
        stop: (String, u64, String),
        events: &[u8],
        signals: Vec<(String, PyBuffer<u64>, PyBuffer<f64>)>,
        threads: Vec<(String, u32)>,
        screens: Vec<(u64, Vec<String>)>,
        inputs: Vec<(u64, String, f64)>,
    ) -> PyResult<Self> {
        let (reason, at_cycles, message) = stop;
        let signals = signals.into_iter().map(|(name, cycles, values)| {
            Ok(OwnedSignal {
                name,
                at_cycles: cycles.to_vec(py)?,
                values: values.to_vec(py)?,
            })
        });
        let threads = threads.into_iter().map(|(name, base_priority)| Thread {
            name,
            base_priority,
        });
        let screens = screens
            .into_iter()
            .map(|(at_cycles, text)| Screen { at_cycles, text });
        let inputs = inputs.into_iter().map(|(at_cycles, name, value)| Input {
            at_cycles,
            name,
            value,
        });
        Ok(Self {
            clock: Clock {
                numerator: clock_hz.0,
                denominator: clock_hz.1,
            },
            stop: Stop {
                reason,
                at_cycles,
                message,
            },
            events: Events::from_packed(events),
            signals: signals.collect::<PyResult<_>>()?,
            threads: threads.collect(),
            screens: screens.collect(),
            inputs: inputs.collect(),
        })
    }

    fn measure(slf: Py<Self>, py: Python<'_>, plan_json: &str) -> PyResult<Measured> {
        let plan = Plan::from_json(plan_json).map_err(raise::<PyValueError>)?;
        let run = slf.get();
        let measures = py.detach(|| measures::measure(&run.run(), &plan));
        let measures = measures.map_err(raise::<PyValueError>)?;
        Ok(Measured { run: slf, measures })
    }

    fn jobs(&self) -> Vec<Vec<Job>> {
        let rows =
            |job: &measures::Job| (job.release_cycles, job.start_cycles, job.completion_cycles);
        let all = measures::jobs(&self.run());
        all.iter()
            .map(|jobs| jobs.iter().map(rows).collect())
            .collect()
    }

    fn stretches<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyBytes>>> {
        let found = measures::stretches(&self.run());
        let columns: [fn(&measures::Stretch) -> i64; 4] = [
            |stretch| stretch.begin_cycles,
            |stretch| stretch.end_cycles,
            |stretch| stretch.owner,
            |stretch| stretch.source,
        ];
        let column = |column: fn(&measures::Stretch) -> i64| {
            let numbers: Vec<i64> = found.iter().map(column).collect();
            packed(py, &numbers, i64::to_le_bytes)
        };
        columns.into_iter().map(column).collect()
    }
}

/// The measures of a run.
#[pyclass(module = "virtual_brick", frozen)]
pub(crate) struct Measured {
    run: Py<RecordedRun>,
    measures: Measures,
}

#[pymethods]
impl Measured {
    fn answer(&self, py: Python<'_>, plan_json: &str) -> PyResult<String> {
        let plan = Plan::from_json(plan_json).map_err(raise::<PyValueError>)?;
        let run = self.run.get();
        let answer = py.detach(|| self.measures.answer(&run.run(), &plan));
        answer.map_err(raise::<PyValueError>)
    }

    fn value(&self, measure: &str) -> Option<f64> {
        self.measures.value(measure)
    }

    fn step<'py>(
        &self,
        py: Python<'py>,
        motor: &str,
    ) -> PyResult<Option<Vec<Bound<'py, PyBytes>>>> {
        let mut steps = self.measures.steps.iter();
        let Some((_, step)) = steps.find(|(name, _)| name == motor) else {
            return Ok(None);
        };
        let columns = [
            &step.times,
            &step.fitted,
            &step.true_speed,
            &step.difference_times,
            &step.difference,
        ];
        let columns = columns.map(|column| packed(py, column, f64::to_le_bytes));
        columns.into_iter().collect::<PyResult<_>>().map(Some)
    }
}

impl RecordedRun {
    fn run(&self) -> Run<'_> {
        let signals = self.signals.iter().map(|signal| Signal {
            name: &signal.name,
            at_cycles: &signal.at_cycles,
            values: &signal.values,
        });
        Run {
            clock: self.clock,
            stop: self.stop.clone(),
            events: &self.events,
            signals: signals.collect(),
            threads: &self.threads,
            screens: &self.screens,
            inputs: &self.inputs,
        }
    }
}

/// What a sentence expects, as a JSON object; raises where it is none.
#[pyfunction]
pub(crate) fn expectation(sentence: &str) -> PyResult<String> {
    let parsed = Expectation::parse(sentence).map_err(raise::<PyValueError>)?;
    Ok(parsed.about())
}

/// Angular velocity (rad/s) from encoder counts, packed.
#[pyfunction]
pub(crate) fn fitted_speed<'py>(
    py: Python<'py>,
    times: PyBuffer<f64>,
    counts: PyBuffer<f64>,
    radians_per_count: f64,
    window: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let (times, counts) = (times.to_vec(py)?, counts.to_vec(py)?);
    if times.len() != counts.len() {
        return Err(raise::<PyValueError>("times and counts differ in length"));
    }
    let speed = measures::fitted_speed(&times, &counts, radians_per_count, window);
    packed(py, &speed, f64::to_le_bytes)
}

/// Unit of a signal or input; empty for a ratio, a switch or a variable of the program.
#[pyfunction]
pub(crate) fn signal_unit(name: &str) -> &'static str {
    measures::signal_unit(name)
}
