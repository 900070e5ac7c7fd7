// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random bodies of tasks that wait anywhere: no time between two waits outside of jobs exceeds its
//! bound.

use crate::support::machine::Machine;
use crate::support::random::Random;
use crate::support::toolchain::{build, VARIANTS};
use std::fmt::Write;
use std::ops::ControlFlow;
use wcet::{MemoryMap, Request};

const FUNCTIONS: u32 = 5;
const PROGRAMS: u32 = 24;
const RUNS: u32 = 6;
const WAITS: usize = 120;

const HEAD: &str = "
#define FUNCTION __attribute__((noinline, noclone))
volatile int place;
unsigned seed;
FUNCTION void wait(void) { place = 0; }
FUNCTION int coin(void) { return (seed = seed * 1664525 + 1013904223) >> 31; }
FUNCTION int works(int times) {
    int sum = 0;
    for (int count = 0; count < times; count++) sum += place;
    return sum;
}
";

/// Statements of function `of`, the last of which may only call later ones.
struct Writer {
    random: Random,
    text: String,
    of: u32,
    loops: u32,
}

impl Writer {
    fn less(&mut self, most: u32) -> u32 {
        self.random.word() % most
    }

    fn add(&mut self, text: &str) {
        let _ = writeln!(self.text, "{text}");
    }

    fn block(&mut self, depth: u32) {
        for _ in 0..1 + self.less(3) {
            self.statement(depth);
        }
    }

    /// A statement whose parts have blocks of statements between them.
    fn nested(&mut self, depth: u32, parts: &[&str]) {
        for (number, part) in parts.iter().enumerate() {
            if number > 0 {
                self.block(depth - 1);
            }
            self.add(part);
        }
    }

    fn statement(&mut self, depth: u32) {
        let kinds = if depth == 0 { 4 } else { 8 };
        match self.less(kinds) {
            0 => {
                let times = self.less(30);
                self.add(&format!("place = works({times});"));
            }
            1 => self.add("wait();"),
            2 if self.of + 1 < FUNCTIONS => {
                let callee = self.of + 1 + self.less(FUNCTIONS - self.of - 1);
                self.add(&format!("f{callee}();"));
            }
            3 if self.of > 0 => self.add("if (coin()) return;"),
            4 => self.nested(depth, &["if (coin()) {", "} else {", "}"]),
            5 => {
                let (name, times) = (self.loops, 1 + self.less(4));
                self.loops += 1;
                let head = format!("for (int i{name} = 0; i{name} < {times}; i{name}++) {{");
                self.nested(depth, &[&head, "}"]);
            }
            6 => self.nested(depth, &["while (coin()) {", "wait();", "}"]),
            7 => self.nested(depth, &["do {", "wait();\n} while (coin());"]),
            _ => self.add("place = works(3);"),
        }
    }

    /// A program whose task is `body`; `f3` is outside of jobs.
    fn program(seed: u32) -> String {
        let mut writer = Self {
            random: Random::new(seed),
            text: HEAD.to_owned(),
            of: FUNCTIONS,
            loops: 0,
        };
        for of in (0..FUNCTIONS).rev() {
            writer.of = of;
            writer.nested(4, &[&format!("FUNCTION void f{of}(void) {{"), "}"]);
        }
        writer.of = 0;
        let parts = ["void body(void) {", "for (;;) {", "wait();", "}}"];
        writer.nested(3, &parts);
        writer.add("int main(void) { body(); return 0; }");
        writer.text
    }
}

/// Longest time from the end of a wait to that of the next one, of those that are no job.
fn longest_outside(machine: &mut Machine, size_of_body: u32) -> u64 {
    let [wait, place, body] = ["wait", "f3", "body"].map(|name| machine.address(name) & !1);
    let own = body..body + size_of_body;
    let (mut longest, mut count) = (0, 0);
    // When the wait before ended, if that was one of the task's own loop; whether it is one now.
    let mut before: Option<(u64, bool)> = None;
    let (mut outside, mut back) = (false, None);
    machine.follow("body", |cpu, cycles| {
        let at = cpu.next_instruction_address();
        outside |= at == place;
        if at == wait {
            back = Some(cpu.register(14) & !1);
        }
        if back == Some(at) {
            let is_own = own.contains(&at);
            if let Some((since, was_own)) = before {
                if outside || !was_own || !is_own {
                    longest = longest.max(cycles - since);
                }
            }
            before = Some((cycles, is_own));
            (outside, back, count) = (false, None, count + 1);
        }
        if count < WAITS {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    longest
}

#[test]
fn no_time_between_two_waits_of_a_random_body_exceeds_its_bound() {
    let text = "[[outside]]\nbody = \"body\"\nwaits = [\"wait\"]\n\
                [[outside_places]]\nsymbol = \"f3\"\n";
    let request: Request = toml::from_str(text).unwrap();
    let (mut bounded, mut asked) = (0, 0);
    for seed in 1..=PROGRAMS {
        let source = std::env::temp_dir().join(format!("waits-{}-{seed}.c", std::process::id()));
        std::fs::write(&source, Writer::program(seed)).unwrap();
        let flags = VARIANTS[seed as usize % VARIANTS.len()];
        let built = build("random_waits", std::slice::from_ref(&source), &flags);
        std::fs::remove_file(source).unwrap();
        let Some(elf) = built else {
            return;
        };
        let answer = request.answer(&elf, &MemoryMap::without_wait_states());
        let found = &answer.unwrap().outside[0];
        if !found.missing.is_empty() {
            asked += 1;
            continue;
        }
        assert_eq!(found.error, None, "program {seed}");
        bounded += 1;
        let mut machine = Machine::new(&elf);
        let size = machine.size("body");
        for run in 0..RUNS {
            let coins = machine.address("seed");
            machine.set_word(coins, run);
            let seen = longest_outside(&mut machine, size);
            let bound = found.cycles;
            assert!(
                seen <= bound,
                "program {seed} {flags:?}: {seen}, at most {bound}"
            );
        }
    }
    assert!(bounded > asked, "{bounded} bounded, {asked} asked for");
}
