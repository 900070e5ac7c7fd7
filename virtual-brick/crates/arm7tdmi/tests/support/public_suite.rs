// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Tests of the public suite SingleStepTests/ARM7TDMI: state before and after one instruction,
//! and every bus cycle of it with its number.
//!
//! A state is r0 to r15 as user mode sees them, then the banks (FIQ r8 to r14; r13 and r14 of
//! supervisor, abort, interrupt, undefined), CPSR, SPSRs in the order
//! FIQ, supervisor, abort, interrupt, undefined, and the two opcodes in the pipeline.

use arm7tdmi::{psr, Abort, Bus, Cpu, Cycle, Mode, TimingProfile, Width};

const MAGIC: u32 = 0xD33D_BAE0;
const STATE_WORDS: usize = 39;
const BANKS: [(Mode, u32, usize, usize); 5] = [
    (Mode::Fiq, 8, 16, 7),
    (Mode::Supervisor, 13, 23, 2),
    (Mode::Abort, 13, 25, 2),
    (Mode::Irq, 13, 27, 2),
    (Mode::Undefined, 13, 29, 2),
];
const CPSR: usize = 31;
const PIPELINE: usize = 37;
const SPSR_MODES: [Mode; 5] = [
    Mode::Fiq,
    Mode::Supervisor,
    Mode::Abort,
    Mode::Irq,
    Mode::Undefined,
];

/// Why a case is not compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Excluded {
    IllegalMode,
    MultiplyWithPc,
    WriteBackToPc,
    StatusToPc,
}

impl Excluded {
    pub const ALL: [Self; 4] = [
        Self::IllegalMode,
        Self::MultiplyWithPc,
        Self::WriteBackToPc,
        Self::StatusToPc,
    ];

    pub const fn sentence(self) -> &'static str {
        match self {
            Self::IllegalMode => {
                "the test ends in a mode number that ARM DDI 0029E section 3.8 does not define"
            }
            Self::MultiplyWithPc => {
                "a multiplication with r15 as an operand, which section 4.7 forbids"
            }
            Self::WriteBackToPc => {
                "write-back to r15 or SWP with base r15, which sections 4.9 and 4.12 forbid"
            }
            Self::StatusToPc => "MRS to r15, which section 4.6 forbids",
        }
    }
}

/// A bus cycle as the suite writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Transfer {
    kind: u32,
    size: u32,
    address: u32,
    data: u32,
    cycle: u32,
}

/// One test.
#[derive(Clone)]
pub struct Case {
    before: Vec<u32>,
    after: Vec<u32>,
    transfers: Vec<Transfer>,
    opcodes: [u32; 5],
    base: u32,
}

/// The tests of one file.
pub struct Suite {
    pub name: String,
    pub cases: Vec<Case>,
}

/// Little-endian words of a file.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn word(&mut self) -> Result<u32, String> {
        let (word, rest) = self
            .0
            .split_first_chunk::<4>()
            .ok_or("ends in the middle of a test")?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*word))
    }

    fn words(&mut self, count: usize) -> Result<Vec<u32>, String> {
        (0..count).map(|_| self.word()).collect()
    }
}

impl Suite {
    pub fn parse(name: &str, content: &[u8]) -> Result<Self, String> {
        let mut reader = Reader(content);
        if reader.word()? != MAGIC {
            return Err(format!(
                "{name}: does not begin with the suite's magic number"
            ));
        }
        let count = reader.word()?;
        let cases = (0..count)
            .map(|_| Case::parse(&mut reader))
            .collect::<Result<_, _>>()
            .map_err(|error| format!("{name}: {error}"))?;
        Ok(Self {
            name: name.to_owned(),
            cases,
        })
    }

