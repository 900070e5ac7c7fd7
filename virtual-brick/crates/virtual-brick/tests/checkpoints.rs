// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Checkpoints, observers and access from outside.

use crate::support::arm::{Program, ALWAYS};
use crate::support::brick;
use arm7tdmi::Step;
use virtual_brick::{Access, StepObserver, VirtualBrick};

const COUNTER: u32 = 0x0020_8000;

fn counting() -> VirtualBrick {
    let mut program = Program::new();
    program.load(1, COUNTER);
    let again = program.here();
    program.add(0, 1).str(0, 1, 0).branch(ALWAYS, again);
    brick(&program)
}

#[derive(Default)]
struct Counting {
    steps: u64,
    writes: Vec<Access>,
    stop_after: u64,
}

impl StepObserver for Counting {
    const SEES_ACCESSES: bool = true;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        self.steps == self.stop_after
    }

    fn access(&mut self, access: Access) {
        self.writes.extend(access.written.map(|_| access));
    }

    fn after_step(&mut self, _brick: &VirtualBrick, _step: Step) -> bool {
        self.steps += 1;
        false
    }
}

#[test]
fn a_run_from_a_checkpoint_is_the_run_that_followed_it() {
    let mut brick = counting();
    brick.schedule_input(400_000, "touch.1", 1.0).unwrap();
    brick.run_until(100_000);
    let checkpoint = brick.checkpoint();
    assert_eq!(checkpoint.cycles(), brick.cycles());
    brick.run_until(1_000_000);
    let (digest, cycles) = (brick.trace().digest(), brick.cycles());
    brick.go_back(&checkpoint).unwrap();
    assert_eq!(brick.cycles(), checkpoint.cycles());
    brick.run_until(1_000_000);
    assert_eq!((brick.trace().digest(), brick.cycles()), (digest, cycles));
    let refused = counting().go_back(&checkpoint).unwrap_err();
    assert_eq!(refused.now_cycles, 0);
}

#[test]
fn an_observer_sees_steps_and_accesses_and_changes_nothing() {
    let mut free = counting();
    let mut observed = free.clone();
    let mut observer = Counting {
        stop_after: 100,
        ..Counting::default()
    };
    assert_eq!(observed.run_observed(1_000_000, &mut observer), None);
    assert_eq!(observer.steps, 100);
    let expected = (1..=33).map(|value| Access {
        address: COUNTER,
        width_bytes: 4,
        written: Some(value),
    });
    assert!(observer.writes.iter().copied().eq(expected));
    observer.stop_after = u64::MAX;
    observed.run_observed(1_000_000, &mut observer).unwrap();
    free.run_until(1_000_000);
    assert_eq!(observed.trace().digest(), free.trace().digest());
    assert_eq!(observed.processor(), free.processor());
}

#[test]
fn the_bus_is_read_without_side_effects_and_memory_is_written() {
    let mut brick = counting();
    brick.write_memory(COUNTER, &[1, 2, 3, 4]).unwrap();
    assert_eq!(brick.read_bus(COUNTER + 1, 2).unwrap(), [2, 3]);
    assert!(brick.write_memory(0x0040_0000, &[0]).is_err());
    let before = brick.processor().clone();
    // DBGU_CIDR tells the part; there is nothing at 0xFFF0_0000.
    assert_eq!(
        brick.read_bus(0xFFFF_F240, 4).unwrap(),
        [0x41, 0x09, 0x0B, 0x27]
    );
    assert!(brick.read_bus(0xFFF0_0000, 4).is_err());
    assert_eq!((brick.cycles(), brick.processor()), (0, &before));
    assert!(brick.ended().is_none());
}
