// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A scripted board that logs what the chip does, and short forms of bus accesses.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::VecDeque;

use arm7tdmi::bus::{Abort, Bus, Cycle, Width};
use at91sam7s::board::{
    Board, Character, ChipEvent, Cycles, PinLevels, PinOutputs, SerialPort, SoundBits, TwiReply,
    UsbAnswer, UsbSignal,
};
use at91sam7s::{Chip, ChipConfiguration, Errata, TimingProfile};

/// Constants for registers by their offsets from a base address.
macro_rules! registers {
    ($base:expr; $($name:ident = $offset:literal),* $(,)?) => {
        $(const $name: u32 = $base + $offset;)*
    };
}

pub const SRAM: u32 = 0x0020_0000;
pub const AIC: u32 = 0xFFFF_F000;
pub const PIOA: u32 = 0xFFFF_F400;
pub const PMC: u32 = 0xFFFF_FC00;
pub const PIT: u32 = 0xFFFF_FD30;
pub const TC0: u32 = 0xFFFA_0000;
pub const TWI: u32 = 0xFFFB_8000;
pub const SPI: u32 = 0xFFFE_0000;
pub const ADC: u32 = 0xFFFD_8000;
pub const MC: u32 = 0xFFFF_FF00;
pub const PCER: u32 = PMC + 0x10;

/// Something that crossed the border to the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seen {
    TwiStart { address: u8, read: bool },
    TwiWrite(u8),
    TwiRead(u8),
    TwiStop,
    Spi { selected: u32, frame: u16, bits: u8 },
    Sound(SoundBits),
    Sent(SerialPort, Character),
    Usb(UsbAnswer),
    Pins { driven: u32, level: u32 },
    Chip(ChipEvent),
}

/// A board that plays a script.
#[derive(Clone, Debug, Default)]
pub struct ScriptedBoard {
    pub log: Vec<(Cycles, Seen)>,
    /// Pin levels from given times on.
    pub pins: VecDeque<(Cycles, PinLevels)>,
    pub levels: PinLevels,
    /// Pins of which the board follows the outputs; of all if it says nothing.
    pub followed: Option<u32>,
    /// Characters that reach the chip at given times.
    pub characters: VecDeque<(Cycles, SerialPort, Character)>,
    /// What the USB host does at given times.
    pub usb: VecDeque<(Cycles, UsbSignal)>,
    pub slave_address: u8,
    pub slave_bytes: VecDeque<u8>,
    /// Number of written bytes that the slave acknowledges.
    pub acknowledges: Option<usize>,
    pub stretch_after_address: Cycles,
    pub stretch_after_write: Cycles,
    pub stretch_after_read: Cycles,
    pub spi_answer: u16,
    pub analogue: [u16; 8],
    pub supply_low: bool,
    pub dead: bool,
}

impl Board for ScriptedBoard {
    fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs) {
        let PinOutputs { driven, level, .. } = outputs;
        self.log.push((now, Seen::Pins { driven, level }));
    }

    fn followed_pins(&self) -> u32 {
        self.followed.unwrap_or(u32::MAX)
    }

    fn pin_levels(&self) -> PinLevels {
        self.levels
    }

    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        self.log.push((now, Seen::TwiStart { address, read }));
        let acknowledged = address == self.slave_address;
        TwiReply {
            acknowledged,
            stretch_cycles: self.stretch_after_address,
        }
    }

    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply {
        self.log.push((now, Seen::TwiWrite(byte)));
        let acknowledged = self.acknowledges != Some(0);
        self.acknowledges = self.acknowledges.map(|n| n.saturating_sub(1));
        TwiReply {
            acknowledged,
            stretch_cycles: self.stretch_after_write,
        }
    }

    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles) {
        let byte = self.slave_bytes.pop_front().unwrap_or(0xFF);
        self.log.push((now, Seen::TwiRead(byte)));
        (byte, 0)
    }

    fn twi_end_of_read(&mut self, _now: Cycles) -> Cycles {
        self.stretch_after_read
    }

    fn twi_stop(&mut self, now: Cycles) {
        self.log.push((now, Seen::TwiStop));
    }

    fn spi_frame(&mut self, now: Cycles, selected: u32, frame: u16, bits: u8) -> u16 {
        self.log.push((
            now,
            Seen::Spi {
                selected,
                frame,
                bits,
            },
        ));
        self.spi_answer
    }

    fn analogue_input(&mut self, _now: Cycles, channel: u8) -> u16 {
        self.analogue[usize::from(channel)]
    }

    fn next_event(&self) -> Cycles {
        let pins = self.pins.front().map(|(at, _)| *at);
        let characters = self.characters.front().map(|(at, ..)| *at);
        let usb = self.usb.front().map(|(at, _)| *at);
        let times = [pins, characters, usb].into_iter().flatten();
        times.min().unwrap_or(Cycles::MAX)
    }

    fn advance(&mut self, now: Cycles) {
        assert_eq!(
            self.next_event(),
            now,
            "the chip serves the board at the exact cycle"
        );
        while self.pins.front().is_some_and(|(at, _)| *at <= now) {
            let (_, levels) = self.pins.pop_front().expect("an event is due");
            self.levels = levels;
        }
    }

    fn powered(&self) -> bool {
        !self.dead
    }

    fn supply_is_low(&self) -> bool {
        self.supply_low
    }

    fn sound_bits(&mut self, now: Cycles, sound: SoundBits) {
        self.log.push((now, Seen::Sound(sound)));
    }

    fn serial_sent(&mut self, now: Cycles, port: SerialPort, character: Character) {
        self.log.push((now, Seen::Sent(port, character)));
    }

    fn serial_received(&mut self, now: Cycles, port: SerialPort) -> Option<Character> {
        let (at, to, character) = *self.characters.front()?;
        if at > now || to != port {
            return None;
        }
        self.characters.pop_front();
        Some(character)
    }

    fn usb_signal(&mut self, now: Cycles) -> Option<UsbSignal> {
        let (at, signal) = *self.usb.front()?;
        if at > now {
            return None;
        }
        self.usb.pop_front();
        Some(signal)
    }

    fn usb_answer(&mut self, now: Cycles, answer: UsbAnswer) {
        self.log.push((now, Seen::Usb(answer)));
    }

    fn observe(&mut self, now: Cycles, event: ChipEvent) {
        self.log.push((now, Seen::Chip(event)));
    }
}

