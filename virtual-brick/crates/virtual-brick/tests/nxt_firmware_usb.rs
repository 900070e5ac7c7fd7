// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The brick's own firmware 1.29 (Debian package `nxt-firmware`) on a USB cable: a host
//! enumerates it and speaks the LEGO MINDSTORMS NXT communication protocol with it.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::VecDeque;

use arm7tdmi::Cpu;
use at91sam7s::board::{
    Board, ChipEvent, Cycles, PinLevels, PinOutputs, SoundBits, TwiReply, UsbAnswer, UsbPacket,
    UsbSignal, UsbTransaction,
};
use at91sam7s::{Chip, ChipConfiguration};
use nxt::{BoardEventKind, NxtBoard};
use virtual_brick::Configuration;

const IMAGE: &str = "/usr/share/nxt-firmware/nxt_firmware.bin";
const MILLISECOND: Cycles = 48_055;
/// Pull-up of the USB, on while the pin is low.
const PULL_UP: u32 = 1 << 16;
/// Analogue input that senses the cable's 5 V.
const CABLE: u8 = 4;
/// The host tries again after this long when the device is not ready.
const RETRY: Cycles = MILLISECOND / 5;
const ADDRESS: u8 = 9;

/// What the host does in turn.
#[derive(Clone, Copy, Debug)]
enum Step {
    Reset,
    Setup(u8, [u8; 8]),
    In(u8, u8),
    Out(u8, u8, UsbPacket),
}

/// The brick's board with a USB host at the end of its cable and an ear at its sound line.
struct Cabled {
    board: NxtBoard,
    pulled_up: bool,
    steps: VecDeque<Step>,
    due: Cycles,
    answers: Vec<UsbAnswer>,
    sound: Vec<(Cycles, SoundBits)>,
}

impl Cabled {
    fn signal(step: Step) -> UsbSignal {
        let (address, endpoint, transaction) = match step {
            Step::Reset => return UsbSignal::Reset,
            Step::Setup(address, request) => (address, 0, UsbTransaction::Setup(request)),
            Step::In(address, endpoint) => (address, endpoint, UsbTransaction::In),
            Step::Out(address, endpoint, data) => (address, endpoint, UsbTransaction::Out(data)),
        };
        UsbSignal::Transaction {
            address,
            endpoint,
            transaction,
        }
    }
}

impl Board for Cabled {
    fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs) {
        self.pulled_up = outputs.driven & !outputs.level & PULL_UP != 0;
        self.board.outputs_changed(now, outputs);
    }
    fn pin_levels(&self) -> PinLevels {
        self.board.pin_levels()
    }
    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        self.board.twi_start(now, address, read)
    }
    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply {
        self.board.twi_write(now, byte)
    }
    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles) {
        self.board.twi_read(now)
    }
    fn twi_stop(&mut self, now: Cycles) {
        self.board.twi_stop(now);
    }
    fn spi_frame(&mut self, now: Cycles, select: u8, frame: u16, bits: u8) -> u16 {
        self.board.spi_frame(now, select, frame, bits)
    }
    fn analogue_input(&mut self, now: Cycles, channel: u8) -> u16 {
        if channel == CABLE {
            return 800;
        }
        self.board.analogue_input(now, channel)
    }
    fn next_event(&self) -> Cycles {
        let host = if self.steps.is_empty() {
            Cycles::MAX
        } else {
            self.due
        };
        self.board.next_event().min(host)
    }
    fn advance(&mut self, now: Cycles) {
        self.board.advance(now);
    }
    fn powered(&self) -> bool {
        self.board.powered()
    }
    fn observe(&mut self, now: Cycles, event: ChipEvent) {
        self.board.observe(now, event);
    }
    fn sound_bits(&mut self, now: Cycles, sound: SoundBits) {
        self.sound.push((now, sound));
    }
    fn usb_signal(&mut self, now: Cycles) -> Option<UsbSignal> {
        let step = *self.steps.front().filter(|_| self.due <= now)?;
        self.due = now + RETRY;
        if !self.pulled_up {
            return None;
        }
        if matches!(step, Step::Reset) {
            self.steps.pop_front();
        }
        Some(Self::signal(step))
    }
    fn usb_answer(&mut self, _now: Cycles, answer: UsbAnswer) {
        if answer != UsbAnswer::NotReady {
            self.steps.pop_front();
            self.answers.push(answer);
        }
    }
}

