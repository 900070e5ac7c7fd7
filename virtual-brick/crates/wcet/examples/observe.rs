// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs functions of an ELF file one after the other on the core, each access in one cycle, and
//! prints the cycles of the last one, to hold against its bound.
//!
//! Usage: `cargo run --release -p wcet --example observe -- ELF SYMBOL... [--recursive NAME]...`,
//! code and data in the two megabytes from 0x200000. For each recursive function, a further line
//! has its most activations in one call from outside and at the same time, in another run.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[path = "../tests/support/machine.rs"]
#[allow(dead_code)]
mod machine;

use machine::Machine;

fn main() {
    let mut words = std::env::args().skip(1);
    let path = words.next().expect("the path of an ELF file");
    let elf = std::fs::read(&path).expect("a readable file");
    let (mut symbols, mut recursive) = (Vec::new(), Vec::new());
    while let Some(word) = words.next() {
        if word == "--recursive" {
            recursive.push(words.next().expect("a function after --recursive"));
        } else {
            symbols.push(word);
        }
    }
    let mut machine = Machine::new(&elf);
    let seen = symbols
        .iter()
        .map(|symbol| machine.call(symbol, [0; 4]))
        .last();
    let seen = seen.expect("at least one function");
    println!(
        "{} cycles, {} bytes of stack",
        seen.cycles, seen.stack_bytes
    );
    let mut machine = Machine::new(&elf);
    let (last, first) = symbols.split_last().expect("at least one function");
    let entries: Vec<u32> = recursive.iter().map(|name| machine.address(name)).collect();
    first.iter().for_each(|symbol| {
        machine.call(symbol, [0; 4]);
    });
    if !entries.is_empty() {
        for ((calls, depth), name) in machine.activations(last, &entries).iter().zip(&recursive) {
            println!("{name} {calls} {depth}");
        }
    }
}
