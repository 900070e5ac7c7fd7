// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Longest protected actions: as long as a run, and no longer than the function around them.

use crate::support::machine::Machine;
use crate::support::toolchain;
use wcet::{AnnotationFile, MemoryMap, Request};

const KERNEL: &str = "[kernel]\nlocks = [\"enter_action\"]\nunlocks = [\"leave_action\"]\n";

fn kernel() -> Vec<AnnotationFile> {
    vec![AnnotationFile {
        name: "kernel".to_owned(),
        text: KERNEL.to_owned(),
        own: false,
    }]
}

fn in_each_state(check: impl Fn(&str, &[u8])) {
    toolchain::in_each_state("critical_sections", "-O0", check);
}

#[test]
fn a_loop_in_a_protected_action_counts_as_often_as_it_runs_wherever_the_action_begins() {
    in_each_state(|state, elf| {
        let names = ["never_leads_into_the_loop", "leaves_in_the_loop"];
        let request = Request {
            annotations: kernel(),
            functions: names.map(str::to_owned).to_vec(),
            ..Request::default()
        };
        let answers = request.answer(elf, &MemoryMap::without_wait_states());
        for answer in answers.unwrap().functions {
            assert_eq!(answer.error, None, "{state}");
            let symbol = &answer.symbol;
            let longest = answer.critical_sections.iter().map(|(_, cycles)| *cycles);
            let longest = longest.max().expect(symbol);
            // Nothing yields: the action lasts from its first call to its last.
            let seen = Machine::new(elf).call(symbol, [0; 4]).cycles;
            let range = seen - 100..=answer.cycles;
            assert!(
                range.contains(&longest),
                "{state} {symbol}: {longest}, expected {range:?}"
            );
        }
    });
}

#[test]
fn a_call_with_a_bound_in_its_context_only_counts_in_an_action_of_the_background() {
    in_each_state(|state, elf| {
        let request = Request {
            annotations: kernel(),
            functions: vec!["adds_up".to_owned()],
            background: vec!["adds_up_and_goes_on".to_owned()],
            ..Request::default()
        };
        let answers = request.answer(elf, &MemoryMap::without_wait_states());
        let answers = answers.unwrap();
        assert_eq!(answers.functions[0].missing.len(), 1, "{state}");
        let found = &answers.background[0];
        assert_eq!(found.error, None, "{state}");
        let longest = found.critical_sections.iter().map(|(_, cycles)| *cycles);
        let seen = Machine::new(elf)
            .call("adds_up_in_an_action", [0; 4])
            .cycles;
        let range = seen - 100..=seen + 100;
        let longest = longest.max().expect("a section");
        assert!(
            range.contains(&longest),
            "{state}: {longest}, expected {range:?}"
        );
    });
}

#[test]
fn a_stack_is_bounded_also_of_what_has_no_bound_in_time() {
    in_each_state(|state, elf| {
        let asked = vec!["elaborates_and_goes_on".to_owned()];
        let request = Request {
            annotations: kernel(),
            background: asked.clone(),
            stacks: asked,
            ..Request::default()
        };
        let answers = request.answer(elf, &MemoryMap::without_wait_states());
        let answers = answers.unwrap();
        let refused = answers.background[0].error.as_deref().unwrap_or_default();
        assert!(refused.contains("no bound"), "{state}: {refused}");
        let stack = &answers.stacks[0];
        assert_eq!(stack.error, None, "{state}");
        // `yields` is 0, so this call ends; the caller has a frame around it.
        let called = Machine::new(elf).call("waits_in_an_action", [3, 0, 0, 0]);
        let bound = stack.stack_bytes.expect("a stack bound");
        let range = called.stack_bytes + 8..=called.stack_bytes + 40;
        assert!(
            range.contains(&bound),
            "{state}: {bound}, expected {range:?}"
        );
    });
}
