// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A binary of ARM and Thumb code: bounds against times over each kind of change of state.

use crate::support::machine::Machine;
use crate::support::random::Random;
use crate::support::toolchain::{build, program};
use crate::support::{check, check_exact, report};
use image::FlowPoint;
use wcet::{AnnotationFile, Image, MemoryMap, Request};

const LEVELS: [&str; 4] = ["-O0", "-O1", "-O2", "-Os"];

/// What the pointers of the table lead to, where the index has no bound in the frame.
const TARGETS: &str = "[[call]]\nsymbol = \"arm_pointers\"\n\
                       targets = [\"arm_weigh\", \"thumb_weigh\"]\n\
                       [[call]]\nsymbol = \"thumb_pointers\"\n\
                       targets = [\"arm_weigh\", \"thumb_weigh\"]\n";

fn elf(level: &str) -> Option<Vec<u8>> {
    build("interworking", &[program("interworking.c")], &[level])
}

/// Does the image hold veneers, which the linker puts where a branch changes the state?
fn has_veneers(elf: &[u8]) -> bool {
    let image = Image::read(elf).unwrap();
    let veneers = ["__thumb_weigh_from_arm", "__arm_weigh_from_thumb"];
    veneers.iter().all(|name| image.function(name).is_some())
}

#[test]
fn functions_of_one_path_over_both_states_take_their_bound() {
    for level in LEVELS {
        let Some(elf) = elf(level) else { return };
        assert!(has_veneers(&elf), "{level}: the binary is not mixed");
        let mut machine = Machine::new(&elf);
        for symbol in [
            "arm_to_thumb",
            "thumb_to_arm",
            "arm_tail",
            "thumb_tail",
            "three_deep",
        ] {
            let found = report(&elf, symbol, TARGETS).unwrap();
            check_exact(level, &found, &mut machine, [2, 0, 0, 0]);
        }
    }
}

#[test]
fn no_way_between_the_states_exceeds_the_bound_and_the_longest_is_nearly_it() {
    for level in LEVELS {
        let Some(elf) = elf(level) else { return };
        let mut machine = Machine::new(&elf);
        let mut random = Random::new(5);
        for symbol in [
            "arm_pointers",
            "thumb_pointers",
            "thumb_either",
            "arm_either",
        ] {
            let found = report(&elf, symbol, TARGETS).unwrap();
            let seen = (0..500).map(|_| {
                let seen = machine.call(symbol, [random.integer(), 0, 0, 0]);
                check(level, &found, seen);
                seen.cycles
            });
            let longest = seen.max().unwrap();
            assert!(
                longest * 21 / 20 >= found.bound_cycles,
                "{level} {symbol}: {longest} of {}",
                found.bound_cycles
            );
        }
    }
}

#[test]
fn a_task_waits_in_a_function_that_it_reaches_over_a_veneer() {
    let question = "[[jobs]]\nbody = \"thumb_task\"\nwaits = [\"arm_wait\"]\n";
    let request: Request = toml::from_str(question).unwrap();
    for level in LEVELS {
        let Some(elf) = elf(level) else { return };
        let answers = request.answer(&elf, &MemoryMap::without_wait_states());
        let job = answers.unwrap().jobs.remove(0);
        assert_eq!(job.error, None, "{level}");
        assert_eq!(job.released_by, ["arm_wait"], "{level}");
    }
}

#[test]
fn a_loop_is_counted_in_its_own_code_though_a_round_ends_behind_a_veneer() {
    let mut ends_with_calls = false;
    for level in LEVELS {
        let Some(elf) = elf(level) else { return };
        let fact = "[[loop]]\nsymbol = \"thumb_polls\"\niterations = 6\n";
        let request = Request {
            annotations: vec![AnnotationFile {
                name: "facts.toml".into(),
                text: fact.into(),
                own: true,
            }],
            functions: vec!["thumb_polls".into()],
            counted: vec!["thumb_polls".into()],
            ..Request::default()
        };
        let answers = request.answer(&elf, &MemoryMap::without_wait_states());
        let counted = answers.unwrap().counted;
        let points: Vec<FlowPoint> = counted.iter().map(|fact| fact.point.clone()).collect();
        let [FlowPoint::Loop {
            entries,
            repeats,
            calls,
            ..
        }] = &points[..]
        else {
            panic!("{level}: {counted:?}");
        };
        ends_with_calls |= !calls.is_empty();
        let image = Image::read(&elf).unwrap();
        for address in entries.iter().chain(repeats) {
            assert_eq!(
                image.name_at(*address),
                "thumb_polls",
                "{level} {address:#x}"
            );
        }
    }
    assert!(ends_with_calls, "no round ends behind a veneer");
}
