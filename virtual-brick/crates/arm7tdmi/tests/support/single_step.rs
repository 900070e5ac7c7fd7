// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The single-step vectors: one instruction each, with the state before and after, the writes
//! and the cycles by kind. The format is described in verification/processor/README.md.

use super::counts::Counts;
use arm7tdmi::{psr, Abort, Bus, Cpu, Cycle, Instruction, Mode, TimingProfile, Width};

const MAGIC: u32 = 0x3156_3741;
const HEADER_WORDS: usize = 4;
const RECORD_WORDS: usize = 131;
const STATE_WORDS: usize = 37;
/// Modes with banked r13 and r14, in the order of the records, and where their pair starts.
const BANKS: [(Mode, usize); 4] = [
    (Mode::Supervisor, 23),
    (Mode::Abort, 25),
    (Mode::Irq, 27),
    (Mode::Undefined, 29),
];
const FIQ_R8: usize = 16;
const CPSR: usize = 31;
/// Modes with SPSR in the order of the records.
const SPSR: [(Mode, usize); 5] = [
    (Mode::Fiq, 32),
    (Mode::Supervisor, 33),
    (Mode::Abort, 34),
    (Mode::Irq, 35),
    (Mode::Undefined, 36),
];

/// All records of one instruction class.
pub struct Class {
    pub name: String,
    pub thumb: bool,
    /// The carry flag has no meaning after these instructions.
    pub ignore_carry: bool,
    pub records: Vec<Record>,
}

/// One instruction with what it starts from and what it must do.
pub struct Record(Vec<u32>);

impl Class {
    pub fn parse(name: &str, content: &[u8]) -> Result<Self, String> {
        let words: Vec<u32> = content
            .chunks_exact(4)
            .map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
            .collect();
        let [magic, count, thumb, ignore_carry] = *words
            .first_chunk()
            .ok_or_else(|| format!("{name}: shorter than its header"))?;
        if magic != MAGIC {
            return Err(format!(
                "{name}: magic {magic:#010X}, expected {MAGIC:#010X}"
            ));
        }
        let records: Vec<Record> = words[HEADER_WORDS..]
            .chunks_exact(RECORD_WORDS)
            .map(|record| Record(record.to_vec()))
            .collect();
        if records.len() != count as usize {
            return Err(format!(
                "{name}: {} records, header says {count}",
                records.len()
            ));
        }
        Ok(Self {
            name: name.trim_end_matches(".a7v").to_owned(),
            thumb: thumb != 0,
            ignore_carry: ignore_carry != 0,
            records,
        })
    }

    /// The timing choices of the core that produced the vectors: it spends no internal cycle on
    /// an undefined instruction, where the data sheet and this core's default have one.
    pub fn profile(&self) -> TimingProfile {
        TimingProfile {
            undefined_internal_cycles: 0,
            ..TimingProfile::default()
        }
    }

    /// Runs one record; the error lists every difference.
    pub fn run(&self, record: &Record) -> Result<(), String> {
        let mut cpu = Cpu::with_profile(self.profile());
        record.load(&mut cpu, self.thumb);
        let mut bus = VectorBus::new(record.opcode(), record.base());
        let _ = cpu.step(&mut bus);
        let mut differences = record.compare_state(&cpu, self.ignore_carry);
        differences.extend(record.compare_bus(&bus));
        if differences.is_empty() {
            return Ok(());
        }
        Err(format!(
            "{} opcode {:#010X} at {:#010X}: {}",
            self.name,
            record.opcode(),
            record.base(),
            differences.join("; ")
        ))
    }
}

impl Record {
    /// Does the static statement of the instruction's cycles equal the vector's counts?
    pub fn check_cost(&self, class: &Class) -> Result<(), String> {
        let instruction = if class.thumb {
            Instruction::thumb(self.opcode() as u16)
        } else {
            Instruction::arm(self.opcode())
        };
        let mut cpu = Cpu::with_profile(class.profile());
        self.load(&mut cpu, class.thumb);
        let expected = Counts::stated(&instruction, &cpu);
        let found = self.counts();
        if expected == found {
            return Ok(());
        }
        Err(format!("{instruction:X?}: {found:?}, stated {expected:?}"))
    }

    fn counts(&self) -> Counts {
        Counts {
            code_nonsequential: self.0[77],
            code_sequential: self.0[78],
            data_nonsequential: self.0[79],
            data_sequential: self.0[80],
            internal: self.0[81],
        }
    }

    fn opcode(&self) -> u32 {
        self.0[0]
    }

    fn base(&self) -> u32 {
        self.0[1]
    }

    fn before(&self) -> &[u32] {
        &self.0[2..2 + STATE_WORDS]
    }

    fn after(&self) -> &[u32] {
        &self.0[2 + STATE_WORDS..2 + 2 * STATE_WORDS]
    }

    fn load(&self, cpu: &mut Cpu, thumb: bool) {
        let state = self.before();
        let thumb_bit = if thumb { psr::T } else { 0 };
        cpu.set_cpsr((state[CPSR] & !psr::T) | thumb_bit);
        for (place, &value) in state_places().iter().zip(state) {
            match *place {
                Place::Register(mode, number) => cpu.set_banked_register(mode, number, value),
                Place::Spsr(mode) => cpu.set_spsr_of(mode, value),
                Place::Cpsr | Place::Pc => {}
            }
        }
        cpu.set_pc(self.base());
    }

