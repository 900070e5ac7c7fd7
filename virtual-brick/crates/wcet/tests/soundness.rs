// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds against times observed on the core.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod support;

use support::machine::{Machine, Observation};
use support::random::Random;
use support::toolchain::{build, program, VARIANTS};
use wcet::{Annotations, Image, MemoryMap, Program, Report};

const LIBGCC: &str = include_str!("../annotations/libgcc.toml");

fn bound(elf: &[u8], symbol: &str) -> Report {
    let image = Image::read(elf).unwrap();
    let map = MemoryMap::without_wait_states();
    let annotations = Annotations::parse(LIBGCC, "libgcc.toml").unwrap();
    let program = Program::new(&image, &map, &annotations).unwrap();
    Report::new(&program, symbol).unwrap_or_else(|error| panic!("{symbol}: {error}"))
}

fn check(what: &str, report: &Report, seen: Observation) {
    let (bound, symbol) = (report.bound_cycles, &report.symbol);
    assert!(
        seen.cycles <= bound,
        "{what} {symbol}: {} > {bound}",
        seen.cycles
    );
    let stack = report.stack_bytes.expect("a stack bound");
    assert!(
        seen.stack_bytes <= stack,
        "{what} {symbol}: stack {} > {stack}",
        seen.stack_bytes
    );
}

#[test]
fn bounds_of_functions_with_one_path_equal_their_times() {
    for flags in VARIANTS {
        let Some(elf) = build("single_path", &[program("single_path.c")], &flags) else {
            return;
        };
        let mut machine = Machine::new(&elf);
        for symbol in [
            "add_up", "fill", "triangle", "weigh", "chain", "shifts", "frame",
        ] {
            let report = bound(&elf, symbol);
            let seen = machine.call(symbol, [5, 6, 7, 8]);
            check(&flags.concat(), &report, seen);
            assert_eq!(seen.cycles, report.bound_cycles, "{flags:?} {symbol}");
            assert_eq!(
                Some(seen.stack_bytes),
                report.stack_bytes,
                "{flags:?} {symbol}"
            );
        }
    }
}

/// Longest time seen for a function with these arguments.
fn hunt(
    machine: &mut Machine<'_>,
    what: &str,
    report: &Report,
    runs: u32,
    mut arguments: impl FnMut(&mut Machine<'_>, u32) -> [u32; 4],
) -> u64 {
    (0..runs)
        .map(|run| {
            let chosen = arguments(machine, run);
            let seen = machine.call(&report.symbol, chosen);
            check(what, report, seen);
            seen.cycles
        })
        .max()
        .unwrap_or(0)
}

#[test]
fn no_time_of_a_function_with_many_paths_exceeds_its_bound() {
    for flags in VARIANTS {
        let Some(elf) = build("many_paths", &[program("many_paths.c")], &flags) else {
            return;
        };
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(7);
        for symbol in [
            "choose", "search", "saturate", "clipped", "order", "product", "tail",
        ] {
            let report = bound(&elf, symbol);
            let longest = hunt(
                &mut machine,
                &flags.concat(),
                &report,
                300,
                |machine, run| {
                    if symbol == "order" {
                        machine.call("disorder", [run, 0, 0, 0]);
                    }
                    [
                        run % 13,
                        random.integer(),
                        random.integer(),
                        random.integer(),
                    ]
                },
            );
            println!("{flags:?} {symbol}: {longest} of {}", report.bound_cycles);
        }
    }
}

#[test]
fn what_a_call_changes_is_forgotten_in_a_loop_whose_counter_it_computes() {
    for flags in [["-marm", "-O2"], ["-mthumb", "-O2"]] {
        let Some(elf) = build("floats", &[program("floats.c")], &flags) else {
            return;
        };
        let image = Image::read(&elf).unwrap();
        let map = MemoryMap::without_wait_states();
        let nine_rounds = "[[loop]]\nsymbol = \"float_sum\"\nheader_executions = 10\n";
        let mut annotations = Annotations::parse(nine_rounds, "nine rounds").unwrap();
        annotations.extend(Annotations::parse(LIBGCC, "libgcc.toml").unwrap());
        let program = Program::new(&image, &map, &annotations).unwrap();
        let report = Report::new(&program, "float_sum").unwrap();
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(9);
        hunt(&mut machine, &flags.concat(), &report, 2_000, |_, _| {
            [random.float(), f32::NAN.to_bits(), 0, 0]
        });
    }
}

#[test]
fn no_time_of_the_support_library_exceeds_its_bound() {
    for flags in [["-marm", "-O2"], ["-mthumb", "-O2"]] {
        let Some(elf) = build("floats", &[program("floats.c")], &flags) else {
            return;
        };
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(3);
        let floats = [
            "float_add",
            "float_multiply",
            "float_divide",
            "float_compare",
        ];
        let others = ["float_to_integer", "integer_to_float"];
        let divisions = ["unsigned_divide", "signed_divide", "unsigned_rest"];
        for symbol in floats.iter().chain(&others).chain(&divisions) {
            let report = bound(&elf, symbol);
            let is_float = floats.contains(symbol);
            let longest = hunt(&mut machine, &flags.concat(), &report, 20_000, |_, _| {
                if is_float {
                    [random.float(), random.float(), 0, 0]
                } else {
                    [random.integer(), random.integer(), 0, 0]
                }
            });
            println!("{flags:?} {symbol}: {longest} of {}", report.bound_cycles);
        }
    }
}
