// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The brick as a JavaScript class.

use std::collections::HashMap;

use serde_json::json;
use trace::NameSpace;
use virtual_brick::{Configuration, ScalarKind, Stop, CLOCK_HZ};
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::JsError;

use crate::scope::{scalar, Scope};
use crate::screens::Displays;
use crate::steps::{Step, Stepper};

/// A step gives up after a virtual second: nothing more is executed, or no job ends.
const STEP_CYCLES_MAX: u64 = CLOCK_HZ.0 / CLOCK_HZ.1;

/// A brick with a program, its surroundings and the record of its run.
#[wasm_bindgen]
pub struct VirtualBrick {
    pub(crate) brick: virtual_brick::VirtualBrick,
    pub(crate) displays: Displays,
    pub(crate) pins: Vec<u32>,
    scope: Scope,
    /// Address and kind by path: the debug information is searched once for each.
    variables: HashMap<String, (u32, ScalarKind)>,
}

#[wasm_bindgen]
impl VirtualBrick {
    /// Assemble a brick and load a program; throws with the sentence of what is wrong.
    #[wasm_bindgen(constructor)]
    pub fn new(configuration_json: &str, elf: &[u8]) -> Result<VirtualBrick, JsError> {
        let configuration = Configuration::from_json(configuration_json)?;
        Ok(Self {
            brick: virtual_brick::VirtualBrick::new(&configuration, elf)?,
            displays: Displays::default(),
            pins: Vec::new(),
            scope: Scope::default(),
            variables: HashMap::new(),
        })
    }

    /// The present.
    pub fn cycles(&self) -> f64 {
        self.brick.cycles() as f64
    }

    /// Run to a cycle; `{reason, at_cycles, message}` as JSON.
    pub fn run_until(&mut self, cycles: f64) -> String {
        let limit = cycles as u64;
        loop {
            self.scope.sample(&self.brick);
            let look_cycles = limit.min(Displays::next_cycles(&self.brick));
            let stop = self
                .brick
                .run_until(look_cycles.min(self.scope.next_cycles()));
            let ended = self.brick.ended().is_some();
            if ended || self.brick.cycles() >= look_cycles {
                self.displays.look(&self.brick);
            }
            if ended || self.brick.cycles() >= limit {
                return stop_json(&stop);
            }
        }
    }

    /// Step by `instruction`, `line`, `controller` (a line of generated C) or `job`: a job of the
    /// thread with this index, or of any when it is negative. The answer is as of `run_until`.
    pub fn step(&mut self, by: &str, thread: i32) -> Result<String, JsError> {
        let step = match by {
            "instruction" => Step::Instruction,
            "line" => Step::Line,
            "controller" => Step::Controller,
            "job" => Step::Job(u32::try_from(thread).ok()),
            _ => {
                return Err(JsError::new(
                    "a step is one of instruction, line, controller, job",
                ))
            }
        };
        let limit = self.brick.cycles().saturating_add(STEP_CYCLES_MAX);
        let mut stepper = Stepper::new(&self.brick, step);
        let stop = self.brick.run_observed(limit, &mut stepper);
        self.scope.sample(&self.brick);
        self.displays.look(&self.brick);
        Ok(stop.map_or_else(|| self.reached(), |stop| stop_json(&stop)))
    }

    /// Let an input change at an instant; throws when it is refused.
    pub fn schedule_input(
        &mut self,
        at_cycles: f64,
        name: &str,
        value: f64,
    ) -> Result<(), JsError> {
        let at_cycles = at_cycles as u64;
        Ok(self.brick.schedule_input(at_cycles, name, value)?)
    }

    /// What can be set: array of `{name, lowest, highest, whole, unit}` as JSON.
    pub fn inputs(&self) -> String {
        let inputs = self.brick.inputs().iter().map(|input| {
            json!({
                "name": input.name, "lowest": input.lowest, "highest": input.highest,
                "whole": input.whole, "unit": input.unit,
            })
        });
        inputs.collect::<serde_json::Value>().to_string()
    }

    /// Record a scalar as the signal `probe.<path>`, as the native run does; an empty kind asks
    /// the debug information.
    pub fn add_probe(&mut self, path: &str, kind: &str) -> Result<(), JsError> {
        let kind = (!kind.is_empty()).then(|| kind.parse()).transpose();
        let kind = kind.map_err(|error: String| JsError::new(&error))?;
        Ok(self.brick.add_probe(path, kind)?)
    }

    /// Channels of the scope and their period; throws when one is unknown.
    pub fn choose_scope(
        &mut self,
        channels: Vec<String>,
        period_cycles: f64,
    ) -> Result<(), JsError> {
        self.scope
            .choose(&self.brick, &channels, period_cycles as u64)
            .map_err(|error| JsError::new(&error))
    }

    /// Rows of the scope since the last call: instant in cycles, then one value per channel.
    pub fn take_scope(&mut self) -> Vec<f64> {
        self.scope.take()
    }

    /// The picture: 64 rows of 100 pixels, one byte 0 or 1 each.
    pub fn lcd(&self) -> Vec<u8> {
        self.brick.lcd()
    }

