// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! `digest RUN ELF`: runs what a run file says with this image and prints the trace digest.
//!
//! A run file is the JSON object that docs/reference/run-files.md describes; of it,
//! `configuration`, `probes`, `inputs` and `until_cycles` are used.

use std::error::Error;

use serde_json::Value;
use virtual_brick::{Configuration, VirtualBrick};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(run), Some(elf)) = (arguments.next(), arguments.next()) else {
        return Err("expected a run file and an image".into());
    };
    let run: Value = serde_json::from_slice(&std::fs::read(run)?)?;
    let configuration = Configuration::from_json(&run["configuration"].to_string())?;
    let mut brick = VirtualBrick::new(&configuration, &std::fs::read(elf)?)?;
    for probe in run["probes"].as_array().into_iter().flatten() {
        let symbol = probe["symbol"].as_str().ok_or("a probe without symbol")?;
        let kind = probe["kind"].as_str().map(str::parse).transpose()?;
        brick.add_probe(symbol, kind)?;
    }
    for input in run["inputs"].as_array().into_iter().flatten() {
        let at_cycles = input["at_cycles"]
            .as_u64()
            .ok_or("an input without instant")?;
        let name = input["name"].as_str().ok_or("an input without name")?;
        let value = input["value"].as_f64().ok_or("an input without value")?;
        brick.schedule_input(at_cycles, name, value)?;
    }
    brick.run_until(run["until_cycles"].as_u64().ok_or("no `until_cycles`")?);
    println!("{}", brick.trace().digest());
    Ok(())
}
