// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs the files `*.json.bin` of the public suite SingleStepTests/ARM7TDMI (its format of
//! December 2024: five opcodes per test) and prints a summary as JSON.
//!
//! Usage: `cargo run --release -p arm7tdmi --example public_single_step -- FOLDER`.
//! Differences go to standard error; the exit code is 1 if there are any, 2 if nothing ran.

#[path = "../tests/support/public_suite.rs"]
mod public_suite;

use std::path::Path;
use std::process::ExitCode;

use public_suite::{Excluded, Suite};

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("expected the folder with the suite's *.json.bin files as the only argument");
        return ExitCode::from(2);
    };
    match run(Path::new(&folder)) {
        Ok((line, failed)) => {
            println!("{line}");
            ExitCode::from(u8::from(failed))
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(folder: &Path) -> Result<(String, bool), String> {
    let shown = folder.display();
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{shown}: {error}"))?;
    let mut paths: Vec<_> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.to_string_lossy().ends_with(".json.bin"))
        .collect();
    paths.sort();
    let mut excluded = [0; Excluded::ALL.len()];
    let (mut cases, mut passed) = (0, 0);
    for path in &paths {
        let content =
            std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let suite = Suite::parse(name.trim_end_matches(".json.bin"), &content)?;
        let mut shown = 0;
        for case in &suite.cases {
            cases += 1;
            match suite.run(case) {
                Ok(None) => passed += 1,
                Ok(Some(reason)) => excluded[reason as usize] += 1,
                Err(difference) if shown < 3 => {
                    shown += 1;
                    eprintln!("{}: {difference}", suite.name);
                }
                Err(_) => {}
            }
        }
    }
    if cases == 0 {
        return Err(format!("{shown}: no *.json.bin file with tests"));
    }
    let reasons: Vec<String> = Excluded::ALL
        .into_iter()
        .zip(excluded)
        .filter(|&(_, count)| count != 0)
        .map(|(reason, count)| format!(r#"{{"count":{count},"reason":"{}"}}"#, reason.sentence()))
        .collect();
    let failed = passed + excluded.iter().sum::<usize>() != cases;
    let counts = format!(r#""case_count":{cases},"passed":{passed}"#);
    let reasons = reasons.join(",");
    let line = format!(
        r#"{{"area":"cpu","suite":"single-step, public",{counts},"excluded":[{reasons}]}}"#
    );
    Ok((line, failed))
}
