// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures and verdicts of the run so far, by the code that judges native runs.

use measures::{Clock, Expectation, Input, Plan, Run, Stop, Thread};
use serde_json::json;
use trace::{EventKind, NameSpace, Signal};
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::JsError;

use crate::brick::VirtualBrick;

/// Instants and levels of a pin.
type Levels = (String, Vec<u64>, Vec<f64>);

#[wasm_bindgen]
impl VirtualBrick {
    /// Record the levels of pins (0 to 31) from now on, for sentences about them.
    pub fn log_pins(&mut self, pins: Vec<u32>) {
        self.pins = pins.into_iter().filter(|&pin| pin < 32).collect();
        let mask = self.pins.iter().fold(0, |mask, pin| mask | 1 << pin);
        self.brick.log_pins(mask);
    }

    /// Measures of the run so far, and a verdict on each criterion and sentence of the plan; both
    /// are JSON (README of the virtual brick, verdicts). Throws where the plan is none.
    pub fn verdict(&self, plan_json: &str) -> Result<String, JsError> {
        let plan = Plan::from_json(plan_json).map_err(|error| JsError::new(&error))?;
        let answer = self.recorded(|run| measures::measure(run, &plan)?.answer(run, &plan));
        answer.map_err(|error| JsError::new(&error))
    }

    /// The step of a motor in rows of seconds after it, fitted and true speed (rad/s); empty where
    /// there was none.
    pub fn step_response(&self, plan_json: &str, motor: &str) -> Result<Vec<f64>, JsError> {
        let plan = Plan::from_json(plan_json).map_err(|error| JsError::new(&error))?;
        let measured = self.recorded(|run| measures::measure(run, &plan));
        let measured = measured.map_err(|error| JsError::new(&error))?;
        let mut steps = measured.steps.iter();
        let Some((_, step)) = steps.find(|(name, _)| name == motor) else {
            return Ok(Vec::new());
        };
        let speeds = step.fitted.iter().zip(&step.true_speed);
        let rows = step.times.iter().zip(speeds);
        Ok(rows
            .flat_map(|(&at, (&fitted, &exact))| [at, fitted, exact])
            .collect())
    }

    /// What a sentence expects, as JSON: what to know before a run, or its `problem`.
    pub fn expectation(sentence: &str) -> String {
        match Expectation::parse(sentence) {
            Ok(expectation) => expectation.about(),
            Err(problem) => json!({ "problem": problem }).to_string(),
        }
    }
}

impl VirtualBrick {
    /// What `use_run` makes of the record of the run so far.
    fn recorded<T>(&self, use_run: impl FnOnce(&Run<'_>) -> T) -> T {
        let (numerator, denominator) = virtual_brick::CLOCK_HZ;
        let trace = self.brick.trace();
        let (pins, threads) = (self.pin_signals(), self.named_threads());
        let (inputs, screens) = (self.inputs_so_far(), self.displays.screens(&self.brick));
        let logged = pins.iter().map(|(name, at_cycles, values)| Signal {
            name,
            at_cycles,
            values,
        });
        use_run(&Run {
            clock: Clock {
                numerator,
                denominator,
            },
            stop: self.stop(),
            events: trace.events(),
            signals: trace.signals().iter().chain(logged).collect(),
            threads: &threads,
            screens: &screens,
            inputs: &inputs,
        })
    }

    fn stop(&self) -> Stop {
        let ended = self.brick.ended();
        Stop {
            reason: ended
                .map_or("reached", |stop| stop.reason.name())
                .to_owned(),
            at_cycles: ended.map_or(self.brick.cycles(), |stop| stop.at_cycles),
            message: ended.map_or(String::new(), |stop| stop.message.clone()),
        }
    }

    fn named_threads(&self) -> Vec<Thread> {
        let names = self.brick.trace().names().all(NameSpace::Thread);
        let threads = self.brick.threads().into_iter().zip(names);
        let threads = threads.map(|(thread, name)| Thread {
            name: name.clone(),
            base_priority: thread.base_priority,
        });
        threads.collect()
    }

    fn inputs_so_far(&self) -> Vec<Input> {
        let trace = self.brick.trace();
        let names = trace.names().all(NameSpace::Input);
        let applied = trace
            .events()
            .iter()
            .filter(|event| event.kind == EventKind::Input);
        let inputs = applied.filter_map(|event| {
            Some(Input {
                at_cycles: event.at_cycles,
                name: names.get(event.subject as usize)?.clone(),
                value: f64::from_bits(event.value as u64),
            })
        });
        inputs.collect()
    }

    /// A signal for each logged pin, with the instants at which its level changes.
    fn pin_signals(&self) -> Vec<Levels> {
        let log = self.brick.logged_pins();
        let levels = |&pin: &u32| {
            let (mut at_cycles, mut values) = (Vec::new(), Vec::new());
            for levels in log {
                let level = f64::from(levels.pins >> pin & 1);
                if values.last() != Some(&level) {
                    at_cycles.push(levels.at_cycles);
                    values.push(level);
                }
            }
            (format!("pin.{pin}"), at_cycles, values)
        };
        self.pins.iter().map(levels).collect()
    }
}
