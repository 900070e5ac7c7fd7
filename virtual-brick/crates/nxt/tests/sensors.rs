// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Light, sound and ultrasonic sensors, faults of the ports and of the link.

use crate::common::{milliseconds, Rig};
use at91sam7s::board::{Board, Cycles};

const SENSORS: &str = r#"{"sensors": {"1": {"kind": "light"}, "2": {"kind": "sound"},
    "4": {"kind": "ultrasonic"}}}"#;
/// Digital lines of ports 1, 2 and 4.
const LIGHT: (u32, u32) = (1 << 23, 1 << 18);
const SOUND: (u32, u32) = (1 << 28, 1 << 19);
const CLOCK: u32 = 1 << 30;
const DATA: u32 = 1 << 2;
const HALF: Cycles = 2_500;

fn raw(rig: &mut Rig, port: usize) -> u16 {
    rig.run(milliseconds(4));
    rig.words()[port - 1]
}

#[test]
fn more_light_gives_a_lower_count_within_the_published_range() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert_eq!(raw(&mut rig, 1), 900);
    rig.set("light.1", 0.5);
    assert_eq!(raw(&mut rig, 1), 532);
    rig.set("light.1", 1.0);
    assert_eq!(raw(&mut rig, 1), 164);
}

#[test]
fn the_lamp_shows_the_surface_only_while_its_line_is_driven_high() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("light.1.reflectance", 1.0);
    assert_eq!(raw(&mut rig, 1), 900, "pulled up is not driven");
    rig.outputs(LIGHT.0 | LIGHT.1, LIGHT.0);
    let white = raw(&mut rig, 1);
    rig.set("light.1.reflectance", 0.1);
    let black = raw(&mut rig, 1);
    assert_eq!((white, black), (458, 856));
    rig.outputs(LIGHT.0 | LIGHT.1, 0);
    assert_eq!(raw(&mut rig, 1), 900);
}

#[test]
fn the_sound_sensor_is_chosen_by_its_lines() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("sound.2", 80.0);
    rig.set("sound.2.frequency", 100.0);
    assert_eq!(raw(&mut rig, 2), 1023);
    rig.outputs(SOUND.0 | SOUND.1, SOUND.0);
    assert_eq!(raw(&mut rig, 2), 739, "31.6 % of the range");
    rig.outputs(SOUND.0 | SOUND.1, SOUND.1);
    assert_eq!(raw(&mut rig, 2), 988, "19.1 dB less at 100 Hz");
    rig.set("sound.2.frequency", 1000.0);
    assert_eq!(raw(&mut rig, 2), 739, "the weighting is 0 dB at 1 kHz");
    rig.set("sound.2", 95.0);
    assert_eq!(raw(&mut rig, 2), 133, "full scale");
}

#[test]
fn an_unplugged_sensor_leaves_the_line_open() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("light.1", 1.0);
    rig.set("sensor.1.plugged", 0.0);
    assert_eq!(raw(&mut rig, 1), 1023);
    rig.set("sensor.1.plugged", 1.0);
    assert_eq!(raw(&mut rig, 1), 164);
}

/// A master that drives its lines with half periods of 2,500 cycles.
struct Master {
    rig: Rig,
    clock: bool,
    data: Option<bool>,
}

impl Master {
    fn new(power: bool) -> Self {
        let mut rig = Rig::running(SENSORS, "{}");
        let supply = if power { 0x80 } else { 0 };
        rig.send([0, 8, 0, 0, 0, 0, 7, supply]);
        rig.run(milliseconds(60));
        let (clock, data) = (true, Some(true));
        let mut master = Self { rig, clock, data };
        master.put(true, Some(true));
        master
    }

    fn put(&mut self, clock: bool, data: Option<bool>) {
        (self.clock, self.data) = (clock, data);
        let driven = CLOCK | if data.is_some() { DATA } else { 0 };
        let level = if clock { CLOCK } else { 0 } | if data == Some(true) { DATA } else { 0 };
        self.rig.outputs(driven, level);
        self.rig.run(HALF);
    }

    fn data_line(&self) -> bool {
        self.rig.board.pin_levels().level & DATA != 0
    }

    fn pulse(&mut self, data: Option<bool>) -> bool {
        self.put(false, data);
        self.put(true, data);
        let seen = self.data_line();
        self.put(false, data);
        seen
    }

    fn start(&mut self) {
        self.put(true, Some(true));
        self.put(true, Some(false));
        self.put(false, Some(false));
    }

    fn stop(&mut self) {
        self.put(false, Some(false));
        self.put(true, Some(false));
        self.put(true, Some(true));
    }

    fn write_byte(&mut self, byte: u8) -> bool {
        for bit in (0..8).rev() {
            self.pulse(Some(byte >> bit & 1 != 0));
        }
        !self.pulse(None)
    }

    fn read_byte(&mut self, last: bool) -> u8 {
        let byte = (0..8).fold(0, |byte, _| byte << 1 | u8::from(self.pulse(None)));
        self.pulse(Some(last));
        byte
    }

    fn write(&mut self, bytes: &[u8]) -> bool {
        self.start();
        let acknowledged = bytes.iter().all(|&byte| self.write_byte(byte));
        self.stop();
        acknowledged
    }

    /// A write and a pause.
    fn command(&mut self, bytes: &[u8]) -> bool {
        let acknowledged = self.write(bytes);
        self.rig.run(milliseconds(2));
        acknowledged
    }

    /// With STOP, an extra clock pulse and START between register and data.
    fn read(&mut self, register: u8, count: usize) -> Option<Vec<u8>> {
        if !self.write(&[0x02, register]) {
            return None;
        }
        self.pulse(Some(true));
        self.start();
        if !self.write_byte(0x03) {
            return None;
        }
        let bytes = (1..=count).map(|number| self.read_byte(number == count));
        let bytes = bytes.collect();
        self.put(true, Some(true));
        Some(bytes)
    }
}

