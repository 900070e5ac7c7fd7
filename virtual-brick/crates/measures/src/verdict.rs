// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Judging expectations: the value that a run gave, and whether it is what was expected.

use serde::Serialize;

use crate::general::general;
use crate::measures::{Criterion, Measures};
use crate::run::{Run, Screen};
use crate::schedule::TaskMeasures;
use crate::sentence::{Bounds, Expectation, Expected, Window};
use crate::units::{signal_unit, unit};

/// The value that decided.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// In the verdict's unit.
    Number(f64),
    /// For people.
    Text(String),
    /// There was none.
    Nothing,
}

/// The value that decided, when it was seen (s), and the judgement.
///
/// For people: `label` says what was expected, `shown` the value, `sentence` both.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Verdict {
    pub expectation: String,
    pub value: Value,
    pub unit: String,
    pub at: Option<f64>,
    pub met: bool,
    pub label: String,
    pub shown: String,
    pub sentence: String,
}

/// The value for people.
fn shown(value: &Value, unit: &str) -> String {
    match value {
        Value::Number(number) => {
            let shown = format!("{} {unit}", general(*number, 4));
            shown.trim_end().to_owned()
        }
        Value::Text(text) => text.clone(),
        Value::Nothing => "none".to_owned(),
    }
}

/// A bounded measure: its value and whether it lies within.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct CriterionVerdict {
    pub measure: String,
    pub value: f64,
    pub minimum: Option<f64>,
    pub maximum: Option<f64>,
    pub met: bool,
    pub label: String,
    pub shown: String,
    pub sentence: String,
}

/// Judge a criterion.
///
/// # Errors
/// The run never reached the measure.
pub fn judge_criterion(
    criterion: &Criterion,
    measures: &Measures,
) -> Result<CriterionVerdict, String> {
    let (measure, minimum, maximum) = (&criterion.measure, criterion.minimum, criterion.maximum);
    let value = measures.value(measure).ok_or_else(|| {
        format!("'{measure}' was never reached in the run; check the inputs, or lengthen the run")
    })?;
    let least = minimum.map(|bound| format!("at least {}", general(bound, 6)));
    let most = maximum.map(|bound| format!("at most {}", general(bound, 6)));
    let expected: Vec<String> = least.into_iter().chain(most).collect();
    let (expected, shown) = (expected.join(" and "), general(value, 4));
    Ok(CriterionVerdict {
        measure: measure.clone(),
        value,
        minimum,
        maximum,
        met: Bounds { minimum, maximum }.contain(value),
        label: format!("{measure} {expected}"),
        sentence: format!(
            "{measure} is {shown}, expected {expected}; look at the report, then change the \
             controller or the criterion"
        ),
        shown,
    })
}

/// Judge one expectation.
///
/// # Errors
/// The run can never show it; the sentence says why.
pub fn judge(
    expectation: &Expectation,
    run: &Run<'_>,
    measures: &Measures,
) -> Result<Verdict, String> {
    let window = expectation.window;
    let (value, unit, at, met) = match &expectation.expected {
        Expected::Signal {
            signal,
            bounds,
            unit,
            ever,
        } => judge_signal(run, window, signal, *bounds, unit.as_deref(), *ever)?,
        Expected::Measure { measure, bounds } => judge_measure(measures, measure, *bounds)?,
        Expected::Lcd { wanted, never } => judge_lcd(run, window, wanted, *never)?,
        Expected::Deadlines { task } => judge_deadlines(measures, task.as_deref())?,
        Expected::Response { task, limit } => judge_response(run, measures, task, *limit)?,
        Expected::PathEnd { x, y, radius } => judge_path(run, (*x, *y), *radius)?,
        Expected::PoweredOff => judge_power(run, window),
        Expected::Fault { wanted, saying } => judge_fault(run, *wanted, saying),
    };
    let label = &expectation.text;
    let shown = shown(&value, unit);
    let when = at.map_or(String::new(), |at| format!(" at {at:.6} s"));
    Ok(Verdict {
        sentence: format!("expected {label}, found {shown}{when}"),
        expectation: label.clone(),
        label: label.clone(),
        unit: unit.to_owned(),
        value,
        at,
        met,
        shown,
    })
}

/// Value, unit, instant and judgement.
type Judged<'a> = (Value, &'a str, Option<f64>, bool);

