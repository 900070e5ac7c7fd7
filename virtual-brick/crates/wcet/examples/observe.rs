// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs functions of an ELF file one after the other on the core, each access in one cycle, and
//! prints the cycles of the last one, to hold against its bound.
//!
//! Usage: `cargo run --release -p wcet --example observe -- ELF SYMBOL...`, code and data in the
//! two megabytes from 0x200000.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[path = "../tests/support/machine.rs"]
#[allow(dead_code)]
mod machine;

fn main() {
    let mut words = std::env::args().skip(1);
    let path = words.next().expect("the path of an ELF file");
    let elf = std::fs::read(&path).expect("a readable file");
    let mut machine = machine::Machine::new(&elf);
    let seen = words.map(|symbol| machine.call(&symbol, [0; 4])).last();
    let seen = seen.expect("at least one function");
    println!(
        "{} cycles, {} bytes of stack",
        seen.cycles, seen.stack_bytes
    );
}
