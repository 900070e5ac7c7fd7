// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The Bluetooth module at its lines and in the air.

use crate::common::{milliseconds, Rig};
use at91sam7s::board::{Board, Character, Cycles, PinOutputs, SerialPort};
use nxt::{AirMessage, AirSignal, BluetoothAddress, BluetoothDevice, BluetoothText};

const RESET: u32 = 1 << 11;
const RXD: u32 = 1 << 21;
const RTS: u32 = 1 << 24;
const CTS: u32 = 1 << 25;
const WANTS_STREAM: u32 = 1 << 27;
const MODE_CHANNEL: u8 = 6;
const CHARACTER: Cycles = 1_040;
const PEER: BluetoothAddress = BluetoothAddress([0xA0, 1, 2, 3, 4, 5]);
const KNOWN: &str = r#"{"bluetooth": {"address": "00:16:53:0A:0B:0C", "name": "Rover",
    "known": [{"address": "A0:01:02:03:04:05", "name": "host"}]}}"#;

/// A board and a program that listens at the module's serial line.
struct Program {
    rig: Rig,
    received: Vec<u8>,
}

impl Program {
    fn new(configuration: &str) -> Self {
        let mut program = Self {
            rig: Rig::new(configuration, "{}", 1),
            received: Vec::new(),
        };
        program.lines(true, false, true);
        program
    }

    /// After the reset indication.
    fn started(configuration: &str) -> Self {
        let mut program = Self::new(configuration);
        program.run(milliseconds(600));
        assert_eq!(program.messages(), [(0x14, vec![])]);
        program
    }

    fn lines(&mut self, out_of_reset: bool, wants_stream: bool, ready: bool) {
        let on = |wish, pin| if wish { pin } else { 0 };
        let level = on(out_of_reset, RESET) | on(wants_stream, WANTS_STREAM) | on(!ready, RTS);
        let driven = RESET | WANTS_STREAM | RTS;
        let outputs = PinOutputs {
            driven,
            level,
            pull_up: 0,
        };
        self.rig.board.outputs_changed(self.rig.now, outputs);
    }

    fn run(&mut self, cycles: Cycles) {
        let end = self.rig.now + cycles;
        while self.rig.board.next_event() <= end {
            self.rig.now = self.rig.board.next_event();
            self.rig.board.advance(self.rig.now);
            let character = self
                .rig
                .board
                .serial_received(self.rig.now, SerialPort::Usart1);
            self.received.extend(character.map(|c| c.data as u8));
        }
        self.rig.now = end;
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.run(CHARACTER);
            let character = Character {
                data: u16::from(*byte),
                bit_cycles: 104,
            };
            let now = self.rig.now;
            self.rig
                .board
                .serial_sent(now, SerialPort::Usart1, character);
        }
    }

    fn command(&mut self, code: u8, arguments: &[u8]) {
        let body: Vec<u8> = [code].iter().chain(arguments).copied().collect();
        let sum = body
            .iter()
            .fold(0_u16, |sum, b| sum.wrapping_add(u16::from(*b)));
        self.write(&[body.len() as u8 + 2]);
        self.write(&body);
        self.write(&sum.wrapping_neg().to_be_bytes());
    }

    /// Messages since the last call: code and arguments, sums checked.
    fn messages(&mut self) -> Vec<(u8, Vec<u8>)> {
        let mut bytes = std::mem::take(&mut self.received);
        let mut messages = Vec::new();
        while let Some(length) = bytes.first().map(|length| usize::from(*length)) {
            let frame: Vec<u8> = bytes.drain(..=length).collect();
            let (body, check) = frame.split_at(length - 1);
            let sum = body
                .iter()
                .fold(0_u16, |sum, b| sum.wrapping_add(u16::from(*b)));
            assert_eq!(check, sum.wrapping_neg().to_be_bytes());
            messages.push((body[1], body[2..].to_vec()));
        }
        messages
    }

    fn ask(&mut self, code: u8, arguments: &[u8]) -> Vec<(u8, Vec<u8>)> {
        self.command(code, arguments);
        self.run(milliseconds(20));
        self.messages()
    }

    /// A signal of the other device comes.
    fn hear(&mut self, signal: AirSignal) {
        let at_cycles = self.rig.now;
        let peer = PEER;
        let module = self.rig.board.bluetooth_mut();
        assert!(module.schedule(AirMessage {
            at_cycles,
            peer,
            signal
        }));
        self.run(milliseconds(20));
    }

    fn sent(&mut self) -> Vec<AirSignal> {
        let sent = self.rig.board.bluetooth_mut().take_sent();
        assert!(sent.iter().all(|message| message.peer == PEER));
        sent.into_iter().map(|message| message.signal).collect()
    }

    fn stream_mode(&mut self) -> bool {
        self.rig.board.analogue_input(self.rig.now, MODE_CHANNEL) > 512
    }

    /// A connection through the port, opened by a paired device, in the stream mode.
    fn streaming(configuration: &str) -> Self {
        let mut program = Self::started(configuration);
        program.ask(0x03, &[]);
        program.hear(page(None));
        program.ask(0x09, &[1]);
        program.sent();
        program.command(0x0B, &[0]);
        program.run(milliseconds(20));
        assert!(program.stream_mode());
        program.lines(true, true, true);
        program
    }
}

