// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Hot blocks: when they are compiled together, how their code is installed, left, invalidated.

use std::sync::{Arc, Mutex};

use super::machine::{assert_as_reference, branch, program, run_until, store, Machine, START};
use crate::blocks::{Blocks, CodeExit, CompileAnswer, GuestState, Jit, RamView, Region};
use crate::instruction::ALWAYS;
use crate::Cpu;

const NE: u32 = 1;
const THRESHOLD_RUNS: u32 = 10;
/// Below a hundred runs, as in most tests, compilation has no budget.
const BUDGETED_THRESHOLD_RUNS: u32 = 200;
const OUTER: u32 = START + 4;
const INNER: u32 = OUTER + 4;

/// Counts r0 down from 20 in an inner loop, again and again.
const OPCODES: [u32; 5] = [
    0xE3A0_3000, // mov r3, #0
    0xE3A0_0014, // OUTER: mov r0, #20
    0xE250_0001, // subs r0, r0, #1
    0x1AFF_FFFD, // bne to the instruction before
    0xEAFF_FFFB, // b to OUTER
];

/// What was asked of the compiler, and what it answers.
#[derive(Debug, Default)]
struct Log {
    requests: Vec<Region>,
    installed: usize,
    invalid: Vec<u32>,
    entries: u32,
    busy: bool,
}

/// A compiler whose code executes nothing: it takes a side exit in front of each block.
#[derive(Clone, Debug)]
struct EmptyCode {
    log: Arc<Mutex<Log>>,
    threshold_runs: u32,
}

impl Jit for EmptyCode {
    fn new_like(&self) -> Box<dyn Jit> {
        Box::new(self.clone())
    }

    fn threshold_runs(&self) -> u32 {
        self.threshold_runs
    }

    fn request(&mut self, region: Region, _ram: &RamView<'_>) -> CompileAnswer {
        let mut log = self.log.lock().unwrap();
        if log.busy {
            return CompileAnswer::Busy;
        }
        log.requests.push(region);
        CompileAnswer::Queued
    }

    fn next_compiled(&mut self, _wait: bool) -> Option<u32> {
        let log = self.log.lock().unwrap();
        log.requests.get(log.installed).map(|region| region.number)
    }

    fn install(&mut self, wanted: bool) -> bool {
        self.log.lock().unwrap().installed += 1;
        wanted
    }

    fn invalidate(&mut self, halfword: u32) {
        self.log.lock().unwrap().invalid.push(halfword);
    }

    fn invalidate_all(&mut self) {}

    fn code_bytes(&self) -> usize {
        self.log.lock().unwrap().installed
    }

    fn is_exhausted(&self) -> bool {
        false
    }

    fn run(&mut self, halfword: u32, state: &mut GuestState, _ram: RamView<'_>) -> CodeExit {
        let mut log = self.log.lock().unwrap();
        log.entries += 1;
        let mut blocks = log.requests.iter().flat_map(|region| &region.blocks);
        let block = blocks.find(|block| block.halfword == halfword).unwrap();
        state.next = block.key;
        CodeExit {
            block: block.number,
            operation: 0,
        }
    }
}

struct Fixture {
    cpu: Cpu,
    machine: Machine,
    blocks: Blocks<Machine>,
    log: Arc<Mutex<Log>>,
}

fn fixture() -> Fixture {
    fixture_with(THRESHOLD_RUNS)
}

fn fixture_with(threshold_runs: u32) -> Fixture {
    let log = Arc::<Mutex<Log>>::default();
    let jit = EmptyCode {
        log: Arc::clone(&log),
        threshold_runs,
    };
    let (cpu, machine) = program(&OPCODES);
    let blocks = Blocks::with_jit(Box::new(jit));
    Fixture {
        cpu,
        machine,
        blocks,
        log,
    }
}

impl Fixture {
    fn run_until(&mut self, end: u64) {
        run_until(&mut self.cpu, &mut self.machine, &mut self.blocks, end);
    }

    /// Writes a word that holds code as it is.
    fn store_again(&mut self, address: u32) {
        let opcode = self.machine.words[address as usize / 4];
        store(&mut self.machine, address, opcode);
        self.blocks.update(&mut self.machine);
    }
}

#[test]
fn a_block_is_compiled_after_as_many_runs_as_the_threshold() {
    let mut fixture = fixture();
    let (first_cycles, inner_cycles) = (fixture.machine.now + 6, 4);
    fixture.run_until(first_cycles + u64::from(THRESHOLD_RUNS - 1) * inner_cycles);
    assert!(fixture.log.lock().unwrap().requests.is_empty());
    fixture.run_until(first_cycles + u64::from(THRESHOLD_RUNS + 4) * inner_cycles);
    let log = fixture.log.lock().unwrap();
    assert_eq!(log.requests[0].blocks[0].key, INNER);
}

#[test]
fn a_region_leaves_out_blocks_that_run_rarely() {
    let mut fixture = fixture();
    fixture.run_until(1_000);
    let log = fixture.log.lock().unwrap();
    let keys = log.requests[0].blocks.iter().map(|block| block.key);
    assert_eq!(keys.collect::<Vec<_>>(), [INNER]);
    let target = log.requests[0].blocks[0].instructions[1].target;
    assert_eq!(target.map(|target| target.key), Some(INNER));
    assert_eq!(OPCODES[3], branch(NE, OUTER + 8, INNER));
    assert_eq!(OPCODES[4], branch(ALWAYS, OUTER + 12, OUTER));
}

#[test]
fn the_interpreter_continues_behind_a_side_exit() {
    let mut fixture = fixture();
    fixture.run_until(5_000);
    assert!(fixture.log.lock().unwrap().entries > 0);
    assert_as_reference(&OPCODES, &fixture.cpu, &fixture.machine);
}

#[test]
fn code_that_executes_nothing_is_not_entered_any_more() {
    let mut fixture = fixture();
    fixture.run_until(5_000);
    let entries = fixture.log.lock().unwrap().entries;
    fixture.run_until(10_000);
    assert_eq!(fixture.log.lock().unwrap().entries, entries);
}

#[test]
fn a_busy_compiler_is_asked_again_after_as_many_runs() {
    let mut fixture = fixture();
    fixture.log.lock().unwrap().busy = true;
    fixture.run_until(500);
    fixture.log.lock().unwrap().busy = false;
    fixture.run_until(1_000);
    assert!(!fixture.log.lock().unwrap().requests.is_empty());
}

#[test]
fn a_change_of_one_block_invalidates_its_region() {
    let mut fixture = fixture();
    fixture.run_until(1_000);
    assert!(fixture.log.lock().unwrap().invalid.is_empty());
    fixture.store_again(INNER);
    let log = fixture.log.lock().unwrap();
    let blocks = log.requests[0].blocks.iter().map(|block| block.halfword);
    assert_eq!(blocks.collect::<Vec<_>>(), log.invalid);
}

#[test]
fn a_region_that_was_invalidated_before_it_paid_is_compiled_again_later() {
    let mut fixture = fixture_with(BUDGETED_THRESHOLD_RUNS);
    let compiled = |fixture: &Fixture| fixture.log.lock().unwrap().requests.len();
    let mut cycles = 0;
    while compiled(&fixture) == 0 {
        cycles += 1_000;
        fixture.run_until(cycles);
    }
    fixture.store_again(INNER);
    fixture.run_until(2 * cycles + cycles / 2);
    assert_eq!(compiled(&fixture), 1);
    fixture.run_until(3 * cycles + cycles / 2);
    assert_eq!(compiled(&fixture), 2);
}
