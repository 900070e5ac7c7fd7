// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The worst path by source lines adds up to the bound.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program, VARIANTS};
use crate::support::LIBGCC;
use wcet::{AnnotationFile, MemoryMap, PathReport, Request, Response};

fn answer(elf: &[u8], functions: &[&str], facts: &str) -> Response {
    let request = Request {
        annotations: vec![AnnotationFile {
            name: "facts".to_owned(),
            text: facts.to_owned(),
            own: false,
        }],
        functions: functions.iter().map(|name| (*name).to_owned()).collect(),
        paths: true,
        ..Request::default()
    };
    let answered = request.answer(elf, &MemoryMap::without_wait_states());
    answered.unwrap()
}

/// Sum of all lines and differences below a function of the path, checked at each function.
fn sum_of_lines(function: &PathReport) -> u64 {
    let calls = function.lines.iter().flat_map(|line| &line.calls);
    let called: u64 = calls.map(sum_of_lines).sum();
    let own: u64 = function.lines.iter().map(|line| line.cycles).sum();
    let sum = (own + called).wrapping_add_signed(function.difference);
    assert_eq!(sum, function.cycles, "{}", function.symbol);
    sum
}

/// Differences of all functions of the path.
fn differences(function: &PathReport) -> u64 {
    let calls = function.lines.iter().flat_map(|line| &line.calls);
    function.difference.unsigned_abs() + calls.map(differences).sum::<u64>()
}

#[test]
fn the_lines_of_the_worst_path_add_up_to_the_bound() {
    let programs = [
        (
            "single_path",
            vec![
                "add_up", "fill", "triangle", "weigh", "chain", "shifts", "frame",
            ],
        ),
        (
            "many_paths",
            vec![
                "choose", "search", "saturate", "clipped", "order", "product", "tail",
            ],
        ),
    ];
    for flags in VARIANTS {
        for (name, functions) in &programs {
            let source = program(&format!("{name}.c"));
            let Some(elf) = build(name, &[source], &flags) else {
                return;
            };
            for found in answer(&elf, functions, LIBGCC).functions {
                assert_eq!(found.error, None);
                let path = found.path.unwrap();
                assert_eq!(sum_of_lines(&path), found.cycles, "{flags:?} {path:#?}");
                assert_eq!(differences(&path), 0, "{flags:?} {path:#?}");
            }
        }
    }
}

#[test]
fn what_a_fact_adds_to_a_call_is_a_difference_of_the_called_function() {
    let Some(elf) = build(
        "single_path",
        &[program("single_path.c")],
        &["-marm", "-O1"],
    ) else {
        return;
    };
    let facts = "[[cost]]\nsymbol = \"add_up\"\nadded_cycles = 1000\nreason = \"a test\"\n";
    let plain = &answer(&elf, &["add_up"], "").functions[0];
    let added = &answer(&elf, &["add_up"], facts).functions[0];
    assert_eq!(added.cycles, plain.cycles + 1000);
    let path = added.path.as_ref().unwrap();
    assert_eq!(sum_of_lines(path), added.cycles);
    assert_eq!(path.difference, 1000);
}

#[test]
fn a_function_with_one_path_executes_each_line_as_often_as_its_worst_path_says() {
    for flags in VARIANTS {
        let Some(elf) = build("single_path", &[program("single_path.c")], &flags) else {
            return;
        };
        for symbol in ["triangle", "chain", "frame"] {
            let worst = answer(&elf, &[symbol], "").functions.remove(0);
            let worst = worst.path.unwrap();
            let steps = Machine::new(&elf).steps_of(symbol, [5, 6, 7, 8]);
            let request = Request {
                runs: vec![steps],
                ..Request::default()
            };
            let answered = request
                .answer(&elf, &MemoryMap::without_wait_states())
                .unwrap();
            let run = &answered.runs[0];
            assert_eq!(executions(run), executions(&worst), "{flags:?} {symbol}");
        }
    }
}

/// A function with its calls, then those that it calls, deeper ones with their depth.
fn called(function: &PathReport, depth: usize, found: &mut Vec<(usize, String, u64)>) {
    found.push((depth, function.symbol.clone(), function.calls));
    for call in function.lines.iter().flat_map(|line| &line.calls) {
        called(call, depth + 1, found);
    }
}

#[test]
fn what_a_veneer_leads_to_is_called_by_the_function_before_it() {
    for level in ["-O0", "-O1", "-O2", "-Os"] {
        let Some(elf) = build("interworking", &[program("interworking.c")], &[level]) else {
            return;
        };
        for symbol in ["arm_to_thumb", "thumb_to_arm"] {
            let steps = Machine::new(&elf).steps_of(symbol, [0; 4]);
            let request = Request {
                runs: vec![steps],
                ..Request::default()
            };
            let answered = request.answer(&elf, &MemoryMap::without_wait_states());
            let mut found = Vec::new();
            called(&answered.unwrap().runs[0], 0, &mut found);
            let other = if symbol == "arm_to_thumb" {
                "thumb_weigh"
            } else {
                "arm_weigh"
            };
            let expected = [(0, symbol.to_owned(), 1), (1, other.to_owned(), 5)];
            assert_eq!(found, expected, "{level} {symbol}");
        }
    }
}

/// Symbol, calls, and line with executions of each function, from the outermost on.
fn executions(function: &PathReport) -> Vec<String> {
    let mut found = vec![format!("{} {}", function.symbol, function.calls)];
    for line in &function.lines {
        found.push(format!("{:?} {}", line.at.line, line.executions));
        found.extend(line.calls.iter().flat_map(executions));
    }
    found
}
