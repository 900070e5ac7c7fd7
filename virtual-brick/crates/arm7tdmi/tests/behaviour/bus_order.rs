// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Order and kind of the bus cycles of an instruction.

use super::program::{Program, DATA, START};
use crate::support::memory::Memory;
use arm7tdmi::{Abort, Bus, Cycle, Width};
use std::cell::RefCell;

/// Passes accesses on to a memory and writes them down, one word each.
struct Recorder {
    memory: Memory,
    log: RefCell<Vec<String>>,
}

impl Recorder {
    fn note(&self, what: &str, address: u32, cycle: Cycle) {
        let kind = match cycle {
            Cycle::Nonsequential => 'N',
            Cycle::Sequential => 'S',
        };
        self.log
            .borrow_mut()
            .push(format!("{what} {address:X} {kind}"));
    }
}

impl Bus for Recorder {
    fn fetch_word(&mut self, address: u32, cycle: Cycle) -> Result<u32, Abort> {
        self.note("fetch", address, cycle);
        self.memory.fetch_word(address, cycle)
    }

    fn fetch_halfword(&mut self, address: u32, cycle: Cycle) -> Result<u16, Abort> {
        self.note("fetch", address, cycle);
        self.memory.fetch_halfword(address, cycle)
    }

    fn read(&mut self, address: u32, width: Width, cycle: Cycle) -> Result<u32, Abort> {
        self.note("read", address, cycle);
        self.memory.read(address, width, cycle)
    }

    fn write(&mut self, address: u32, width: Width, value: u32, cycle: Cycle) -> Result<(), Abort> {
        self.note("write", address, cycle);
        self.memory.write(address, width, value, cycle)
    }

    fn internal(&mut self, count: u32) {
        self.log.borrow_mut().push(format!("internal {count}"));
    }

    fn irq(&self) -> bool {
        self.memory.irq
    }

    fn fiq(&self) -> bool {
        self.memory.fiq
    }
}

/// The bus cycles of the next `steps` steps.
fn cycles_of(program: Program, steps: usize) -> Vec<String> {
    let Program { mut cpu, memory } = program;
    let mut bus = Recorder {
        memory,
        log: RefCell::new(Vec::new()),
    };
    for _ in 0..steps {
        let _ = cpu.step(&mut bus);
    }
    bus.log.into_inner()
}

fn arm(opcode: u32) -> Vec<String> {
    let program = Program::arm(&[opcode]).with_words(DATA, &[0x200, 0x200]);
    cycles_of(program, 1)
}

#[test]
fn the_first_step_fills_the_pipeline_from_the_reset_vector() {
    let mut program = Program::arm(&[]);
    program.cpu.reset();
    let cycles = cycles_of(program, 1);
    assert_eq!(cycles[..3], ["fetch 0 N", "fetch 4 S", "fetch 8 S"]);
}

#[test]
fn a_load_fetches_reads_and_waits() {
    assert_eq!(
        arm(0xE594_0000),
        ["fetch 108 S", "read 1000 N", "internal 1"]
    );
}

#[test]
fn a_load_to_r15_refills_after_the_internal_cycle() {
    let expected = [
        "fetch 108 S",
        "read 1000 N",
        "internal 1",
        "fetch 200 N",
        "fetch 204 S",
    ];
    assert_eq!(arm(0xE594_F000), expected);
}

#[test]
fn the_fetch_after_a_store_is_non_sequential() {
    let program = Program::arm(&[0xE584_0000, 0xE1A0_8008]);
    let expected = ["fetch 108 S", "write 1000 N", "fetch 10C N"];
    assert_eq!(cycles_of(program, 2), expected);
}

#[test]
fn multiple_transfers_are_sequential_after_the_first() {
    let expected = ["fetch 108 S", "read 1000 N", "read 1004 S", "internal 1"];
    assert_eq!(arm(0xE894_0003), expected);
    let expected = ["fetch 108 S", "write 1000 N", "write 1004 S"];
    assert_eq!(arm(0xE884_0003), expected);
}

#[test]
fn a_swap_reads_and_writes_non_sequentially_then_waits() {
    let expected = ["fetch 108 S", "read 1000 N", "write 1000 N", "internal 1"];
    assert_eq!(arm(0xE104_0091), expected);
}

#[test]
fn a_branch_fetches_behind_itself_before_its_target() {
    assert_eq!(
        arm(0xEB00_0002),
        ["fetch 108 S", "fetch 110 N", "fetch 114 S"]
    );
}

#[test]
fn a_state_change_refills_in_the_width_of_the_new_state() {
    let program = Program::arm(&[0xE12F_FF14]).with(4, 0x301); // bx r4
    let expected = ["fetch 108 S", "fetch 300 N", "fetch 302 S"];
    assert_eq!(cycles_of(program, 1), expected);
}

#[test]
fn an_undefined_instruction_waits_one_cycle_before_its_vector() {
    let expected = ["fetch 108 S", "internal 1", "fetch 4 N", "fetch 8 S"];
    assert_eq!(arm(0xE600_0010), expected);
}

#[test]
fn an_interrupt_loses_one_fetch_before_its_vector() {
    let mut program = Program::arm(&[]);
    program.cpu.set_cpsr(0x1F);
    program.memory.irq = true;
    let expected = ["fetch 108 S", "fetch 18 N", "fetch 1C S"];
    assert_eq!(cycles_of(program, 1), expected);
}

#[test]
fn set_pc_leaves_the_bus_alone_until_the_next_step() {
    let mut program = Program::arm(&[]);
    program.cpu.set_pc(START + 0x100);
    assert_eq!(program.cpu.next_instruction_address(), START + 0x100);
    assert_eq!(program.memory.cycles, 0);
    let expected = ["fetch 200 N", "fetch 204 S", "fetch 208 S"];
    assert_eq!(cycles_of(program, 1), expected);
}
