// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds under the chip's timing profiles against times on the chip, code in flash.

#[path = "../../../bindings/python/src/chip_memory_map.rs"]
mod chip_memory_map;

use crate::support::random::Random;
use crate::support::toolchain::{build, program};
use crate::support::LIBGCC;
use arm7tdmi::{psr, Bus, Cpu, Cycle, Width};
use at91sam7s::board::{Board, ChipEvent, Cycles, PinLevels, PinOutputs, TwiReply};
use at91sam7s::{Chip, ChipConfiguration, TimingProfile};
use wcet::{Annotations, Image, Program, Report};

const FLASH_MODE: u32 = 0xFFFF_FF60;
const STACK: u32 = 0x0020_F000;
const STOP: u32 = 0x0013_F000;
const FLASH: [&str; 2] = ["-Wl,-Ttext=0x100000,-e0x100000", "-Wl,-Tdata=0x202000"];

/// A board with nothing on it.
#[derive(Clone, Debug)]
struct Bare;

const NO_ANSWER: TwiReply = TwiReply {
    acknowledged: false,
    stretch_cycles: 0,
};

impl Board for Bare {
    fn outputs_changed(&mut self, _: Cycles, _: PinOutputs) {}
    fn pin_levels(&self) -> PinLevels {
        PinLevels::default()
    }
    fn twi_start(&mut self, _: Cycles, _: u8, _: bool) -> TwiReply {
        NO_ANSWER
    }
    fn twi_write(&mut self, _: Cycles, _: u8) -> TwiReply {
        NO_ANSWER
    }
    fn twi_read(&mut self, _: Cycles) -> (u8, Cycles) {
        (0, 0)
    }
    fn twi_stop(&mut self, _: Cycles) {}
    fn spi_frame(&mut self, _: Cycles, _: u32, _: u16, _: u8) -> u16 {
        0
    }
    fn analogue_input(&mut self, _: Cycles, _: u8) -> u16 {
        0
    }
    fn next_event(&self) -> Cycles {
        Cycles::MAX
    }
    fn advance(&mut self, _: Cycles) {}
    fn powered(&self) -> bool {
        true
    }
    fn observe(&mut self, _: Cycles, _: ChipEvent) {}
}

fn profile(name: &str) -> TimingProfile {
    match name {
        "optimistic" => TimingProfile::optimistic(),
        "pessimistic" => TimingProfile::pessimistic(),
        _ => TimingProfile::nominal(),
    }
}

/// Cycles of a call on the chip, from the first instruction to the end of the return.
fn call(elf: &[u8], symbol: &str, arguments: [u32; 2], timing: &str, wait_states: u32) -> u64 {
    let image = image::Image::parse(elf).unwrap();
    let configuration = ChipConfiguration {
        timing: profile(timing),
        ..ChipConfiguration::default()
    };
    let mut chip = Chip::new(Bare, configuration);
    chip.enter_as_boot_monitor();
    for segment in image.segments() {
        chip.load(segment.address, &segment.bytes).unwrap();
    }
    chip.write(
        FLASH_MODE,
        Width::Word,
        wait_states << 8,
        Cycle::Nonsequential,
    )
    .unwrap();
    let (address, thumb) = Image::read(elf).unwrap().function(symbol).unwrap();
    let address = address | u32::from(thumb);
    let mut cpu = Cpu::new();
    let thumb = if address & 1 != 0 { psr::T } else { 0 };
    cpu.set_cpsr(cpu.cpsr() | thumb);
    for (number, value) in (0..).zip(arguments) {
        cpu.set_register(number, value);
    }
    cpu.set_register(13, STACK);
    cpu.set_register(14, STOP | (address & 1));
    cpu.set_pc(address & !1);
    let before_fill = chip.now();
    let _ = fill_cycles(&mut chip, address);
    let start = chip.now();
    let fill = start - before_fill;
    while cpu.next_instruction_address() != STOP {
        let _ = cpu.step(&mut chip);
        assert!(chip.fault().is_none(), "{:?}", chip.fault());
    }
    chip.now() - start - fill
}

/// The two fetches at the entry, which belong to the caller.
fn fill_cycles(chip: &mut Chip<Bare>, entry: u32) -> Option<()> {
    if entry & 1 != 0 {
        chip.fetch_halfword(entry & !1, Cycle::Nonsequential).ok()?;
        chip.fetch_halfword((entry & !1) + 2, Cycle::Sequential)
            .ok()?;
    } else {
        chip.fetch_word(entry, Cycle::Nonsequential).ok()?;
        chip.fetch_word(entry + 4, Cycle::Sequential).ok()?;
    }
    Some(())
}

fn bound(elf: &[u8], symbol: &str, timing: &str, wait_states: u32) -> u64 {
    let image = Image::read(elf).unwrap();
    let map = chip_memory_map::memory_map(timing, u64::from(wait_states)).unwrap();
    let annotations = Annotations::parse(LIBGCC, "libgcc.toml").unwrap();
    let program = Program::new(&image, &map, &annotations).unwrap();
    Report::new(&program, symbol).unwrap().bound_cycles
}

const SETTINGS: [(&str, u32); 5] = [
    ("nominal", 0),
    ("nominal", 1),
    ("nominal", 2),
    ("optimistic", 1),
    ("pessimistic", 1),
];

#[test]
fn bounds_from_flash_equal_the_chip_on_single_paths_up_to_the_unknown_return() {
    for code in ["-marm", "-mthumb"] {
        let flags = [code, "-O2", FLASH[0], FLASH[1]];
        let Some(elf) = build("flash_single", &[program("single_path.c")], &flags) else {
            return;
        };
        for (timing, wait_states) in SETTINGS {
            for symbol in [
                "add_up", "fill", "triangle", "weigh", "chain", "shifts", "frame",
            ] {
                let seen = call(&elf, symbol, [5, 6], timing, wait_states);
                let bound = bound(&elf, symbol, timing, wait_states);
                let spare = if code == "-marm" {
                    0
                } else {
                    u64::from(wait_states) + 1
                };
                let what = format!("{code} {timing} {wait_states} {symbol}: {seen} of {bound}");
                assert!((seen..=seen + spare).contains(&bound), "{what}");
            }
        }
    }
}

#[test]
fn no_time_of_floats_in_flash_exceeds_the_bound() {
    let flags = ["-mthumb", "-O2", FLASH[0], FLASH[1]];
    let Some(elf) = build("flash_floats", &[program("floats.c")], &flags) else {
        return;
    };
    let mut random = Random::new(5);
    for (timing, wait_states) in SETTINGS {
        for symbol in [
            "float_add",
            "float_multiply",
            "float_divide",
            "float_compare",
        ] {
            let bound = bound(&elf, symbol, timing, wait_states);
            let runs = (0..40).map(|_| {
                let arguments = [random.float(), random.float()];
                call(&elf, symbol, arguments, timing, wait_states)
            });
            let longest = runs.max().unwrap();
            assert!(
                longest <= bound,
                "{timing} {wait_states} {symbol}: {longest} > {bound}"
            );
        }
    }
}
