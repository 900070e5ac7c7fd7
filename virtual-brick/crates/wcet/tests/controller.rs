// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The generated controller of the vehicle: bound against the longest time that a search finds.

use crate::support::machine::Machine;
use crate::support::random::Random;
use crate::support::toolchain::{build, program};
use crate::support::{bound, LIBGCC};
use std::path::Path;

const GENERATED: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../../examples/vehicle/generated"
);
const SYMBOL: &str = "functional_step_instance";
const RANDOM_RUNS: u32 = 4_000;
const CLIMBING_RUNS: u32 = 12_000;
const INPUTS: usize = 7;
/// All inputs denormal, so that multiplications shift their operands through all bits, and the
/// demand beyond the saturation.
const DENORMALS: Inputs = [1, 0, 5, 1, 1, 1, 1];

/// Input voltage, real voltage, integral; then the four tunables, which a tuner may change.
type Inputs = [u32; INPUTS];

fn run(machine: &mut Machine, inputs: &Inputs) -> u64 {
    let u = machine.address("functional_U");
    let y = machine.address("functional_Y");
    let work = machine.address("functional_DW");
    let tunables = machine.address("functional_P");
    machine.set_word(u, inputs[0]);
    machine.set_word(u + 4, inputs[1]);
    machine.set_word(work, inputs[2]);
    for (place, value) in (tunables..).step_by(4).zip(&inputs[3..]) {
        machine.set_word(place, *value);
    }
    machine.call(SYMBOL, [work, u, y, 0]).cycles
}

/// Random inputs, then small changes of the best ones. The first `free` inputs vary.
fn longest(machine: &mut Machine, start: Inputs, free: usize) -> (u64, Inputs) {
    let mut random = Random::new(11);
    let mut best = (run(machine, &start), start);
    for round in 0..RANDOM_RUNS + CLIMBING_RUNS {
        let mut inputs = if round < RANDOM_RUNS { start } else { best.1 };
        if round < RANDOM_RUNS {
            inputs[..free].fill_with(|| random.float());
        } else {
            let place = random.word() as usize % free;
            inputs[place] = match random.word() & 3 {
                0 => random.float(),
                1 => inputs[place].wrapping_add(random.word() & 0xFF),
                _ => inputs[place] ^ 1 << (random.word() & 31),
            };
        }
        let cycles = run(machine, &inputs);
        if cycles >= best.0 {
            best = (cycles, inputs);
        }
    }
    best
}

#[test]
fn no_step_of_the_controller_takes_longer_than_its_bound() {
    for flags in [["-marm", "-O2"], ["-mthumb", "-O2"]] {
        let sources = [
            Path::new(GENERATED).join("functional.c"),
            program("controller_main.c"),
        ];
        let include = format!("-I{GENERATED}");
        let all_flags = [flags[0], flags[1], &include];
        let Some(elf) = build(
            &flags.concat().replace('-', "controller"),
            &sources,
            &all_flags,
        ) else {
            return;
        };
        let bound = bound(&elf, SYMBOL, LIBGCC).unwrap();
        let mut machine = Machine::new(&elf);
        let tunables = machine.address("functional_P");
        let mut start = [0; INPUTS];
        for (index, value) in (0..).zip(&mut start[3..]) {
            *value = machine.word(tunables + 4 * index);
        }
        let (as_designed, _) = longest(&mut machine, start, 3);
        let (anything, inputs) = [start, DENORMALS]
            .map(|start| longest(&mut machine, start, INPUTS))
            .into_iter()
            .max()
            .unwrap();
        println!("{flags:?}: {as_designed} as designed, {anything} with any tunables, {bound}");
        println!("  inputs {inputs:X?}");
        assert!(as_designed <= bound && anything <= bound);
        assert!(
            4 * bound < 5 * anything,
            "{bound} is more than 25 % above {anything}"
        );
    }
}
