// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The brick's own firmware 1.29 (Debian package `nxt-firmware`) on a USB cable: a host
//! enumerates it and speaks the LEGO MINDSTORMS NXT communication protocol with it.

use crate::support::elf::ElfBuilder;
use crate::support::vehicle;
use nxt::{UsbRequest, UsbTransfer};
use trace::EventKind;
use virtual_brick::{StopReason, VirtualBrick};

const IMAGE: &str = "/usr/share/nxt-firmware/nxt_firmware.bin";
const FLASH: u32 = 0x0010_0000;
const MILLISECOND: u64 = 48_055;
/// The menu stands well before this.
const MENU_MS: u64 = 3_000;
const ADDRESS: u8 = 9;
/// Samples of the sound in a second: 1,000 cycles each.
const SAMPLES_HZ: f64 = 336_384_000.0 / 7.0 / 1_000.0;

/// The firmware on a brick that hangs on a cable.
struct Brick {
    brick: VirtualBrick,
    transfers: u64,
}

impl Brick {
    /// Running its menu; nothing, with the reason printed, where the package is not installed.
    fn at_the_menu() -> Option<Self> {
        let Ok(image) = std::fs::read(IMAGE) else {
            eprintln!("skipped: {IMAGE} is absent (Debian package nxt-firmware)");
            return None;
        };
        let elf = ElfBuilder::new(FLASH).segment(FLASH, &image).build();
        let mut brick = VirtualBrick::new(&vehicle(), &elf).unwrap();
        brick.schedule_input(0, "usb.plugged", 1.0).unwrap();
        let mut brick = Self {
            brick,
            transfers: 0,
        };
        brick.run(MENU_MS);
        assert!(brick.brick.usb_attached());
        Some(brick)
    }

    fn run(&mut self, milliseconds: u64) {
        let end = self.brick.cycles() + milliseconds * MILLISECOND;
        let stop = self.brick.run_until(end);
        assert_eq!(stop.reason, StopReason::Reached, "{}", stop.message);
    }

    /// Let the host make a transfer; the bytes that came.
    fn transfer(&mut self, request: UsbRequest) -> Vec<u8> {
        self.transfers += 1;
        let transfer = UsbTransfer {
            at_cycles: self.brick.cycles(),
            id: self.transfers,
            timeout_cycles: 500 * MILLISECOND,
            request,
        };
        self.brick.usb_transfer(transfer).unwrap();
        for _ in 0..=500 {
            self.run(1);
            if let [completion] = &self.brick.usb_completed()[..] {
                assert_eq!(completion.id, self.transfers);
                return completion.result.clone().unwrap();
            }
        }
        panic!("the host forgot the transfer");
    }

    fn control(&mut self, setup: [u8; 8]) -> Vec<u8> {
        let data = Vec::new();
        self.transfer(UsbRequest::Control { setup, data })
    }

    fn enumerate(&mut self) -> Vec<u8> {
        self.transfer(UsbRequest::Reset);
        self.run(20);
        self.control([0x00, 5, ADDRESS, 0, 0, 0, 0, 0]);
        let descriptor = self.control([0x80, 6, 0, 1, 0, 0, 18, 0]);
        self.control([0x00, 9, 1, 0, 0, 0, 0, 0]);
        descriptor
    }

    fn command(&mut self, telegram: &[u8]) {
        let data = telegram.to_vec();
        self.transfer(UsbRequest::Out { endpoint: 1, data });
    }

    fn ask(&mut self, telegram: &[u8]) -> Vec<u8> {
        self.command(telegram);
        let length = 64;
        self.transfer(UsbRequest::In {
            endpoint: 2,
            length,
        })
    }
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
    brick.command(&[0x80, 0x04, 1, 60, 0x03, 0, 0, 0x20, 0, 0, 0, 0]);
    brick.run(1_500);
    let events = brick.brick.trace().events().iter();
    let commands = events.filter(|event| event.kind == EventKind::MotorCommand);
    let last = commands.last().unwrap();
    assert_eq!((last.subject, last.value), (1, 60 + 256), "60 %, braked");
    let state = brick.ask(&[0x00, 0x06, 1]);
    let degrees = number(&state[21..25]);
    assert!((500..1_200).contains(&degrees), "turned {degrees} degrees");
}

/// The strongest of the whole frequencies in a range.
fn loudest(sound: &[i16], lowest_hz: u32, highest_hz: u32) -> f64 {
    let power = |hertz: u32| {
        let turn = std::f64::consts::TAU * f64::from(hertz) / SAMPLES_HZ;
        let add = |(c, s): (f64, f64), (number, sample): (usize, &i16)| {
            let (sine, cosine) = (turn * number as f64).sin_cos();
            (
                c + cosine * f64::from(*sample),
                s + sine * f64::from(*sample),
            )
        };
        let (c, s) = sound.iter().enumerate().fold((0.0, 0.0), add);
        c * c + s * s
    };
    let powers = (lowest_hz..=highest_hz).map(|hertz| (hertz, power(hertz)));
    let best = powers.max_by(|(_, a), (_, b)| a.total_cmp(b));
    best.map_or(0.0, |(hertz, _)| f64::from(hertz))
}

/// A tone of 440 Hz for 500 ms.
fn plays_a_tone(brick: &mut Brick) {
    let start = brick.brick.cycles();
    brick.command(&[0x80, 0x03, 0xB8, 0x01, 0xF4, 0x01]);
    brick.run(700);
    let sound = brick.brick.sound(start);
    let heard: Vec<_> = sound.iter().enumerate().filter(|(_, s)| **s != 0).collect();
    let (first, last) = (heard[0].0, heard[heard.len() - 1].0);
    let duration = (last - first) as f64 / SAMPLES_HZ;
    assert!((duration - 0.5).abs() < 0.01, "{duration} s");
    let pitch_hz = loudest(&sound[first..last], 400, 480);
    assert!((pitch_hz - 440.0).abs() < 3.0, "{pitch_hz} Hz");
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
