// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Calls analysed in the context of their caller: frames, contexts, facts about calls, and memory.

use crate::support::bound;
use crate::support::machine::Machine;
use crate::support::toolchain::{build, program};
use wcet::{Annotations, Error, Image, Input, KnownMemory, KnownMemoryBound, MemoryMap};

const FLAGS: [[&str; 2]; 4] = [
    ["-marm", "-O1"],
    ["-marm", "-O2"],
    ["-mthumb", "-O1"],
    ["-mthumb", "-O2"],
];

fn elf(flags: &[&str]) -> Option<Vec<u8>> {
    build("calls", &[program("calls.c")], flags)
}

/// Runs a check on the code of all flags.
fn on_all(check: impl Fn([&str; 2], &[u8])) {
    for flags in FLAGS {
        if let Some(elf) = elf(&flags) {
            check(flags, &elf);
        }
    }
}

/// Cycles of a call on the core with a word in a variable.
fn seen_with(elf: &[u8], (variable, value): (&str, u32), symbol: &str) -> u64 {
    let mut machine = Machine::new(elf);
    let address = machine.address(variable);
    machine.set_word(address, value);
    machine.call(symbol, [0; 4]).cycles
}

/// What is found about the last of some calls for all contents of the inputs, with the two fetches
/// after its return.
fn last_call(
    elf: &[u8],
    calls: &[&str],
    inputs: &[Input],
    facts: &str,
) -> Result<KnownMemoryBound, Error> {
    let known_memory = KnownMemory {
        calls: calls.iter().map(|name| (*name).into()).collect(),
        stack_pointer: 0x3F_FFC0,
        inputs: inputs.to_vec(),
    };
    let (image, map) = (Image::read(elf)?, MemoryMap::without_wait_states());
    let facts = Annotations::parse(facts, "facts.toml")?;
    let found = known_memory.bound(&image, &map, &facts)?;
    Ok(KnownMemoryBound {
        cycles: found.cycles + 2,
        ..found
    })
}

#[test]
fn a_loop_is_bounded_by_what_its_caller_left_in_the_frame() {
    on_all(|flags, elf| {
        let seen = Machine::new(elf).call("framed", [3, 0, 0, 0]);
        assert_eq!(bound(elf, "framed", "").unwrap(), seen.cycles, "{flags:?}");
    });
}

#[test]
fn a_store_to_one_of_several_places_leaves_the_rest_of_the_frame_known() {
    on_all(|flags, elf| {
        let times = (0..4).map(|which| Machine::new(elf).call("beside_a_store", [which, 0, 0, 0]));
        let seen = times.map(|run| run.cycles).max().unwrap();
        let most = bound(elf, "beside_a_store", "").unwrap();
        assert!(
            seen <= most && 20 * most <= 23 * seen,
            "{flags:?}: {seen}, {most}"
        );
    });
}

#[test]
fn each_call_costs_what_it_costs_and_not_what_the_longest_does() {
    on_all(|flags, elf| {
        let seen = Machine::new(elf).call("rising", [0; 4]);
        let most = bound(elf, "rising", "").unwrap();
        // The multiplier's size is known for each call, too.
        assert_eq!(most, seen.cycles, "{flags:?}");
    });
}

#[test]
fn a_program_that_nothing_disturbs_is_bounded_as_it_is_recursion_included() {
    on_all(|flags, elf| {
        let mut machine = Machine::new(elf);
        machine.call("prepare", [0; 4]);
        let seen = machine.call("stored", [0; 4]);
        let found = last_call(elf, &["prepare", "stored"], &[], "").unwrap();
        assert_eq!(found.cycles, seen.cycles, "{flags:?}");
    });
}

