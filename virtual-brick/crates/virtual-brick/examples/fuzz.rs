// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Gives the facade what no honest user gives it, for a time: damaged images and configurations,
//! random programs, random writes of registers, random inputs. Nothing may panic, and memory stays
//! bounded. Every case is a function of its seed, which is printed when it fails.
//!
//! Usage: `cargo run --release -p virtual-brick --example fuzz -- [SECONDS [SEED [CORPUS
//! [TARGET]]]]`. The seconds are of a processor and are divided among the targets. Files in
//! `CORPUS/image` and `CORPUS/configuration` are given as they are, then damaged. Prints cases and
//! failures of each target as JSON; the exit code is 1 if a case failed.

#[path = "../tests/support/mod.rs"]
mod support;

use std::panic::catch_unwind;
use std::path::Path;
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
/// Random programs among the images.
const RANDOM_IMAGES: u64 = 64;
/// Cases of which the first looks at the time.
const CASES_TIMED: u64 = 32;
/// As `/proc` counts them on every Linux.
const TICKS_PER_S: u64 = 100;

type Target = fn(&Corpus, &mut Numbers);

const TARGETS: [(&str, Target); 5] = [
    ("damaged image", damaged_image),
    ("damaged configuration", damaged_configuration),
    ("random program", random_program),
    ("random register writes", register_writes),
    ("random inputs", random_inputs),
];

/// What is right, to be damaged.
struct Corpus {
    images: Vec<Vec<u8>>,
    configurations: Vec<Vec<u8>>,
}

impl Corpus {
    fn read(folder: Option<&str>) -> Self {
        let files = |kind: &str| {
            let folder = folder.map(|folder| Path::new(folder).join(kind));
            let listed = folder.and_then(|folder| std::fs::read_dir(folder).ok());
            let mut paths: Vec<_> = listed
                .into_iter()
                .flatten()
                .filter_map(|entry| Some(entry.ok()?.path()))
                .collect();
            paths.sort();
            let contents = paths.iter().filter_map(|path| std::fs::read(path).ok());
            contents.collect::<Vec<_>>()
        };
        let mut images = files("image");
        images.extend((0..RANDOM_IMAGES).map(|seed| {
            let kind = [Kind::Ram, Kind::Flash, Kind::SlowFlash][seed as usize % 3];
            random::image(seed, kind)
        }));
        let mut configurations = files("configuration");
        configurations.push(VEHICLE.as_bytes().to_vec());
        Self {
            images,
            configurations,
        }
    }

    /// How many entries a target starts from.
    fn size(&self, target: &str) -> usize {
        match target {
            "damaged image" | "random inputs" => self.images.len(),
            "damaged configuration" => self.configurations.len(),
            _ => 0,
        }
    }

    /// Everything undamaged: whether it passes.
    fn passes(&self) -> bool {
        let unharmed = catch_unwind(|| {
            self.images.iter().for_each(|elf| try_image(elf));
            let texts = self.configurations.iter();
            texts.for_each(|json| try_configuration(json));
        });
        unharmed.is_ok()
    }
}

#[derive(Clone, Copy, Default)]
struct Counts {
    cases: u64,
    passed: u64,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, otherwise: u64| match arguments.get(index) {
        Some(text) => text.parse::<u64>().ok(),
        None => Some(otherwise),
    };
    let (Some(seconds), Some(first)) = (number(0, 60), number(1, 1)) else {
        eprintln!("expected a number of seconds and a first seed");
        return ExitCode::from(2);
    };
    let chosen = arguments.get(3);
    let among = |(name, _): &(&str, Target)| chosen.is_none_or(|chosen| chosen == name);
    let targets: Vec<_> = TARGETS.into_iter().filter(among).collect();
    if targets.is_empty() {
        eprintln!("expected one of {:?}", TARGETS.map(|(name, _)| name));
        return ExitCode::from(2);
    }
    let corpus = Corpus::read(arguments.get(2).map(String::as_str));
    if !corpus.passes() {
        eprintln!("the corpus itself: panic");
        return ExitCode::FAILURE;
    }
    let share = Duration::from_secs(seconds) / targets.len() as u32;
    let run = |&(name, target): &(&str, Target)| run_target(name, target, &corpus, share, first);
    let counts: Vec<Counts> = targets.iter().map(run).collect();
    let rows: Vec<String> = targets
        .iter()
        .zip(&counts)
        .map(|((name, _), Counts { cases, passed })| {
            let corpus = corpus.size(name);
            format!(
                r#"{{"target":"{name}","corpus":{corpus},"case_count":{cases},"passed":{passed}}}"#
            )
        })
        .collect();
    println!("[{}]", rows.join(","));
    ExitCode::from(u8::from(counts.iter().any(|c| c.cases != c.passed)))
}