fn text(text: &str) -> BluetoothText {
    text.parse().unwrap()
}

fn host() -> BluetoothDevice {
    BluetoothDevice {
        address: PEER,
        name: text("host"),
        class: [0, 0, 1, 4],
    }
}

fn page(pin: Option<&str>) -> AirSignal {
    AirSignal::Page {
        device: host(),
        pin: pin.map(text),
    }
}

fn address(tail: &[u8]) -> Vec<u8> {
    [0xA0, 1, 2, 3, 4, 5, 0]
        .iter()
        .chain(tail)
        .copied()
        .collect()
}

#[test]
fn the_reset_indication_comes_after_reset_and_waits_for_the_chip() {
    let mut program = Program::new("{}");
    program.lines(false, false, true);
    program.run(milliseconds(1_000));
    assert!(program.received.is_empty());
    let held_back = |program: &Program| program.rig.board.pin_levels().level & CTS != 0;
    assert!(held_back(&program));
    program.lines(true, false, false);
    program.run(milliseconds(1_000));
    assert!(program.received.is_empty(), "RTS is high");
    assert!(!held_back(&program));
    program.lines(true, false, true);
    program.run(milliseconds(1));
    assert_eq!(program.received, [0x03, 0x14, 0xFF, 0xE9]);
    assert_ne!(program.rig.board.pin_levels().driven & RXD, 0);
}

#[test]
fn it_reports_address_name_version_and_settings() {
    let mut program = Program::started(KNOWN);
    let address = vec![0x00, 0x16, 0x53, 0x0A, 0x0B, 0x0C, 0];
    assert_eq!(program.ask(0x27, &[]), [(0x28, address)]);
    assert_eq!(program.ask(0x29, &[]), [(0x2C, text("Rover").0.to_vec())]);
    assert_eq!(program.ask(0x2F, &[]), [(0x30, vec![1, 1])]);
    assert_eq!(program.ask(0x33, &[]), [(0x31, vec![0, 0])]);
    assert_eq!(program.ask(0x34, &[1, 7]), [(0x32, vec![0x50])]);
    assert_eq!(program.ask(0x33, &[]), [(0x31, vec![1, 7])]);
    assert_eq!(program.ask(0x2A, &[]), [(0x2D, vec![1])]);
    assert_eq!(program.ask(0x1C, &[0]), [(0x20, vec![1])]);
    assert_eq!(program.ask(0x2A, &[]), [(0x2D, vec![0])]);
    assert_eq!(program.ask(0x2B, &[]), [(0x2E, vec![0])]);
    assert_eq!(program.ask(0x03, &[]), [(0x1B, vec![1, 0])]);
    assert_eq!(program.ask(0x2B, &[]), [(0x2E, vec![1])]);
    assert_eq!(program.ask(0x1D, &[3]), [(0x1E, vec![1, 0])]);
    assert_eq!(program.ask(0x36, &[1]), [(0x37, vec![1])]);
    assert_eq!(program.ask(0x35, &[]), [(0x37, vec![1])]);
    assert_eq!(program.ask(0x21, &text("other").0), [(0x22, vec![1])]);
    assert_eq!(program.ask(0x29, &[]), [(0x2C, text("other").0.to_vec())]);
    assert_eq!(program.ask(0x25, &[]), [(0x26, vec![])]);
    assert_eq!(program.ask(0x29, &[]), [(0x2C, text("NXT").0.to_vec())]);
}

#[test]
fn the_store_survives_a_reset_and_connections_do_not() {
    let mut program = Program::streaming(KNOWN);
    program.lines(false, false, true);
    assert_eq!(program.sent(), [AirSignal::Close]);
    assert!(!program.stream_mode());
    program.lines(true, false, true);
    program.run(milliseconds(600));
    assert_eq!(program.messages(), [(0x14, vec![])]);
    assert_eq!(program.ask(0x29, &[]), [(0x2C, text("Rover").0.to_vec())]);
    assert_eq!(program.ask(0x38, &[]), [(0x39, vec![0, 0, 0, 0])]);
}