#[test]
fn the_ultrasonic_sensor_identifies_itself() {
    let mut master = Master::new(true);
    assert_eq!(master.read(0x00, 8).unwrap(), b"V1.0\0\0\0\0");
    assert_eq!(master.read(0x08, 8).unwrap(), b"LEGO\0\0\0\0");
    assert_eq!(master.read(0x10, 8).unwrap(), b"Sonar\0\0\0");
    assert_eq!(master.read(0x11, 3).unwrap(), [0, 1, 14]);
    assert_eq!(master.read(0x14, 7).unwrap(), b"10E-2m\0");
}

#[test]
fn distances_come_in_centimetres_30_ms_after_the_command() {
    let mut master = Master::new(true);
    master.rig.set("distance.4", 1.239);
    assert!(master.command(&[0x02, 0x41, 1]));
    assert_eq!(master.read(0x42, 1).unwrap(), [255]);
    master.rig.run(milliseconds(30));
    assert_eq!(master.read(0x42, 2).unwrap(), [123, 255]);
    master.rig.set("distance.4", 0.5);
    master.rig.run(milliseconds(40));
    assert_eq!(master.read(0x42, 1).unwrap(), [123], "one ping only");
    assert!(master.command(&[0x02, 0x41, 2]));
    for (distance, reading) in [(0.5, 50), (0.0, 0), (2.54, 254), (2.6, 255), (100.0, 255)] {
        master.rig.set("distance.4", distance);
        master.rig.run(milliseconds(35));
        assert_eq!(master.read(0x42, 1).unwrap(), [reading], "{distance} m");
    }
}

#[test]
fn the_calibration_scales_the_readings() {
    let mut master = Master::new(true);
    master.rig.set("distance.4", 0.5);
    assert!(master.command(&[0x02, 0x4A, 3, 2, 14]));
    assert_eq!(master.read(0x50, 3).unwrap(), [3, 2, 14]);
    master.rig.run(milliseconds(35));
    assert_eq!(master.read(0x42, 1).unwrap(), [103]);
}

#[test]
fn modes_are_kept_and_a_warm_reset_leaves_it_off() {
    let mut master = Master::new(true);
    assert_eq!(master.read(0x41, 1).unwrap(), [2], "continuous by default");
    for (command, mode) in [(0, 0), (1, 1), (3, 3), (4, 0)] {
        assert!(master.command(&[0x02, 0x41, command]));
        assert_eq!(master.read(0x41, 1).unwrap(), [mode]);
    }
}

#[test]
fn without_9_volts_it_answers_and_hears_no_echo() {
    for (power, echo) in [(false, 255), (true, 100)] {
        let mut master = Master::new(power);
        master.rig.set("distance.4", 1.0);
        master.rig.run(milliseconds(60));
        assert_eq!(master.read(0x42, 1), Some(vec![echo]));
    }
}

#[test]
fn unplugged_or_addressed_otherwise_it_does_not_answer() {
    let mut master = Master::new(true);
    assert!(!master.write(&[0x04, 0x41, 2]));
    assert!(master.command(&[0x02, 0x41, 1]));
    master.rig.set("sensor.4.plugged", 0.0);
    assert!(!master.command(&[0x02, 0x41, 1]));
    master.rig.set("sensor.4.plugged", 1.0);
    assert_eq!(master.read(0x41, 1).unwrap(), [2], "it starts anew");
}

#[test]
fn a_start_without_stop_and_a_stop_without_clock_are_ignored() {
    let mut master = Master::new(true);
    master.start();
    assert!(master.write_byte(0x02) && master.write_byte(0x42));
    master.put(false, Some(true));
    master.start();
    assert!(!master.write_byte(0x03));
    master.stop();
    assert!(master.write(&[0x02, 0x42]));
    master.start();
    assert!(!master.write_byte(0x03));
    master.stop();
    master.rig.run(milliseconds(2));
    assert!(master.write(&[0x02, 0x42]), "digested in the meantime");
}

#[test]
fn a_short_holds_a_line_at_both_ends() {
    let mut master = Master::new(true);
    master.rig.set("fault.4.digital_1_low", 1.0);
    master.rig.outputs(0, 0);
    assert!(!master.data_line());
    assert_eq!(master.rig.board.analogue_input(0, 7), 0);
    master.rig.set("fault.4.digital_1_low", 0.0);
    assert!(master.data_line());
    master.rig.run(milliseconds(2));
    assert!(master.read(0x42, 1).is_some());
}

#[test]
fn as_many_frames_as_requested_have_a_wrong_checksum() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("fault.coprocessor_checksum", 2.0);
    let sum = |bytes: Vec<u8>| bytes.into_iter().fold(0_u8, u8::wrapping_add);
    let sums = [0; 4].map(|_| sum(rig.read(13)));
    assert_eq!(sums.map(|sum| sum == 0xFF), [false, false, true, true]);
}

#[test]
fn a_stuck_co_processor_holds_the_clock_of_the_bus() {
    let mut rig = Rig::running(SENSORS, "{}");
    let clock = |rig: &Rig| rig.board.pin_levels().level & 1 << 4 != 0;
    assert!(clock(&rig));
    rig.set("fault.twi_stuck", 1.0);
    assert!(!clock(&rig));
    let reply = rig.board.twi_start(rig.now, 1, false);
    assert!(reply.stretch_cycles > milliseconds(1_000_000));
    rig.set("fault.twi_stuck", 0.0);
    assert!(clock(&rig));
    assert!(rig.board.twi_start(rig.now, 1, false).stretch_cycles < milliseconds(1));
}
