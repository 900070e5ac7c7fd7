// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Runs `arm/arm.gba` and `thumb/thumb.gba` of the public suite jsmolka/gba-tests on the core with
//! a small bus: cartridge, work memories, memory of the screen, and a status register that changes
//! with each read. The programs test themselves and leave the number of the first failure in a
//! register. Prints a summary as JSON.
//!
//! Usage: `cargo run --release -p arm7tdmi --example gba_tests -- FOLDER`. Failures go to standard
//! error; the exit code is 1 if there are any, 2 if a program is missing.

use std::path::Path;
use std::process::ExitCode;

use arm7tdmi::{Abort, Bus, Cpu, Cycle, Mode, Width};

/// Program and the register that tells its result.
const PROGRAMS: [(&str, u32); 2] = [("arm/arm.gba", 12), ("thumb/thumb.gba", 7)];
const STEPS_MOST: u32 = 10_000_000;
const CARTRIDGE: u32 = 8;
const SCREEN_STATUS: u32 = 0x0400_0004;

/// Memories by the highest byte of the address, each repeated through its 16 MiB.
struct Console {
    cartridge: Vec<u8>,
    external: Vec<u8>,
    internal: Vec<u8>,
    palette: Vec<u8>,
    screen: Vec<u8>,
    status: u32,
}

impl Console {
    fn new(cartridge: Vec<u8>) -> Self {
        Self {
            cartridge,
            external: vec![0; 0x4_0000],
            internal: vec![0; 0x8000],
            palette: vec![0; 0x400],
            screen: vec![0; 0x2_0000],
            status: 0,
        }
    }

    fn memory(&mut self, address: u32) -> Option<&mut Vec<u8>> {
        match address >> 24 {
            2 => Some(&mut self.external),
            3 => Some(&mut self.internal),
            5 => Some(&mut self.palette),
            6 => Some(&mut self.screen),
            CARTRIDGE => Some(&mut self.cartridge),
            _ => None,
        }
    }

    fn load(&mut self, address: u32, bytes: u32) -> u32 {
        if address & !3 == SCREEN_STATUS {
            self.status ^= 1;
            return self.status;
        }
        let Some(memory) = self.memory(address) else {
            return 0;
        };
        let start = (address & 0x00FF_FFFF & !(bytes - 1)) as usize;
        let length = memory.len().max(1);
        (0..bytes).fold(0, |word, at| {
            let byte = memory.get((start + at as usize) % length).copied();
            word | u32::from(byte.unwrap_or(0)) << (8 * at)
        })
    }
}

const fn bytes_of(width: Width) -> u32 {
    match width {
        Width::Byte => 1,
        Width::Halfword => 2,
        Width::Word => 4,
    }
}

impl Bus for Console {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        Ok(self.load(address, 4))
    }

    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        Ok(self.load(address, 2) as u16)
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        Ok(self.load(address, bytes_of(width)))
    }

    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        if address >> 24 == CARTRIDGE {
            return Ok(());
        }
        let bytes = bytes_of(width);
        let start = (address & 0x00FF_FFFF & !(bytes - 1)) as usize;
        if let Some(memory) = self.memory(address) {
            let length = memory.len();
            for at in 0..bytes as usize {
                memory[(start + at) % length] = (value >> (8 * at)) as u8;
            }
        }
        Ok(())
    }

    fn internal(&mut self, _count: u32) {}
}

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("expected the folder with arm.gba and thumb.gba as the only argument");
        return ExitCode::from(2);
    };
    let mut passed = 0;
    for (name, register) in PROGRAMS {
        let path = Path::new(&folder).join(name);
        let outcome = match std::fs::read(&path) {
            Ok(cartridge) => run(cartridge, register),
            Err(error) => {
                eprintln!("{}: {error}", path.display());
                return ExitCode::from(2);
            }
        };
        match outcome {
            Ok(()) => passed += 1,
            Err(difference) => eprintln!("{name}: {difference}"),
        }
    }
    let count = PROGRAMS.len();
    let counts = format!(r#""case_count":{count},"passed":{passed}"#);
    println!(r#"{{"area":"cpu","suite":"jsmolka/gba-tests",{counts}}}"#);
    ExitCode::from(u8::from(passed != count))
}

/// Runs a program to the loop at its end.
fn run(cartridge: Vec<u8>, register: u32) -> Result<(), String> {
    let mut console = Console::new(cartridge);
    let mut cpu = Cpu::new();
    cpu.set_banked_register(Mode::Supervisor, 13, 0x0300_7FE0);
    cpu.set_banked_register(Mode::Irq, 13, 0x0300_7FA0);
    cpu.set_cpsr(Mode::System.bits());
    cpu.set_register(13, 0x0300_7F00);
    cpu.set_pc(CARTRIDGE << 24);
    for step in 0..STEPS_MOST {
        let before = cpu.next_instruction_address();
        cpu.step(&mut console);
        if cpu.next_instruction_address() == before && step > 0 {
            return match cpu.register(register) {
                0 => Ok(()),
                number => Err(format!("its test {number} fails")),
            };
        }
    }
    Err(format!("did not end in {STEPS_MOST} instructions"))
}
