// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Inputs, sensors, buttons, configuration.

use crate::common::{milliseconds, motor, Rig};
use at91sam7s::board::Board;
use nxt::{BoardConfiguration, InputError, NxtBoard};
use plant::RobotParameters;

const SENSORS: &str = r#"{"sensors": {"1": {"kind": "touch"}, "3": {"kind": "analogue"}}}"#;

fn button_word(pressed: &[&str]) -> u16 {
    let mut rig = Rig::running(SENSORS, "{}");
    for button in pressed {
        rig.set(&format!("button.{button}"), 1.0);
    }
    rig.run(milliseconds(4));
    rig.words()[4]
}

fn lego(word: u16) -> &'static str {
    match word {
        0..0x40 => "none",
        0x40..0x100 => "left",
        0x100..0x1FF => "right",
        0x1FF..0x5FF => "grey",
        _ => "orange",
    }
}

fn lejos(word: u16) -> &'static str {
    match word {
        1501.. => "orange",
        721.. => "grey",
        271.. => "right",
        61.. => "left",
        _ => "none",
    }
}

fn nxos(word: u16) -> &'static str {
    if word >= 0x7FF {
        "orange"
    } else {
        lejos(word)
    }
}

fn gnat(word: u16) -> &'static str {
    match word {
        0x7FF.. => "orange",
        0x301.. => "grey",
        0x101.. => "right",
        0x61.. => "left",
        _ => "none",
    }
}

fn frank(word: u16) -> &'static str {
    match word {
        0x701.. => "orange",
        0x281.. => "grey",
        0x91.. => "right",
        0x51.. => "left",
        _ => "none",
    }
}

#[test]
fn each_button_is_understood_by_every_known_decoder() {
    assert_eq!(button_word(&[]), 0);
    for button in ["left", "right", "grey", "orange"] {
        let word = button_word(&[button]);
        for decoder in [lego, lejos, nxos, gnat, frank] {
            assert_eq!(decoder(word), button, "word {word}");
        }
    }
}

#[test]
fn the_orange_button_adds_to_the_ladder() {
    assert_eq!(button_word(&["orange", "left"]), 0x7FF + 128);
    assert_eq!(button_word(&["orange", "grey"]), 0x7FF + 1023);
}

#[test]
fn a_released_button_is_seen_as_released() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("button.grey", 1.0);
    rig.run(milliseconds(4));
    rig.set("button.grey", 0.0);
    rig.run(milliseconds(4));
    assert_eq!(rig.words()[4], 0);
}

#[test]
fn the_touch_sensor_reads_low_while_pressed_and_open_otherwise() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert_eq!(rig.words()[0], 1023);
    rig.set("touch.1", 1.0);
    rig.run(milliseconds(4));
    let pressed = rig.words()[0];
    assert!(pressed < 460 && pressed > 0, "{pressed}");
    rig.set("touch.1", 0.0);
    rig.run(milliseconds(4));
    assert_eq!(rig.words()[0], 1023);
}

#[test]
fn an_analogue_sensor_reads_its_input() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert_eq!(rig.words()[2], 1023);
    rig.set("sensor.3.raw", 417.0);
    rig.run(milliseconds(4));
    assert_eq!(rig.words()[2], 417);
}