#[test]
fn a_bound_for_any_content_of_an_input_holds_for_each_and_is_nearly_reached() {
    on_all(|flags, elf| {
        let items = Input::any("items".into());
        let found = last_call(elf, &["prepare", "highest"], &[items], "").unwrap();
        let mut most = 0;
        for rises in [false, true] {
            let mut machine = Machine::new(elf);
            let items = machine.address("items");
            for place in 0..8 {
                let value = if rises { place } else { 8 - place };
                machine.set_word(items + 4 * place, value);
            }
            most = most.max(machine.call("highest", [0; 4]).cycles);
        }
        let bound = found.cycles;
        assert!(
            most <= bound && 20 * bound <= 21 * most,
            "{flags:?}: {most}, {bound}"
        );
        let comparison = found.lines.iter().find(|l| l.line.ends_with("calls.c:83"));
        assert_eq!(comparison.map(|line| line.executions), Some(8), "{flags:?}");
    });
}

#[test]
fn a_fact_within_a_function_holds_in_its_calls_only() {
    let Some(elf) = elf(&["-marm", "-O1"]) else {
        return;
    };
    let anywhere = "[[loop]]\nsymbol = \"counted\"\nindex = 0\niterations = 15\n";
    let wide = bound(&elf, "either", anywhere).unwrap();
    let within = |name: &str| {
        let fact = "[[loop]]\nsymbol = \"counted\"\nindex = 0\niterations = 2\nwithin =";
        format!("{anywhere}{fact} \"{name}\"\n")
    };
    for name in ["either", "*either"] {
        let narrow = bound(&elf, "either", &within(name)).unwrap();
        assert!(narrow < wide, "{name}: {narrow} < {wide}");
        assert_eq!(
            bound(&elf, "counted", anywhere).unwrap(),
            bound(&elf, "counted", &within(name)).unwrap()
        );
    }
    assert_eq!(bound(&elf, "either", &within("*other")).unwrap(), wide);
}

#[test]
fn an_avoided_call_and_a_given_cost_shorten_the_way() {
    let Some(elf) = elf(&["-marm", "-O1"]) else {
        return;
    };
    let whole = bound(&elf, "either", "").unwrap();
    let avoided = "[[avoided]]\nsymbol = \"counted\"\n";
    let seen = Machine::new(&elf).call("either", [0, 0, 0, 0]).cycles;
    assert_eq!(bound(&elf, "either", avoided).unwrap(), seen);
    let cost = "[[cost]]\nsymbol = \"counted\"\ncycles = 20\n";
    let cheap = bound(&elf, "either", cost).unwrap();
    assert!(seen < cheap && cheap < whole, "{seen} < {cheap} < {whole}");
}

#[test]
fn a_jump_table_ends_where_the_counter_ends_that_is_its_index() {
    let facts = "[[loop]]\nsymbol = \"turned\"\nindex = 0\niterations = 8\n\
                 [[loop]]\nsymbol = \"turned\"\nindex = 1\niterations = 8\n";
    for flags in [["-mthumb", "-O1"], ["-mthumb", "-O2"], ["-marm", "-O2"]] {
        let Some(elf) = elf(&flags) else { return };
        let seen = seen_with(&elf, ("turns", 8), "turned");
        let most = bound(&elf, "turned", facts).unwrap();
        assert!(seen <= most, "{flags:?}: {seen} of {most}");
        let own = last_call(&elf, &["turned"], &[], "").unwrap();
        let idle = Machine::new(&elf).call("turned", [0; 4]).cycles;
        assert_eq!(own.cycles, idle, "{flags:?}");
    }
}

#[test]
fn a_call_through_a_pointer_comes_back_to_the_caller_of_the_piece_of_code_that_makes_it() {
    let call = "[[call]]\nsymbol = \"through\"\ntargets = [\"counted\"]\n";
    let count = "[[loop]]\nsymbol = \"counted\"\nindex = 0\niterations = 6\n";
    on_all(|flags, elf| {
        let mut machine = Machine::new(elf);
        let callee = machine.address("counted");
        let seen = machine.call("through", [callee, 6, 0, 0]).cycles;
        let most = bound(elf, "through", &format!("{call}{count}")).unwrap();
        assert!(
            seen <= most && most < seen * 3 / 2,
            "{flags:?}: {seen} of {most}"
        );
    });
}

