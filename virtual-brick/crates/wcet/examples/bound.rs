// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds a function of an ELF file.
//!
//! Usage: `cargo run --release -p wcet --example bound -- ELF SYMBOL [--annotations FILE]...
//! [--timing plain|optimistic|nominal|pessimistic] [--wait-states N] [--json]`.
//! `plain` (the default) charges one cycle for each access; the others are the chip's profiles.

#[path = "support/chip.rs"]
mod chip;

use std::process::ExitCode;
use wcet::report::Report;
use wcet::{Annotations, Error, Image, MemoryMap, Program};

struct Arguments {
    elf: String,
    symbol: String,
    annotations: Annotations,
    map: MemoryMap,
    json: bool,
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, Error> {
    let mut plain = Vec::new();
    let (mut annotations, mut json) = (Annotations::default(), false);
    let (mut timing, mut wait_states) = ("plain".to_owned(), 1);
    while let Some(word) = words.next() {
        let mut value = || {
            let missing = || Error::Input(format!("{word} needs a value"));
            words.next().ok_or_else(missing)
        };
        match word.as_str() {
            "--annotations" => annotations.extend(read_annotations(&value()?)?),
            "--timing" => timing = value()?,
            "--wait-states" => {
                let text = value()?;
                wait_states = text
                    .parse()
                    .map_err(|_| Error::Input(format!("--wait-states {text}: not a number")))?;
            }
            "--json" => json = true,
            _ => plain.push(word),
        }
    }
    let [elf, symbol] = <[String; 2]>::try_from(plain)
        .map_err(|_| Error::Input("expected ELF and SYMBOL; see the head of this file".into()))?;
    Ok(Arguments {
        elf,
        symbol,
        annotations,
        map: chip::memory_map(&timing, wait_states)?,
        json,
    })
}

fn read_annotations(path: &str) -> Result<Annotations, Error> {
    let text =
        std::fs::read_to_string(path).map_err(|error| Error::Input(format!("{path}: {error}")))?;
    Annotations::parse(&text, path)
}

fn run() -> Result<String, Error> {
    let arguments = parse(std::env::args().skip(1))?;
    let bytes = std::fs::read(&arguments.elf)
        .map_err(|error| Error::Input(format!("{}: {error}", arguments.elf)))?;
    let image = Image::read(&bytes)?;
    let program = Program::new(&image, &arguments.map, &arguments.annotations)?;
    let report = Report::new(&program, &arguments.symbol)?;
    if arguments.json {
        return serde_json::to_string_pretty(&report)
            .map_err(|error| Error::Input(format!("JSON: {error}")));
    }
    Ok(report.text())
}

fn main() -> ExitCode {
    match run() {
        Ok(text) => {
            println!("{}", text.trim_end());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(1)
        }
    }
}
