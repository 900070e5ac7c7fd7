// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds against times observed on the core.

use crate::support::machine::Machine;
use crate::support::random::Random;
use crate::support::toolchain::{build, program, VARIANTS};
use crate::support::{check, check_exact, report, LIBGCC};
use wcet::Report;

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
            let report = report(&elf, symbol, "").unwrap();
            check_exact(&flags.concat(), &report, &mut machine, [5, 6, 7, 8]);
        }
    }
}

/// Longest time seen for a function with these arguments.
fn longest_time(
    machine: &mut Machine,
    what: &str,
    report: &Report,
    runs: u32,
    mut arguments: impl FnMut(&mut Machine, u32) -> [u32; 4],
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
            let report = report(&elf, symbol, LIBGCC).unwrap();
            let longest = longest_time(
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
fn what_a_call_changes_is_invalidated_in_a_loop_whose_counter_it_computes() {
    for flags in [["-marm", "-O2"], ["-mthumb", "-O2"]] {
        let Some(elf) = build("floats", &[program("floats.c")], &flags) else {
            return;
        };
        let nine_rounds = "[[loop]]\nsymbol = \"float_sum\"\nheader_executions = 10\n";
        let facts = format!("{nine_rounds}{LIBGCC}");
        let report = report(&elf, "float_sum", &facts).unwrap();
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(9);
        longest_time(&mut machine, &flags.concat(), &report, 2_000, |_, _| {
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
            let report = report(&elf, symbol, LIBGCC).unwrap();
            let is_float = floats.contains(symbol);
            let longest = longest_time(&mut machine, &flags.concat(), &report, 20_000, |_, _| {
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
