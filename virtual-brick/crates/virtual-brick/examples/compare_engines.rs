// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Answers random requests with all engines for a time and compares stops, registers, memory,
//! cycles and records at random instants. Prints a summary as JSON.
//!
//! Usage: `cargo run --release -p virtual-brick --example compare_engines -- [SECONDS [SEED]]`.
//! Differences and how the runs ended go to standard error; the exit code is 1 if there are
//! differences.

#[path = "../tests/support/mod.rs"]
mod support;

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use support::requests;

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
    let mut ends = BTreeMap::<_, u32>::new();
    for seed in first.. {
        if Instant::now() >= end {
            break;
        }
        for (kind, longest) in requests::KINDS {
            cases += 1;
            match requests::compare(seed, kind, longest) {
                Ok(reason) => {
                    passed += 1;
                    *ends.entry(reason.name()).or_default() += 1;
                }
                Err(difference) => eprintln!("{difference}"),
            }
        }
    }
    eprintln!("{ends:?}");
    let counts = format!(r#""case_count":{cases},"passed":{passed}"#);
    println!(r#"{{"area":"cpu","suite":"fast engine equals reference engine",{counts}}}"#);
    ExitCode::from(u8::from(cases != passed))
}
