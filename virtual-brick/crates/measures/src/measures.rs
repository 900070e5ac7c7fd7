// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Everything a run shows, measured once: tasks, processor, step, path.

use std::collections::BTreeSet;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;
use trace::EventKind;

use crate::motion::{
    count_difference_speed, fitted_speed, path_length, path_measures, step_measures, PathMeasures,
    StepMeasures, RADIANS_PER_COUNT, WINDOW,
};
use crate::run::Run;
use crate::schedule::{
    by_priority, jobs, measure_task, utilization, Task, TaskMeasures, Utilization,
};

/// Interval of the plain difference of counts in s.
const DIFFERENCE_INTERVAL: f64 = 0.004;
const LEAST_SAMPLES: usize = 100;
const DRIVEN_DUTY: i64 = 0xFF;

/// A number to the last bit, which the parser of JSON does not promise.
pub(crate) fn exact<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let written = <&RawValue>::deserialize(deserializer)?;
    written.get().parse().map_err(serde::de::Error::custom)
}

/// As `exact`, or none; also in quotes, for what JSON has no number for, such as `"inf"`.
fn exact_or_null<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let written = <&RawValue>::deserialize(deserializer)?.get();
    let number = (written != "null").then(|| written.trim_matches('"').parse());
    number.transpose().map_err(serde::de::Error::custom)
}

/// The variable with a motor's speed set-point.
#[derive(Clone, Debug, Deserialize)]
pub struct Setpoint {
    /// The motor's port.
    pub port: String,
    /// The recorded variable.
    pub symbol: String,
    /// What turns a value into rad/s.
    #[serde(deserialize_with = "exact")]
    pub factor: f64,
}

/// The window in which the set-point steps, and the motors to measure.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs)]
pub struct StepWindow {
    pub from_ms: u64,
    pub until_ms: u64,
    pub motors: Vec<String>,
}

/// From where on, and over which path length (m), the vehicle drives straight.
#[derive(Clone, Debug, Deserialize)]
pub struct StraightDrive {
    /// Begin.
    pub from_ms: u64,
    /// Path length in m.
    #[serde(deserialize_with = "exact")]
    pub distance: f64,
}

/// A bound on a measure.
#[derive(Clone, Debug, Deserialize)]
pub struct Criterion {
    /// Its name.
    pub measure: String,
    /// Lower bound.
    #[serde(default, deserialize_with = "exact_or_null")]
    pub minimum: Option<f64>,
    /// Upper bound.
    #[serde(default, deserialize_with = "exact_or_null")]
    pub maximum: Option<f64>,
}

/// What the project says about the run: task set, set-points, what the scenario measures and
/// expects.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(missing_docs)]
pub struct Plan {
    pub tasks: Vec<Task>,
    pub setpoints: Vec<Setpoint>,
    pub step: Option<StepWindow>,
    pub straight: Option<StraightDrive>,
    pub criteria: Vec<Criterion>,
    pub expectations: Vec<String>,
}

impl Plan {
    /// The task with this name in whatever letter case.
    fn task(&self, name: &str) -> Option<&Task> {
        let name = name.to_lowercase();
        self.tasks
            .iter()
            .find(|task| task.name.to_lowercase() == name)
    }
}

/// A measured step of one motor; times in s after the step, speeds in rad/s.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct StepRecord {
    pub times: Vec<f64>,
    pub fitted: Vec<f64>,
    pub true_speed: Vec<f64>,
    pub difference_times: Vec<f64>,
    pub difference: Vec<f64>,
    pub measures: StepMeasures,
}

/// All measures of one run; `tasks` from high to low priority, `shares` of the processor.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct Measures {
    pub tasks: Vec<TaskMeasures>,
    pub shares: Vec<f64>,
    pub utilization: Utilization,
    #[serde(serialize_with = "as_map")]
    pub steps: Vec<(String, StepRecord)>,
    pub path: Option<PathMeasures>,
    pub powered_off: bool,
    pub end_cycles: u64,
}

