// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A run is a function of configuration, image and inputs; snapshots repeat it.

use crate::support::arm::{Program, ALWAYS};
use crate::support::{image, vehicle};
use virtual_brick::{Configuration, Engine, ScalarKind, StopReason, VirtualBrick};

const COUNTER: u32 = 0x0020_8000;
const END: u64 = 500_000;

/// Counts the interval timer's periods of 1,000 cycles, with the processor stopped in between.
fn counting() -> VirtualBrick {
    counting_on(Engine::default())
}

fn counting_on(engine: Engine) -> VirtualBrick {
    let mut program = Program::new();
    program
        .poke(0xFFFF_F080 + 4, 0)
        .poke(0xFFFF_F120, 2)
        .poke(0xFFFF_FD30, 0x0300_003E)
        .load(2, COUNTER)
        .load(3, 0);
    let again = program.here();
    program
        .poke(0xFFFF_FC04, 1)
        .load(1, 0xFFFF_FD38)
        .ldr(0, 1, 0)
        .add(3, 1)
        .str(3, 2, 0)
        .poke(0xFFFF_F128, 2)
        .branch(ALWAYS, again);
    let elf = image(&program).object("counter", COUNTER, 4).build();
    let configuration = Configuration {
        engine,
        ..vehicle()
    };
    let mut brick = VirtualBrick::new(&configuration, &elf).unwrap();
    brick.add_probe("counter", Some(ScalarKind::U32)).unwrap();
    brick
}

fn with_inputs() -> VirtualBrick {
    let mut brick = counting();
    brick.schedule_input(100_000, "touch.1", 1.0).unwrap();
    brick
        .schedule_input(100_000, "motor.A.hand_angle", 0.5)
        .unwrap();
    brick.schedule_input(300_000, "touch.1", 0.0).unwrap();
    brick
}

/// The counter is set to 5,000 by hand at an instant, by inputs alone.
fn with_counter_written(engine: Engine) -> VirtualBrick {
    let mut brick = counting_on(engine);
    brick
        .schedule_input(200_000, "variable.counter:u32", 5_000.0)
        .unwrap();
    brick
}

#[test]
fn a_variable_is_an_input_that_every_engine_replays() {
    let mut seen = Vec::new();
    for engine in [Engine::Reference, Engine::Blocks] {
        let mut brick = with_counter_written(engine);
        brick.run_until(199_000);
        assert!(counter(&brick) < 200);
        brick.run_until(200_100);
        assert_eq!(counter(&brick), 5_000);
        brick.run_until(END);
        seen.push(brick.trace().digest());
    }
    assert_eq!(seen[0], seen[1]);
    let mut untouched = counting();
    untouched.run_until(END);
    assert_ne!(seen[0], untouched.trace().digest());
}

#[test]
fn a_variable_that_cannot_be_written_is_refused_at_once() {
    let mut brick = counting();
    for (name, value, expected) in [
        ("variable.gain:f32", 1.0, "gain"),
        ("variable.counter", 1.0, "its type is unknown"),
        ("variable.counter:u9", 1.0, "unknown kind"),
        ("variable.counter:u32", -1.0, "-1 is no number of type u32"),
    ] {
        let refused = brick.schedule_input(10, name, value).unwrap_err();
        assert!(refused.to_string().contains(expected), "{refused}");
    }
}

fn counter(brick: &VirtualBrick) -> i64 {
    brick
        .read_scalar("counter", Some(ScalarKind::U32))
        .unwrap()
        .as_integer()
}

#[test]
fn idle_time_is_skipped_to_exact_interrupts() {
    let mut brick = counting();
    assert_eq!(brick.run_until(END).reason, StopReason::Reached);
    let periods = END as i64 / (63 * 16);
    assert!(
        (periods - 2..=periods).contains(&counter(&brick)),
        "{}",
        counter(&brick)
    );
}

#[test]
fn equal_runs_have_equal_digests_however_they_are_cut() {
    let (mut whole, mut cut) = (with_inputs(), with_inputs());
    whole.run_until(END);
    for step in 0..END / 333 {
        cut.run_until(step * 333);
    }
    cut.run_until(END);
    assert_eq!(whole.trace().digest(), cut.trace().digest());
    assert_eq!(whole.cycles(), cut.cycles());
    assert_eq!(whole.processor(), cut.processor());
}

#[test]
fn another_input_gives_another_digest() {
    let (mut first, mut second) = (with_inputs(), with_inputs());
    second.schedule_input(400_000, "touch.1", 1.0).unwrap();
    first.run_until(END);
    second.run_until(END);
    assert_ne!(first.trace().digest(), second.trace().digest());
}

#[test]
fn going_on_after_a_snapshot_equals_going_on_after_its_restore() {
    let mut brick = with_inputs();
    brick.run_until(200_000);
    let snapshot = brick.snapshot();
    brick.run_until(END);
    let (digest, end, processor) = (
        brick.trace().digest(),
        brick.cycles(),
        brick.processor().clone(),
    );
    brick.restore(&snapshot);
    assert!(brick.cycles() < 201_000);
    brick.run_until(END);
    assert_eq!(brick.trace().digest(), digest);
    assert_eq!((brick.cycles(), brick.processor()), (end, &processor));
}

#[test]
fn a_snapshot_can_be_restored_into_another_brick_of_any_kind() {
    let mut brick = with_inputs();
    brick.run_until(200_000);
    let snapshot = brick.snapshot();
    brick.run_until(END);
    let mut other = counting();
    other.run_until(5_000);
    other.restore(&snapshot);
    other.run_until(END);
    assert_eq!(other.trace().digest(), brick.trace().digest());
}

#[test]
fn inputs_of_the_past_and_of_unknown_name_are_refused() {
    let mut brick = counting();
    brick.run_until(10_000);
    let past = brick
        .schedule_input(9_000, "touch.1", 1.0)
        .unwrap_err()
        .to_string();
    assert!(past.contains("cycle 9000 has passed"), "{past}");
    assert!(brick.schedule_input(20_000, "touch.2", 1.0).is_err());
    assert!(brick.schedule_input(20_000, "touch.1", f64::NAN).is_err());
    assert!(brick.schedule_input(brick.cycles(), "touch.1", 1.0).is_ok());
}

#[test]
fn signals_and_probes_are_sampled_once_per_period() {
    let mut brick = counting();
    brick.run_until(END);
    let probe = brick.trace().signals().get("probe.counter").unwrap();
    assert_eq!(probe.at_cycles.len(), 1 + (END / 48_055) as usize);
    for (index, at_cycles) in probe.at_cycles.iter().enumerate() {
        let due = index as u64 * 48_055;
        assert!(
            (due..due + 8).contains(at_cycles),
            "{at_cycles} is not at {due}"
        );
    }
    assert!(probe.values.windows(2).all(|pair| pair[0] < pair[1]));
}
