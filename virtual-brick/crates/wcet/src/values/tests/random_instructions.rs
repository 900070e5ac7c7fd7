// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random instructions on abstract values and on the core: what is known afterwards holds for what
//! the core then has in its registers, flags and memory. Left out is what the architecture leaves
//! unpredictable (DDI 0100, part A): accesses that are not aligned, a base register that is loaded
//! and written back, r15 where it may not stand.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[path = "../../../tests/support/random.rs"]
#[allow(dead_code)] // this test uses its part
mod random;

#[path = "opcodes.rs"]
mod opcodes;

use crate::inputs::image::Image;
use crate::inputs::kernel::KernelConventions;
use crate::inputs::memory_map::MemoryMap;
use crate::values::comparison::Comparison;
use crate::values::flags::difference_flags;
use crate::values::instruction::{execute, Environment};
use crate::values::memory_contents::Contents;
use crate::values::relations::Location;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::shift_by_constant;
use arm7tdmi::{condition_passes, psr, Abort, Bus, Cpu, Cycle, Instruction, Width};
use opcodes::{arm, reach, thumb};
use random::Random;
use std::collections::BTreeMap;

const CODE: u32 = 0x1000;
const DATA: u32 = 0x8000;
/// Words that base registers point to; as many more are the stack.
const WORDS: usize = 8;
const BYTES: u32 = 4 * WORDS as u32;
const STACK: u32 = DATA + BYTES + BYTES / 2;
/// Registers with addresses in the data.
const BASES: [u32; 2] = [6, 7];
/// Register with an address in the stack, where the stack is known.
const LOCAL: u32 = 5;
const SEQUENCES: u32 = 2_000;
const LENGTH: u32 = 16;

/// Words, one instruction, and whether something else was asked for.
#[derive(Clone)]
struct Memory {
    at: u32,
    opcode: u32,
    words: [u32; 2 * WORDS],
    reach: (u32, u32),
    missed: bool,
}

impl Memory {
    fn word(&mut self, address: u32, width: Width) -> &mut u32 {
        let size = match width {
            Width::Byte => 1,
            Width::Halfword => 2,
            Width::Word => 4,
        };
        let inside = (self.reach.0..self.reach.1).contains(&address);
        self.missed |= !inside || address % size != 0;
        &mut self.words[(address.wrapping_sub(DATA) / 4) as usize % (2 * WORDS)]
    }
}

impl Bus for Memory {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        Ok(if address == self.at { self.opcode } else { 0 })
    }

    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        Ok(if address == self.at {
            self.opcode as u16
        } else {
            0
        })
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        let word = *self.word(address, width) >> (8 * (address & 3));
        Ok(match width {
            Width::Byte => word & 0xFF,
            Width::Halfword => word & 0xFFFF,
            Width::Word => word,
        })
    }

    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        let mask = match width {
            Width::Byte => 0xFF,
            Width::Halfword => 0xFFFF,
            Width::Word => u32::MAX,
        };
        let shift = 8 * (address & 3);
        let word = self.word(address, width);
        *word = *word & !(mask << shift) | (value & mask) << shift;
        Ok(())
    }

    fn internal(&mut self, _: u32) {}

    fn irq(&self) -> bool {
        false
    }

    fn fiq(&self) -> bool {
        false
    }
}

/// The core with its memory, and what is known about both.
struct Pair {
    cpu: Cpu,
    memory: Memory,
    state: State,
}

/// Does a value allow an element, with the same meaning of unknown bases in the whole state?
fn allows(value: &Value, element: u32, bases: &mut BTreeMap<u32, u32>) -> bool {
    match value {
        Value::Constant(constant) => *constant == element,
        Value::Set(elements) => elements.contains(&element),
        Value::Range(low, high) => (*low..=*high).contains(&element),
        Value::Signed(low, high) => (*low..=*high).contains(&(element as i32)),
        Value::Bits(mask, most) => element & !mask == 0 && element.count_ones() <= *most,
        Value::Stack(offset) => STACK.wrapping_add(*offset as u32) == element,
        Value::StackBetween(low, high) => {
            (*low..=*high).contains(&(element.wrapping_sub(STACK) as i32))
        }
        Value::MinusStack(offset) => (*offset as u32).wrapping_sub(STACK) == element,
        Value::Based(base, offset) => {
            let held = element.wrapping_sub(*offset as u32);
            *bases.entry(*base).or_insert(held) == held
        }
        Value::Region(_) | Value::StackAny | Value::OuterStack | Value::Top => true,
    }
}