#[test]
fn the_list_of_devices_is_kept_changed_and_dumped() {
    let mut program = Program::started(KNOWN);
    let mut host_bytes = address(&text("host").0);
    host_bytes.extend([0, 0, 8, 4]);
    assert_eq!(program.ask(0x07, &[]), [(0x18, host_bytes), (0x19, vec![])]);
    let mut other = vec![9, 9, 9, 9, 9, 9, 0];
    other.extend(text("other").0);
    other.extend([1, 2, 3, 4]);
    assert_eq!(program.ask(0x05, &other), [(0x17, vec![0x50])]);
    assert_eq!(program.ask(0x06, &address(&[])), [(0x17, vec![0x53])]);
    assert_eq!(program.ask(0x06, &address(&[])), [(0x17, vec![0x54])]);
    assert_eq!(
        program.ask(0x07, &[]),
        [(0x18, other.clone()), (0x19, vec![])]
    );
    for number in 0..29 {
        other[0] = 100 + number;
        assert_eq!(program.ask(0x05, &other), [(0x17, vec![0x50])]);
    }
    other[0] = 99;
    assert_eq!(
        program.ask(0x05, &other),
        [(0x17, vec![0x52])],
        "30 entries"
    );
}

#[test]
fn an_inquiry_finds_the_devices_in_range() {
    let mut program = Program::started("{}");
    program.hear(AirSignal::InRange(host()));
    program.command(0x00, &[10, 0, 2, 0, 0, 0, 0]);
    program.run(milliseconds(3_000));
    let mut result = address(&text("host").0);
    result.extend([0, 0, 1, 4]);
    let expected = [(0x0E, vec![1]), (0x0F, result.clone()), (0x10, vec![])];
    assert_eq!(program.messages(), expected);
    program.command(0x04, &address(&[]));
    program.run(milliseconds(100));
    assert_eq!(program.messages(), [(0x11, result)]);
    program.hear(AirSignal::OutOfRange);
    program.command(0x04, &address(&[]));
    program.run(milliseconds(6_000));
    assert_eq!(program.messages(), [(0x12, address(&[]))]);
    program.command(0x00, &[10, 0, 30, 0, 0, 0, 0]);
    program.run(milliseconds(100));
    assert_eq!(program.messages(), [(0x0E, vec![1])]);
    assert_eq!(program.ask(0x01, &[]), [(0x10, vec![])]);
}

#[test]
fn a_paired_device_connects_and_both_sides_send() {
    let mut program = Program::streaming(KNOWN);
    program.write(b"\x02\x00ab");
    program.run(milliseconds(20));
    assert_eq!(program.sent(), [AirSignal::Data(b"\x02\x00ab".to_vec())]);
    program.hear(AirSignal::Data(b"hello".to_vec()));
    assert_eq!(program.received, b"hello");
}

#[test]
fn an_unknown_device_needs_the_same_pin_code_on_both_sides() {
    for (given, taken) in [("1234", true), ("4321", false)] {
        let mut program = Program::started("{}");
        program.ask(0x03, &[]);
        program.hear(page(Some("1234")));
        assert_eq!(program.messages(), [(0x15, address(&[]))]);
        let answers = program.ask(0x0A, &address(&text(given).0));
        if taken {
            assert_eq!(answers, [(0x1F, vec![]), (0x16, address(&[]))]);
            assert_eq!(program.ask(0x09, &[1]), [(0x13, vec![1, 0])]);
            assert_eq!(program.sent(), [AirSignal::Accept]);
        } else {
            assert_eq!(answers, [(0x1F, vec![]), (0x13, vec![0, 0xFF])]);
            assert_eq!(program.sent(), [AirSignal::Refuse]);
        }
    }
}

#[test]
fn without_an_open_port_or_when_the_program_refuses_nobody_connects() {
    let mut program = Program::started(KNOWN);
    program.hear(page(None));
    assert_eq!(program.sent(), [AirSignal::Refuse]);
    program.ask(0x03, &[]);
    program.hear(page(None));
    assert_eq!(program.messages(), [(0x16, address(&[]))]);
    assert_eq!(program.ask(0x09, &[0]), [(0x13, vec![0, 0xFF])]);
    assert_eq!(program.sent(), [AirSignal::Refuse]);
    program.hear(page(None));
    program.run(milliseconds(31_000));
    let expected = [(0x16, address(&[])), (0x13, vec![0, 0xFF])];
    assert_eq!(program.messages(), expected, "no answer");
}