/// Begin and end of the window in s.
fn span(run: &Run<'_>, window: Window) -> Result<(f64, f64), String> {
    let end = run.end();
    if window.at_end {
        return Ok((end, end));
    }
    if window.last_named() > end {
        return Err(format!(
            "{} s never comes: the run ended after {end:.6} s ({}); name an earlier time",
            general(window.last_named(), 6),
            run.stop.words()
        ));
    }
    Ok((window.begin.unwrap_or(0.0), window.end.unwrap_or(end)))
}

/// How far a value lies outside of the bounds; negative inside.
fn distance(value: f64, bounds: Bounds) -> f64 {
    let below = bounds
        .minimum
        .map_or(f64::NEG_INFINITY, |minimum| minimum - value);
    let above = bounds
        .maximum
        .map_or(f64::NEG_INFINITY, |maximum| value - maximum);
    if below.is_nan() || above.is_nan() {
        f64::NAN
    } else {
        below.max(above)
    }
}

/// The first place of the largest number; one that is none counts as larger.
fn largest(numbers: impl Iterator<Item = f64>) -> usize {
    let mut found = (0, f64::NEG_INFINITY);
    for (place, number) in numbers.enumerate() {
        if number.is_nan() {
            return place;
        }
        if number > found.1 {
            found = (place, number);
        }
    }
    found.0
}

fn judge_signal<'a>(
    run: &Run<'_>,
    window: Window,
    signal: &str,
    bounds: Bounds,
    written: Option<&'a str>,
    ever: bool,
) -> Result<Judged<'a>, String> {
    if run.find(signal).is_none() {
        let known = run.signal_names();
        return Err(format!(
            "the signal '{signal}' was not recorded; recorded: {known}"
        ));
    }
    let (begin, end) = span(run, window)?;
    let (times, values) = run.signal(signal)?;
    // A sample holds until the next one, so the window begins with the sample in force.
    let first = times.partition_point(|&at| at <= begin).saturating_sub(1);
    let last = times.partition_point(|&at| at <= end).max(first + 1);
    let seen = values
        .get(first..last.min(values.len()))
        .unwrap_or_default();
    if seen.is_empty() {
        return Err("there is no sample in this time; lengthen it".to_owned());
    }
    let sign = if ever { -1.0 } else { 1.0 };
    let place = largest(seen.iter().map(|&value| sign * distance(value, bounds)));
    let mut inside = seen.iter().map(|&value| bounds.contain(value));
    let met = if ever {
        inside.any(|met| met)
    } else {
        inside.all(|met| met)
    };
    let size = written.and_then(unit).map_or(1.0, |(_, size)| size);
    let unit = written.unwrap_or_else(|| signal_unit(signal));
    let at = times.get(first + place).copied();
    Ok((Value::Number(seen[place] / size), unit, at, met))
}

fn judge_measure<'a>(
    measures: &Measures,
    measure: &str,
    bounds: Bounds,
) -> Result<Judged<'a>, String> {
    let value = measures.value(measure).ok_or_else(|| {
        format!(
            "'{measure}' was never reached in the run; check the inputs and the scenario's \
             tables, or lengthen the run"
        )
    })?;
    Ok((Value::Number(value), "", None, bounds.contain(value)))
}

fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Lines that are not empty, in one.
fn joined<'a>(lines: impl Iterator<Item = &'a String>) -> String {
    let lines = lines
        .map(|line| words(line))
        .filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" / ")
}

/// The screens of the window with their instants; the one in force at its begin too.
fn screens<'a>(run: &Run<'a>, window: Window) -> Result<Vec<(f64, &'a Screen)>, String> {
    let (begin, end) = span(run, window)?;
    if run.screens.iter().all(|screen| screen.text.is_empty()) {
        return Err(
            "the LCD cannot be read: the image lacks the project's letters; use package NXT.LCD"
                .to_owned(),
        );
    }
    let timed = run.screens.iter();
    let timed: Vec<_> = timed.map(|s| (run.clock.seconds(s.at_cycles), s)).collect();
    let before = timed.iter().rfind(|(at, _)| *at <= begin);
    let within = timed.iter().filter(|(at, _)| begin < *at && *at <= end);
    Ok(before.into_iter().chain(within).copied().collect())
}