/// A value that allows an element.
fn around(element: u32, random: &mut Random) -> Value {
    match random.word() % 8 {
        6 => {
            let (signed, wide) = (element as i32, i128::from(random.integer() & 0x7FFF_FFFF));
            let few = i128::from(random.word() % 3);
            let (low, high) = (i128::from(signed) - wide, i128::from(signed) + few);
            Value::of_interval(low.max(i32::MIN.into()), high.min(i32::MAX.into()))
        }
        7 => Value::bits(element | random.integer(), 1 + element.count_ones()),
        0 => Value::Constant(element),
        1 | 2 => {
            let others = (0..1 + random.word() % 5).map(|_| random.integer());
            Value::of_elements(others.chain([element]).collect()).unwrap()
        }
        3 => {
            let wide = random.integer() & 0x7FFF_FFFF;
            Value::range(element.saturating_sub(wide), element.saturating_add(wide))
        }
        4 => {
            let few = random.word() % 9;
            Value::range(element.saturating_sub(few), element.saturating_add(few))
        }
        _ => Value::Top,
    }
}

fn pointer_around(element: u32, random: &mut Random) -> Value {
    match random.word() % 4 {
        0 | 1 => Value::Constant(element),
        2 => {
            let others = (0..random.word() % 3).map(|_| DATA + 4 * (random.word() % WORDS as u32));
            Value::of_elements(others.chain([element]).collect()).unwrap()
        }
        _ => Value::range(DATA, DATA + BYTES - 1),
    }
}

impl Pair {
    /// One with known memory knows no stack, another one its stack only.
    fn new(random: &mut Random, thumb: bool, memory_known: bool) -> Self {
        let mut cpu = Cpu::new();
        let flags = random.word() & 0xF000_0000;
        cpu.set_cpsr(cpu.cpsr() & 0x0FFF_FFFF | flags | if thumb { psr::T } else { 0 });
        let mut state = State::entry(&std::array::from_fn(|_| Value::Top));
        state.flags = random.word() as u16 | 1 << (flags >> 28);
        for number in 0..13 {
            let element = random.integer();
            cpu.set_register(number, element);
            let value = around(element, random);
            if value != Value::Top {
                state.set(number, value);
            }
        }
        for number in BASES {
            let element = DATA + 4 * (random.word() % WORDS as u32);
            cpu.set_register(number, element);
            state.set(number, pointer_around(element, random));
        }
        cpu.set_register(13, STACK);
        let words: [u32; 2 * WORDS] = std::array::from_fn(|_| random.integer());
        if memory_known {
            state.set(13, Value::Constant(STACK));
            let mut contents = Contents::default();
            for (address, word) in (DATA..).step_by(4).zip(words) {
                contents.store(&Value::Constant(address), 4, &around(word, random));
            }
            state.memory = Some(contents);
        } else {
            let offset = 4 * (random.word() % WORDS as u32) as i32 - BYTES as i32 / 2;
            let (less, more) = ((random.word() % 9) as i32, (random.word() % 9) as i32);
            cpu.set_register(LOCAL, STACK.wrapping_add(offset as u32));
            state.set(LOCAL, Value::stack_between(offset - less, offset + more));
            let stack = (-(BYTES as i32) / 2..).step_by(4).zip(&words[WORDS..]);
            for (offset, word) in stack {
                let value = around(*word, random);
                if value != Value::Top {
                    state.stack_words.insert(offset, value);
                }
            }
        }
        state.control = (!thumb).then_some(cpu.cpsr() & 0xDF);
        let memory = Memory {
            at: 0,
            opcode: 0,
            words,
            reach: (0, 0),
            missed: false,
        };
        Self { cpu, memory, state }
    }

