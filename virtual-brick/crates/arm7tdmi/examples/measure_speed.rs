// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures how fast the core interprets two programs, one per state, over a memory that answers
//! in one cycle. Prints one line of JSON per program with the median of the runs.
//!
//! Usage: `cargo run --release -p arm7tdmi --example measure_speed`.

#[path = "../tests/support/memory.rs"]
mod memory;

use arm7tdmi::{psr, Cpu};
use memory::Memory;
use std::time::Instant;

const INSTRUCTIONS: u64 = 20_000_000;
const RUNS: usize = 7;
/// Where both programs keep the table they update.
const TABLE: u32 = 0x8000;

/// Shift register, table update, bit loop and a subroutine that multiplies.
const ARM_PROGRAM: [u32; 25] = [
    0xE3A0_D903, // mov sp, #0xC000
    0xE3A0_4902, // mov r4, #0x8000
    0xE3A0_0001, // mov r0, #1
    0xE3A0_74ED, // mov r7, #0xED000000
    0xE020_0680, // outer: eor r0, r0, r0, lsl #13
    0xE020_08A0, // eor r0, r0, r0, lsr #17
    0xE020_0280, // eor r0, r0, r0, lsl #5
    0xE200_10FC, // and r1, r0, #0xFC
    0xE794_2001, // ldr r2, [r4, r1]
    0xE082_2000, // add r2, r2, r0
    0xE784_2001, // str r2, [r4, r1]
    0xE3A0_6008, // mov r6, #8
    0xE1B0_20A2, // bits: movs r2, r2, lsr #1
    0x2022_2007, // eorcs r2, r2, r7
    0xE256_6001, // subs r6, r6, #1
    0x1AFF_FFFB, // bne bits
    0xEB00_0001, // bl mix
    0xE285_5001, // add r5, r5, #1
    0xEAFF_FFF0, // b outer
    0xE92D_4010, // mix: stmdb sp!, {r4, lr}
    0xE003_0092, // mul r3, r2, r0
    0xE093_3005, // adds r3, r3, r5
    0xE2A8_8000, // adc r8, r8, #0
    0xE8BD_4010, // ldmia sp!, {r4, lr}
    0xE12F_FF1E, // bx lr
];

/// The same work in Thumb state.
const THUMB_PROGRAM: [u16; 32] = [
    0x2480, // movs r4, #0x80
    0x0224, // lsls r4, r4, #8
    0x46A5, // mov sp, r4
    0x2001, // movs r0, #1
    0x27ED, // movs r7, #0xED
    0x0341, // outer: lsls r1, r0, #13
    0x4048, // eors r0, r1
    0x0C41, // lsrs r1, r0, #17
    0x4048, // eors r0, r1
    0x0141, // lsls r1, r0, #5
    0x4048, // eors r0, r1
    0x21FC, // movs r1, #0xFC
    0x4001, // ands r1, r0
    0x5862, // ldr r2, [r4, r1]
    0x1812, // adds r2, r2, r0
    0x5062, // str r2, [r4, r1]
    0x2608, // movs r6, #8
    0x0852, // bits: lsrs r2, r2, #1
    0xD300, // bcc even
    0x407A, // eors r2, r7
    0x3E01, // even: subs r6, #1
    0xD1FA, // bne bits
    0xF000, // bl mix
    0xF802, // (second half)
    0x3501, // adds r5, #1
    0xE7EA, // b outer
    0xB510, // mix: push {r4, lr}
    0x0013, // movs r3, r2
    0x4343, // muls r3, r0
    0x195B, // adds r3, r3, r5
    0x78E4, // ldrb r4, [r4, #3]
    0xBD10, // pop {r4, pc}
];

fn main() {
    let arm = || (Cpu::new(), Memory::with_arm(0, &ARM_PROGRAM));
    let thumb = || {
        let mut cpu = Cpu::new();
        cpu.set_cpsr(cpu.cpsr() | psr::T);
        (cpu, Memory::with_thumb(0, &THUMB_PROGRAM))
    };
    report("arm", arm);
    report("thumb", thumb);
}

fn report(program: &str, start: impl Fn() -> (Cpu, Memory)) {
    let mut rates: Vec<f64> = Vec::with_capacity(RUNS);
    let (mut cycles, mut result) = (0, 0);
    for _ in 0..RUNS {
        let (mut cpu, mut memory) = start();
        let begin = Instant::now();
        for _ in 0..INSTRUCTIONS {
            let _ = cpu.step(&mut memory);
        }
        rates.push(INSTRUCTIONS as f64 / begin.elapsed().as_secs_f64() / 1e6);
        cycles = memory.cycles;
        result = memory.word(TABLE);
    }
    rates.sort_by(f64::total_cmp);
    let run = format!(r#""instructions":{INSTRUCTIONS},"cycles":{cycles},"result":{result}"#);
    let [least, median, most] = [0, RUNS / 2, RUNS - 1].map(|index| rates[index].round());
    let rate = format!(r#""median":{median},"min":{least},"max":{most}"#);
    println!(r#"{{"program":"{program}",{run},"guest_mips":{{{rate}}}}}"#);
}
