// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a task executes between two waits outside of its jobs: as long as a run of that part, and
//! hardly longer, though the whole of it has no bound.

use crate::support::machine::Machine;
use crate::support::toolchain;
use wcet::{MemoryMap, Request, Response};

/// Frames that the whole has, or the part alone.
const AROUND: u64 = 60;

fn answers(elf: &[u8], bodies: &[&str]) -> Response {
    let tasks = bodies.iter().map(|body| {
        format!("[[outside]]\nbody = \"{body}\"\nwaits = [\"yields\"]\notherwise = [\"wait\"]\n")
    });
    let places = ["searches", "repairs"];
    let places = places.map(|place| format!("[[outside_places]]\nsymbol = \"{place}\"\n"));
    let text = tasks.chain(places).collect::<String>();
    let request: Request = toml::from_str(&text).unwrap();
    let map = MemoryMap::without_wait_states();
    request.answer(elf, &map).unwrap()
}

fn in_each_state(check: impl Fn(&str, &[u8])) {
    toolchain::in_each_state("between_waits", "-O1", check);
}

#[test]
fn what_is_outside_of_jobs_is_bounded_between_two_waits_wherever_these_are() {
    in_each_state(|state, elf| {
        let cases = [
            ("set_up_first", "sets_up_seen"),
            ("set_up_long", "set_up_long_seen"),
            ("leads_to_search", "leads_to_search_seen"),
            ("without_a_wait", "without_a_wait_seen"),
        ];
        let answers = answers(elf, &cases.map(|(body, _)| body));
        for (answer, (body, part)) in answers.outside.iter().zip(cases) {
            assert_eq!(answer.error, None, "{state} {body}");
            let seen = Machine::new(elf).call(part, [0; 4]).cycles;
            let range = seen - AROUND / 3..=seen + AROUND;
            let bound = answer.cycles;
            assert!(
                range.contains(&bound),
                "{state} {body}: {bound}, expected {range:?}"
            );
        }
    });
}

#[test]
fn jobs_alone_are_nothing_outside_of_jobs() {
    in_each_state(|state, elf| {
        let found = &answers(elf, &["only_jobs"]).outside[0];
        assert_eq!((&found.error, found.cycles), (&None, 0), "{state}");
    });
}

#[test]
fn a_loop_that_need_not_wait_in_each_pass_is_asked_for() {
    in_each_state(|state, elf| {
        let found = &answers(elf, &["looks"]).outside[0];
        let [missing] = &found.missing[..] else {
            panic!("{state}: {:?}", found.error);
        };
        assert_eq!(missing.symbol, "looks_often", "{state}");
    });
}