/// Cases of one target from seed `first` on, for a time of the processor.
fn run_target(name: &str, target: Target, corpus: &Corpus, time: Duration, first: u64) -> Counts {
    let mut counts = Counts::default();
    let begin = Instant::now();
    let end = used(begin) + time;
    for seed in first.. {
        if counts.cases % CASES_TIMED == 0 && used(begin) >= end {
            break;
        }
        let passed = case(name, seed, || target(corpus, &mut Numbers::new(seed)));
        counts.cases += 1;
        counts.passed += u64::from(passed);
    }
    counts
}

/// Processor time of the process where the system tells it, else the time since `begin`.
fn used(begin: Instant) -> Duration {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name before may hold anything; user and system time are fields 14 and 15.
    let fields = text.rsplit_once(") ").map_or("", |(_, after)| after);
    let mut times = fields
        .split(' ')
        .skip(11)
        .map_while(|ticks| ticks.parse::<u64>().ok());
    match (times.next(), times.next()) {
        (Some(user), Some(system)) => Duration::from_millis((user + system) * 1000 / TICKS_PER_S),
        _ => begin.elapsed(),
    }
}

fn case(name: &str, seed: u64, run: impl FnOnce() + std::panic::UnwindSafe) -> bool {
    let unharmed = catch_unwind(run).is_ok();
    let bounded = resident_bytes() < RESIDENT_BYTES_MAX;
    if !unharmed || !bounded {
        let what = if unharmed { "memory" } else { "panic" };
        eprintln!("{name}, seed {seed}: {what}");
    }
    unharmed && bounded
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

fn chosen<'a>(numbers: &mut Numbers, among: &'a [Vec<u8>]) -> &'a [u8] {
    &among[numbers.below(among.len() as u32) as usize]
}

fn try_image(elf: &[u8]) {
    if let Ok(image) = Image::parse(elf) {
        let _ = image.variable("start.part");
        let _ = image.symbols().nearest_code(RAM);
        run(elf);
    }
}

fn damaged_image(corpus: &Corpus, numbers: &mut Numbers) {
    let mut elf = chosen(numbers, &corpus.images).to_vec();
    // The headers and the symbols behind the contents matter most.
    let middle = elf.split_off(elf.len().min(100));
    damage(numbers, &mut elf);
    elf.extend(middle);
    if numbers.below(2) == 0 {
        damage(numbers, &mut elf);
    }
    try_image(&elf);
}

fn try_configuration(json: &[u8]) {
    let text = String::from_utf8_lossy(json);
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

fn damaged_configuration(corpus: &Corpus, numbers: &mut Numbers) {
    let mut json = chosen(numbers, &corpus.configurations).to_vec();
    damage(numbers, &mut json);
    try_configuration(&json);
}

fn random_program(_: &Corpus, numbers: &mut Numbers) {
    let words: Vec<u32> = (0..16 + numbers.below(240))
        .map(|_| numbers.below(u32::MAX))
        .collect();
    let thumb = numbers.below(2);
    run(&ElfBuilder::new(RAM | thumb).words(RAM, &words).build());
}

fn register_writes(_: &Corpus, numbers: &mut Numbers) {
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

fn random_inputs(corpus: &Corpus, numbers: &mut Numbers) {
    let elf = chosen(numbers, &corpus.images);
    let Ok(mut brick) = VirtualBrick::new(&vehicle(), elf) else {
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
