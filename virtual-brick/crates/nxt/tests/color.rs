// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The colour sensor: reset, mode, calibration, lamps, and what disturbs it.

use crate::common::{milliseconds, Rig};
use at91sam7s::board::{Board, Cycles};

const SENSOR: &str = r#"{"sensors": {"2": {"kind": "color"}}}"#;
/// Digital lines and analogue channel of port 2.
const CLOCK: u32 = 1 << 28;
const DATA: u32 = 1 << 19;
const CHANNEL: u8 = 2;
const MICROSECOND: Cycles = 48;
const FULL: u8 = 13;

/// A brick that speaks with the sensor.
struct Brick {
    rig: Rig,
    half: Cycles,
}

impl Brick {
    fn new() -> Self {
        Self {
            rig: Rig::running(SENSOR, "{}"),
            half: 30 * MICROSECOND,
        }
    }

    fn put(&mut self, clock: bool, data: Option<bool>, time: Cycles) {
        let driven = CLOCK | if data.is_some() { DATA } else { 0 };
        let level = if clock { CLOCK } else { 0 } | if data == Some(true) { DATA } else { 0 };
        self.rig.outputs(driven, level);
        self.rig.run(time);
    }

    fn reset(&mut self, last_low: Cycles) {
        for (clock, time) in [(true, 1), (false, 1), (true, 1)] {
            self.put(clock, Some(true), milliseconds(time));
        }
        self.put(false, Some(true), last_low);
    }

    fn send(&mut self, byte: u8) {
        let mut before = true;
        for bit in 0..8 {
            let data = byte >> bit & 1 != 0;
            self.put(true, Some(before), 2 * MICROSECOND);
            self.put(true, Some(data), self.half - 2 * MICROSECOND);
            self.put(false, Some(data), self.half);
            before = data;
        }
    }

    fn level(&self, pin: u32) -> bool {
        self.rig.board.pin_levels().level & pin != 0
    }

    fn byte(&mut self) -> u8 {
        (0..8).fold(0, |byte, bit| {
            self.put(true, None, 4 * MICROSECOND);
            self.put(false, None, 2 * MICROSECOND);
            let value = self.level(DATA);
            self.rig.run(2 * MICROSECOND);
            byte | u8::from(value) << bit
        })
    }

    fn start(&mut self, mode: u8) -> Vec<u8> {
        self.reset(milliseconds(100));
        self.send(mode);
        (0..54).map(|_| self.byte()).collect()
    }

    fn count(&mut self) -> u16 {
        self.rig.board.analogue_input(self.rig.now, CHANNEL)
    }

    /// Counts without lamp, then with the red, green and blue one.
    fn cycle(&mut self) -> [u16; 4] {
        [true, false, true, false].map(|next| {
            let count = self.count();
            self.put(next, None, 20 * MICROSECOND);
            count
        })
    }
}

/// Remainder of the polynomial x^16 + x^15 + x^2 + 1, lowest bit first, from the bits one by one.
fn remainder(data: &[u8]) -> u16 {
    let mut sum = 0x5AA5_u16;
    for bit in data
        .iter()
        .flat_map(|byte| (0..8).map(move |n| byte >> n & 1))
    {
        let out = sum & 1 ^ u16::from(bit);
        sum >>= 1;
        if out == 1 {
            sum ^= 0xA001;
        }
    }
    sum
}

#[test]
fn it_sends_factors_limits_and_their_sum() {
    let mut brick = Brick::new();
    let bytes = brick.start(FULL);
    let (data, sum) = bytes.split_at(52);
    assert_eq!(remainder(data).to_be_bytes(), sum);
    let word = |n: usize| u32::from_le_bytes(data[4 * n..4 * n + 4].try_into().unwrap());
    assert!((0..12).all(|n| word(n) > 1 << 13 && word(n) < 1 << 18));
    let limit = |n: usize| u16::from_le_bytes([data[48 + 2 * n], data[49 + 2 * n]]);
    assert!(limit(0) > limit(1));
}

