// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs all single-step vectors of an archive and prints a summary as JSON.
//!
//! Usage: `cargo run --release -p arm7tdmi --example single_step -- ARCHIVE.tar.xz`.
//! Differences go to standard error; the exit code is 1 if there are any, 2 if nothing ran.

#[path = "../tests/support/mod.rs"]
mod support;

use std::path::Path;
use std::process::ExitCode;
use support::{archive, single_step::Class};

/// Comparisons that the vectors offer and this run does not make, with the reasons.
const EXCLUDED: [(&str, &str, &str); 4] = [
    (
        "arm_undefined",
        "cycles under the default timing profile",
        "the core that produced the vectors spends 3 cycles; ARM DDI 0029E section 10 gives 4 and \
         the default follows it; all vectors run under a profile without that internal cycle",
    ),
    (
        "arm_mul_mla, arm_mull_mlal, thumb_mul",
        "carry flag",
        "the architecture leaves C without meaning after a multiplication that sets flags",
    ),
    (
        "ARM state after the instruction",
        "bits 1:0 of r15",
        "they are zero in ARM state (ARM DDI 0029E section 3.7); the core that produced the \
         vectors keeps them after a branch to an unaligned address",
    ),
    (
        "arm_msr_flags",
        "bits 27:8 of CPSR",
        "they do not exist in the ARM7TDMI (ARM DDI 0029E section 3.8) and read as zero here",
    ),
];

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("expected the path of the vector archive (.tar.xz) as the only argument");
        return ExitCode::from(2);
    };
    match run(Path::new(&path)) {
        Ok((case_count, passed)) => {
            println!("{}", summary(case_count, passed));
            ExitCode::from(u8::from(passed != case_count))
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(path: &Path) -> Result<(usize, usize), String> {
    let (mut case_count, mut passed) = (0, 0);
    for member in archive::read(path)? {
        let class = Class::parse(&member.name, &member.content)?;
        for record in &class.records {
            case_count += 1;
            match class.run(record) {
                Ok(()) => passed += 1,
                Err(difference) => eprintln!("{difference}"),
            }
        }
    }
    if case_count == 0 {
        return Err(format!("{}: no vectors in the archive", path.display()));
    }
    Ok((case_count, passed))
}

fn summary(case_count: usize, passed: usize) -> String {
    let excluded: Vec<String> = EXCLUDED
        .iter()
        .map(|(class, what, reason)| {
            let reason = format!("no case, but of {class} the {what}: {reason}");
            format!(r#"{{"count":0,"reason":"{reason}"}}"#)
        })
        .collect();
    let counts = format!(r#""case_count":{case_count},"passed":{passed}"#);
    let excluded = excluded.join(",");
    format!(r#"{{"area":"cpu","suite":"single-step",{counts},"excluded":[{excluded}]}}"#)
}
