// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random programs that keep running: arithmetic, transfers, branches, loops, both states, stores
//! into their own code, exceptions, interrupts of random period, reads of a running timer.

use super::arm::{Program, ALWAYS, NE};
use super::devices;
use super::elf::ElfBuilder;

pub const RAM: u32 = 0x0020_2000;
const FLASH: u32 = 0x0010_0000;
pub const DATA: u32 = 0x0020_8000;
const STACK: u32 = 0x0020_C000;
/// Image register of the interval timer: tells the exact cycle of its reading.
const TIMER: u32 = 0xFFFF_FD3C;
/// Instructions before the set-up: eight vectors and the handlers.
const fn handlers_length(kind: Kind) -> usize {
    match kind {
        Kind::Devices => 20 + devices::SERVE_LENGTH,
        _ => 20,
    }
}

/// ADD r3, r3, #1: what stores into code put there.
const HARMLESS: u32 = 0xE283_3001;

/// Deterministic numbers (xorshift).
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Below `bound`.
    pub fn below(&mut self, bound: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 32) as u32) % bound
    }

    pub fn word(&mut self) -> u32 {
        self.below(u32::MAX)
    }

    fn register(&mut self) -> u32 {
        self.below(7)
    }

    fn condition(&mut self) -> u32 {
        let any = self.below(48);
        if any < 14 {
            any << 28
        } else {
            ALWAYS << 28
        }
    }
}

/// Where a program runs and what it does besides computing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From RAM, with stores into its own code.
    Ram,
    /// From flash at the full clock, with wait states.
    Flash,
    /// From flash at the slow clock.
    SlowFlash,
    /// From RAM, with peripherals at work, watched words and stacks of threads.
    Devices,
}

/// An image with a random program.
pub fn image(seed: u64, kind: Kind) -> Vec<u8> {
    let numbers = &mut Numbers::new(seed);
    let base = base(kind);
    let mut program = Program::new();
    handlers(&mut program, kind);
    set_up(&mut program, numbers, base, kind);
    let body = program.here();
    restore_pointers(&mut program, base);
    for _ in 0..30 + numbers.below(50) {
        match (kind, numbers.below(4)) {
            (Kind::Devices, 0) => devices::accesses(&mut program, numbers),
            _ => piece(&mut program, numbers, base, kind),
        }
    }
    program.branch(ALWAYS, body);
    let words = program.words();
    let elf = ElfBuilder::new(base).words(base, &words);
    let elf = match kind {
        Kind::Devices => devices::symbols(elf, numbers, words.len()),
        _ => elf,
    };
    elf.function("start", base).build()
}

/// Where the program lies.
pub const fn base(kind: Kind) -> u32 {
    match kind {
        Kind::Ram | Kind::Devices => RAM,
        Kind::Flash | Kind::SlowFlash => FLASH,
    }
}

/// Vectors, then: skip an instruction; return; serve the interval timer.
fn handlers(program: &mut Program, kind: Kind) {
    for handler in [handlers_length(kind), 8, 8, 8, 9, 9, 10, 9] {
        let offset = handler.wrapping_sub(program.here() + 2) as u32;
        program.raw(0xEA00_0000 | offset & 0x00FF_FFFF);
    }
    program.raw(0xE1B0_F00E); // movs pc, lr
    program.raw(0xE25E_F004); // subs pc, lr, #4
    program.raw(0xE92D_0007); // stmdb sp!, {r0-r2}
    program.load(0, 0xFFFF_F000).load(1, 0xFFFF_FD38);
    program.ldr(2, 0, 0x100); // AIC_IVR
    program.ldr(2, 1, 0); // PIT_PIVR
    if kind == Kind::Devices {
        devices::serve(program);
    }
    program.str(2, 0, 0x130); // AIC_EOICR
    program.load(1, DATA - 4).str(2, 1, 0);
    program.raw(0xE8BD_0007); // ldmia sp!, {r0-r2}
    program.raw(0xE25E_F004); // subs pc, lr, #4
    assert_eq!(program.here(), handlers_length(kind));
}

