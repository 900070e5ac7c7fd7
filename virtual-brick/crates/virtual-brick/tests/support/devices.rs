// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Pieces of random programs that let peripherals work: timers, pins, converter, two-wire bus,
//! serial ports with the data controller, interrupts, clocks, watched words, stacks of threads.

use super::arm::{Program, EQ, NE};
use super::elf::ElfBuilder;
use super::random::{Numbers, DATA, RAM};

/// The running thread, the first one, its control block, and where the offsets of that lie.
const RUNNING: u32 = DATA;
const FIRST: u32 = DATA + 4;
const BLOCK: u32 = DATA + 0x100;
const LAYOUT: u32 = 0x0020_A100;
const OFFSETS: [u32; 9] = [0, 4, 8, 12, 16, 20, 24, 32, 36];
const STACK: u32 = DATA + 0x800;
const STACK_BYTES: u32 = 512;
/// Of the interrupt handlers, which run in Supervisor mode here.
const HANDLER_STACK: u32 = 0x0020_C780;
const HANDLER_STACK_BYTES: u32 = 0x80;

const AIC: u32 = 0xFFFF_F000;
const PMC: u32 = 0xFFFF_FC00;
const PIO: u32 = 0xFFFF_F400;
const TC: u32 = 0xFFFA_0000;
const ADC: u32 = 0xFFFD_8000;
const TWI: u32 = 0xFFFB_8000;
const SPI: u32 = 0xFFFE_0000;
const DBGU: u32 = 0xFFFF_F200;
/// System, PIOA, ADC, SPI, TWI, TC0 to TC2.
const SOURCES: u32 = 0x7236;

/// Pins that neither the board nor another peripheral follows.
const UNFOLLOWED: u32 = 0x0040_7678;

/// A register: its address, the bits that are always written and those that may be; it is only
/// read if there are none.
type Register = (u32, u32, u32);

const REGISTERS: &[Register] = &[
    (PIO + 0x10, 0, u32::MAX), // OER
    (PIO + 0x30, 0, u32::MAX), // SODR
    (PIO + 0x34, 0, u32::MAX), // CODR
    (PIO + 0x3C, 0, 0),        // PDSR
    (PIO + 0x40, 0, 0x0080_8003),
    (PIO + 0x44, 0, u32::MAX),
    (PIO + 0x4C, 0, 0), // ISR
    (ADC, 0, 2),        // CR: START
    (ADC + 0x10, 0, 0xF2),
    (ADC + 0x1C, 0, 0),
    (ADC + 0x20, 0, 0), // LCDR
    (ADC + 0x24, 0, 0x1_0002),
    (TWI, 4, 3),                    // CR
    (TWI + 0x04, 0x1_0000, 0x1000), // MMR
    (TWI + 0x10, 0x0101, 0x3F3F),
    (TWI + 0x20, 0, 0),
    (TWI + 0x24, 0, 7),
    (TWI + 0x28, 0, 7),
    (TWI + 0x30, 0, 0),
    (TWI + 0x34, 0, 0xFF),
    (SPI, 1, 0),
    (SPI + 0x04, 0x11, 0x000E_0000), // MR
    (SPI + 0x08, 0, 0),              // RDR
    (SPI + 0x0C, 0, 0xFF),           // TDR
    (SPI + 0x10, 0, 0),
    (SPI + 0x14, 0, 3),
    (SPI + 0x30, 0x0402, 0xF000), // CSR0
    (SPI + 0x100, RAM, 0x7FC),    // RPR: into code
    (SPI + 0x104, 0, 0x1F),
    (SPI + 0x108, DATA, 0x3C),
    (SPI + 0x10C, 0, 0x1F),
    (SPI + 0x120, 0, 0x303),
    (DBGU, 0, 0x50),
    (DBGU + 0x14, 0, 0),
    (DBGU + 0x1C, 0, 0xFF),
    (DBGU + 0x20, 1, 0x3F),
    (DBGU + 0x108, DATA, 0x3C),
    (DBGU + 0x10C, 0, 0x1F),
    (DBGU + 0x120, 0, 0x300),
    (0xFFFF_FD20, 0x0000_0003, 0x3_001C), // RTT_MR
    (0xFFFF_FD28, 0, 0),
    (0xFFFF_FD2C, 0, 0),
    (0xFFFF_FD30, 0x0300_0010, 0xFF), // PIT_MR
    (0xFFFF_FD38, 0, 0),
    (0xFFFF_FD3C, 0, 0),
    (0xFFFF_FD40, 0xA500_0001, 0),   // WDT_CR
    (0xFFFF_FF60, 0x34_0000, 0x300), // MC_FMR
    (PMC + 0x04, 0, 1),              // SCDR: the processor stops
    (PMC + 0x30, 7, 8),              // MCKR
    (PMC + 0x68, 0, 0),
    (AIC + 0x100, 0, 0), // IVR
    (AIC + 0x10C, 0, 0),
    (AIC + 0x114, 0, 0),
    (AIC + 0x120, 2, SOURCES),
    (AIC + 0x124, 0, SOURCES & !2),
    (AIC + 0x128, 0, SOURCES),
    (AIC + 0x12C, 0, SOURCES),
    (AIC + 0x130, 0, 1),
    (AIC + 0x30, 0, 0x67), // SMR of TC0
    (AIC + 0x34, 0, 0x67),
];

