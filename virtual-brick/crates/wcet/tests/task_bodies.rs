// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Tasks without a wait in their own loop: one that ends has one job, one that waits elsewhere is
//! refused. A loop in which a task can stay without a wait is told with its line.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program};
use wcet::{MemoryMap, Request, Response};

fn answers(elf: &[u8]) -> Response {
    let jobs = ["ends", "never_waits", "waits_below", "waits_first"]
        .map(|body| format!("[[jobs]]\nbody = \"{body}\"\nwaits = [\"wait\"]\n"));
    let request: Request = toml::from_str(&jobs.concat()).unwrap();
    request
        .answer(elf, &MemoryMap::without_wait_states())
        .unwrap()
}

#[test]
fn a_body_without_a_wait_is_one_job_or_an_endless_loop() {
    for state in ["-marm", "-mthumb"] {
        let Some(elf) = build("task_bodies", &[program("task_bodies.c")], &[state, "-O1"]) else {
            return;
        };
        let answers = answers(&elf);
        let [ends, never_waits, waits_below, waits_first] = &answers.jobs[..] else {
            panic!("four answers");
        };
        assert_eq!((&ends.error, &ends.endless), (&None, &None), "{state}");
        assert!(ends.released_by.is_empty());
        let seen = Machine::new(&elf).call("ends", [0; 4]).cycles;
        assert!(seen <= ends.cycles + answers.return_cycles, "{state}");

        assert_eq!(never_waits.error, None, "{state}");
        assert_eq!(never_waits.endless.as_deref(), Some("task_bodies.c:22"));
        assert!(never_waits.reached.contains(&"work".to_owned()));

        assert_eq!(waits_first.error, None, "{state}");
        assert_eq!(waits_first.endless.as_deref(), Some("task_bodies.c:51"));

        assert_eq!(waits_below.endless, None, "{state}");
        let refused = waits_below.error.as_deref().unwrap_or_default();
        assert!(refused.contains("calls none of wait"), "{refused}");
    }
}
