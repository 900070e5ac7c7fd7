// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Compiling programs, bounding them, running them on the core, and searching for their longest
//! time.

#[allow(dead_code)] // the examples use the rest
pub mod machine;
pub mod random;
pub mod toolchain;

use machine::{Machine, Observation};
use wcet::{Annotations, Error, Image, MemoryMap, Program, Report};

pub const LIBGCC: &str = include_str!("../../annotations/libgcc.toml");

/// Bound of a function with these annotations, each access in one cycle.
pub fn report(elf: &[u8], symbol: &str, facts: &str) -> Result<Report, Error> {
    let image = Image::read(elf)?;
    let map = MemoryMap::without_wait_states();
    let annotations = Annotations::parse(facts, "facts.toml")?;
    let program = Program::new(&image, &map, &annotations)?;
    Report::new(&program, symbol)
}

/// Cycles of that bound.
pub fn bound(elf: &[u8], symbol: &str, facts: &str) -> Result<u64, Error> {
    Ok(report(elf, symbol, facts)?.bound_cycles)
}

/// The error in place of a bound.
pub fn refusal(elf: &[u8], symbol: &str, facts: &str) -> String {
    bound(elf, symbol, facts).expect_err(symbol).to_string()
}

/// Time and stack of a run are within the bound.
pub fn check(what: &str, report: &Report, seen: Observation) {
    let (bound, symbol) = (report.bound_cycles, &report.symbol);
    let stack = report.stack_bytes.expect("a stack bound");
    assert!(
        seen.cycles <= bound && seen.stack_bytes <= stack,
        "{what} {symbol}: {seen:?}, at most {bound} cycles and {stack} bytes"
    );
}

/// The bound is the time and stack of a run with these arguments.
pub fn check_exact(what: &str, report: &Report, machine: &mut Machine, arguments: [u32; 4]) {
    let seen = machine.call(&report.symbol, arguments);
    let bounds = (report.bound_cycles, report.stack_bytes);
    let symbol = &report.symbol;
    assert_eq!(
        (seen.cycles, Some(seen.stack_bytes)),
        bounds,
        "{what} {symbol}"
    );
}