/// Offsets in a timer channel.
const TIMER_REGISTERS: &[Register] = &[
    (0x00, 1, 6),      // CCR
    (0x04, 0, 0xC003), // CMR: capture, or wave up or up to RC
    (0x10, 0, 0),      // CV
    (0x14, 0, 0xFF),
    (0x1C, 0, 0x3FF), // RC
    (0x20, 0, 0),     // SR
    (0x24, 0, 0x1D),
    (0x28, 0, 0xFF),
];

/// Registers that programs poll.
const POLLED: [u32; 8] = [
    PIO + 0x3C,
    PIO + 0x4C,
    ADC + 0x1C,
    TWI + 0x20,
    TC + 0x10,
    TC + 0x20,
    0xFFFF_FD34,
    0xFFFF_FD3C,
];

/// Where the interrupt handler counts.
const SERVED: u32 = DATA - 8;

/// What the interrupt handler does besides: it reads, so that requests end, and counts.
pub fn serve(program: &mut Program) {
    for address in [TC + 0x20, TC + 0x60, TC + 0xA0, PIO + 0x4C, ADC + 0x20] {
        program.load(1, address).ldr(2, 1, 0);
    }
    program.load(1, SERVED).ldr(2, 1, 0).add(2, 1).str(2, 1, 0);
}

/// Instructions of [`serve`].
pub const SERVE_LENGTH: usize = 14;

pub fn set_up(program: &mut Program, numbers: &mut Numbers) {
    program.poke(PMC + 0x10, !3);
    program.poke(AIC + 0x120, 2 | numbers.word() & SOURCES);
    program.poke(SPI + 0x30, 0x0402).poke(SPI, 1);
    program.status(0xDF).load(13, STACK + STACK_BYTES);
    for (address, value) in [
        (BLOCK + 12, 5),
        (BLOCK + 32, STACK),
        (BLOCK + 36, STACK_BYTES),
        (FIRST, BLOCK),
        (BLOCK + 20, 1),
        (RUNNING, BLOCK),
    ] {
        program.poke(address, value);
    }
}

/// The symbols that the observer of threads and inputs of variables need.
pub fn symbols(elf: ElfBuilder, numbers: &mut Numbers, length: usize) -> ElfBuilder {
    let mut layout = vec![1, 40];
    layout.extend(OFFSETS);
    let mut place = || RAM + 4 * numbers.below(length as u32);
    elf.words(LAYOUT, &layout)
        .object("tasks__control_task", BLOCK, 600)
        .object("ravenbrick_running_thread", RUNNING, 4)
        .object("ravenbrick_first_thread", FIRST, 4)
        .object("ravenbrick_thread_layout", LAYOUT, 44)
        .object(
            "ravenbrick_handler_stack",
            HANDLER_STACK,
            HANDLER_STACK_BYTES,
        )
        .object(
            "ravenbrick_handler_stack_top",
            HANDLER_STACK + HANDLER_STACK_BYTES,
            4,
        )
        .object("patch", place(), 4)
        .object("number", DATA + 0x20, 4)
        .function("called", place())
        .function("also_called", place())
}