    fn flags(&self) -> u32 {
        self.cpu.cpsr() >> 28
    }

    /// The first thing known that does not hold.
    fn mistake(&self) -> Option<String> {
        let (state, cpu) = (&self.state, &self.cpu);
        let mut bases = BTreeMap::new();
        for (number, value) in (0..).zip(state.registers.iter()) {
            if !allows(value, cpu.register(number), &mut bases) {
                return Some(format!("r{number} {:#x}, {value:x?}", cpu.register(number)));
            }
        }
        for (offset, value) in state.stack_words.iter() {
            let index = (STACK.wrapping_add(offset as u32)).wrapping_sub(DATA) / 4;
            let held = self.memory.words.get(index as usize);
            if held.is_some_and(|word| !allows(value, *word, &mut bases)) {
                return Some(format!("stack {offset}: {held:x?}, {value:x?}"));
            }
        }
        if state.flags >> self.flags() & 1 == 0 {
            return Some(format!("NZCV {:04b}, {:#x}", self.flags(), state.flags));
        }
        if let Some(number) = state.tested {
            let held = cpu.register(number);
            let result = held >> 31 << 3 | u32::from(held == 0) << 2;
            if result != self.flags() & 0b1100 {
                return Some(format!("r{number} {held:#x} is not what set N and Z"));
            }
        }
        for copy in &state.shifted {
            let (held, from) = (cpu.register(copy.register), cpu.register(copy.from));
            let shifted = shift_by_constant(copy.kind, from, copy.amount, false).value;
            if held != shifted {
                return Some(format!("{held:#x}, {copy:?} {shifted:#x}"));
            }
        }
        for span in &state.spans {
            let distance = cpu
                .register(span.place)
                .wrapping_sub(cpu.register(span.base));
            if !allows(&span.distance, distance, &mut bases) {
                return Some(format!("{distance:#x}, {span:x?}"));
            }
        }
        let wrong = |comparison| self.wrong_comparison(comparison, &mut bases);
        let compared = state.comparison.as_ref().and_then(wrong);
        compared
            .or_else(|| self.wrong_relation())
            .or_else(|| self.wrong_word())
    }

    fn wrong_comparison(
        &self,
        comparison: &Comparison,
        bases: &mut BTreeMap<u32, u32>,
    ) -> Option<String> {
        let held = |register: Option<u32>| match register {
            Some(number) if number < 15 => Some(self.cpu.register(number)),
            _ => None,
        };
        let moved = comparison
            .moved
            .map(|(n, more)| self.cpu.register(n).wrapping_sub(more));
        let right = held(comparison.right.0).or(comparison.right.1.constant());
        let result = held(comparison.result)
            .zip(right)
            .map(|(r, b)| r.wrapping_add(b));
        for left in [held(comparison.left.0), moved, result]
            .into_iter()
            .flatten()
        {
            let fits = right.is_none_or(|b| difference_flags(left, b).1 == self.flags());
            if !fits || !allows(&comparison.left.1, left, bases) {
                return Some(format!("{comparison:x?}"));
            }
        }
        let allowed = right.is_none_or(|b| allows(&comparison.right.1, b, bases));
        (!allowed).then(|| format!("{comparison:x?}"))
    }

    fn wrong_relation(&self) -> Option<String> {
        let held = |place: Location| match place {
            Location::Register(number) => self.cpu.register(number),
            Location::Word(address) => self.memory.words[((address - DATA) / 4) as usize],
        };
        let places = (0..13).map(Location::Register);
        let mut related = places.flat_map(|one| {
            let others = self.state.relations.of(one);
            others.map(move |(other, more)| (one, other, more))
        });
        let wrong = related.find(|(a, b, more)| held(*b).wrapping_sub(held(*a)) != *more);
        wrong.map(|pair| format!("{pair:x?}"))
    }

