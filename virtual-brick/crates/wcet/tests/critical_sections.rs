// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Longest protected actions: as long as a run, and no longer than the function around them.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program};
use wcet::{AnnotationFile, MemoryMap, Request};

const KERNEL: &str = "[kernel]\nlocks = [\"enter_action\"]\nunlocks = [\"leave_action\"]\n";
const STATES: [&str; 2] = ["-marm", "-mthumb"];

#[test]
fn a_loop_in_a_protected_action_counts_as_often_as_it_runs_wherever_the_action_begins() {
    for state in STATES {
        let sources = [program("critical_sections.c")];
        let Some(elf) = build("critical_sections", &sources, &[state, "-O0"]) else {
            return;
        };
        let names = ["never_leads_into_the_loop", "leaves_in_the_loop"];
        let request = Request {
            annotations: vec![AnnotationFile {
                name: "kernel".to_owned(),
                text: KERNEL.to_owned(),
                own: false,
            }],
            functions: names.map(str::to_owned).to_vec(),
            ..Request::default()
        };
        let answers = request.answer(&elf, &MemoryMap::without_wait_states());
        for answer in answers.unwrap().functions {
            assert_eq!(answer.error, None, "{state}");
            let symbol = &answer.symbol;
            let longest = answer.critical_sections.iter().map(|(_, cycles)| *cycles);
            let longest = longest.max().expect(symbol);
            // Nothing yields: the action lasts from its first call to its last.
            let seen = Machine::new(&elf).call(symbol, [0; 4]).cycles;
            let range = seen - 100..=answer.cycles;
            assert!(
                range.contains(&longest),
                "{state} {symbol}: {longest}, expected {range:?}"
            );
        }
    }
}
