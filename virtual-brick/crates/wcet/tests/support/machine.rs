// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The core with a memory that answers every access in one cycle.

use arm7tdmi::{psr, Abort, Bus, Cpu, Cycle, Width};
use image::Image;
use std::ops::ControlFlow;

const BASE: u32 = 0x20_0000;
const SIZE: usize = 0x20_0000;
const STACK: u32 = BASE + SIZE as u32 - 64;
const STOP: u32 = BASE;
const PATIENCE: u64 = 20_000_000_000;
/// Fetches that fill the pipeline before the first instruction.
const FILL_CYCLES: u64 = 2;

/// Memory from `BASE` on that counts cycles.
struct Memory {
    bytes: Vec<u8>,
    cycles: u64,
}

impl Memory {
    fn get<const N: usize>(&mut self, address: u32) -> Result<[u8; N], Abort> {
        self.cycles += 1;
        let start = (address & !(N as u32 - 1)).wrapping_sub(BASE) as usize;
        self.bytes
            .get(start..)
            .and_then(|rest| rest.first_chunk())
            .copied()
            .ok_or(Abort)
    }

    fn put<const N: usize>(&mut self, address: u32, value: [u8; N]) -> Result<(), Abort> {
        self.cycles += 1;
        let start = (address & !(N as u32 - 1)).wrapping_sub(BASE) as usize;
        let place = self
            .bytes
            .get_mut(start..start.wrapping_add(N))
            .ok_or(Abort)?;
        place.copy_from_slice(&value);
        Ok(())
    }
}

impl Bus for Memory {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        self.get(address).map(u32::from_le_bytes)
    }

    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        self.get(address).map(u16::from_le_bytes)
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        match width {
            Width::Byte => self.get::<1>(address).map(|[byte]| u32::from(byte)),
            Width::Halfword => self.get(address).map(|b| u32::from(u16::from_le_bytes(b))),
            Width::Word => self.get(address).map(u32::from_le_bytes),
        }
    }

    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        match width {
            Width::Byte => self.put(address, [value as u8]),
            Width::Halfword => self.put(address, (value as u16).to_le_bytes()),
            Width::Word => self.put(address, value.to_le_bytes()),
        }
    }

    fn internal(&mut self, count: u32) {
        self.cycles += u64::from(count);
    }

    fn irq(&self) -> bool {
        false
    }

    fn fiq(&self) -> bool {
        false
    }
}

/// A program in memory.
pub struct Machine {
    image: Image,
    memory: Memory,
}

/// What a call took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Observation {
    pub cycles: u64,
    pub result: u32,
    pub stack_bytes: u32,
}

impl Machine {
    pub fn new(elf: &[u8]) -> Self {
        let image = Image::parse(elf).expect("an ELF file");
        let mut memory = Memory {
            bytes: vec![0; SIZE],
            cycles: 0,
        };
        for segment in image.segments() {
            let start = (segment.virtual_address - BASE) as usize;
            memory.bytes[start..start + segment.bytes.len()].copy_from_slice(&segment.bytes);
        }
        Self { image, memory }
    }

    /// Address of a variable or function; bit 0 is set for Thumb code.
    pub fn address(&self, symbol: &str) -> u32 {
        let symbols = self.image.symbols();
        let address = symbols.find(symbol).expect("a symbol").address;
        let thumb = symbols.functions().get(&address).is_some_and(|f| f.thumb);
        address | u32::from(thumb)
    }

    /// Size of a function in bytes.
    pub fn size(&self, symbol: &str) -> u32 {
        let address = self.address(symbol) & !1;
        self.image.symbols().functions()[&address].size
    }

    pub fn set_word(&mut self, address: u32, value: u32) {
        let start = (address - BASE) as usize;
        self.memory.bytes[start..start + 4].copy_from_slice(&value.to_le_bytes());
    }

    pub fn word(&self, address: u32) -> u32 {
        let start = (address - BASE) as usize;
        u32::from_le_bytes(*self.memory.bytes[start..].first_chunk().expect("a word"))
    }

    /// All memory, to begin again from it.
    pub fn memory(&self) -> Vec<u8> {
        self.memory.bytes.clone()
    }

    pub fn restore(&mut self, memory: &[u8]) {
        self.memory.bytes.copy_from_slice(memory);
    }

