// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! `steps CONFIGURATION ELF FROM UNTIL [FROM UNTIL]...`: every step of the processor between two
//! cycles, then between two later ones, as binary records on standard output: cycles (u64), address
//! of the instruction that comes next, program status, r13 and r14 (u32 each), little endian, each
//! before the step.

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
            let words = [
                cpu.next_instruction_address(),
                cpu.cpsr(),
                cpu.register(13),
                cpu.register(14),
            ];
            let words = words.into_iter().flat_map(u32::to_le_bytes);
            let record: Vec<u8> = brick
                .cycles()
                .to_le_bytes()
                .into_iter()
                .chain(words)
                .collect();
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
    let [configuration, elf, windows @ ..] = arguments.as_slice() else {
        return Err("expected a configuration (JSON), an image, first and last cycles".into());
    };
    let configuration = Configuration::from_json(configuration)?;
    let mut brick = VirtualBrick::new(&configuration, &std::fs::read(elf)?)?;
    let mut writer = Writer {
        to: BufWriter::new(std::io::stdout().lock()),
        from_cycles: 0,
        failure: None,
    };
    for window in windows.chunks(2) {
        let [from, until] = window else {
            return Err("a first cycle without a last one".into());
        };
        writer.from_cycles = from.parse()?;
        brick.run_observed(until.parse()?, &mut writer);
    }
    writer.to.flush()?;
    writer.failure.map_or(Ok(()), |failure| Err(failure.into()))
}