    /// Runs one test; a reason when it is not compared.
    pub fn run(&self, case: &Case) -> Result<Option<Excluded>, String> {
        if let Some(reason) = self.exclusion(case) {
            return Ok(Some(reason));
        }
        let signed_halfword = self.name == "ldrsb_ldrsh" && case.opcodes[0] >> 5 & 3 == 3;
        let widened = signed_halfword.then(|| case.with_halfwords());
        let case = widened.as_ref().unwrap_or(case);
        let mut cpu = Cpu::with_profile(TimingProfile {
            undefined_internal_cycles: 0,
            ..TimingProfile::default()
        });
        case.load(&mut cpu);
        let mut bus = SuiteBus::new(case);
        let _ = cpu.step(&mut bus);
        let ignored = if self.name.starts_with("mul") {
            psr::C
        } else {
            0
        };
        let mut differences = case.compare_state(&cpu, ignored);
        differences.extend(case.compare_transfers(&bus.seen));
        if differences.is_empty() {
            return Ok(None);
        }
        let (opcode, base) = (case.opcodes[0], case.base);
        let list = differences.join("; ");
        Err(format!("opcode {opcode:#010X} at {base:#010X}: {list}"))
    }

    fn exclusion(&self, case: &Case) -> Option<Excluded> {
        let opcode = case.opcodes[0];
        let field = |position: u32| opcode >> position & 15;
        let bit = |position: u32| opcode >> position & 1 != 0;
        if Mode::from_psr(case.after[CPSR]).is_none() {
            return Some(Excluded::IllegalMode);
        }
        match self.name.as_str() {
            "mul_mla" | "mull_mlal" if [0, 8, 12, 16].into_iter().any(|at| field(at) == 15) => {
                Some(Excluded::MultiplyWithPc)
            }
            "mrs" if field(12) == 15 => Some(Excluded::StatusToPc),
            "swp" if field(16) == 15 => Some(Excluded::WriteBackToPc),
            name if name.starts_with("ld") && field(16) == 15 && (bit(21) || !bit(24)) => {
                Some(Excluded::WriteBackToPc)
            }
            _ => None,
        }
    }
}

impl Case {
    fn parse(reader: &mut Reader<'_>) -> Result<Self, String> {
        let _size = reader.word()?;
        let mut section = || -> Result<Vec<u32>, String> {
            let size = reader.word()? as usize;
            reader.words((size / 4).checked_sub(1).ok_or("a section without a tag")?)
        };
        let (before, after) = (section()?, section()?);
        let (transfers, opcodes) = (section()?, section()?);
        let transfers = transfers
            .get(2..)
            .unwrap_or_default()
            .chunks_exact(6)
            .map(|words| Transfer {
                kind: words[0],
                size: words[1],
                address: words[2],
                data: words[3],
                cycle: words[4],
            })
            .collect();
        let (&[_, a, b, c, d, e, base], true, true) = (
            opcodes.as_slice(),
            before.len() == STATE_WORDS + 1,
            after.len() == STATE_WORDS + 1,
        ) else {
            return Err("a test of another format than five opcodes and 39 words".to_owned());
        };
        Ok(Self {
            before: before[1..].to_vec(),
            after: after[1..].to_vec(),
            transfers,
            opcodes: [a, b, c, d, e],
            base,
        })
    }

    /// LDRSH from an odd address is unpredictable (section 4.10). The suite reads the byte there;
    /// this core reads the halfword whose upper byte it is.
    fn with_halfwords(&self) -> Self {
        let mut widened = self.clone();
        for transfer in &mut widened.transfers {
            if transfer.kind == 1 && transfer.size == 1 {
                transfer.size = 2;
                transfer.data = (transfer.data & 0xFF) << 8;
            }
        }
        widened
    }

    fn load(&self, cpu: &mut Cpu) {
        cpu.set_cpsr(self.before[CPSR]);
        for (bank, first, start, count) in BANKS {
            for index in 0..count {
                let value = self.before[start + index];
                cpu.set_banked_register(bank, first + index as u32, value);
            }
        }
        for (bank, &value) in SPSR_MODES.into_iter().zip(&self.before[CPSR + 1..]) {
            cpu.set_spsr_of(bank, value);
        }
        for (number, &value) in (0..).zip(&self.before[..15]) {
            cpu.set_banked_register(Mode::User, number, value);
        }
        cpu.set_pc(self.base);
    }