    /// Sound played from a cycle on.
    pub fn sound(&self, from_cycles: f64) -> Vec<i16> {
        self.brick.sound(from_cycles as u64)
    }

    /// Cycles of one sample of sound.
    pub fn sound_sample_cycles() -> f64 {
        virtual_brick::SOUND_SAMPLE_CYCLES as f64
    }

    /// Number of events recorded.
    pub fn event_count(&self) -> usize {
        self.brick.trace().events().len()
    }

    /// Events from a position on, packed as the trace describes: 24 bytes each.
    pub fn events(&self, first: usize) -> Vec<u8> {
        self.brick.trace().events().packed_from(first).to_vec()
    }

    /// Last sample of each signal: object of name to value as JSON.
    pub fn signals(&self) -> String {
        let signals = self.brick.trace().signals();
        let last = signals
            .iter()
            .map(|signal| (signal.name.to_owned(), json!(signal.values.last())));
        last.collect::<serde_json::Value>().to_string()
    }

    /// Samples of a signal from a position on: instant in cycles and value of each; none when there
    /// is no such signal.
    pub fn samples(&self, name: &str, first: usize) -> Vec<f64> {
        let Some(signal) = self.brick.trace().signals().get(name) else {
            return Vec::new();
        };
        let pairs = signal.at_cycles.iter().zip(signal.values).skip(first);
        pairs
            .flat_map(|(&cycles, &value)| [cycles as f64, value])
            .collect()
    }

    /// The number that a variable of the program has now; throws when there is none.
    pub fn variable(&mut self, path: &str) -> Result<f64, JsError> {
        let Some(&(address, kind)) = self.variables.get(path) else {
            let probe = self.brick.read_scalar(path, None)?;
            let place = (probe.address, probe.kind);
            self.variables.insert(path.to_owned(), place);
            return Ok(probe.as_float());
        };
        Ok(scalar(&self.brick, address, kind))
    }

    /// Names of signals, pins excepted, and of global objects in memory: `{signals, symbols}` as
    /// JSON.
    pub fn channels(&self) -> String {
        let signals: Vec<_> = self
            .brick
            .trace()
            .signals()
            .iter()
            .map(|s| s.name)
            .collect();
        let symbols = self.brick.image().symbols();
        let objects: Vec<_> = symbols
            .iter()
            .filter(|(_, symbol)| symbols.object_at(symbol.address).is_some())
            .map(|(name, symbol)| json!({"name": name, "size": symbol.size}))
            .collect();
        json!({"signals": signals, "symbols": objects}).to_string()
    }

    /// Threads, in the order of their index in events: array of `{name, priority, state,
    /// stack_size, stack_used}` as JSON.
    pub fn threads(&self) -> String {
        let names = self.brick.trace().names().all(NameSpace::Thread);
        let threads = self.brick.threads();
        let threads = threads.iter().zip(names).map(|(thread, name)| {
            json!({
                "name": name, "priority": thread.base_priority, "state": thread.state,
                "stack_size": thread.stack_size, "stack_used": thread.stack_used,
            })
        });
        threads.collect::<serde_json::Value>().to_string()
    }

    /// The next instruction: `{pc, function, offset, file, line}` as JSON; unknown ones are null.
    /// `raised` is `{file, line}` of the failure that ended the program, else null.
    pub fn place(&self) -> String {
        let ended = self.brick.ended().is_some();
        let raised = ended.then(|| self.brick.raised_at()).flatten();
        let pc = self.brick.processor().next_instruction_address();
        let image = self.brick.image();
        let function = image.symbols().nearest_code(pc);
        let line = image.lines().at(pc);
        json!({
            "pc": pc, "function": function.map(|f| f.0), "offset": function.map(|f| f.1),
            "file": line.map(|l| l.file), "line": line.map(|l| l.line),
            "raised": raised.map(|(file, line, _)| json!({"file": file, "line": line})),
        })
        .to_string()
    }

    /// Source places of the calls that lead to the next instruction, innermost first: array of
    /// `{file, line}` as JSON.
    pub fn calls(&self) -> String {
        let places = self.brick.call_places().into_iter();
        let places = places.map(|(file, line)| json!({"file": file, "line": line}));
        places.collect::<serde_json::Value>().to_string()
    }

    /// SHA-256 of bytes, as hexadecimal digits.
    pub fn sha256(bytes: &[u8]) -> String {
        trace::Digest::of_bytes(bytes).to_string()
    }

    /// Why the program's threads cannot be observed.
    pub fn threads_unobserved(&self) -> Option<String> {
        self.brick.threads_unobserved().map(str::to_owned)
    }

    /// Digest of the record up to the present, as hexadecimal digits.
    pub fn digest(&self) -> String {
        self.brick.trace().digest().to_string()
    }
}

impl VirtualBrick {
    fn reached(&self) -> String {
        json!({"reason": "reached", "at_cycles": self.brick.cycles(), "message": ""}).to_string()
    }
}

fn stop_json(stop: &Stop) -> String {
    let (reason, at_cycles) = (stop.reason.name(), stop.at_cycles);
    json!({"reason": reason, "at_cycles": at_cycles, "message": stop.message}).to_string()
}