/// Waits for a bit of a register, or until an interrupt was served.
fn wait(program: &mut Program, numbers: &mut Numbers) {
    let address = POLLED[numbers.below(POLLED.len() as u32) as usize];
    program.status(0x13).load(5, address).load(6, SERVED);
    program.ldr(7, 6, 0);
    let again = program.here();
    program.ldr(1, 5, 0).ldr(2, 6, 0).cmp(2, 7);
    program.raw(0x0311_0000 | 1 << numbers.below(8)); // tsteq r1, #bit
    program.branch(EQ, again);
}

/// Levels of outputs that nothing else follows, and what is read of them.
fn write_pins(program: &mut Program, numbers: &mut Numbers) {
    program.poke(PIO + 0x10, UNFOLLOWED); // OER
    program.poke(PIO + 0x40, numbers.word() & numbers.word() & UNFOLLOWED); // IER
    program.load(5, PIO);
    for _ in 0..4 {
        program.load(6, numbers.word() & UNFOLLOWED);
        program.str(6, 5, 0x30 + 4 * numbers.below(2)); // SODR, CODR
        program.ldr(numbers.below(5), 5, 0x3C); // PDSR
    }
}

/// Accesses of registers, alone or in a loop.
pub fn accesses(program: &mut Program, numbers: &mut Numbers) {
    if numbers.below(12) == 0 {
        return wait(program, numbers);
    }
    if numbers.below(12) == 0 {
        return write_pins(program, numbers);
    }
    if numbers.below(3) > 0 {
        return access(program, numbers);
    }
    let (address, ..) = register(numbers);
    program.load(5, address);
    program.raw(0xE3A0_7001 + numbers.below(60)); // mov r7, #count
    let again = program.here();
    program.ldr(numbers.below(5), 5, 0).add(4, 1);
    if numbers.below(2) == 0 {
        access(program, numbers);
    }
    program.subs(7, 1).branch(NE, again);
}

fn register(numbers: &mut Numbers) -> Register {
    let place = numbers.below((REGISTERS.len() + TIMER_REGISTERS.len()) as u32) as usize;
    match TIMER_REGISTERS.get(place) {
        Some(&(offset, always, may)) => (TC + 0x40 * numbers.below(3) + offset, always, may),
        None => REGISTERS[place - TIMER_REGISTERS.len()],
    }
}

fn access(program: &mut Program, numbers: &mut Numbers) {
    let (address, always, may) = register(numbers);
    program.load(5, address);
    if always | may == 0 {
        // ldr, or ldrb: the byte in the lowest lane
        program.raw(0xE595_0000 | numbers.below(2) << 22 | numbers.below(5) << 12);
    } else {
        let value = always | numbers.word() & numbers.word() & may;
        program.load(6, value).str(6, 5, 0);
    }
}

/// Of a thread's stack, in System mode: words pushed and popped, frames small and large.
pub fn stack_work(program: &mut Program, numbers: &mut Numbers) {
    program.status(0x1F | numbers.below(2) << 7);
    program.load(13, STACK + 8 * (1 + numbers.below(STACK_BYTES / 8)));
    for _ in 0..1 + numbers.below(4) {
        match numbers.below(5) {
            0 => program.raw(0xE92D_000F), // push {r0-r3}
            1 => program.raw(0xE8BD_000F), // pop {r0-r3}
            2 => program.raw(0xE24D_D000 | (4 * numbers.below(64))), // sub sp, sp, #
            3 => program.raw(0xE28D_D000 | (4 * numbers.below(64))), // add sp, sp, #
            _ => return access(program, numbers),
        };
    }
    program.load(13, STACK + STACK_BYTES);
    if numbers.below(4) == 0 {
        program.poke(RUNNING, BLOCK);
    }
    program.status(0x13);
}