    fn compare_state(&self, cpu: &Cpu, ignored_status: u32) -> Vec<String> {
        let mut differences = Vec::new();
        let mut compare = |what: String, found: u32, expected: u32, mask: u32| {
            if (found ^ expected) & mask != 0 {
                differences.push(format!("{what} {found:#X}, expected {expected:#X}"));
            }
        };
        for number in 0..15 {
            let expected = self.after[number as usize];
            let found = cpu.banked_register(Mode::User, number);
            compare(format!("r{number}"), found, expected, !0);
        }
        let size = if cpu.thumb() { 2 } else { 4 };
        let ahead = cpu.next_instruction_address().wrapping_add(2 * size);
        compare("r15".to_owned(), ahead, self.after[15], !(size - 1));
        for (bank, first, start, count) in BANKS {
            for index in 0..count {
                let number = first + index as u32;
                let expected = self.after[start + index];
                let found = cpu.banked_register(bank, number);
                compare(format!("{bank:?} r{number}"), found, expected, !0);
            }
        }
        for (bank, &expected) in SPSR_MODES.into_iter().zip(&self.after[CPSR + 1..PIPELINE]) {
            let found = cpu.spsr_of(bank).unwrap_or(0);
            let mask = psr::IMPLEMENTED & !psr::M4;
            compare(format!("SPSR {bank:?}"), found, expected, mask);
        }
        let mask = psr::IMPLEMENTED & !ignored_status;
        compare("CPSR".to_owned(), cpu.cpsr(), self.after[CPSR], mask);
        differences
    }

    /// Data writes are stamped one cycle early; misaligned addresses as they were computed.
    fn compare_transfers(&self, seen: &[Transfer]) -> Option<String> {
        let aligned = |transfer: &Transfer| Transfer {
            address: transfer.address & !(transfer.size - 1),
            data: if transfer.kind == 2 { transfer.data } else { 0 },
            cycle: transfer.cycle + u32::from(transfer.kind == 2),
            ..*transfer
        };
        let expected: Vec<_> = self.transfers.iter().map(aligned).collect();
        (expected != seen).then(|| format!("bus {seen:X?}, expected {expected:X?}"))
    }
}

/// Answers from the test's list and writes down what was asked.
struct SuiteBus<'a> {
    case: &'a Case,
    /// The two fetches that fill the pipeline before the test begins.
    ahead: u32,
    cycle: u32,
    seen: Vec<Transfer>,
}

impl<'a> SuiteBus<'a> {
    fn new(case: &'a Case) -> Self {
        Self {
            case,
            ahead: 2,
            cycle: 0,
            seen: Vec::new(),
        }
    }

    fn transfer(&mut self, kind: u32, size: u32, address: u32, data: u32) {
        self.cycle += 1;
        self.seen.push(Transfer {
            kind,
            size,
            address: address & !(size - 1),
            data,
            cycle: self.cycle,
        });
    }

    fn answer(&self, kind: u32, size: u32, address: u32) -> u32 {
        let aligned = address & !(size - 1);
        let listed = self.case.transfers.iter().find(|transfer| {
            let same_place = transfer.address & !(size - 1) == aligned && transfer.size == size;
            same_place && (transfer.kind == 0) == (kind == 0)
        });
        let offset = aligned.wrapping_sub(self.case.base) as usize / 4;
        listed.map_or(self.case.opcodes[offset.min(4)], |transfer| transfer.data)
    }

    fn fetch(&mut self, size: u32, address: u32) -> u32 {
        if self.ahead > 0 {
            self.ahead -= 1;
            return self.case.before[PIPELINE + 1 - self.ahead as usize];
        }
        self.transfer(0, size, address, 0);
        self.answer(0, size, address)
    }
}

const fn bytes(width: Width) -> u32 {
    match width {
        Width::Byte => 1,
        Width::Halfword => 2,
        Width::Word => 4,
    }
}

impl Bus for SuiteBus<'_> {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        Ok(self.fetch(4, address))
    }

    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        Ok(self.fetch(2, address) as u16)
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        let size = bytes(width);
        self.transfer(1, size, address, 0);
        Ok(self.answer(1, size, address))
    }

    fn write(&mut self, address: u32, width: Width, value: u32, _: Cycle) -> Result<(), Abort> {
        let size = bytes(width);
        let mask = u32::MAX >> (32 - 8 * size);
        self.transfer(2, size, address, value & mask);
        Ok(())
    }

    fn internal(&mut self, count: u32) {
        self.cycle += count;
    }
}
