// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Stacks of functions with objects whose size is computed, and of tasks.

use crate::support::machine::Machine;
use crate::support::report;
use crate::support::toolchain::{build, in_each_state, program};
use wcet::{MemoryMap, Request};

/// Without optimisation the address of the object is kept in the frame, among other numbers. Thumb
/// code of -O1 computes a length by arithmetic of which only the range is known.
fn on_optimised(check: impl Fn(&[u8])) {
    let arm = ["-O1", "-O2", "-Os"].map(|level| ["-marm", level]);
    for flags in arm
        .into_iter()
        .chain([["-mthumb", "-O2"], ["-mthumb", "-Os"]])
    {
        if let Some(elf) = build("computed_frames", &[program("computed_frames.c")], &flags) {
            check(&elf);
        }
    }
}

/// The bound of the stack is what the deepest of these calls takes.
fn assert_stack_is_reached(
    elf: &[u8],
    symbol: &str,
    facts: &str,
    arguments: impl Iterator<Item = u32>,
) {
    let mut machine = Machine::new(elf);
    let calls = arguments.map(|argument| machine.call(symbol, [argument, 0, 0, 0]));
    let deepest = calls.map(|seen| seen.stack_bytes).max();
    assert_eq!(report(elf, symbol, facts).unwrap().stack_bytes, deepest);
}

#[test]
fn an_object_of_one_of_several_sizes_has_a_stack_though_the_frame_holds_the_pointer_before_it() {
    let facts = "[[loop]]\nsymbol = \"chosen\"\niterations = 3\n";
    on_optimised(|elf| assert_stack_is_reached(elf, "chosen", facts, 0..8));
}

#[test]
fn an_object_whose_size_only_the_frame_of_the_caller_shows_has_a_stack() {
    on_optimised(|elf| {
        assert_eq!(report(elf, "copied", "").unwrap().stack_bytes, None);
        assert_stack_is_reached(elf, "in_context", "", 0..1);
    });
}

#[test]
fn a_stack_without_a_bound_names_the_line_at_which_its_depth_is_lost() {
    on_optimised(|elf| {
        let request = Request {
            functions: vec!["any_length".to_owned(), "in_context".to_owned()],
            ..Request::default()
        };
        let map = MemoryMap::without_wait_states();
        let response = request.answer(elf, &map).unwrap();
        let [lost, known] = &response.functions[..] else {
            panic!("two answers");
        };
        assert_eq!(lost.stack_bytes, None);
        let line = lost.stack_lost.as_deref();
        assert_eq!(line, Some("computed_frames.c:61"));
        assert_eq!(known.stack_lost, None);
    });
}

#[test]
fn a_line_that_is_never_executed_loses_no_depth() {
    let never = "[[never]]\nfile = \"computed_frames.c\"\nline = 61\n";
    on_optimised(|elf| {
        let stack = |facts| {
            report(elf, "perhaps_any_length", facts)
                .unwrap()
                .stack_bytes
        };
        assert_eq!(stack(""), None);
        assert!(stack(never).is_some());
    });
}

#[test]
fn a_stack_of_code_that_cannot_be_followed_says_which_fact_is_missing() {
    let sources = [program("refused.c")];
    let Some(elf) = build("refused", &sources, &["-marm", "-O1"]) else {
        return;
    };
    let request = Request {
        stacks: vec!["through".to_owned()],
        ..Request::default()
    };
    let answers = request.answer(&elf, &MemoryMap::without_wait_states());
    let stack = &answers.unwrap().stacks[0];
    let refused = stack.error.as_deref().unwrap_or_default();
    assert!(refused.contains("[[call]] with 'targets'"), "{refused}");
    assert_eq!(stack.stack_bytes, None);
}

#[test]
fn the_stack_of_a_task_is_that_of_all_its_jobs_and_of_what_comes_before_them() {
    in_each_state("task_stacks", "-O1", |state, elf| {
        let bodies = [
            "deep_before_jobs",
            "deep_in_jobs",
            "lost_before_jobs",
            "lost_in_jobs",
        ];
        let jobs = bodies.map(|body| format!("[[jobs]]\nbody = \"{body}\"\nwaits = [\"wait\"]\n"));
        let request: Request = toml::from_str(&jobs.concat()).unwrap();
        let map = MemoryMap::without_wait_states();
        let answers = request.answer(elf, &map).unwrap().jobs;
        let (deep, lost) = answers.split_at(2);
        for task in deep {
            let bytes = task.stack_bytes.unwrap_or_default();
            assert!(
                (400..450).contains(&bytes),
                "{state}, {}: {bytes}",
                task.symbol
            );
        }
        for task in lost {
            assert_eq!(task.stack_bytes, None, "{state}, {}", task.symbol);
            assert_eq!(task.stack_lost.as_deref(), Some("task_stacks.c:28"));
        }
    });
}