#[test]
fn a_device_that_gives_up_before_the_answer_is_forgotten_and_may_try_again() {
    let mut program = Program::started(KNOWN);
    program.ask(0x03, &[]);
    for _ in 0..2 {
        program.hear(page(None));
        assert_eq!(program.messages(), [(0x16, address(&[]))]);
        program.hear(AirSignal::Close);
        assert_eq!(program.messages(), [(0x13, vec![0, 0xFF])]);
    }
}

#[test]
fn it_connects_as_client_after_pairing() {
    let mut program = Program::started("{}");
    assert_eq!(program.ask(0x02, &address(&[])), [(0x15, address(&[]))]);
    assert_eq!(program.ask(0x0A, &address(&text("77").0)), [(0x1F, vec![])]);
    let [AirSignal::Page { device, pin }] = program.sent()[..] else {
        panic!("no page");
    };
    assert_eq!(device.name, text("NXT"));
    assert_eq!(pin, Some(text("77")));
    program.hear(AirSignal::Accept);
    assert_eq!(program.messages(), [(0x13, vec![1, 1])]);
    assert_eq!(program.ask(0x38, &[]), [(0x39, vec![0, 1, 0, 0])]);
    assert_eq!(program.ask(0x23, &[1]), [(0x24, vec![0xFF])]);
    assert_eq!(program.ask(0x08, &[1]), [(0x1A, vec![1, 1])]);
    assert_eq!(program.sent(), [AirSignal::Close]);
    assert_eq!(program.ask(0x08, &[1]), [(0x1A, vec![0, 1])]);
}

#[test]
fn a_device_that_is_not_there_is_given_up_after_the_page_time_out() {
    let mut program = Program::started(KNOWN);
    assert_eq!(program.ask(0x02, &address(&[])), []);
    program.run(milliseconds(5_000));
    assert_eq!(program.messages(), []);
    program.run(milliseconds(200));
    assert_eq!(program.messages(), [(0x13, vec![0, 0xFF])]);
}

#[test]
fn the_chip_leaves_stream_mode_and_returns_without_loss() {
    let mut program = Program::streaming(KNOWN);
    program.lines(true, true, false);
    program.hear(AirSignal::Data(b"kept".to_vec()));
    program.lines(true, false, true);
    program.run(milliseconds(20));
    assert!(!program.stream_mode());
    program.hear(AirSignal::Data(b" too".to_vec()));
    assert_eq!(program.ask(0x2F, &[]), [(0x30, vec![1, 1])]);
    program.command(0x0B, &[0]);
    program.run(milliseconds(20));
    program.lines(true, true, true);
    program.run(milliseconds(20));
    assert_eq!(program.received, b"kept too");
}

#[test]
fn the_other_end_closes_and_the_stream_mode_ends() {
    let mut program = Program::streaming(KNOWN);
    program.hear(AirSignal::Close);
    assert!(!program.stream_mode());
    assert_eq!(program.messages(), [], "the chip still wants the stream");
    program.lines(true, false, true);
    program.run(milliseconds(20));
    assert_eq!(program.messages(), [(0x1A, vec![1, 0])]);
}

#[test]
fn heartbeats_come_every_5_seconds_when_requested() {
    let mut program = Program::started("{}");
    program.command(0x0C, &[]);
    program.run(milliseconds(50_003));
    assert_eq!(program.messages(), vec![(0x0D, vec![]); 10]);
}

#[test]
fn a_full_outbox_holds_the_chip_back() {
    let mut program = Program::streaming(KNOWN);
    program.write(&[7; 1_200]);
    let cts = |program: &Program| program.rig.board.pin_levels().level & CTS != 0;
    assert!(cts(&program), "1,200 characters in 26 ms, 635 sent in them");
    program.run(milliseconds(30));
    assert!(!cts(&program));
    let bytes: usize = program
        .sent()
        .iter()
        .map(|signal| match signal {
            AirSignal::Data(bytes) => bytes.len(),
            _ => 0,
        })
        .sum();
    assert_eq!(bytes, 1_200);
}

#[test]
fn an_unknown_message_is_reported_and_garbage_is_not() {
    let mut program = Program::started("{}");
    program.write(&[0x02, 0xFF, 0xFF, 0x04, 0x01, 0x02, 0x03, 0x04]);
    assert_eq!(program.rig.events(), []);
    program.command(0x3A, &[]);
    let events = program.rig.events();
    assert!(format!("{events:?}").contains("BluetoothMessage { code: 58 }"));
}