/// The firmware on a brick that hangs on a cable.
struct Brick {
    cpu: Cpu,
    chip: Chip<Cabled>,
}

impl Brick {
    /// Running its menu; nothing, with the reason printed, where the package is not installed.
    fn at_the_menu() -> Option<Self> {
        let Ok(image) = std::fs::read(IMAGE) else {
            eprintln!("skipped: {IMAGE} is absent (Debian package nxt-firmware)");
            return None;
        };
        let json = include_str!("support/vehicle.json");
        let configuration = Configuration::from_json(json).unwrap();
        let board = NxtBoard::new(&configuration.board, &configuration.robot, 1).unwrap();
        let board = Cabled {
            board,
            pulled_up: false,
            steps: VecDeque::new(),
            due: 0,
            answers: Vec::new(),
            sound: Vec::new(),
        };
        let mut chip = Chip::new(board, ChipConfiguration::default());
        chip.load(0x0010_0000, &image).unwrap();
        let mut brick = Self {
            cpu: Cpu::new(),
            chip,
        };
        brick.run(7_500);
        Some(brick)
    }

    fn run(&mut self, milliseconds: u64) {
        let end = self.chip.now() + milliseconds * MILLISECOND;
        while self.chip.now() < end {
            self.cpu.step(&mut self.chip);
            assert!(
                self.chip.fault().is_none(),
                "{}",
                self.chip.fault().unwrap()
            );
        }
    }

    /// Let the host do these steps; the answers of the device.
    fn host(&mut self, steps: &[Step]) -> Vec<UsbAnswer> {
        let board = self.chip.board_mut();
        board.answers.clear();
        board.steps.extend(steps);
        for _ in 0..500 {
            self.run(1);
            if self.chip.board().steps.is_empty() {
                self.run(2);
                return self.chip.board().answers.clone();
            }
        }
        panic!(
            "the device is never ready for {:?}",
            self.chip.board().steps
        );
    }

    /// A control transfer that reads; all bytes that came.
    fn read_control(&mut self, address: u8, request: [u8; 8]) -> Vec<u8> {
        let packets = usize::from(request[6]).div_ceil(8);
        let mut steps = vec![Step::Setup(address, request)];
        steps.extend(vec![Step::In(address, 0); packets]);
        steps.push(Step::Out(address, 0, UsbPacket::EMPTY));
        let answers = self.host(&steps);
        assert_eq!(answers.first(), Some(&UsbAnswer::Acknowledged));
        assert_eq!(answers.last(), Some(&UsbAnswer::Acknowledged));
        bytes(&answers)
    }

    /// A control transfer without data.
    fn write_control(&mut self, address: u8, request: [u8; 8]) {
        let answers = self.host(&[Step::Setup(address, request), Step::In(address, 0)]);
        let expected = [UsbAnswer::Acknowledged, UsbAnswer::Data(UsbPacket::EMPTY)];
        assert_eq!(answers, expected);
    }

    fn enumerate(&mut self) -> Vec<u8> {
        self.host(&[Step::Reset]);
        self.run(20);
        self.write_control(0, [0x00, 5, ADDRESS, 0, 0, 0, 0, 0]);
        let descriptor = self.read_control(ADDRESS, [0x80, 6, 0, 1, 0, 0, 18, 0]);
        self.write_control(ADDRESS, [0x00, 9, 1, 0, 0, 0, 0, 0]);
        descriptor
    }

    fn command(&mut self, telegram: &[u8]) {
        let data = UsbPacket::new(telegram).unwrap();
        let answers = self.host(&[Step::Out(ADDRESS, 1, data)]);
        assert_eq!(answers, [UsbAnswer::Acknowledged]);
    }

