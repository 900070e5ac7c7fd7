// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flow facts: the loops that a number of iterations in an annotation holds for.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program, VARIANTS};
use crate::support::{bound, check, refusal, report};
use wcet::{unmatched_facts, Annotations, Image};

fn on_all(check: impl Fn(&[u8])) {
    on_levels(&["-O0", "-O1", "-O2", "-Os"], check);
}

fn on_levels(levels: &[&str], check: impl Fn(&[u8])) {
    for flags in VARIANTS.iter().filter(|[_, level]| levels.contains(level)) {
        if let Some(elf) = build("loops", &[program("loops.c")], flags) {
            check(&elf);
        }
    }
}

#[test]
fn a_fact_of_a_file_with_two_loops_is_refused_with_both_unless_it_says_every() {
    on_all(|elf| {
        let wide = "[[loop]]\nfile = \"loops.c\"\niterations = 4\n";
        let text = refusal(elf, "both", wide);
        assert!(
            text.contains("facts.toml: [[loop]] file = \"loops.c\" holds for 2 loops"),
            "{text}"
        );
        assert!(
            text.contains("loop 0 of grow") && text.contains("loop 0 of shrink"),
            "{text}"
        );
        assert!(bound(elf, "both", &format!("{wide}every = true\n")).is_ok());
        assert!(bound(elf, "grow", wide).is_ok());
    });
}

#[test]
fn a_file_is_named_by_its_whole_name() {
    on_all(|elf| {
        let facts = |file: &str| format!("[[loop]]\nfile = \"{file}\"\niterations = 4\n");
        assert!(bound(elf, "grow", &facts("loops.c")).is_ok());
        assert!(refusal(elf, "grow", &facts("oops.c")).contains("loops without a bound"));
    });
}

fn asks_for_the_inner_loop(text: &str) -> bool {
    text.contains("loops.c:33)") || text.contains("loops.c:34)")
}

const OUTER: &str = "[[statement]]\nfile = \"loops.c\"\ndepth = 0\niterations = 5\n";
const INNER: &str = "[[statement]]\nfile = \"loops.c\"\nlines = [33, 34]\ndepth = 1\n";

#[test]
fn a_statement_does_not_bound_a_loop_inside_that_no_statement_shows() {
    on_all(|elf| {
        let whole = format!("{OUTER}lines = [31, 32, 33, 34, 35, 36]\n");
        let text = refusal(elf, "nested", &whole);
        assert!(asks_for_the_inner_loop(&text), "{text}");
        let silent = format!("{OUTER}lines = [31, 32, 35, 36]\n{INNER}");
        let text = refusal(elf, "nested", &silent);
        assert!(asks_for_the_inner_loop(&text), "{text}");
    });
}

#[test]
fn nested_statements_bound_a_loop_each_where_the_code_keeps_them_apart() {
    on_levels(&["-O0"], |elf| {
        let apart = format!("{OUTER}lines = [31, 32, 35, 36]\n{INNER}iterations = ");
        let [few, many] = [2, 3].map(|n| bound(elf, "nested", &format!("{apart}{n}\n")).unwrap());
        assert!(few < many && many < 2 * few);
    });
}

/// So many iterations, and the pass in which the loop is left, wherever that is.
#[test]
fn a_run_with_as_many_iterations_as_the_fact_says_is_within_the_bound() {
    let facts = "[[loop]]\nsymbol = \"grow\"\nindex = 0\niterations = 5\n";
    on_all(|elf| {
        let found = report(elf, "grow", facts).unwrap();
        let seen = Machine::new(elf).call("grow", [5, 0, 0, 0]);
        check("five iterations", &found, seen);
        assert!(Machine::new(elf).call("grow", [9, 0, 0, 0]).cycles > found.bound_cycles);
    });
}

const FILL: &str = "[[loop]]\nsymbol = \"fill\"\nindex = 0\n";

#[test]
fn a_question_names_the_calls_and_an_answer_may_hold_for_these_only() {
    on_levels(&["-O0", "-O1", "-Os"], |elf| {
        let text = format!("{:?}", bound(elf, "either", "").expect_err("a question"));
        assert!(
            text.contains(r#"callers: ["either", "fill_some"]"#),
            "{text}"
        );
        let scoped = format!("{FILL}within = \"fill_some\"\niterations = 5\n");
        let whole = bound(elf, "either", &scoped).unwrap();
        assert!(whole > bound(elf, "fill_all", "").unwrap());
    });
}

#[test]
fn a_fact_that_a_call_certainly_exceeds_is_refused_with_the_call() {
    on_levels(&["-O0", "-O1", "-Os"], |elf| {
        let text = refusal(elf, "either", &format!("{FILL}iterations = 5\n"));
        let fact = "facts.toml: [[loop]] symbol = \"fill\", index = 0, iterations = 5 contradicts";
        assert!(text.starts_with(fact), "{text}");
        assert!(
            text.contains("called by fill_all, called by either, cannot be left"),
            "{text}"
        );
        assert!(bound(elf, "either", &format!("{FILL}iterations = 40\n")).is_ok());
    });
}

#[test]
fn a_fact_for_every_loop_is_refused_where_it_leaves_no_way_on() {
    on_levels(&["-O0", "-O1", "-Os"], |elf| {
        let every = "[[loop]]\nfile = \"loops.c\"\nevery = true\niterations = 5\n";
        assert!(refusal(elf, "either", every).contains("contradicts the code"));
        assert!(bound(elf, "fill_some", every).is_ok());
    });
}

#[test]
fn facts_that_match_nothing_are_told_with_their_field() {
    on_all(|elf| {
        let image = Image::read(elf).unwrap();
        let facts = "[[loop]]\nfile = \"nowhere.c\"\niterations = 1\n\
                     [[never]]\nsymbol = \"growth\"\n[[never]]\nfile = \"loops.c\"\nline = 1\n\
                     [[loop]]\nsymbol = \"fill\"\niterations = 1\nwithin = \"*_none\"\n\
                     [[loop]]\nsymbol = \"fill\"\niterations = 1\nwithin = \"*_some\"\n";
        let facts = Annotations::parse(facts, "facts.toml").unwrap();
        let found = unmatched_facts(&facts, &image);
        let fields: Vec<_> = found.iter().map(|f| (f.table, f.index, f.field)).collect();
        assert_eq!(
            fields,
            [
                ("loop", 0, "file"),
                ("loop", 1, "within"),
                ("never", 0, "symbol"),
                ("never", 1, "line")
            ]
        );
    });
}

#[test]
fn a_loop_left_early_by_a_failed_check_only_has_as_many_executions_as_iterations() {
    let Some(elf) = build("loops", &[program("loops.c")], &["-marm", "-O2"]) else {
        return;
    };
    let facts = |count: &str| {
        let never = "[[never]]\nsymbol = \"failed\"\n";
        format!("{never}[[loop]]\nsymbol = \"checked\"\nindex = 0\n{count} = 4\n")
    };
    let most = bound(&elf, "checked", &facts("header_executions")).unwrap();
    assert_eq!(bound(&elf, "checked", &facts("iterations")).unwrap(), most);
    let mut machine = Machine::new(&elf);
    let samples = machine.address("samples");
    assert!(machine.call("checked", [samples, 3, 0, 0]).cycles <= most);
}