#[test]
fn an_unknown_input_lists_those_that_exist() {
    let motor = motor();
    let held = motor.replace("}}", r#"}, "held_by_hand": true, "hand_rate": 4}"#);
    let robot = format!(r#"{{"motors": {{"A": {held}, "B": {motor}}}}}"#);
    let mut rig = Rig::running(SENSORS, &robot);
    let error = rig.board.set_input(0, "touch.2", 1.0).unwrap_err();
    let InputError::UnknownName { valid, .. } = &error else {
        panic!("{error}");
    };
    let wanted = [
        "button.left",
        "button.right",
        "button.orange",
        "button.grey",
        "touch.1",
        "sensor.1.plugged",
        "fault.1.digital_0_low",
        "fault.1.digital_1_low",
        "sensor.3.raw",
        "sensor.3.plugged",
        "fault.3.digital_0_low",
        "fault.3.digital_1_low",
        "motor.A.hand_angle",
        "motor.B.load_torque",
        "battery.voltage",
        "fault.coprocessor_checksum",
        "fault.coprocessor_torn_words",
        "fault.coprocessor_refuses",
        "fault.twi_stuck",
        "usb.plugged",
    ];
    assert_eq!(valid, &wanted);
    let start = "input touch.2: this brick has no such input; it has button.left, ";
    assert!(error.to_string().starts_with(start), "{error}");
}

#[test]
fn values_out_of_range_are_rejected_with_the_range() {
    let mut rig = Rig::running(SENSORS, "{}");
    for (name, value) in [
        ("touch.1", 0.5),
        ("button.left", 2.0),
        ("sensor.3.raw", 1024.0),
        ("sensor.3.raw", -1.0),
        ("battery.voltage", 13.0),
        ("battery.voltage", f64::NAN),
    ] {
        assert!(
            rig.board.check_input(name, value).is_err(),
            "{name} {value}"
        );
        assert!(
            rig.board.set_input(0, name, value).is_err(),
            "{name} {value}"
        );
    }
    assert_eq!(
        rig.board
            .check_input("sensor.3.raw", 2000.0)
            .unwrap_err()
            .to_string(),
        "input sensor.3.raw = 2000: expected a whole number from 0 to 1023"
    );
}

#[test]
fn the_hand_turns_the_joystick_and_the_load_holds_a_motor_back() {
    let motor = motor();
    let held = motor.replace("}}", r#"}, "held_by_hand": true, "hand_rate": 4}"#);
    let robot = format!(r#"{{"motors": {{"A": {held}, "B": {motor}}}}}"#);
    let mut rig = Rig::running(r#"{"battery": {"voltage": 8.0}}"#, &robot);
    rig.set("motor.A.hand_angle", 0.5);
    rig.set("motor.B.load_torque", 0.1);
    rig.drive([0, 50, 0], 2);
    rig.run(milliseconds(300));
    assert_eq!(rig.signal("motor.A.angle"), 0.5);
    assert!((rig.signal("motor.A.encoder") - 0.5_f64.to_degrees()).abs() <= 1.0);
    let speed = rig.signal("motor.B.angular_velocity");
    let free = 8.0 * 62.0 / 125.0 * 2.029;
    assert!(speed > 0.0 && speed < free - 1.0, "{speed}");
}

#[test]
fn configurations_with_unknown_fields_or_bad_numbers_are_rejected() {
    for json in [
        r#"{"battery": {"kind": "coal", "voltage": 8}}"#,
        r#"{"battery": {"voltage": 8, "colour": 1}}"#,
        r#"{"sensors": {"5": {"kind": "touch"}}}"#,
        r#"{"sensors": {"1": {"kind": "compass"}}}"#,
        r#"{"sensors": {"1": {"kind": "touch", "raw": 4}}}"#,
    ] {
        assert!(
            serde_json::from_str::<BoardConfiguration>(json).is_err(),
            "{json}"
        );
    }
    for (json, message) in [
        (
            r#"{"battery": {"voltage": 20}}"#,
            "battery.voltage = 20: expected a number from 5 to 11.8 (V)",
        ),
        (
            r#"{"sensors": {"2": {"kind": "analogue", "raw": 1024}}}"#,
            "sensors.2.raw = 1024: expected an integer from 0 to 1023",
        ),
    ] {
        let configuration = serde_json::from_str(json).unwrap();
        let error = NxtBoard::new(&configuration, &RobotParameters::default(), 1).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}

#[test]
fn analogue_inputs_of_the_chip_follow_pulled_up_lines_and_missing_devices() {
    let mut rig = Rig::running(SENSORS, "{}");
    for (channel, count) in [(1, 1023), (2, 1023), (3, 1023), (7, 1023), (4, 0), (6, 0)] {
        assert_eq!(
            rig.board.analogue_input(0, channel),
            count,
            "channel {channel}"
        );
    }
    rig.outputs(1 << 19, 0);
    assert_eq!(rig.board.analogue_input(0, 2), 0);
}
