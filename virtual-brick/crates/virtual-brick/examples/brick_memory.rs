// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures the memory of many bricks in one process, each with the same program. Prints one line
//! of JSON: bytes resident and mappings for each brick, and threads.
//!
//! Usage: `cargo run --release -p virtual-brick --example brick_memory -- PROGRAM.elf BRICKS
//! CYCLES`. Linux only: the figures are those of `/proc/self`.

use std::error::Error;
use std::fs;

use virtual_brick::{Configuration, VirtualBrick};

/// A number of `/proc/self/status`.
fn status(name: &str) -> Result<u64, Box<dyn Error>> {
    let text = fs::read_to_string("/proc/self/status")?;
    let line = text.lines().find_map(|line| line.strip_prefix(name));
    let number = line.and_then(|rest| rest.split_whitespace().nth(1));
    Ok(number.ok_or("not in /proc/self/status")?.parse()?)
}

fn mappings() -> Result<usize, Box<dyn Error>> {
    Ok(fs::read_to_string("/proc/self/maps")?.lines().count())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(elf), Some(bricks), Some(cycles)) =
        (arguments.next(), arguments.next(), arguments.next())
    else {
        return Err("expected an image, a number of bricks and a number of cycles".into());
    };
    let (elf, bricks, cycles) = (fs::read(elf)?, bricks.parse::<usize>()?, cycles.parse()?);
    let configuration = Configuration::from_json("{}")?;
    let before = (status("VmRSS")?, mappings()?);
    let mut kept = Vec::with_capacity(bricks);
    for _ in 0..bricks {
        let mut brick = VirtualBrick::new(&configuration, &elf)?;
        brick.run_until(cycles);
        kept.push(brick);
    }
    let resident = 1024 * status("VmRSS")?.saturating_sub(before.0);
    let code: usize = kept.iter().map(VirtualBrick::jit_code_bytes).sum();
    println!(
        "{{\"bricks\": {bricks}, \"resident_bytes\": {}, \"jit_code_bytes\": {}, \
         \"mappings\": {:.2}, \"threads\": {}}}",
        resident / bricks as u64,
        code / bricks,
        (mappings()? as f64 - before.1 as f64) / bricks as f64,
        status("Threads")?,
    );
    Ok(())
}