fn set_up(program: &mut Program, numbers: &mut Numbers, base: u32, kind: Kind) {
    if base == RAM {
        for vector in 1..8 {
            let target = base + 4 * vector;
            let offset = target.wrapping_sub(4 * vector + 8) >> 2;
            program.poke(0x0020_0000 + 4 * vector, 0xEA00_0000 | offset & 0x00FF_FFFF);
        }
        program.poke(0xFFFF_FF00, 1); // remap
    } else {
        program.poke(0xFFFF_FD44, 0x8000); // watchdog off
        program.poke(0xFFFF_FF60, 0x0034_0000 | numbers.below(3) << 8); // flash wait states
    }
    if kind == Kind::Flash {
        program.poke(0xFFFF_FC20, 0x0601).wait(0xFFFF_FC68, 1);
        program.poke(0xFFFF_FC2C, 0x1048_1C0E).wait(0xFFFF_FC68, 4);
        program.poke(0xFFFF_FC30, 4).wait(0xFFFF_FC68, 8);
        program.poke(0xFFFF_FC30, 7).wait(0xFFFF_FC68, 8);
    }
    for (mode, stack) in [(0xD2, STACK), (0xDB, STACK + 0x200), (0xD7, STACK + 0x400)] {
        program.status(mode).load(13, stack);
    }
    program.status(0xD3).load(13, STACK + 0x800);
    program.poke(0xFFFF_F004, 0).poke(0xFFFF_F120, 2); // system interrupt
    let period = if kind == Kind::SlowFlash {
        0xFFFF
    } else {
        4 + numbers.below(200)
    };
    program.poke(0xFFFF_FD30, 0x0300_0000 | period);
    if kind == Kind::Devices {
        devices::set_up(program, numbers);
    }
    program.load(11, HARMLESS).load(12, TIMER).status(0x13);
}

fn restore_pointers(program: &mut Program, base: u32) {
    program.load(8, DATA).load(9, base).load(10, DATA + 0x400);
}

/// One or a few instructions.
fn piece(program: &mut Program, numbers: &mut Numbers, base: u32, kind: Kind) {
    match numbers.below(30) {
        0..=8 => data_processing(program, numbers),
        9 => multiplication(program, numbers),
        10..=14 => transfer(program, numbers),
        15 => block_transfer(program, numbers),
        16 | 17 => forward_branch(program, numbers),
        18 => counted_loop(program, numbers),
        19 => thumb_call(program, numbers, base),
        20 => {
            let masked = numbers.below(2) << 7;
            program.status(0x13 | masked);
        }
        21 => {
            program.ldr(numbers.register(), 12, 0);
        }
        22 if base == RAM => store_into_code(program, numbers),
        23 => register_access(program, numbers),
        24 => status_access(program, numbers),
        25 => return_from_mode(program, numbers),
        26 => jump_by_table(program, numbers, base),
        27 if kind == Kind::Devices => devices::stack_work(program, numbers),
        _ => {
            let oddities = [
                0xEF00_0000,
                0xE7FF_FFFF,
                0xE10F_0000,
                0xE108_1092,
                0xE1A0_000F,
            ];
            program.raw(oddities[numbers.below(5) as usize]);
        }
    }
}

fn data_processing(program: &mut Program, numbers: &mut Numbers) {
    let code = numbers.below(16);
    let flags = if code & 0b1100 == 0b1000 {
        1
    } else {
        numbers.below(2)
    };
    let first = match numbers.below(12) {
        0 => 15,
        1 => 8,
        _ => numbers.register(),
    };
    let second = match numbers.below(4) {
        0 => 1 << 25 | numbers.below(0x1000),
        1 => numbers.below(0x100) << 4 & 0xF60 | numbers.register(),
        2 => numbers.register() << 8 | numbers.below(4) << 5 | 1 << 4 | numbers.register(),
        _ => numbers.below(32) << 7 | numbers.below(4) << 5 | numbers.register(),
    };
    // Shifts by register with r15 read another r15: rare enough to leave out.
    let first = if second & 1 << 4 != 0 && first == 15 {
        0
    } else {
        first
    };
    let second = if second >> 25 == 0 && second & 0x90 == 0x90 {
        second & !0x80
    } else {
        second
    };
    let operands = first << 16 | numbers.register() << 12 | second;
    program.raw(numbers.condition() | code << 21 | flags << 20 | operands);
}

