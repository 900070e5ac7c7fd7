// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What has no bound is refused with the place, and annotations are used.

use crate::support::machine::Machine;
use crate::support::toolchain::{build, program};
use crate::support::{bound, check, refusal, report};

const ARM: [&str; 2] = ["-marm", "-O1"];
const THUMB: [&str; 2] = ["-mthumb", "-O1"];

/// Runs a check on the ARM and the Thumb code.
fn on_both(check: impl Fn(&[u8])) {
    for flags in [ARM, THUMB] {
        if let Some(elf) = build("refused", &[program("refused.c")], &flags) {
            check(&elf);
        }
    }
}

#[test]
fn recursion_is_refused_with_the_line_of_the_call() {
    on_both(|elf| {
        let text = refusal(elf, "outer", "");
        assert!(
            text.contains("recursion") && text.contains("descend"),
            "{text}"
        );
        assert!(text.contains("refused.c:11"), "{text}");
    });
}

#[test]
fn a_loop_without_bound_is_asked_for_by_line_and_accepted_by_line_or_symbol() {
    on_both(|elf| {
        let text = refusal(elf, "poll", "");
        assert!(
            text.contains("loop 0") && text.contains("refused.c:2"),
            "{text}"
        );
        let by_symbol = "[[loop]]\nsymbol = \"poll\"\nindex = 0\niterations = 10\n";
        let few = bound(elf, "poll", by_symbol).unwrap();
        let by_file = "[[loop]]\nfile = \"refused.c\"\niterations = 20\n";
        let many = bound(elf, "poll", by_file).unwrap();
        assert!(few < many);
        let seen = Machine::new(elf).call("poll", [0; 4]);
        assert!(seen.cycles <= few);
    });
}

#[test]
fn a_table_of_functions_that_is_read_beyond_its_end_is_asked_for_at_the_branch() {
    on_both(|elf| {
        let text = refusal(elf, "from_table", "");
        assert!(
            text.contains("target of this branch") && text.contains("refused.c"),
            "{text}"
        );
        let fact = "[[call]]\nsymbol = \"from_table\"\ntargets = [\"first\", \"second\"]\n";
        assert!(bound(elf, "from_table", fact).is_ok());
    });
}

#[test]
fn an_indirect_call_is_refused_with_its_address() {
    on_both(|elf| {
        let text = refusal(elf, "through", "");
        assert!(
            text.contains("target of this branch") && text.contains("0x0020"),
            "{text}"
        );
    });
}

#[test]
fn an_indirect_call_is_bounded_by_the_most_expensive_of_its_annotated_targets() {
    let Some(elf) = build("refused", &[program("refused.c")], &ARM) else {
        return;
    };
    let with = |targets: &[&str]| {
        let facts = format!("[[call]]\nsymbol = \"through\"\ntargets = {targets:?}\n");
        bound(&elf, "through", &facts).unwrap()
    };
    let mut machine = Machine::new(&elf);
    let both = with(&["first", "second"]);
    for target in ["first", "second"] {
        let step = machine.address(target);
        let seen = machine.call("through", [step, 0x7FFF_FFFF, 0, 0]);
        assert!(seen.cycles <= both);
        assert_eq!(seen.cycles, with(&[target]));
    }
    assert!(with(&["first"]) < both);
}

#[test]
fn endless_loops_and_software_interrupts_are_refused() {
    on_both(|elf| {
        assert!(refusal(elf, "forever", "").contains("never returns"));
        assert!(refusal(elf, "trap", "").contains("software interrupt"));
    });
}

#[test]
fn a_loop_entered_at_two_places_is_bounded_like_any_other() {
    on_both(|elf| {
        assert!(refusal(elf, "two_entries", "").contains("loops without a bound"));
        let facts = "[[loop]]\nsymbol = \"two_entries\"\nheader_executions = 60\n";
        let bound = bound(elf, "two_entries", facts).unwrap();
        for x in [2, 3] {
            let seen = Machine::new(elf).call("two_entries", [x, 0, 0, 0]);
            assert!(seen.cycles > 60 && seen.cycles <= bound);
        }
    });
}

#[test]
fn recursion_is_bounded_when_the_number_of_calls_is_annotated() {
    on_both(|elf| {
        let facts = "[[recursion]]\nsymbol = \"descend\"\ncalls = 6\ndepth = 6\n";
        let report = report(elf, "outer", facts).unwrap();
        let seen = Machine::new(elf).call("outer", [5, 0, 0, 0]);
        check("recursion", &report, seen);
        let fewer = Machine::new(elf).call("outer", [4, 0, 0, 0]);
        assert!(fewer.cycles < seen.cycles);
    });
}

#[test]
fn wrong_input_is_refused_with_its_name() {
    on_both(|elf| {
        let text = refusal(elf, "nothing", "");
        assert!(text.contains("'nothing'"), "{text}");
        let facts = "[[access]]\nregion = \"nowhere\"\n";
        let text = refusal(elf, "first", facts);
        assert!(
            text.contains("'nowhere'") && text.contains("memory"),
            "{text}"
        );
        let text = refusal(elf, "first", "[[loop]]\nsymbol = \"poll\"\n");
        assert!(text.contains("iterations"), "{text}");
        let text = refusal(&elf[..20], "first", "");
        assert!(text.contains("ELF"), "{text}");
    });
}
