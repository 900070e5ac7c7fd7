// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Gives the facade what no honest user gives it, for a time: damaged images and configurations,
//! random programs, random writes of registers, random inputs. Nothing may panic, and memory stays
//! bounded. Every case is a function of its seed, which is printed when it fails.
//!
//! Usage: `cargo run --release -p virtual-brick --example fuzz -- [SECONDS [SEED]]`. Prints a
//! conformance summary as JSON; the exit code is 1 if a case failed.

#[path = "../tests/support/mod.rs"]
mod support;

use std::panic::catch_unwind;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use support::arm::Program;
use support::elf::ElfBuilder;
use support::random::{self, Kind, Numbers};
use support::{image, vehicle, RAM, VEHICLE};
use virtual_brick::{Configuration, Image, VirtualBrick};

/// A case runs its program this long.
const CYCLES: u64 = 60_000;
/// The process keeps below this.
const RESIDENT_BYTES_MAX: u64 = 1 << 30;
const PAGE_BYTES: u64 = 4096;

const TARGETS: [(&str, fn(&mut Numbers)); 5] = [
    ("damaged image", damaged_image),
    ("damaged configuration", damaged_configuration),
    ("random program", random_program),
    ("random register writes", register_writes),
    ("random inputs", random_inputs),
];

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Some(Ok(seconds)), Some(Ok(first))) = (
        arguments.next().or(Some(Ok(60))),
        arguments.next().or(Some(Ok(1))),
    ) else {
        eprintln!("expected a number of seconds and a first seed");
        return ExitCode::from(2);
    };
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut cases, mut passed) = (0, 0);
    for seed in first.. {
        if Instant::now() >= end {
            break;
        }
        for (number, (name, target)) in TARGETS.into_iter().enumerate() {
            cases += 1;
            let own = seed * TARGETS.len() as u64 + number as u64;
            let calm = catch_unwind(|| target(&mut Numbers::new(own))).is_ok();
            let bounded = resident_bytes() < RESIDENT_BYTES_MAX;
            if calm && bounded {
                passed += 1;
            } else {
                let what = if calm { "memory" } else { "panic" };
                eprintln!("{name}, seed {seed}: {what}");
            }
        }
    }
    let counts = format!(r#""case_count":{cases},"passed":{passed}"#);
    println!(r#"{{"area":"peripherals","suite":"fuzz","seconds":{seconds},{counts}}}"#);
    ExitCode::from(u8::from(cases != passed))
}

/// Resident memory of the process where the system tells it, else 0.
fn resident_bytes() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split(' ').nth(1).and_then(|pages| pages.parse().ok());
    pages.unwrap_or(0) * PAGE_BYTES
}

fn run(elf: &[u8]) {
    if let Ok(mut brick) = VirtualBrick::new(&vehicle(), elf) {
        let stop = brick.run_until(CYCLES);
        assert!(stop.at_cycles <= brick.cycles());
        assert!(!brick.trace().digest().to_string().is_empty());
    }
}

/// Some bytes replaced, removed, repeated, or the rest cut off.
fn damage(numbers: &mut Numbers, content: &mut Vec<u8>) {
    for _ in 0..1 + numbers.below(8) {
        if content.is_empty() {
            return;
        }
        let at = numbers.below(content.len() as u32) as usize;
        match numbers.below(8) {
            0 => content.truncate(at),
            1 => {
                content.remove(at);
            }
            2 => content.insert(at, numbers.below(256) as u8),
            3 => content[at] ^= 1 << numbers.below(8),
            4 => content[at] = [0, 0x7F, 0x80, 0xFF][numbers.below(4) as usize],
            _ => content[at] = numbers.below(256) as u8,
        }
    }
}

fn damaged_image(numbers: &mut Numbers) {
    let seed = u64::from(numbers.below(64));
    let mut elf = random::image(seed, Kind::Ram);
    // The headers and the symbols behind the contents matter most.
    let middle = elf.split_off(elf.len().min(100));
    damage(numbers, &mut elf);
    elf.extend(middle);
    if numbers.below(2) == 0 {
        damage(numbers, &mut elf);
    }
    if let Ok(image) = Image::parse(&elf) {
        let _ = image.variable("start.part");
        let _ = image.symbols().nearest_code(RAM);
        run(&elf);
    }
}

fn damaged_configuration(numbers: &mut Numbers) {
    let mut json = VEHICLE.as_bytes().to_vec();
    damage(numbers, &mut json);
    let text = String::from_utf8_lossy(&json);
    match Configuration::from_json(&text) {
        Ok(configuration) => {
            let elf = random::image(1, Kind::Ram);
            if let Ok(mut brick) = VirtualBrick::new(&configuration, &elf) {
                brick.run_until(CYCLES);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn random_program(numbers: &mut Numbers) {
    let words: Vec<u32> = (0..16 + numbers.below(240))
        .map(|_| numbers.below(u32::MAX))
        .collect();
    let thumb = numbers.below(2);
    run(&ElfBuilder::new(RAM | thumb).words(RAM, &words).build());
}

fn register_writes(numbers: &mut Numbers) {
    let mut program = Program::new();
    for _ in 0..1 + numbers.below(60) {
        let address = 0xFFFA_0000 | numbers.below(0x6_0000) & !3;
        let (address, narrow) = match numbers.below(4) {
            0 => (address, true),
            1 => (address | 0xFFFF_0000, true),
            _ => (address | 0xFFFF_F000, false),
        };
        let value = if narrow {
            1 << numbers.below(32)
        } else {
            numbers.below(u32::MAX)
        };
        program.poke(address, value);
    }
    program.delay(2_000).stop();
    run(&image(&program).build());
}

fn random_inputs(numbers: &mut Numbers) {
    let elf = random::image(u64::from(numbers.below(64)), Kind::Ram);
    let Ok(mut brick) = VirtualBrick::new(&vehicle(), &elf) else {
        return;
    };
    let names = [
        "touch.1",
        "motor.A.hand_angle",
        "battery.voltage",
        "button.enter",
        "",
        "motor.",
    ];
    for _ in 0..numbers.below(20) {
        let name = names[numbers.below(names.len() as u32) as usize];
        let value = match numbers.below(5) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e300,
            _ => f64::from(numbers.below(3)),
        };
        let at_cycles = u64::from(numbers.below(CYCLES as u32));
        let _ = brick.schedule_input(at_cycles, name, value);
    }
    brick.run_until(CYCLES);
}
