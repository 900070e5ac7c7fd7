// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The compile thread: the run is the same whenever its code arrives, and all bricks of a process
//! have one.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use support::arm::{Program, ALWAYS, NE};
use support::random::{self, Kind, Numbers};
use support::{image, vehicle};
use virtual_brick::{Engine, VirtualBrick};

/// The tests wait for things that come soon, or never.
const LONGEST: Duration = Duration::from_secs(60);

fn brick(elf: &[u8], engine: Engine) -> VirtualBrick {
    let mut configuration = vehicle();
    configuration.engine = engine;
    configuration.jit_threshold_runs = 2;
    VirtualBrick::new(&configuration, elf).unwrap()
}

/// A loop in a loop, without end.
fn busy() -> Vec<u8> {
    let mut program = Program::new();
    let outer = program.here();
    program.raw(0xE3A0_7064); // mov r7, #100
    let inner = program.here();
    program.add(0, 1).subs(7, 1).branch(NE, inner);
    program.add(1, 1).branch(ALWAYS, outer);
    image(&program).build()
}

/// Lets the brick run in small pieces until it has JIT code.
fn run_until_compiled(brick: &mut VirtualBrick) {
    let begun = Instant::now();
    while brick.jit_code_bytes() == 0 {
        assert!(begun.elapsed() < LONGEST, "no JIT code comes");
        brick.run_until(brick.cycles() + 1_000);
        thread::yield_now();
    }
}

/// Compile threads of this process.
#[cfg(target_os = "linux")]
fn compile_threads() -> usize {
    let threads = fs::read_dir("/proc/self/task").unwrap().flatten();
    let names = threads.filter_map(|thread| fs::read_to_string(thread.path().join("comm")).ok());
    names
        .filter(|name| name.trim_end() == "JIT compiler")
        .count()
}

fn assert_same(one: &VirtualBrick, other: &VirtualBrick, what: &str) {
    assert_eq!(one.cycles(), other.cycles(), "{what}");
    assert_eq!(one.processor(), other.processor(), "{what}");
    assert_eq!(one.trace().digest(), other.trace().digest(), "{what}");
}

#[test]
fn random_programs_run_alike_whenever_their_code_arrives() {
    for (seed, kind) in (0..24).zip([Kind::Ram, Kind::Flash].into_iter().cycle()) {
        let elf = random::image(seed, kind);
        let (mut fast, mut blocks) = (brick(&elf, Engine::Fast), brick(&elf, Engine::Blocks));
        let mut numbers = Numbers::new(seed ^ 0xBE51DE);
        let mut until = 0;
        for _ in 0..20 {
            until += u64::from(1 + numbers.below(40_000));
            assert_eq!(fast.run_until(until), blocks.run_until(until));
            assert_same(&fast, &blocks, &format!("seed {seed} at {until}"));
            // The thread may be anywhere.
            (0..numbers.below(8)).for_each(|_| thread::yield_now());
        }
    }
}

/// A loop that calls one function by its address, and after 50 turns another, whose first
/// instruction it changes in each turn.
fn changing() -> Vec<u8> {
    let mut program = Program::new();
    program.raw(0xEA00_0003); // b to the fifth instruction from here
    let (first, second) = (support::RAM + 4, support::RAM + 12);
    program.raw(0xE3A0_0000).raw(0xE12F_FF1E); // mov r0, #0; bx lr
    program.raw(0xE3A0_0001).raw(0xE12F_FF1E); // mov r0, #1; bx lr
    program.load(9, first).load(8, second).load(11, 0xE3A0_0001);
    let outer = program.here();
    program.str(11, 8, 0).raw(0xE22B_B003); // eor r11, r11, #3: mov r0, #1 and #2 in turn
    program.raw(0xE3A0_7014); // mov r7, #20
    let inner = program.here();
    program.raw(0xE1A0_E00F).raw(0xE12F_FF19); // mov lr, pc; bx r9
    program.raw(0xE081_1000); // add r1, r1, r0
    program.subs(7, 1).branch(NE, inner);
    program.add(4, 1).raw(0xE354_0032).raw(0x01A0_9008); // cmp r4, #50; moveq r9, r8
    program.branch(ALWAYS, outer);
    image(&program).build()
}

#[test]
fn code_of_a_program_that_has_changed_is_not_installed() {
    let elf = changing();
    let (mut fast, mut blocks) = (brick(&elf, Engine::Fast), brick(&elf, Engine::Blocks));
    fast.run_until(20_000);
    run_until_compiled(&mut fast);
    let end = fast.cycles() + 1_000_000;
    fast.run_until(end);
    blocks.run_until(end);
    assert_same(&fast, &blocks, "changing");
    assert!(fast.processor().register(4) > 50, "too few turns");
}

#[test]
fn a_run_continues_alike_when_code_is_installed() {
    let elf = busy();
    let mut fast = brick(&elf, Engine::Fast);
    run_until_compiled(&mut fast);
    let mut reference = brick(&elf, Engine::Reference);
    reference.run_until(fast.cycles());
    assert_same(&fast, &reference, "with JIT code");
}

#[test]
fn a_block_that_never_leaves_the_engine_waits_for_its_code() {
    let mut fast = brick(&busy(), Engine::Fast);
    fast.run_until(100_000);
    assert_ne!(fast.jit_code_bytes(), 0);
}

#[test]
fn snapshots_and_copies_start_without_jit_code_and_run_alike() {
    let elf = busy();
    let mut brick = brick(&elf, Engine::Fast);
    brick.run_until(20_000);
    let early = brick.snapshot();
    run_until_compiled(&mut brick);
    let mut copy = brick.clone();
    assert_eq!(copy.jit_code_bytes(), 0);
    let end = brick.cycles() + 50_000;
    brick.run_until(end);
    copy.run_until(end);
    assert_same(&brick, &copy, "copy");
    copy.restore(&early);
    assert_eq!((copy.cycles(), copy.jit_code_bytes()), (20_000, 0));
    copy.run_until(end);
    assert_same(&brick, &copy, "restored");
}

/// Bricks that are dropped while the thread compiles for them are among them.
#[test]
#[cfg(target_os = "linux")]
fn all_bricks_of_a_process_have_one_compile_thread() {
    let elf = busy();
    for count in 0..200 {
        let mut brick = brick(&elf, Engine::Fast);
        brick.run_until(5_000);
        if count % 10 == 0 {
            run_until_compiled(&mut brick);
            assert_eq!(compile_threads(), 1);
            thread::spawn(move || drop(brick)).join().unwrap();
        }
    }
    assert_eq!(compile_threads(), 1);
}