fn multiplication(program: &mut Program, numbers: &mut Numbers) {
    let kind = [0, 1, 4, 5, 6, 7][numbers.below(6) as usize];
    let start = numbers.below(4);
    let operands = (start + 3) << 16 | (start + 2) << 12 | (start + 1) << 8 | 0x90 | start;
    program.raw(numbers.condition() | kind << 21 | numbers.below(2) << 20 | operands);
}

fn transfer(program: &mut Program, numbers: &mut Numbers) {
    let (load, register) = (numbers.below(2), numbers.register());
    let (condition, up) = (numbers.condition(), numbers.below(2) << 23);
    let word = match numbers.below(5) {
        // Words and bytes, plain and from r10 with write-back, before or after.
        0 => 0x0508_0000 | up | (4 * numbers.below(64)),
        1 => 0x0548_0000 | up | numbers.below(256),
        2 => 0x040A_0000 | up | numbers.below(4) << 22 & 1 << 22 | (4 * numbers.below(4)),
        3 => 0x052A_0000 | up | (4 * numbers.below(4)),
        // Halfwords and signed items; a signed store does not exist.
        _ => {
            let signed = if load == 1 {
                0x90 | (1 + numbers.below(3)) << 5
            } else {
                0xB0
            };
            0x0148_0000 | up | numbers.below(16) << 8 | (2 * numbers.below(8)) | signed
        }
    };
    program.raw(condition | word | load << 20 | register << 12);
}

fn block_transfer(program: &mut Program, numbers: &mut Numbers) {
    let list = 1 + numbers.below(0x7F);
    let address = numbers.below(4) << 23 | numbers.below(2) << 21 | numbers.below(2) << 20;
    program.raw(numbers.condition() | 0x080A_0000 | address | list);
}

fn forward_branch(program: &mut Program, numbers: &mut Numbers) {
    let count = 1 + numbers.below(3);
    program.raw(numbers.condition() | 0x0A00_0000 | (count - 1));
    (0..count).for_each(|_| data_processing(program, numbers));
}

fn counted_loop(program: &mut Program, numbers: &mut Numbers) {
    program.raw(0xE3A0_7001 + numbers.below(40)); // mov r7, #count
    let again = program.here();
    for _ in 0..1 + numbers.below(4) {
        if numbers.below(3) == 0 {
            transfer(program, numbers);
        } else {
            data_processing(program, numbers);
        }
    }
    program.subs(7, 1).branch(NE, again);
}

/// Around a store of a harmless instruction into one of the next: fetched already or not.
fn store_into_code(program: &mut Program, numbers: &mut Numbers) {
    let target = program.here() as u32 + 1 + numbers.below(6);
    if 4 * target < 0xFFF {
        program.raw(numbers.condition() | 0x0589_B000 | (4 * target)); // str r11, [r9, #4 * target]
        (0..7).for_each(|_| data_processing(program, numbers));
    }
}

/// Loads and stores of registers that change nothing but time, in every width and addressing.
fn register_access(program: &mut Program, numbers: &mut Numbers) {
    let (condition, register) = (numbers.condition(), numbers.register());
    let word = match numbers.below(5) {
        0 => 0x059C_0000, // ldr rn, [r12]
        1 => 0x05DC_0000 | numbers.below(4),
        2 => 0x049C_0000, // ldr rn, [r12], #0
        3 => 0x01DC_00B0 | numbers.below(2) << 1,
        // The image register of the timer cannot be written.
        _ => 0x058C_0000,
    };
    program.raw(condition | word | register << 12);
}

/// A load of r15 from a table behind it, and a load from that table.
fn jump_by_table(program: &mut Program, numbers: &mut Numbers, base: u32) {
    program.raw(0xE200_6003 | numbers.register() << 16); // and r6, rn, #3
    program.raw(0xE79F_5106); // ldr r5, [pc, r6, lsl #2]: from the first entry on
    program.raw(numbers.condition() & 0xF000_0000 | 0x079F_F106); // ldr pc, [pc, r6, lsl #2]
    program.branch(ALWAYS, program.here() + 5);
    let targets = program.here() as u32 + 4;
    for _ in 0..4 {
        program.raw(base + 4 * (targets + numbers.below(4)));
    }
    (0..4).for_each(|_| data_processing(program, numbers));
}

