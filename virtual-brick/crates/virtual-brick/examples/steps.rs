// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! `steps CONFIGURATION ELF FROM UNTIL`: every step of the processor between two cycles, as binary
//! records on standard output: cycles (u64), address of the instruction that comes next (u32) and
//! program status (u32), little endian, each before the step.

use std::error::Error;
use std::io::{BufWriter, Write};

use virtual_brick::{Access, Configuration, CpuStep, StepObserver, VirtualBrick};

struct Writer<W: Write> {
    to: W,
    from_cycles: u64,
    failure: Option<std::io::Error>,
}

impl<W: Write> StepObserver for Writer<W> {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, brick: &VirtualBrick) -> bool {
        if brick.cycles() >= self.from_cycles {
            let cpu = brick.processor();
            let mut record = [0; 16];
            record[..8].copy_from_slice(&brick.cycles().to_le_bytes());
            record[8..12].copy_from_slice(&cpu.next_instruction_address().to_le_bytes());
            record[12..].copy_from_slice(&cpu.cpsr().to_le_bytes());
            self.failure = self.to.write_all(&record).err();
        }
        self.failure.is_some()
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, _brick: &VirtualBrick, _step: CpuStep) -> bool {
        false
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [configuration, elf, from, until] = arguments.as_slice() else {
        return Err("expected a configuration (JSON), an image, a first and a last cycle".into());
    };
    let configuration = Configuration::from_json(configuration)?;
    let mut brick = VirtualBrick::new(&configuration, &std::fs::read(elf)?)?;
    let mut writer = Writer {
        to: BufWriter::new(std::io::stdout().lock()),
        from_cycles: from.parse()?,
        failure: None,
    };
    brick.run_observed(until.parse()?, &mut writer);
    writer.to.flush()?;
    writer.failure.map_or(Ok(()), |failure| Err(failure.into()))
}
