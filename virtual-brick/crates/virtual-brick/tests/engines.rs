// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! JIT code and blocks do what the reference engine does: same registers, memory, cycles, trace.

use crate::support::arm::{Program, ALWAYS, EQ, NE};
use crate::support::random::{self, Kind, Numbers};
use crate::support::{image, requests, vehicle};
use virtual_brick::{Access, CpuStep, Engine, StepObserver, StopReason, VirtualBrick};

fn brick(elf: &[u8], engine: Engine, jit_threshold_runs: u32) -> VirtualBrick {
    let mut configuration = vehicle();
    configuration.engine = engine;
    configuration.jit_threshold_runs = jit_threshold_runs;
    configuration.jit_synchronous = true;
    VirtualBrick::new(&configuration, elf).unwrap()
}

/// JIT code from the first runs on, and the reference engine.
fn pair(elf: &[u8]) -> (VirtualBrick, VirtualBrick) {
    (
        brick(elf, Engine::Fast, 2),
        brick(elf, Engine::Reference, 0),
    )
}

fn assert_same(fast: &VirtualBrick, reference: &VirtualBrick, what: &str) {
    assert_eq!(requests::difference(fast, reference), None, "{what}");
}

/// Runs all in the same pieces of random length and compares after each.
fn compare(elf: &[u8], seed: u64, pieces: u32, longest: u32) {
    let mut reference = brick(elf, Engine::Reference, 0);
    let mut others = [
        brick(elf, Engine::Fast, 1 + (seed % 4) as u32),
        brick(elf, Engine::Blocks, 0),
    ];
    let mut numbers = Numbers::new(seed ^ 0x5EED);
    let mut until = 0;
    for _ in 0..pieces {
        until += u64::from(1 + numbers.below(longest));
        let stop = reference.run_until(until);
        for (other, name) in others.iter_mut().zip(["JIT code", "blocks"]) {
            assert_eq!(other.run_until(until), stop, "{name}, seed {seed}");
            assert_same(
                other,
                &reference,
                &format!("{name}, seed {seed} at {until}"),
            );
        }
    }
}

/// What is recorded and where the run is stopped are random as well.
fn compare_requests(kind: Kind, seeds: u64, longest: u32) {
    for seed in 0..seeds {
        if let Err(difference) = requests::compare(seed, kind, longest) {
            panic!("{difference}");
        }
    }
}

#[test]
fn random_programs_in_ram_with_interrupts_and_stores_into_code() {
    compare_requests(Kind::Ram, 12, 8_000);
}

#[test]
fn random_programs_with_peripherals_at_work() {
    compare_requests(Kind::Devices, 20, 8_000);
}

#[test]
fn random_programs_in_flash_with_wait_states() {
    compare_requests(Kind::Flash, 6, 200_000);
}

#[test]
fn random_programs_at_the_slow_clock() {
    compare_requests(Kind::SlowFlash, 8, 4_000_000);
}

/// Masked interrupts that the program sets, acknowledges and ends itself are two events each; the
/// block goes on behind them.
#[test]
fn a_trace_that_fills_up_in_a_block_ends_the_run_there() {
    let mut program = Program::new();
    program.poke(0xFFFF_F010, 0x20).poke(0xFFFF_F120, 0x10); // source 4: edge, enabled
    program.load(1, 0xFFFF_F000).load(5, 0x10);
    let again = program.here();
    program.str(5, 1, 0x12C); // AIC_ISCR
    (0..6).for_each(|_| {
        program.add(4, 1);
    });
    program.ldr(3, 1, 0x100).str(3, 1, 0x130).add(4, 1); // AIC_IVR, AIC_EOICR
    program.branch(ALWAYS, again);
    let elf = image(&program).build();
    for events in 0..40 {
        let stops = [Engine::Reference, Engine::Blocks, Engine::Fast].map(|engine| {
            let mut configuration = vehicle();
            configuration.engine = engine;
            configuration.jit_threshold_runs = 2;
            configuration.trace_limits.events = events;
            let mut brick = VirtualBrick::new(&configuration, &elf).unwrap();
            (brick.run_until(10_000), brick.processor().clone())
        });
        assert_eq!(stops[0].0.reason, StopReason::TraceFull);
        assert_eq!(stops[0], stops[1]);
        assert_eq!(stops[0], stops[2]);
    }
}

/// Blocks that were decoded before do not hide a call.
#[test]
fn calls_are_traced_from_the_middle_of_a_run_on() {
    let mut program = Program::new();
    program.raw(0xEA00_0000).raw(0xE12F_FF1E); // b over the function: bx lr
    let again = program.here();
    program.raw(0xEBFF_FFFD).branch(ALWAYS, again); // bl to the function
    let function = crate::support::RAM + 4;
    let elf = image(&program).function("called", function).build();
    for engine in [Engine::Reference, Engine::Blocks, Engine::Fast] {
        let mut brick = brick(&elf, engine, 2);
        brick.run_until(1_000);
        brick.trace_calls(&["called".to_owned()]);
        brick.run_until(2_000);
        let calls = brick.traced_calls();
        let seen = calls.iter().map(|call| call.cycles).collect::<Vec<_>>();
        assert_eq!(seen, [(1_007, 1_997)], "{engine:?}");
    }
}

#[test]
fn random_programs_really_run() {
    let (mut fast, _) = pair(&random::image(1, Kind::Ram));
    assert_eq!(fast.run_until(100_000).reason, StopReason::Reached);
    let served = fast.read_memory(0x0020_7FFC, 4).unwrap();
    assert_ne!(served, [0; 4], "no interrupt was served");
}