    fn wrong_word(&self) -> Option<String> {
        let contents = self.state.memory.as_ref()?;
        for (start, word) in (DATA..).step_by(4).zip(self.memory.words) {
            for (size, mask) in [(4, u32::MAX), (2, 0xFFFF), (1, 0xFF)] {
                for address in (start..start + 4).step_by(size) {
                    let part = word >> (8 * (address & 3)) & mask;
                    let known = contents.load(&Value::Constant(address), size as u32);
                    let known = known.unwrap_or(Value::Top);
                    if !allows(&known, part, &mut BTreeMap::new()) {
                        return Some(format!("{address:#x}: {part:#x}, {known:x?}"));
                    }
                }
            }
        }
        None
    }

    /// Executes an instruction on both sides, if it is one that may be. `before` is any state.
    fn step(
        &mut self,
        environment: Environment<'_>,
        at: u32,
        opcode: u32,
        before: Option<State>,
    ) -> bool {
        let thumb = self.cpu.thumb();
        let instruction = if thumb {
            Instruction::thumb(opcode as u16)
        } else {
            Instruction::arm(opcode)
        };
        let Some(reach) = reach(&instruction) else {
            return false;
        };
        let (mut cpu, mut memory) = (self.cpu.clone(), self.memory.clone());
        (memory.at, memory.opcode) = (at, opcode);
        (memory.reach, memory.missed) = (reach, false);
        cpu.set_pc(at);
        let _ = cpu.step(&mut memory);
        if memory.missed {
            return false;
        }
        let passes = condition_passes(instruction.condition, self.flags());
        let (failed, passed) = self.state.clone().split(instruction.condition);
        let (own, other) = if passes {
            (passed, failed)
        } else {
            (failed, passed)
        };
        let mut state = own.expect("a way that is taken");
        if passes {
            let _ = execute(environment, &mut state, at, &instruction);
        }
        for other in [other, before].into_iter().flatten() {
            state = if at & 4 == 0 {
                state.join(&other)
            } else {
                other.join(&state)
            };
        }
        (self.cpu, self.memory, self.state) = (cpu, memory, state);
        true
    }
}

fn sequence(environment: Environment<'_>, seed: u32, thumb_code: bool) {
    let mut random = Random::new(seed);
    let mut pair = Pair::new(&mut random, thumb_code, seed % 2 == 0);
    let (mut told, mut done, mut before) = (Vec::new(), 0, pair.state.clone());
    while done < LENGTH {
        let opcode = if thumb_code {
            thumb(&mut random)
        } else {
            arm(&mut random)
        };
        let at = CODE + 4 * (random.word() % 8);
        let joined = (random.word() % 8 == 0).then(|| before.clone());
        let here = pair.state.clone();
        told.push(format!("{at:#x}: {opcode:#x}, joined {}", joined.is_some()));
        if !pair.step(environment, at, opcode, joined) {
            told.pop();
            continue;
        }
        done += 1;
        before = here;
        if random.word() % 3 == 0 {
            let condition = random.word() % 14;
            let passes = condition_passes(condition, pair.flags());
            told.push(format!("condition {condition} {passes}"));
            let assumed = pair.state.assume(condition, passes);
            pair.state = assumed.unwrap_or_else(|| panic!("{seed}: no way\n{}", told.join("\n")));
        }
        if let Some(mistake) = pair.mistake() {
            panic!("{seed}: {mistake}\n{}", told.join("\n"));
        }
    }
}

#[test]
fn what_is_known_after_random_instructions_holds_on_the_core() {
    let without_sections = image::Image::binary(&[0], 0).unwrap();
    let image = Image::of_file(without_sections).unwrap();
    let (map, conventions) = (
        MemoryMap::without_wait_states(),
        KernelConventions::default(),
    );
    let environment = Environment {
        image: &image,
        map: &map,
        conventions: &conventions,
        facts: None,
    };
    for seed in 0..SEQUENCES {
        for thumb_code in [false, true] {
            sequence(environment, seed, thumb_code);
        }
    }
}
