// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Searches inputs with which a function takes long: hill climbing with restarts at random, on the
//! core, each access in one cycle.
//!
//! Usage: `cargo run --release -p wcet --example search -- ELF BEFORE SYMBOL CYCLES
//! INPUT...`, where CYCLES is how long all runs together may take and INPUT is
//! `NAME:OFFSET:COUNT:KIND:LOW:HIGH` with KIND `i8`, `i16`, `i32`, `u8`, `u16`, `u32`, `f32` or
//! `f64`. Prints the cycles with the given data, the most cycles, the runs and the restarts.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[path = "../tests/support/machine.rs"]
#[allow(dead_code)]
mod machine;
#[path = "../tests/support/random.rs"]
#[allow(dead_code)]
mod random;

use machine::Machine;
use random::Random;

/// Changes without a longer time after which the search begins anew.
const PATIENCE: u32 = 250;

/// Runs with data that are alike, before others.
const UNIFORM: u32 = 9;

/// Elements of which some are changed in a row more often than one alone.
const MANY: usize = 64;

/// Runs that are made whatever they take.
const LEAST_RUNS: u32 = 20;

/// Runs after which it is enough, whatever they took.
const MOST_RUNS: u32 = 20_000;

/// A run may take this many times as long as with the given data.
const LONGEST_RUN: u64 = 1000;

/// Elements of one kind in a row.
struct Input {
    address: u32,
    count: usize,
    kind: Kind,
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Integer { bytes: usize },
    Single,
    Double,
}

impl Kind {
    fn parse(word: &str) -> Self {
        match word {
            "f32" => Self::Single,
            "f64" => Self::Double,
            _ => {
                let bits: usize = word[1..].parse().expect("a kind such as i32");
                Self::Integer { bytes: bits / 8 }
            }
        }
    }

    const fn size(self) -> usize {
        match self {
            Self::Integer { bytes } => bytes,
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    /// Least positive value, least normal value and distance of 1 to the next value.
    const fn corners(self) -> Option<[f64; 3]> {
        match self {
            Self::Integer { .. } => None,
            Self::Single => Some([1.4e-45, f32::MIN_POSITIVE as f64, f32::EPSILON as f64]),
            Self::Double => Some([5e-324, f64::MIN_POSITIVE, f64::EPSILON]),
        }
    }

    fn decoded(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::Single, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Self::Double, &[a, b, c, d, e, f, g, h]) => {
                f64::from_le_bytes([a, b, c, d, e, f, g, h])
            }
            _ => 0.0,
        }
    }

    fn encoded(self, value: f64) -> Vec<u8> {
        match self {
            Self::Integer { bytes } => (value as i64).to_le_bytes()[..bytes].to_vec(),
            Self::Single => (value as f32).to_le_bytes().to_vec(),
            Self::Double => value.to_le_bytes().to_vec(),
        }
    }
}

impl Input {
    fn parse(word: &str, machine: &Machine) -> Self {
        let parts: Vec<&str> = word.split(':').collect();
        let [name, offset, count, kind, low, high] = parts[..] else {
            panic!("{word}: expected NAME:OFFSET:COUNT:KIND:LOW:HIGH");
        };
        let offset: u32 = offset.parse().expect("an offset in bytes");
        Self {
            address: machine.address(name) + offset,
            count: count.parse().expect("a count"),
            kind: Kind::parse(kind),
            low: low.parse().expect("the least value"),
            high: high.parse().expect("the greatest value"),
        }
    }

    /// Any value, corners more often than others.
    fn value(&self, random: &mut Random) -> f64 {
        if let Some(corners) = self.kind.corners().filter(|_| random.word() % 2 == 0) {
            return self.corner(corners, random).clamp(self.low, self.high);
        }
        let width = self.high - self.low;
        let share = f64::from(random.word()) / f64::from(u32::MAX);
        let small = f64::from(random.word() % 17) - 8.0;
        let power = 0.5_f64.powi((random.word() % 32) as i32);
        let value = match random.word() % 8 {
            0 => self.low,
            1 => self.high,
            2 => small,
            3 => self.low + width * share * power,
            4 => self.high - width * share * power,
            _ => self.low + width * share,
        };
        let value = if matches!(self.kind, Kind::Integer { .. }) {
            value.round()
        } else {
            value
        };
        value.clamp(self.low, self.high)
    }