    fn compare_state(&self, cpu: &Cpu, ignore_carry: bool) -> Vec<String> {
        let mut differences = Vec::new();
        for (place, &expected) in state_places().iter().zip(self.after()) {
            let (found, mask) = match *place {
                Place::Register(mode, number) => (cpu.banked_register(mode, number), !0),
                Place::Spsr(mode) => (cpu.spsr_of(mode).unwrap_or(0), !0),
                Place::Cpsr if ignore_carry => (cpu.cpsr(), psr::IMPLEMENTED & !psr::C),
                Place::Cpsr => (cpu.cpsr(), psr::IMPLEMENTED),
                Place::Pc if cpu.thumb() => (pipeline_pc(cpu), !0),
                Place::Pc => (pipeline_pc(cpu), !3),
            };
            if (found ^ expected) & mask != 0 {
                differences.push(format!(
                    "{place:?} {found:#010X}, expected {expected:#010X}"
                ));
            }
        }
        differences
    }

    fn compare_bus(&self, bus: &VectorBus) -> Vec<String> {
        let expected = self.counts();
        let mut differences = Vec::new();
        if bus.counts != expected || expected.total() != self.0[76] {
            differences.push(format!(
                "{:?}, expected {expected:?}, total {}",
                bus.counts, self.0[76]
            ));
        }
        let writes: Vec<Write> = self.0[83..]
            .chunks_exact(3)
            .take(self.0[82] as usize)
            .map(|write| Write::new(write[0], write[1], write[2]))
            .collect();
        if bus.writes != writes {
            differences.push(format!("{:X?}, expected {writes:X?}", bus.writes));
        }
        differences
    }
}

/// r15 as an instruction would read it.
fn pipeline_pc(cpu: &Cpu) -> u32 {
    let offset = if cpu.thumb() { 4 } else { 8 };
    cpu.next_instruction_address().wrapping_add(offset)
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Register(Mode, u32),
    Pc,
    Cpsr,
    Spsr(Mode),
}

/// What each of the 37 words of a state is.
fn state_places() -> [Place; STATE_WORDS] {
    let mut places = [Place::Pc; STATE_WORDS];
    for number in 0..15 {
        places[number as usize] = Place::Register(Mode::User, number);
    }
    for number in 8..15 {
        places[FIQ_R8 + number as usize - 8] = Place::Register(Mode::Fiq, number);
    }
    for (mode, start) in BANKS {
        places[start] = Place::Register(mode, 13);
        places[start + 1] = Place::Register(mode, 14);
    }
    places[CPSR] = Place::Cpsr;
    for (mode, index) in SPSR {
        places[index] = Place::Spsr(mode);
    }
    places
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Write {
    address: u32,
    size: u32,
    data: u32,
}

impl Write {
    /// Sub-word addresses are recorded as computed; memory ignores their low bits.
    fn new(address: u32, size: u32, data: u32) -> Self {
        Self {
            address: address & !(size - 1),
            size,
            data,
        }
    }
}

/// The synthetic memory of the vectors: each word is a hash of its address.
pub struct VectorBus {
    opcode: u32,
    base: u32,
    /// Fetches that fill the pipeline and do not belong to the instruction.
    fills_left: u32,
    pub counts: Counts,
    writes: Vec<Write>,
}

impl VectorBus {
    pub fn new(opcode: u32, base: u32) -> Self {
        Self {
            opcode,
            base,
            fills_left: 2,
            counts: Counts::default(),
            writes: Vec::new(),
        }
    }

    fn count_fetch(&mut self, cycle: Cycle) -> bool {
        if self.fills_left > 0 {
            self.fills_left -= 1;
            return false;
        }
        self.counts.count_code(cycle);
        true
    }

    /// The opcode is injected into the first fetch only; memory does not hold it.
    fn fetched(&mut self, address: u32, cycle: Cycle) -> u32 {
        let filling = !self.count_fetch(cycle);
        if filling && address == self.base {
            self.opcode
        } else {
            memory_word(address) >> (8 * (address & 2))
        }
    }
}

fn memory_word(address: u32) -> u32 {
    let mut x = (address & !3) ^ 0x9E37_79B9;
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

impl Bus for VectorBus {
    fn fetch_word(&mut self, address: u32, cycle: Cycle) -> Result<u32, Abort> {
        Ok(self.fetched(address, cycle))
    }

    fn fetch_halfword(&mut self, address: u32, cycle: Cycle) -> Result<u16, Abort> {
        Ok(self.fetched(address, cycle) as u16)
    }

    fn read(&mut self, address: u32, width: Width, cycle: Cycle) -> Result<u32, Abort> {
        self.counts.count_data(cycle);
        let word = memory_word(address);
        Ok(match width {
            Width::Byte => (word >> (8 * (address & 3))) & 0xFF,
            Width::Halfword => (word >> (8 * (address & 2))) & 0xFFFF,
            Width::Word => word,
        })
    }

    fn write(&mut self, address: u32, width: Width, value: u32, cycle: Cycle) -> Result<(), Abort> {
        self.counts.count_data(cycle);
        let (size, mask) = match width {
            Width::Byte => (1, 0xFF),
            Width::Halfword => (2, 0xFFFF),
            Width::Word => (4, !0),
        };
        self.writes.push(Write::new(address, size, value & mask));
        Ok(())
    }

    fn internal(&mut self, count: u32) {
        self.counts.internal += count;
    }
}