fn judge_lcd<'a>(
    run: &Run<'_>,
    window: Window,
    wanted: &str,
    never: bool,
) -> Result<Judged<'a>, String> {
    let wanted = words(wanted);
    let seen = screens(run, window)?;
    for (at, screen) in &seen {
        let mut lines = screen.text.iter().map(|line| words(line));
        if let Some(line) = lines.find(|line| line.contains(&wanted)) {
            return Ok((Value::Text(line), "", Some(*at), !never));
        }
    }
    let Some((at, last)) = seen.last().filter(|_| !never) else {
        return Ok((Value::Nothing, "", None, never));
    };
    let text = joined(last.text.iter());
    let text = if text.is_empty() {
        "(empty)".to_owned()
    } else {
        text
    };
    Ok((Value::Text(text), "", Some(*at), false))
}

fn tasks<'a>(measures: &'a Measures, name: Option<&str>) -> Result<Vec<&'a TaskMeasures>, String> {
    let wanted = name.map(str::to_lowercase);
    let named = |task: &&TaskMeasures| {
        wanted
            .as_ref()
            .is_none_or(|n| task.name.to_lowercase() == *n)
    };
    let found: Vec<_> = measures.tasks.iter().filter(named).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let names: Vec<_> = measures
        .tasks
        .iter()
        .map(|task| task.name.as_str())
        .collect();
    let known = if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    };
    let name = name.unwrap_or("None");
    Err(format!("there is no task '{name}'; the image has: {known}"))
}

fn judge_deadlines<'a>(measures: &Measures, task: Option<&str>) -> Result<Judged<'a>, String> {
    let mut bounded = tasks(measures, task)?;
    bounded.retain(|task| task.deadline_cycles.is_some());
    if bounded.is_empty() {
        return Err("no deadline is known; give one in robot.toml, [[tasks]]".to_owned());
    }
    let missed: usize = bounded.iter().map(|task| task.deadline_misses).sum();
    Ok((Value::Number(missed as f64), "missed", None, missed == 0))
}

fn judge_response<'a>(
    run: &Run<'_>,
    measures: &Measures,
    task: &str,
    limit: f64,
) -> Result<Judged<'a>, String> {
    let found = tasks(measures, Some(task))?;
    let longest = found[0].response_time_cycles_max;
    let longest = longest.ok_or("no job of the task completed; lengthen the run")?;
    let longest = run.clock.seconds(longest.unsigned_abs());
    Ok((Value::Number(longest), "s", None, longest <= limit))
}

fn judge_path<'a>(
    run: &Run<'_>,
    (x_wanted, y_wanted): (f64, f64),
    radius: f64,
) -> Result<Judged<'a>, String> {
    if run.find("body.x").is_none() {
        return Err("no vehicle drives: the scenario uses the bench".to_owned());
    }
    let (_, x) = run.signal("body.x")?;
    let (times, y) = run.signal("body.y")?;
    let (Some(x), Some(y)) = (x.last(), y.last()) else {
        return Err("there is no sample in this time; lengthen it".to_owned());
    };
    let off = libm::hypot(x - x_wanted, y - y_wanted);
    let value = format!("({x:.4}, {y:.4}) m, {off:.4} m off");
    Ok((Value::Text(value), "", times.last().copied(), off <= radius))
}

fn judge_power<'a>(run: &Run<'_>, window: Window) -> Judged<'a> {
    let end = run.end();
    let met = run.stop.reason == "power_off"
        && window.begin.is_none_or(|begin| end >= begin)
        && window.end.is_none_or(|last| end <= last);
    (Value::Text(run.stop.words()), "", Some(end), met)
}

fn judge_fault<'a>(run: &Run<'_>, wanted: bool, saying: &str) -> Judged<'a> {
    if run.stop.alive() {
        return (Value::Text("no fault".to_owned()), "", None, !wanted);
    }
    let shown = run
        .screens
        .last()
        .into_iter()
        .flat_map(|screen| &screen.text);
    let said = joined(std::iter::once(&run.stop.message).chain(shown));
    let said = if said.is_empty() {
        run.stop.reason.clone()
    } else {
        said
    };
    let met = wanted && said.contains(&words(saying));
    (Value::Text(said), "", Some(run.end()), met)
}
