// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures how fast each engine runs a program on the whole brick, peripherals and plant
//! included, until the program ends or a number of cycles has passed. Prints one line of JSON.
//!
//! Usage: `cargo run --release -p virtual-brick --example brick_speed -- PROGRAM.elf [CYCLES
//! [RUNS]]`.

use std::process::ExitCode;
use std::time::Instant;

use arm7tdmi::Step;
use cpu_time::ProcessTime;
use virtual_brick::{
    Access, Configuration, Engine, ScalarKind, StepObserver, VirtualBrick, CLOCK_HZ,
};

const ENGINES: [(&str, Engine); 3] = [
    ("fast", Engine::Fast),
    ("blocks", Engine::Blocks),
    ("reference", Engine::Reference),
];

/// Counts instructions.
struct Counter(u64);

impl StepObserver for Counter {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        false
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, _brick: &VirtualBrick, step: Step) -> bool {
        self.0 += u64::from(step == Step::Instruction);
        false
    }
}

/// Seconds that passed, and processor time of all threads, the compile thread included.
#[derive(Clone, Copy)]
struct Took {
    seconds: f64,
    processor_seconds: f64,
}

fn main() -> ExitCode {
    match measure() {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn measure() -> Result<String, String> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments
        .next()
        .ok_or("expected the path of an ELF image")?;
    let mut number = |default: u64| match arguments.next() {
        Some(text) => text.parse().map_err(|_| format!("'{text}' is no number")),
        None => Ok(default),
    };
    let (cycles, runs) = (number(1 << 30)?, number(5)?);
    let elf = std::fs::read(&path).map_err(|error| format!("{path}: {error}"))?;
    let mut counter = Counter(0);
    let mut counted = brick(Engine::Reference, &elf)?;
    let _ = counted.run_observed(cycles, &mut counter);
    let virtual_seconds = counted.cycles() as f64 * CLOCK_HZ.1 as f64 / CLOCK_HZ.0 as f64;
    let mut answer = format!(
        r#"{{"instructions":{},"cycles":{},"virtual_seconds":{virtual_seconds}"#,
        counter.0,
        counted.cycles()
    );
    if let Ok(result) = counted.read_scalar("result", Some(ScalarKind::U32)) {
        answer += &format!(r#","result":{}"#, result.as_float());
    }
    let mut times = ENGINES.map(|_| Vec::new());
    for _ in 0..runs.max(1) {
        // One after the other in each round: what else the host does disturbs them alike.
        for ((_, engine), times) in ENGINES.iter().zip(&mut times) {
            let mut brick = brick(*engine, &elf)?;
            let (start, processor) = (Instant::now(), ProcessTime::now());
            brick.run_until(cycles);
            times.push(Took {
                seconds: start.elapsed().as_secs_f64(),
                processor_seconds: processor.elapsed().as_secs_f64(),
            });
            let same = brick.processor() == counted.processor();
            if !same || brick.cycles() != counted.cycles() {
                return Err(format!("{path}: the engines differ at the end"));
            }
        }
    }
    for ((name, _), times) in ENGINES.iter().zip(&times) {
        let (least, median) = least_and_median(times, |took| took.seconds);
        let (_, processor) = least_and_median(times, |took| took.processor_seconds);
        let rounds: Vec<f64> = times.iter().map(|took| took.processor_seconds).collect();
        let rate = |seconds: f64| counter.0 as f64 / seconds / 1e6;
        answer +=
            &format!(r#","{name}":{{"seconds":{median:.6},"processor_seconds":{processor:.6},"#);
        answer += &format!(
            r#""rounds":{rounds:?},"mips":{:.1},"mips_best":{:.1},"#,
            rate(median),
            rate(least)
        );
        answer += &format!(r#""times_real_time":{:.2}}}"#, virtual_seconds / median);
    }
    Ok(answer + "}")
}

fn least_and_median(times: &[Took], which: impl Fn(&Took) -> f64) -> (f64, f64) {
    let mut seconds: Vec<f64> = times.iter().map(which).collect();
    seconds.sort_by(f64::total_cmp);
    (seconds[0], seconds[seconds.len() / 2])
}

fn brick(engine: Engine, elf: &[u8]) -> Result<VirtualBrick, String> {
    let mut configuration = Configuration::from_json("{}").map_err(|error| error.to_string())?;
    configuration.engine = engine;
    VirtualBrick::new(&configuration, elf).map_err(|error| error.to_string())
}