pub type TestChip = Chip<ScriptedBoard>;

/// A chip as the boot monitor leaves it, with all peripheral clocks on and an empty log.
pub fn running_chip() -> TestChip {
    chip_with(TimingProfile::nominal(), Errata::NONE)
}

/// The same chip with another timing.
pub fn running_chip_with(timing: TimingProfile) -> TestChip {
    chip_with(timing, Errata::NONE)
}

/// The same chip with faults of the silicon.
pub fn faulty_chip(errata: Errata) -> TestChip {
    chip_with(TimingProfile::nominal(), errata)
}

fn chip_with(timing: TimingProfile, errata: Errata) -> TestChip {
    let board = ScriptedBoard {
        slave_address: 1,
        ..ScriptedBoard::default()
    };
    let configuration = ChipConfiguration {
        timing,
        errata,
        ..ChipConfiguration::default()
    };
    let mut chip = Chip::new(board, configuration);
    chip.enter_as_boot_monitor();
    write(&mut chip, PCER, 0xFFFF_FFFF);
    chip.board_mut().log.clear();
    chip
}

/// A chip at power-on.
pub fn cold_chip() -> TestChip {
    Chip::new(ScriptedBoard::default(), ChipConfiguration::default())
}

pub fn write(chip: &mut TestChip, address: u32, value: u32) {
    try_write(chip, address, Width::Word, value).expect("write aborted");
}

pub fn read(chip: &mut TestChip, address: u32) -> u32 {
    try_read(chip, address, Width::Word).expect("read aborted")
}

pub fn try_write(chip: &mut TestChip, address: u32, width: Width, value: u32) -> Result<(), Abort> {
    chip.write(address, width, value, Cycle::Nonsequential)
}

pub fn try_read(chip: &mut TestChip, address: u32, width: Width) -> Result<u32, Abort> {
    chip.read(address, width, Cycle::Nonsequential)
}

/// Internal cycles until `cycles`.
pub fn run_to(chip: &mut TestChip, cycles: Cycles) {
    assert!(chip.now() <= cycles, "already at {}", chip.now());
    while chip.now() < cycles {
        chip.internal(1);
    }
}

/// Cycles of so many periods of the slow clock.
pub fn slow(periods: u64) -> u64 {
    periods * 336_384_000 / (7 * 32_768)
}

/// Poll a register until some of the bits are set; panics after 100 000 polls.
pub fn wait_for(chip: &mut TestChip, address: u32, bits: u32) -> u32 {
    for _ in 0..100_000 {
        let value = read(chip, address);
        if value & bits != 0 {
            return value;
        }
    }
    panic!("no bit of {bits:#x} in {address:#x} was set");
}

/// The log without pin changes and chip events, relative to `start`.
pub fn bus_log(chip: &TestChip, start: Cycles) -> Vec<(Cycles, Seen)> {
    let on_bus = |seen: &Seen| !matches!(seen, Seen::Pins { .. } | Seen::Chip(_));
    let log = chip.board().log.iter();
    log.filter(|(_, seen)| on_bus(seen))
        .map(|(at, s)| (at - start, s.clone()))
        .collect()
}

/// The same without times.
pub fn bus_sequence(chip: &TestChip) -> Vec<Seen> {
    let log = bus_log(chip, 0).into_iter();
    log.map(|(_, seen)| seen).collect()
}

/// Only the chip events of the log.
pub fn chip_events(chip: &TestChip) -> Vec<(Cycles, ChipEvent)> {
    let pick = |(at, seen): &(Cycles, Seen)| match seen {
        Seen::Chip(event) => Some((*at, event.clone())),
        _ => None,
    };
    chip.board().log.iter().filter_map(pick).collect()
}