/// Status registers: read, flags written, SPSR written as it is.
fn status_access(program: &mut Program, numbers: &mut Numbers) {
    let (condition, register) = (numbers.condition(), numbers.register());
    match numbers.below(4) {
        0 => program.raw(condition | 0x010F_0000 | register << 12), // mrs rn, cpsr
        1 => program.raw(condition | 0x014F_0000 | register << 12), // mrs rn, spsr
        2 => program.raw(condition | 0x0128_F000 | register),       // msr cpsr_f, rn
        _ => {
            program.raw(0xE14F_0000 | register << 12);
            program.raw(condition | 0x016F_F000 | register) // msr spsr_cxsf, rn
        }
    };
}

/// Work in another mode's registers, then back to Supervisor mode as from an exception.
fn return_from_mode(program: &mut Program, numbers: &mut Numbers) {
    let mode = [0xD2, 0xDB, 0xD7, 0x92][numbers.below(4) as usize];
    program.status(mode);
    (0..numbers.below(3)).for_each(|_| data_processing(program, numbers));
    program.load(6, 0x13 | numbers.below(2) << 7 | numbers.below(16) << 28);
    program.raw(0xE16F_F006); // msr spsr_cxsf, r6
    match numbers.below(3) {
        0 => {
            program.raw(0xE28F_6004); // add r6, pc, #4: behind the next two
            program.raw(0xE92D_0060).raw(0xE8FD_8020); // push {r5, r6}; ldm sp!, {r5, pc}^
        }
        1 => {
            program.raw(0xE28F_E000).raw(0xE1B0_F00E); // add lr, pc, #0; movs pc, lr
        }
        _ => {
            program.raw(0xE28F_E004).raw(0xE25E_F004); // add lr, pc, #4; subs pc, lr, #4
        }
    }
}

/// Call of a Thumb subroutine that lies in the way: r7 points to data in it.
fn thumb_call(program: &mut Program, numbers: &mut Numbers, base: u32) {
    let mut code: Vec<u16> = (0..8 + numbers.below(12)).map(|_| thumb(numbers)).collect();
    let leaf = code.len();
    code.extend([0xE001, 0x3401, 0x4770, 0x46F0]); // b over; adds r4, #1; bx lr; mov r8, lr
    let jump = (leaf + 1).wrapping_sub(code.len() + 2) as u32;
    code.push(0xF000 | (jump >> 11 & 0x7FF) as u16);
    code.push(0xF800 | (jump & 0x7FF) as u16);
    code.push(0x4740); // bx r8
    if code.len() % 2 == 1 {
        code.push(0x46C0);
    }
    let start = program.here() as u32 + 6;
    program.load(7, DATA + 0x40).load(14, base + 4 * start + 1);
    program.raw(0xE1A0_B00E); // mov r11, lr
    program.raw(0xE1A0_E00F); // mov lr, pc
    program.raw(0xE12F_FF1B); // bx r11
    let words = code.len() as u32 / 2;
    program.raw(0xEA00_0000 | (words - 1)); // b behind
    assert_eq!(program.here() as u32, start);
    for pair in code.chunks(2) {
        program.raw(u32::from(pair[0]) | u32::from(pair[1]) << 16);
    }
    restore_pointers(program, base);
    program.load(11, HARMLESS);
}

fn thumb(numbers: &mut Numbers) -> u16 {
    let (a, b) = (numbers.register(), numbers.register());
    let word = match numbers.below(9) {
        0 => numbers.below(3) << 11 | numbers.below(32) << 6 | a << 3 | b,
        1 => 0x1800 | numbers.below(4) << 9 | numbers.below(7) << 6 | a << 3 | b,
        2 => 0x2000 | numbers.below(4) << 11 | a << 8 | numbers.below(256),
        3 => 0x4000 | numbers.below(16) << 6 | a << 3 | b,
        4 => 0x6000 | numbers.below(2) << 11 | numbers.below(32) << 6 | 7 << 3 | b,
        5 => 0x7000 | numbers.below(2) << 11 | numbers.below(32) << 6 | 7 << 3 | b,
        6 => 0x8000 | numbers.below(2) << 11 | numbers.below(32) << 6 | 7 << 3 | b,
        7 => 0xD000 | numbers.below(14) << 8,
        _ => [0xA000 | a << 8 | numbers.word() & 0xFF, 0x4440 | a][numbers.below(2) as usize],
    };
    word as u16
}
