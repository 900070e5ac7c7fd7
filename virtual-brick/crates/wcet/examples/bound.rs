// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds a function of an ELF file.
//!
//! Usage: `cargo run --release -p wcet --example bound -- ELF SYMBOL [--annotations FILE]...
//! [--timing plain|optimistic|nominal|pessimistic] [--wait-states N] [--json]`.
//! `plain` (the default) charges one cycle for each access; the others are the chip's profiles.
//! With `--own-data STACK_POINTER [--after SYMBOL]...` the function is bounded as it is, with the
//! memory that the image and the functions named before it leave; variables named by `--input`
//! may have any content.

#[path = "support/chip.rs"]
mod chip;

use std::process::ExitCode;
use wcet::closed::{Closed, Input};
use wcet::report::Report;
use wcet::{Annotations, Error, Image, MemoryMap, Program};

struct Arguments {
    elf: String,
    symbol: String,
    annotations: Annotations,
    map: MemoryMap,
    json: bool,
    own_data: Option<u32>,
    before: Vec<String>,
    inputs: Vec<Input>,
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, Error> {
    let mut plain = Vec::new();
    let (mut annotations, mut json) = (Annotations::default(), false);
    let (mut own_data, mut before, mut inputs) = (None, Vec::new(), Vec::new());
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
            "--input" => inputs.push(Input::any(value()?)),
            "--after" => before.push(value()?),
            "--own-data" => {
                let text = value()?;
                let number = u32::from_str_radix(text.trim_start_matches("0x"), 16);
                own_data =
                    Some(number.map_err(|_| Error::Input(format!("{text}: no stack pointer")))?);
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
        own_data,
        before,
        inputs,
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
    if let Some(stack_pointer) = arguments.own_data {
        let mut calls = arguments.before;
        calls.push(arguments.symbol);
        let closed = Closed {
            calls,
            stack_pointer,
            inputs: arguments.inputs,
        };
        let found = closed.bound(&image, &arguments.map, &arguments.annotations)?;
        return Ok(format!("{} cycles", found.cycles));
    }
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
