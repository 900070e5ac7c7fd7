// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs random programs on both engines for a time and compares registers, memory, cycles and
//! trace at random instants. Prints a summary as JSON.
//!
//! Usage: `cargo run --release -p virtual-brick --example compare_engines -- [SECONDS [SEED]]`.
//! Differences go to standard error; the exit code is 1 if there are any.

#[path = "../tests/support/mod.rs"]
mod support;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use support::random::{self, Kind, Numbers};
use virtual_brick::{Engine, VirtualBrick};

const PIECES: u32 = 16;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Some(Ok(seconds)), Some(Ok(first))) = (
        arguments.next().or(Some(Ok(60))),
        arguments.next().or(Some(Ok(1_000))),
    ) else {
        eprintln!("expected a number of seconds and a first seed");
        return ExitCode::from(2);
    };
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut cases, mut passed) = (0, 0);
    for seed in first.. {
        if Instant::now() >= end {
            break;
        }
        for (kind, longest) in [
            (Kind::Ram, 20_000),
            (Kind::Flash, 200_000),
            (Kind::SlowFlash, 4_000_000),
        ] {
            cases += 1;
            match compare(seed, kind, longest) {
                Ok(()) => passed += 1,
                Err(difference) => eprintln!("seed {seed}, {kind:?}: {difference}"),
            }
        }
    }
    let counts = format!(r#""case_count":{cases},"passed":{passed}"#);
    println!(r#"{{"area":"cpu","suite":"fast engine equals reference engine",{counts}}}"#);
    ExitCode::from(u8::from(cases != passed))
}

fn compare(seed: u64, kind: Kind, longest: u32) -> Result<(), String> {
    let elf = random::image(seed, kind);
    let brick = |engine, jit_threshold_runs| {
        let mut configuration = support::vehicle();
        configuration.engine = engine;
        configuration.jit_threshold_runs = jit_threshold_runs;
        configuration.jit_synchronous = seed % 3 != 0;
        VirtualBrick::new(&configuration, &elf).map_err(|error| error.to_string())
    };
    // Most of the run is JIT code, since it is compiled so early; with some seeds by a thread.
    let mut jit = brick(Engine::Fast, 1 + (seed % 8) as u32)?;
    let mut blocks = brick(Engine::Blocks, 0)?;
    let mut reference = brick(Engine::Reference, 0)?;
    let mut numbers = Numbers::new(seed);
    let mut until = 0;
    for _ in 0..PIECES {
        until += u64::from(1 + numbers.below(longest));
        let stop = reference.run_until(until);
        for (name, fast) in [("JIT code", &mut jit), ("blocks", &mut blocks)] {
            let memory = |brick: &VirtualBrick| brick.read_memory(0x0020_0000, 0x1_0000);
            let same = fast.run_until(until) == stop
                && fast.cycles() == reference.cycles()
                && fast.processor() == reference.processor()
                && memory(fast) == memory(&reference)
                && fast.trace().digest() == reference.trace().digest();
            if !same {
                return Err(format!("{name} and reference differ before cycle {until}"));
            }
        }
    }
    Ok(())
}
