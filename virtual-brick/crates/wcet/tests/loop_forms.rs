// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Ordinary forms of loops: how many are bounded without a flow fact, and no run above its bound.

use crate::support::machine::Machine;
use crate::support::random::Random;
use crate::support::toolchain::{build, program};
use crate::support::{check, report, LIBGCC};

/// As projects are compiled, and for size.
const OPTIONS: [[&str; 2]; 2] = [["-marm", "-O2"], ["-mthumb", "-Os"]];

/// Forms that are bounded with each of them, of 32.
const BOUNDED: [usize; 2] = [30, 30];

const RUNS: u32 = 200;

/// Where an object that is an argument lies: the first code.
const OBJECT: u32 = 0x20_2000;

fn forms() -> Vec<String> {
    let source = std::fs::read_to_string(program("loop_forms.c")).unwrap();
    let names = source.lines().filter_map(|line| line.strip_prefix("FORM("));
    let names = names.map(|rest| format!("form_{}", rest.trim_end_matches(')')));
    names.collect()
}

#[test]
fn ordinary_forms_of_loops_are_bounded_and_no_run_exceeds_its_bound() {
    for (options, wanted) in OPTIONS.iter().zip(BOUNDED) {
        let Some(elf) = build("loop_forms", &[program("loop_forms.c")], options) else {
            return;
        };
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(11);
        let mut missing = Vec::new();
        for form in forms() {
            let found = match report(&elf, &form, LIBGCC) {
                Ok(found) => found,
                Err(error) => {
                    missing.push(format!("{form}: {error}"));
                    continue;
                }
            };
            for _ in 0..RUNS {
                let mut argument = [(); 4].map(|()| random.integer());
                if form == "form_argument_to_end" {
                    argument[0] = OBJECT;
                }
                let seen = machine.call(&form, argument);
                check(&options.concat(), &found, seen);
            }
        }
        let bounded = forms().len() - missing.len();
        println!(
            "{options:?}: {bounded} bounded, not\n{}",
            missing.join("\n")
        );
        assert!(
            bounded >= wanted,
            "{options:?}: {bounded} bounded, not\n{}",
            missing.join("\n")
        );
    }
}