#[test]
fn each_edge_lights_the_next_lamp() {
    let mut brick = Brick::new();
    for (name, value) in [("red", 1.0), ("green", 0.5), ("blue", 0.0)] {
        brick.rig.set(&format!("color.2.{name}"), value);
    }
    brick.start(FULL);
    brick.rig.run(milliseconds(1));
    let first = brick.cycle();
    assert_eq!(first, [71, 401, 199, 71]);
    assert_eq!(brick.cycle(), first);
    brick.rig.set("color.2", 0.5);
    let [blank, red, ..] = brick.cycle();
    assert_eq!(blank, 446);
    assert_eq!(red, 446 + 297, "a lamp adds less in a bright room");
}

#[test]
fn a_lamp_needs_time_to_settle() {
    let mut brick = Brick::new();
    brick.rig.set("color.2.red", 1.0);
    brick.start(FULL);
    brick.rig.run(milliseconds(1));
    brick.put(true, None, 5 * MICROSECOND);
    assert_eq!(brick.count(), 71);
    brick.rig.run(15 * MICROSECOND);
    assert_eq!(brick.count(), 401);
}

#[test]
fn a_single_lamp_stays_and_the_sensor_holds_the_clock() {
    for (mode, count) in [(14, 401), (15, 326), (16, 351), (17, 71)] {
        let mut brick = Brick::new();
        for name in ["red", "green", "blue"] {
            brick.rig.set(&format!("color.2.{name}"), 1.0);
        }
        brick.start(mode);
        brick.rig.outputs(0, 0);
        brick.rig.run(milliseconds(3));
        assert!(!brick.level(CLOCK), "mode {mode}");
        assert_eq!(brick.count(), count, "mode {mode}");
    }
}

#[test]
fn without_a_long_low_clock_or_a_known_mode_it_does_not_answer() {
    for (low, mode) in [(50, FULL), (100, 12), (100, 18)] {
        let mut brick = Brick::new();
        brick.reset(milliseconds(low));
        brick.send(mode);
        let bytes: Vec<u8> = (0..54).map(|_| brick.byte()).collect();
        assert!(bytes.iter().all(|&byte| byte == 0xFF), "{low} ms, {mode}");
        brick.rig.outputs(0, 0);
        assert!(brick.level(CLOCK));
    }
    let mut hasty = Brick::new();
    hasty.half = 5 * MICROSECOND;
    assert!(hasty.start(FULL).iter().all(|&byte| byte == 0xFF));
}

#[test]
fn unplugged_it_releases_its_lines_and_replugged_it_waits_for_a_reset() {
    let mut brick = Brick::new();
    brick.start(FULL);
    brick.rig.run(milliseconds(4));
    assert_eq!(brick.rig.words()[1], 12, "it grounds the analogue line");
    brick.rig.set("sensor.2.plugged", 0.0);
    brick.rig.outputs(0, 0);
    brick.rig.run(milliseconds(4));
    assert!(brick.level(CLOCK));
    assert_eq!((brick.rig.words()[1], brick.count()), (1023, 1023));
    brick.rig.set("sensor.2.plugged", 1.0);
    brick.rig.run(milliseconds(4));
    assert!(brick.level(CLOCK));
    assert_eq!(brick.start(FULL).len(), 54);
    brick.rig.outputs(0, 0);
    assert!(!brick.level(CLOCK));
}

#[test]
fn plugged_in_while_the_clock_is_low_it_counts_the_reset_from_then() {
    for (low, starts) in [(100, true), (50, false)] {
        let mut brick = Brick::new();
        brick.rig.set("sensor.2.plugged", 0.0);
        brick.put(false, Some(true), milliseconds(60));
        brick.rig.set("sensor.2.plugged", 1.0);
        brick.rig.run(milliseconds(low));
        brick.send(FULL);
        let answers = (0..54).any(|_| brick.byte() != 0xFF);
        assert_eq!(answers, starts, "{low} ms");
    }
}

#[test]
fn a_corrupt_checksum_is_one_bit_wrong() {
    let mut brick = Brick::new();
    let right = brick.start(FULL);
    brick.rig.set("fault.2.checksum", 1.0);
    let wrong = brick.start(FULL);
    assert_eq!(right[..53], wrong[..53]);
    assert_eq!(right[53] ^ wrong[53], 0x80);
}