    fn ask(&mut self, telegram: &[u8]) -> Vec<u8> {
        self.command(telegram);
        let answers = self.host(&[Step::In(ADDRESS, 2)]);
        bytes(&answers)
    }
}

fn bytes(answers: &[UsbAnswer]) -> Vec<u8> {
    let data = |answer: &UsbAnswer| match answer {
        UsbAnswer::Data(packet) => packet.data().to_vec(),
        _ => Vec::new(),
    };
    answers.iter().flat_map(data).collect()
}

/// Little-endian number in a reply.
fn number(reply: &[u8]) -> i32 {
    let fold = |value, byte: &u8| value << 8 | i32::from(*byte);
    reply.iter().rev().fold(0, fold)
}

fn enumerates(brick: &mut Brick) {
    let descriptor = brick.enumerate();
    assert_eq!(descriptor.len(), 18);
    assert_eq!(descriptor[..2], [18, 1]);
    assert_eq!(number(&descriptor[8..10]), 0x0694, "LEGO");
    assert_eq!(number(&descriptor[10..12]), 0x0002, "NXT");
}

fn tells_of_itself(brick: &mut Brick) {
    let version = brick.ask(&[0x01, 0x88]);
    assert_eq!(
        version,
        [0x02, 0x88, 0, 124, 1, 29, 1],
        "protocol 1.124, 1.29"
    );
    let information = brick.ask(&[0x01, 0x9B]);
    assert_eq!(information[..7], *b"\x02\x9B\0NXT\0");
    let battery = brick.ask(&[0x00, 0x0B]);
    let millivolts = number(&battery[3..5]);
    assert!(
        (7_950..8_050).contains(&millivolts),
        "{millivolts} mV of 8 V"
    );
}

/// Motor B at 60 % with brake and without regulation, for 1.5 s.
fn drives_a_motor(brick: &mut Brick) {
    brick.chip.board_mut().board.take_events();
    brick.command(&[0x80, 0x04, 1, 60, 0x03, 0, 0, 0x20, 0, 0, 0, 0]);
    brick.run(1_500);
    let events = brick.chip.board_mut().board.take_events();
    let commands = events.into_iter().filter_map(|event| match event.kind {
        BoardEventKind::MotorCommand { motor, duty, brake } => Some((motor.letter(), duty, brake)),
        _ => None,
    });
    assert_eq!(commands.collect::<Vec<_>>(), [("B", 60, true)]);
    let state = brick.ask(&[0x00, 0x06, 1]);
    let degrees = number(&state[21..25]);
    assert!((500..1_200).contains(&degrees), "turned {degrees} degrees");
}

/// A tone of 440 Hz for 500 ms: one period is 16 words of 32 bits.
fn plays_a_tone(brick: &mut Brick) {
    brick.command(&[0x80, 0x03, 0xB8, 0x01, 0xF4, 0x01]);
    brick.run(700);
    let sound = &brick.chip.board().sound;
    let clock_hz = 336_384_000.0 / 7.0;
    let bit_cycles = sound[0].1.bit_cycles;
    assert!(sound.iter().all(|(_, bits)| bits.bit_cycles == bit_cycles));
    let pitch_hz = clock_hz / (16.0 * 32.0 * bit_cycles as f64);
    assert!((pitch_hz - 440.0).abs() < 3.0, "{pitch_hz} Hz");
    let duration = (sound.len() as u64 * 32 * bit_cycles) as f64 / clock_hz;
    assert!((duration - 0.5).abs() < 0.01, "{duration} s");
    let ones: u32 = sound.iter().map(|(_, sound)| sound.bits.count_ones()).sum();
    assert!(ones > 0, "not silence");
}

#[test]
fn a_host_on_the_cable_enumerates_the_firmware_and_commands_it() {
    let Some(mut brick) = Brick::at_the_menu() else {
        return;
    };
    enumerates(&mut brick);
    tells_of_itself(&mut brick);
    drives_a_motor(&mut brick);
    plays_a_tone(&mut brick);
}