fn as_map<S: Serializer>(steps: &[(String, StepRecord)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(steps.iter().map(|(motor, step)| (motor, &step.measures)))
}

impl Measures {
    /// A measure by its name in a scenario's criteria; none when the run did not reach it.
    ///
    /// Of several motors, the one farthest from zero counts.
    #[must_use]
    pub fn value(&self, measure: &str) -> Option<f64> {
        let path = self.path.as_ref();
        match measure {
            "cpu_utilization" => return Some(self.utilization.busy()),
            "deadline_misses" => {
                let missed = self.tasks.iter().map(|task| task.deadline_misses);
                return Some(missed.sum::<usize>() as f64);
            }
            "powered_off" => return Some(f64::from(u8::from(self.powered_off))),
            "lateral_deviation" => return path?.lateral_deviation,
            "distance" => return path.map(|path| path.distance),
            _ => {}
        }
        let steps = self.steps.iter().map(|(_, step)| &step.measures);
        let values = steps.map(|step| match measure {
            "setpoint" => Some(step.setpoint),
            "final_value" => Some(step.final_value),
            "settling_time" => step.settling_time,
            "overshoot" => Some(step.overshoot),
            "rise_time" => step.rise_time,
            "steady_state_error" => Some(step.steady_state_error),
            _ => None,
        });
        let values: Vec<f64> = values.collect::<Option<_>>()?;
        let farther = |most: f64, value: f64| {
            if value.abs() > most.abs() {
                value
            } else {
                most
            }
        };
        values.into_iter().reduce(farther)
    }
}

/// Measure a run.
///
/// # Errors
/// A signal that the plan needs was not recorded; the sentence names it.
pub fn measure(run: &Run<'_>, plan: &Plan) -> Result<Measures, String> {
    let timed = plan
        .tasks
        .iter()
        .filter(|task| task.release != "background");
    let timed: BTreeSet<&str> = timed.map(|task| task.name.as_str()).collect();
    let threads: BTreeSet<&str> = run
        .threads
        .iter()
        .map(|thread| thread.name.as_str())
        .collect();
    let shares = utilization(run, &(&threads - &timed));
    let all_jobs = jobs(run);
    let order = by_priority(run.threads);
    let measured = order.iter().map(|&index| {
        measure_task(
            run,
            index,
            &all_jobs[index],
            plan.task(&run.threads[index].name),
        )
    });
    let mut steps = Vec::new();
    for motor in plan.step.iter().flat_map(|step| &step.motors) {
        if let Some(record) = step_record(run, plan, motor)? {
            steps.push((motor.clone(), record));
        }
    }
    Ok(Measures {
        tasks: measured.collect(),
        shares: order.iter().map(|&index| shares.threads[index]).collect(),
        utilization: shares,
        steps,
        path: path(run, plan)?,
        powered_off: run.stop.reason == "power_off",
        end_cycles: run.stop.at_cycles,
    })
}

/// Instant (s) and height (rad/s) of the step: the set-point's change, or the first command.
fn step_begin(
    run: &Run<'_>,
    plan: &Plan,
    window: &StepWindow,
    motor: &str,
) -> Result<Option<(f64, f64)>, String> {
    let (begin, end) = (
        window.from_ms as f64 / 1000.0,
        window.until_ms as f64 / 1000.0,
    );
    if let Some(setpoint) = plan
        .setpoints
        .iter()
        .find(|setpoint| setpoint.port == motor)
    {
        let (times, values) = run.signal(&format!("probe.{}", setpoint.symbol))?;
        let heights = values.iter().map(|value| value * setpoint.factor);
        let mut rows = times.into_iter().zip(heights);
        return Ok(rows.find(|(at, height)| (begin..end).contains(at) && height.abs() > 1e-9));
    }
    let mut commands = run.of_kind(EventKind::MotorCommand);
    let first = commands.find(|command| {
        ["A", "B", "C"].get(command.subject as usize) == Some(&motor)
            && command.value & DRIVEN_DUTY != 0
            && (begin..end).contains(&run.clock.seconds(command.at_cycles))
    });
    Ok(first.map(|command| (run.clock.seconds(command.at_cycles), 0.0)))
}

/// The step of a motor; none when it did not happen, or is too short to be measured.
///
/// # Errors
/// As of [`measure`].
fn step_record(run: &Run<'_>, plan: &Plan, motor: &str) -> Result<Option<StepRecord>, String> {
    let Some(window) = &plan.step else {
        return Ok(None);
    };
    let Some((begin, height)) = step_begin(run, plan, window, motor)? else {
        return Ok(None);
    };
    let (instants, counts) = run.signal(&format!("motor.{motor}.encoder"))?;
    let (_, true_speed) = run.signal(&format!("motor.{motor}.angular_velocity"))?;
    let end = window.until_ms as f64 / 1000.0;
    let first = instants.partition_point(|&at| at < begin);
    let last = instants.partition_point(|&at| at <= end);
    if last < first + LEAST_SAMPLES {
        return Ok(None);
    }
    let times: Vec<f64> = instants[first..last].iter().map(|at| at - begin).collect();
    let fitted = fitted_speed(&instants, counts, RADIANS_PER_COUNT, WINDOW);
    let fitted = fitted[first..last].to_vec();
    let (difference_times, difference) = count_difference_speed(
        &times,
        &counts[first..last],
        RADIANS_PER_COUNT,
        DIFFERENCE_INTERVAL,
    );
    Ok(Some(StepRecord {
        measures: step_measures(&times, &fitted, height),
        true_speed: true_speed[first..last].to_vec(),
        times,
        fitted,
        difference_times,
        difference,
    }))
}

fn path(run: &Run<'_>, plan: &Plan) -> Result<Option<PathMeasures>, String> {
    let Some(straight) = plan
        .straight
        .as_ref()
        .filter(|_| run.find("body.x").is_some())
    else {
        return Ok(None);
    };
    let (times, x) = run.signal("body.x")?;
    let (_, y) = run.signal("body.y")?;
    let (_, heading) = run.signal("body.heading")?;
    let (begin, end) = (straight.from_ms as f64 / 1000.0, first_steering(run));
    let first = times.partition_point(|&at| at < begin);
    let last = times.partition_point(|&at| at <= end);
    if first >= last {
        return Ok(Some(PathMeasures {
            lateral_deviation: None,
            distance: 0.0,
        }));
    }
    let window = first..last;
    let (x_window, y_window) = (&x[window.clone()], &y[window]);
    let driven = path_measures(x_window, y_window, heading[first], straight.distance);
    Ok(Some(PathMeasures {
        distance: path_length(x, y),
        ..driven
    }))
}

/// When a hand first turns a motor, or the end of the run; s.
fn first_steering(run: &Run<'_>) -> f64 {
    let turned = |input: &&crate::Input| input.name.ends_with(".hand_angle") && input.value != 0.0;
    let steered = run
        .inputs
        .iter()
        .filter(turned)
        .map(|input| input.at_cycles);
    run.clock
        .seconds(steered.min().unwrap_or(run.stop.at_cycles))
}
