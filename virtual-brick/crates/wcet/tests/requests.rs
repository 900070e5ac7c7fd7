// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a function still executes after it called one of certain functions: as long as a run of
//! that part, and hardly longer.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program};
use wcet::{MemoryMap, Request};

/// Frames that the part alone has, and the steps of a loop around it.
const AROUND: u64 = 70;

#[test]
fn from_a_request_to_the_end_is_what_runs_last_wherever_the_request_is() {
    for state in ["-marm", "-mthumb"] {
        let Some(elf) = build("requests", &[program("requests.c")], &[state, "-O1"]) else {
            return;
        };
        let request = Request {
            functions: ["late", "inside", "again", "nowhere"]
                .map(str::to_owned)
                .to_vec(),
            requesting: vec!["absent_".to_owned(), "device_".to_owned()],
            ..Request::default()
        };
        let answers = request.answer(&elf, &MemoryMap::without_wait_states());
        for answer in answers.unwrap().functions {
            let symbol = &answer.symbol;
            assert_eq!(answer.error, None, "{state} {symbol}");
            assert_eq!(answer.remaining[0], None, "{state} {symbol}");
            if symbol == "nowhere" {
                assert_eq!(answer.remaining[1], None, "{state}");
                continue;
            }
            let rest = answer.remaining[1].expect(symbol);
            let seen = Machine::new(&elf)
                .call(&format!("{symbol}_rest"), [0; 4])
                .cycles;
            let range = seen - AROUND..=seen + AROUND;
            assert!(
                range.contains(&rest),
                "{state} {symbol}: {rest}, expected {range:?}"
            );
            assert!(
                rest < answer.cycles,
                "{state} {symbol}: {rest} of {}",
                answer.cycles
            );
        }
    }
}