    /// Values at which floating-point operations take other ways: denormal ones with few digits,
    /// the least normal ones, powers of two and their neighbours, any exponent.
    fn corner(&self, [least, normal, step]: [f64; 3], random: &mut Random) -> f64 {
        let power = 2_f64.powi((random.word() % 64) as i32 - 32);
        let share = f64::from(random.word()) / f64::from(u32::MAX);
        let most = self.high.abs().max(self.low.abs());
        let value = match random.word() % 10 {
            0..=2 => least * f64::from(1 + random.word() % 4),
            3 => normal * share,
            4 => normal - least,
            5 => normal * f64::from(1 + random.word() % 4),
            6 => power * (1.0 + step),
            7 => power * (1.0 - step / 2.0),
            8 => 0.0,
            _ => most * (least / most).powf(share),
        };
        if random.word() % 2 == 0 {
            value
        } else {
            -value
        }
    }

    /// An element that cancels another one, or nearly.
    fn near(&self, bytes: &[u8], random: &mut Random) -> Vec<u8> {
        let Some([least, _, step]) = self.kind.corners() else {
            return bytes.to_vec();
        };
        let value = self.kind.decoded(bytes);
        let off = f64::from(random.word() % 5) - 2.0;
        let near = value + off * (value.abs() * step).max(least);
        let sign = if random.word() % 2 == 0 { 1.0 } else { -1.0 };
        self.kind.encoded((sign * near).clamp(self.low, self.high))
    }

    /// Fills elements with one value, or every other of them with two in turn.
    fn fill(&self, elements: &mut [Vec<u8>], random: &mut Random) {
        let pair = [0; 2].map(|_| self.kind.encoded(self.value(random)));
        let alike = random.word() % 2 == 0;
        let step = if alike { 1 } else { 2 };
        for (index, element) in elements.iter_mut().step_by(step).enumerate() {
            element.clone_from(&pair[if alike { 0 } else { index % 2 }]);
        }
    }
}

/// Bytes of all elements of an input.
type Data = Vec<Vec<Vec<u8>>>;

fn anything(inputs: &[Input], random: &mut Random) -> Data {
    let each = inputs.iter().map(|input| {
        let mut values: Vec<f64> = (0..input.count).map(|_| input.value(random)).collect();
        match random.word() % 6 {
            0 => values.sort_by(f64::total_cmp),
            1 => values.sort_by(|a, b| b.total_cmp(a)),
            2 | 3 => {
                let period = 1 + random.word() as usize % 4;
                for index in period..values.len() {
                    values[index] = values[index - period];
                }
            }
            _ => {}
        }
        let encoded = values.iter().map(|value| input.kind.encoded(*value));
        encoded.collect()
    });
    each.collect()
}

/// Data in which all elements of an input, or every other one, are alike: the least, the greatest,
/// none, and what floating-point operations take long for.
fn uniform(inputs: &[Input], number: usize) -> Data {
    let each = inputs.iter().map(|input| {
        let [least, normal, step] = input.kind.corners().unwrap_or([1.0, 2.0, 0.5]);
        let (one, other) = match number {
            0 => (input.low, input.low),
            1 => (input.high, input.high),
            2 => (input.low, input.high),
            3 => (0.0, input.high),
            4 => (least, least),
            5 => (least, -least),
            6 => (least, input.high),
            7 => (1.0, -1.0 - step),
            _ => (normal - least, least),
        };
        let pair = [one, other].map(|v| input.kind.encoded(v.clamp(input.low, input.high)));
        (0..input.count)
            .map(|index| pair[index % 2].clone())
            .collect()
    });
    each.collect()
}