/// A flag in memory that an interrupt would set: the loop is passed over, not its cycles.
#[test]
fn waiting_loops_take_the_same_time() {
    let mut program = Program::new();
    program.load(2, 0x0020_8000).load(3, 0xFFFF_FD3C);
    let again = program.here();
    program.ldr(0, 2, 0).tst(0, 1).branch(EQ, again);
    let elf = image(&program).build();
    compare(&elf, 1, 20, 5_000);
}

/// The instruction that reads an address without a register is the last one of the run.
#[test]
fn an_access_to_nothing_ends_the_run_with_the_same_state() {
    for access in [0xE5B2_0004, 0xE5A2_0004, 0xE492_0004] {
        // ldr r0, [r2, #4]!; str r0, [r2, #4]!; ldr r0, [r2], #4
        let mut program = Program::new();
        program.load(2, 0xFFFF_FC80).add(0, 1).raw(access).add(0, 2);
        let elf = image(program.stop()).build();
        let (mut fast, mut reference) = pair(&elf);
        let stops = (fast.run_until(10_000), reference.run_until(10_000));
        assert_eq!(stops.0.reason, StopReason::Fault, "{}", stops.0.message);
        assert_eq!(stops.0, stops.1);
        assert_same(&fast, &reference, "after the fault");
    }
}

#[test]
fn a_spinning_processor_takes_the_same_time() {
    let mut program = Program::new();
    program.status(0x13).stop();
    compare(&image(&program).build(), 2, 20, 5_000);
}

/// The instruction behind a store is fetched already, the third one is not.
#[test]
fn a_store_changes_only_what_was_not_fetched() {
    let mut program = Program::new();
    program.load(9, crate::support::RAM).load(11, 0xE3A0_4007); // mov r4, #7
    program.raw(0xE3A0_7004); // mov r7, #4
    let again = program.here();
    let store = program.here() as u32;
    program
        .str(11, 9, 4 * (store + 1))
        .str(11, 9, 4 * (store + 4));
    program.raw(0xE3A0_4001).raw(0xE3A0_5001); // mov r4, #1; mov r5, #1
    program.raw(0xE3A0_6001); // mov r6, #1: becomes mov r4, #7
    program.subs(7, 1).branch(NE, again).stop();
    let elf = image(&program).build();
    compare(&elf, 3, 12, 60);
    let (mut fast, _) = pair(&elf);
    fast.run_until(10_000);
    assert_eq!(fast.processor().register(6), 0);
    assert_eq!(fast.processor().register(4), 7);
}

/// MOVS with each kind of shift and amount; sums take the carry that it leaves.
#[test]
fn jit_code_shifts_as_the_reference_does() {
    let mut program = Program::new();
    program.load(1, 0x8123_4567).load(7, 40);
    let again = program.here();
    let amounts = [0, 1, 8, 31, 32, 33, 63, 64, 255];
    for kind in 0..4 {
        for amount in [0, 1, 17, 31] {
            program.raw(0xE1B0_4001 | amount << 7 | kind << 5); // movs r4, r1, <shift> #amount
            program.raw(0xE0B5_5004).raw(0xE0D6_6004); // adcs r5, r5, r4; sbcs r6, r6, r4
        }
        for amount in amounts {
            program.raw(0xE3A0_2000 | amount); // mov r2, #amount
            program.raw(0xE1B0_4211 | kind << 5); // movs r4, r1, <shift> r2
            program.raw(0xE0B5_5004).raw(0x20F6_6004); // adcs r5, r5, r4; rsccs r6, r6, r4
        }
    }
    program.raw(0xE081_11E5); // add r1, r1, r5, ror #3
    program.subs(7, 1).branch(NE, again).stop();
    compare(&image(&program).build(), 3, 30, 2_000);
}

/// A branch by register to itself is the end of a program whose interrupts are masked.
#[test]
fn jit_code_does_not_run_past_a_branch_to_itself() {
    let mut program = Program::new();
    program.status(0xD3).load(7, 60);
    let again = program.here() + 2;
    let branch = again + 4;
    program.load(1, crate::support::RAM + 4 * again as u32);
    program.load(2, crate::support::RAM + 4 * branch as u32);
    assert_eq!(program.here(), again);
    program.subs(7, 1);
    program.raw(0x11A0_0001).raw(0x01A0_0002); // movne r0, r1; moveq r0, r2
    program.raw(0xEAFF_FFFF).raw(0xE12F_FF10); // b to the next instruction; bx r0
    compare(&image(&program).build(), 3, 20, 400);
}

/// Counts the steps of the reference engine in a run of the fast engine.
struct ReferenceSteps(u32);

impl StepObserver for ReferenceSteps {
    const SEES_ACCESSES: bool = false;
    const SEES_STEPS: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        self.0 += 1;
        false
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, _brick: &VirtualBrick, _step: CpuStep) -> bool {
        false
    }
}

/// Each event of the chip ends a run of blocks; the instructions before it are no single steps.
#[test]
fn blocks_run_up_to_an_event() {
    let mut program = Program::new();
    program.load(9, crate::support::RAM).load(1, 1);
    let again = program.here();
    for _ in 0..20 {
        program.ldr(2, 9, 0).add(1, 1);
    }
    program.branch(ALWAYS, again);
    let elf = image(&program).build();
    for engine in [Engine::Blocks, Engine::Fast] {
        let mut brick = brick(&elf, engine, 2);
        let mut steps = ReferenceSteps(0);
        for piece in 1..=1_000 {
            brick.run_observed(1_000 * piece, &mut steps);
        }
        assert!(steps.0 <= 2_000, "{engine:?}: {} steps", steps.0);
    }
}