    pub fn bytes(&self, address: u32, count: usize) -> Vec<u8> {
        let start = (address - BASE) as usize;
        self.memory.bytes[start..start + count].to_vec()
    }

    pub fn set_bytes(&mut self, address: u32, bytes: &[u8]) {
        let start = (address - BASE) as usize;
        self.memory.bytes[start..start + bytes.len()].copy_from_slice(bytes);
    }

    /// Calls a function and counts, for each of the functions at `entries`, its most activations
    /// in one call from outside of it and its most activations at the same time.
    pub fn activations(&mut self, symbol: &str, entries: &[u32]) -> Vec<(u64, usize)> {
        let mut open: Vec<(Vec<u32>, u64)> = vec![(Vec::new(), 0); entries.len()];
        let mut most = vec![(0, 0); entries.len()];
        self.run(symbol, [0; 4], PATIENCE, |address, stack_pointer| {
            for (index, entry) in entries.iter().enumerate() {
                if entry & !1 != address {
                    continue;
                }
                let (stack, count) = &mut open[index];
                stack.retain(|outer| *outer > stack_pointer);
                *count = if stack.is_empty() { 1 } else { *count + 1 };
                stack.push(stack_pointer);
                most[index] = (most[index].0.max(*count), most[index].1.max(stack.len()));
            }
        });
        most
    }

    /// Calls a function: address and cycles of each instruction.
    pub fn steps_of(&mut self, symbol: &str, arguments: [u32; 4]) -> Vec<(u32, u64)> {
        let mut steps = Vec::new();
        self.run(symbol, arguments, PATIENCE, |address, _| {
            steps.push((address, 0))
        });
        steps
    }

    /// Begins a function that need not return: each instruction before it is executed, with the
    /// cycles so far, until it says that it is enough.
    pub fn follow(&mut self, symbol: &str, mut before: impl FnMut(&Cpu, u64) -> ControlFlow<()>) {
        let mut cpu = self.at(symbol, [0; 4]);
        while before(&cpu, self.memory.cycles).is_continue() {
            assert!(
                self.memory.cycles < PATIENCE,
                "{symbol} is not followed to an end"
            );
            let _ = cpu.step(&mut self.memory);
        }
    }

    /// Calls a function and counts from its first instruction to the end of its return.
    pub fn call(&mut self, symbol: &str, arguments: [u32; 4]) -> Observation {
        self.run(symbol, arguments, PATIENCE, |_, _| {})
    }

    /// The same; it is a mistake when the call takes longer than `limit` cycles.
    pub fn call_within(&mut self, symbol: &str, arguments: [u32; 4], limit: u64) -> Observation {
        self.run(symbol, arguments, limit.min(PATIENCE), |_, _| {})
    }

    fn run(
        &mut self,
        symbol: &str,
        arguments: [u32; 4],
        limit: u64,
        mut before: impl FnMut(u32, u32),
    ) -> Observation {
        let mut cpu = self.at(symbol, arguments);
        let mut lowest = STACK;
        while cpu.next_instruction_address() != STOP {
            before(cpu.next_instruction_address(), cpu.register(13));
            let _ = cpu.step(&mut self.memory);
            lowest = lowest.min(cpu.register(13));
            assert!(self.memory.cycles < limit, "{symbol} does not return");
        }
        assert_eq!(
            cpu.register(13),
            STACK,
            "{symbol} returns with its stack pointer"
        );
        Observation {
            cycles: self.memory.cycles - FILL_CYCLES,
            result: cpu.register(0),
            stack_bytes: STACK - lowest,
        }
    }

    /// The core before the first instruction of a function.
    fn at(&mut self, symbol: &str, arguments: [u32; 4]) -> Cpu {
        let address = self.address(symbol);
        let mut cpu = Cpu::new();
        if address & 1 != 0 {
            cpu.set_cpsr(cpu.cpsr() | psr::T);
        }
        for (number, value) in (0..).zip(arguments) {
            cpu.set_register(number, value);
        }
        cpu.set_register(13, STACK);
        cpu.set_register(14, STOP | (address & 1));
        cpu.set_pc(address & !1);
        self.memory.cycles = 0;
        cpu
    }
}