#[test]
fn a_byte_that_may_be_anything_leaves_the_rest_of_its_word_known() {
    on_all(|flags, elf| {
        let second = Input {
            offset_bytes: 1,
            size_bytes: Some(1),
            element_bytes: 1,
            range: Some((0, 4)),
            ..Input::any("portions".into())
        };
        let most = last_call(elf, &["portion", "portioned"], &[second], "")
            .unwrap()
            .cycles;
        let mut machine = Machine::new(elf);
        machine.call("portion", [0; 4]);
        let portions = machine.address("portions");
        machine.set_bytes(portions + 1, &[4]);
        let seen = machine.call("portioned", [0; 4]).cycles;
        assert_eq!(most, seen, "{flags:?}");
    });
}

#[test]
fn what_is_compared_is_known_of_what_differs_from_it_by_a_constant() {
    on_all(|flags, elf| {
        let input = Input {
            range: Some((2, 20)),
            ..Input::any("stairs".into())
        };
        let most = last_call(elf, &["portion", "climbed"], &[input], "")
            .unwrap()
            .cycles;
        let runs = (2..=20).map(|count| seen_with(elf, ("stairs", count), "climbed"));
        let longest = runs.max().unwrap();
        assert!(
            longest <= most && most <= longest + 3,
            "{flags:?}: {longest} {most}"
        );
    });
}

#[test]
fn steps_that_exclude_each_other_are_not_both_charged() {
    on_all(|flags, elf| {
        let input = Input {
            range: Some((0, 5)),
            ..Input::any("marks".into())
        };
        let most = last_call(elf, &["portion", "exclusive"], &[input], "")
            .unwrap()
            .cycles;
        let seen = seen_with(elf, ("marks", 5), "exclusive");
        assert_eq!(most, seen, "{flags:?}");
    });
}

#[test]
fn a_recursion_that_depends_on_an_input_is_refused() {
    for flags in [FLAGS[0], FLAGS[2]] {
        let Some(elf) = elf(&flags) else { return };
        let input = Input::any("stairs".into());
        let refused = last_call(&elf, &["portion", "descended"], &[input], "").unwrap_err();
        assert!(
            matches!(refused, Error::Recursion(_)),
            "{flags:?}: {refused}"
        );
    }
}

#[test]
fn memory_is_still_known_after_a_loop_that_ends_because_the_user_says_so() {
    let facts = "[[loop]]\nsymbol = \"awaited\"\nindex = 0\niterations = 5\n";
    on_all(|flags, elf| {
        let once = "[[loop]]\nsymbol = \"awaited\"\nindex = 0\niterations = 4\n";
        let wait = |facts| {
            let input = Input::any("signals".into());
            last_call(elf, &["portion", "awaited"], &[input], facts)
                .unwrap()
                .cycles
        };
        let (four, five) = (wait(once), wait(facts));
        let mut machine = Machine::new(elf);
        machine.call("portion", [0; 4]);
        let least = machine.call("awaited", [0; 4]).cycles;
        let bound = least + 5 * (five - four);
        assert!(
            five.abs_diff(bound) <= 6,
            "{flags:?}: {least} {four} {five}"
        );
    });
}

#[test]
fn loops_that_depend_on_an_input_are_asked_for_and_inputs_outside_a_variable_refused() {
    let Some(elf) = elf(&["-marm", "-O2"]) else {
        return;
    };
    let sought = |input| last_call(&elf, &["portion", "turned"], &[input], "");
    let Err(Error::MissingBounds(loops)) = sought(Input::any("turns".into())) else {
        panic!("the loop over 'turns' has no bound");
    };
    assert!(loops.iter().all(|l| l.place.to_string().contains("turned")));
    let outside = Input {
        size_bytes: Some(8),
        ..Input::any("turns".into())
    };
    let refused = sought(outside).unwrap_err().to_string();
    assert_eq!(refused, "input 'turns': ends behind the variable's end");
}