/// The same with some elements changed, copied, exchanged or filled with one value.
fn changed(data: &Data, inputs: &[Input], random: &mut Random) -> Data {
    let mut data = data.clone();
    let largest = inputs.iter().map(|input| input.count).max().unwrap_or(1);
    let most = 1 << (random.word() % (4 + largest.ilog2() / 2));
    for _ in 0..=random.word() % most {
        let which = random.word() as usize % inputs.len();
        let (input, elements) = (&inputs[which], &mut data[which]);
        let one = random.word() as usize % input.count;
        let other = random.word() as usize % input.count;
        // Of many elements, one alone changes little.
        let choices = if input.count < MANY { 8 } else { 10 };
        match random.word() % choices {
            0 => elements.swap(one, other),
            1 => elements[one] = elements[other].clone(),
            2 => elements[one.min(other)..=one.max(other)].reverse(),
            6 => elements[one] = input.near(&elements[other], random),
            7.. => input.fill(&mut elements[one.min(other)..=one.max(other)], random),
            _ => elements[one] = input.kind.encoded(input.value(random)),
        }
    }
    data
}

struct Search {
    machine: Machine,
    memory: Vec<u8>,
    symbol: String,
    inputs: Vec<Input>,
    longest_run: u64,
}

impl Search {
    fn cycles(&mut self, data: &Data) -> u64 {
        self.machine.restore(&self.memory);
        for (input, elements) in self.inputs.iter().zip(data) {
            for (address, bytes) in (input.address..).step_by(input.kind.size()).zip(elements) {
                self.machine.set_bytes(address, bytes);
            }
        }
        let limit = self.longest_run;
        self.machine.call_within(&self.symbol, [0; 4], limit).cycles
    }

    fn given(&self) -> Data {
        let each = self.inputs.iter().map(|input| {
            let size = input.kind.size();
            let places = (input.address..).step_by(size).take(input.count);
            places
                .map(|place| self.machine.bytes(place, size))
                .collect()
        });
        each.collect()
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [path, before, symbol, budget, inputs @ ..] = &words[..] else {
        panic!("expected ELF BEFORE SYMBOL CYCLES INPUT...");
    };
    let elf = std::fs::read(path).expect("a readable file");
    let mut machine = Machine::new(&elf);
    machine.call(before, [0; 4]);
    let inputs: Vec<Input> = inputs.iter().map(|w| Input::parse(w, &machine)).collect();
    let budget: u64 = budget.parse().expect("a number of cycles");
    let mut search = Search {
        memory: machine.memory(),
        machine,
        symbol: symbol.clone(),
        inputs,
        longest_run: u64::MAX,
    };
    let mut random = Random::new(1);
    let mut best = search.given();
    let given = search.cycles(&best);
    search.longest_run = given * LONGEST_RUN;
    let (mut top, mut here, mut most) = (best.clone(), given, given);
    let (mut spent, mut runs, mut restarts, mut rejected) = (given, 1, 0, 0);
    while runs < LEAST_RUNS || spent < budget && runs < MOST_RUNS {
        let anew = rejected == PATIENCE;
        if anew && restarts % 2 == 1 {
            (best, here, rejected) = (top.clone(), most, 0);
            restarts += 1;
            continue;
        }
        let next = if runs <= UNIFORM {
            uniform(&search.inputs, runs as usize - 1)
        } else if anew {
            anything(&search.inputs, &mut random)
        } else {
            changed(&best, &search.inputs, &mut random)
        };
        let cycles = search.cycles(&next);
        (spent, runs) = (spent + cycles, runs + 1);
        if anew || cycles >= here {
            rejected = if anew || cycles > here {
                0
            } else {
                rejected + 1
            };
            restarts += u32::from(anew);
            (best, here) = (next, cycles);
            if cycles > most {
                (top, most) = (best.clone(), cycles);
            }
        } else {
            rejected += 1;
        }
    }
    println!("{given} {most} {runs} {restarts}");
}
