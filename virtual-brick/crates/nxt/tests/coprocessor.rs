// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The two-wire link, sampling and the power states of the co-processor.

use crate::common::{milliseconds, three_motors, Rig, HANDSHAKE};
use at91sam7s::board::Board;
use nxt::{BoardEventKind, BoardFault, CoprocessorTiming, PowerOffReason, SensorSupply};
use plant::MotorPort;

const SENSORS: &str = r#"{"battery": {"kind": "li_ion", "voltage": 7.318},
    "sensors": {"1": {"kind": "touch"}, "2": {"kind": "analogue", "raw": 300}}}"#;
const LONGEST_TICK: u64 = 145_000;

fn power_off(rig: &mut Rig) -> Option<(u64, PowerOffReason)> {
    rig.events().into_iter().find_map(|(at, kind)| match kind {
        BoardEventKind::PowerOff(reason) => Some((at, reason)),
        _ => None,
    })
}

#[test]
fn only_slave_1_acknowledges() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert!(rig.board.twi_start(0, 1, false).acknowledged);
    assert!(rig.board.twi_start(0, 1, true).acknowledged);
    for address in (0..128).filter(|&address| address != 1) {
        assert!(
            !rig.board.twi_start(0, address, false).acknowledged,
            "{address}"
        );
        assert!(
            !rig.board.twi_start(0, address, true).acknowledged,
            "{address}"
        );
    }
}

#[test]
fn port_words_are_zero_until_110_ms_after_power_on_but_the_battery_was_measured_before() {
    for seed in 1..20 {
        let mut rig = Rig::new(SENSORS, "{}", seed);
        rig.run_until(milliseconds(107));
        assert_eq!(rig.words(), [0, 0, 0, 0, 0, 0xA610]);
        rig.run_until(milliseconds(112));
        assert_eq!(rig.words(), [1023, 300, 1023, 1023, 0, 0xA610]);
    }
}

#[test]
fn the_battery_word_carries_count_version_and_kind() {
    let mut rig = Rig::running(r#"{"battery": {"kind": "aa", "voltage": 8.008}}"#, "{}");
    assert_eq!(rig.words()[5], 0x2642);
}

#[test]
fn the_battery_word_tells_the_rechargeable_pack_from_cells() {
    let word = |kind| {
        let board = format!(r#"{{"battery": {{"kind": "{kind}", "voltage": 8.008}}}}"#);
        Rig::running(&board, "{}").words()[5]
    };
    assert_eq!(word("li_ion") & !0x8000, word("aa"));
    assert_eq!(word("li_ion") & 0x8000, 0x8000);
}

#[test]
fn reading_beyond_the_frame_repeats_its_last_byte() {
    let mut rig = Rig::running(SENSORS, "{}");
    let bytes = rig.read(16);
    assert_eq!(bytes[13..], [bytes[12]; 3]);
}

#[test]
fn the_frame_read_is_the_state_at_its_start() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert!(rig.board.twi_start(rig.now, 1, true).acknowledged);
    rig.set("touch.1", 1.0);
    rig.run(milliseconds(4));
    let low = rig.board.twi_read(rig.now).0;
    let high = rig.board.twi_read(rig.now).0;
    assert_eq!(u16::from_le_bytes([low, high]), 1023);
    rig.board.twi_stop(rig.now);
    assert_eq!(rig.words()[0], 183);
}

/// The words that a read would give now.
fn peek(rig: &Rig) -> [u16; 6] {
    rig.clone().words()
}

#[test]
fn a_port_is_stored_twice_per_tick_of_about_2_985_ms_57_us_apart() {
    let mut rig = Rig::running(SENSORS, "{}");
    let mut changes = Vec::new();
    let mut last = 300;
    for step in 0..2_000_u16 {
        rig.set("sensor.2.raw", f64::from(step % 1_000));
        rig.run(240);
        let mut probe = rig.clone();
        probe.board.twi_start(probe.now, 1, true);
        let bytes: Vec<_> = (0..4).map(|_| probe.board.twi_read(probe.now).0).collect();
        let word = u16::from_le_bytes([bytes[2], bytes[3]]);
        if word != last {
            changes.push(rig.now);
        }
        last = word;
    }
    let gaps: Vec<_> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.len() >= 4, "{changes:?}");
    for gap in gaps {
        let within = gap.abs_diff(2_739) <= 480;
        assert!(
            within || gap.abs_diff(143_443 - 2_739) <= 2_000,
            "{changes:?}"
        );
    }
}

#[test]
fn ports_are_sampled_one_after_another_within_a_tick() {
    let sensors = r#"{"sensors": {"1": {"kind": "analogue", "raw": 1},
        "4": {"kind": "analogue", "raw": 1}}}"#;
    let mut rig = Rig::running(sensors, "{}");
    rig.set("sensor.1.raw", 2.0);
    rig.set("sensor.4.raw", 2.0);
    let mut seen = Vec::new();
    for _ in 0..400 {
        rig.run(480);
        let words = peek(&rig);
        seen.push((words[0], words[3]));
    }
    seen.dedup();
    assert_eq!(seen, [(1, 1), (2, 1), (2, 2)]);
}

#[test]
fn a_frame_is_accepted_only_with_nine_bytes_and_the_right_checksum() {
    let rig = Rig::running(SENSORS, &three_motors());
    let good: [u8; 9] = [0, 8, 50, 0, 0, 0, 1, 0, !59];
    let duty_after = |frame: &[u8]| {
        let mut rig = rig.clone();
        assert!(rig.write(frame));
        rig.run(milliseconds(4));
        rig.board.motor_command(MotorPort::A).duty
    };
    assert_eq!(duty_after(&good), 50);
    assert_eq!(duty_after(&good[..8]), 0);
    let mut longer = good.to_vec();
    longer.extend([1, 2, 3]);
    assert_eq!(duty_after(&longer), 50);
    for place in 0..9 {
        let mut bad = good;
        bad[place] ^= 0x10;
        assert_eq!(duty_after(&bad), 0, "byte {place}");
    }
}

#[test]
fn a_command_waits_for_the_end_of_a_pass_670_us_if_that_samples() {
    let rig = Rig::running(SENSORS, &three_motors());
    let mut delays = Vec::new();
    for offset in (0..2 * LONGEST_TICK).step_by(701) {
        let mut rig = rig.clone();
        rig.run(offset);
        rig.events();
        rig.drive([0, -30, 0], 0b010);
        let sent = rig.now;
        rig.run(LONGEST_TICK);
        let events = rig.events();
        let expected = BoardEventKind::MotorCommand {
            motor: MotorPort::B,
            duty: -30,
            brake: true,
        };
        let (at, _) = events.iter().find(|(_, kind)| *kind == expected).unwrap();
        delays.push(at - sent);
    }
    delays.sort_unstable();
    let microseconds = |cycles: u64| cycles / 48;
    let longest = microseconds(delays[delays.len() - 1]);
    assert!((650..=680).contains(&longest), "{longest} us");
    // Three quarters of the commands do not meet a sampling.
    assert!(microseconds(delays[delays.len() * 3 / 4]) <= 45);
}

#[test]
fn frames_that_arrive_in_parts_or_doubled_leave_the_last_duty_for_ever() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.drive([70, 0, 0], 1);
    rig.run(milliseconds(4));
    let stop: [u8; 9] = [0, 8, 0, 0, 0, 0, 1, 0, !9];
    for cut in 1..9 {
        rig.write(&stop[..cut]);
        rig.write(&stop[cut..]);
    }
    let mut doubled = vec![stop[0]; 2];
    doubled.extend(&stop[1..8]);
    rig.write(&doubled);
    rig.run_until(milliseconds(20_000));
    assert_eq!(rig.board.motor_command(MotorPort::A).duty, 70);
}

#[test]
fn the_clock_is_held_longest_after_the_address_for_a_read_and_the_end_of_a_frame() {
    let mut rig = Rig::running(SENSORS, "{}");
    let timing = CoprocessorTiming::nominal();
    let base = timing.stretch_cycles;
    let good: [u8; 9] = [0, 8, 0, 0, 0, 0, 1, 0, !9];
    let mut held = |frame: &[u8]| -> Vec<_> {
        let first = rig.board.twi_start(rig.now, 1, false).stretch_cycles;
        let rest = frame
            .iter()
            .map(|&byte| rig.board.twi_write(0, byte).stretch_cycles);
        let all = std::iter::once(first)
            .chain(rest)
            .map(|cycles| cycles - base);
        all.collect()
    };
    let mut expected = [0; 12];
    expected[9] = timing.good_frame_cycles;
    assert_eq!(held(&[&good[..], &[1, 2]].concat()), expected);
    expected[9] = timing.bad_frame_cycles;
    assert_eq!(held(&[&good[..8], &[0, 1, 2]].concat()), expected);
    assert_eq!(held(HANDSHAKE), [0; 48]);
    let address = rig.board.twi_start(rig.now, 1, true).stretch_cycles;
    assert_eq!(address, base + timing.status_copy_cycles);
    let before: Vec<_> = (0..13).map(|_| rig.board.twi_read(0).1).collect();
    assert_eq!(before[0], 0);
    assert_eq!(before[1..], [base; 12]);
    assert_eq!(rig.board.twi_end_of_read(0), base);
}

#[test]
fn a_torn_word_has_the_old_low_byte_and_a_right_sum() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.set("fault.coprocessor_torn_words", 1.0);
    assert_eq!(rig.words()[1], 300);
    rig.set("sensor.2.raw", 513.0);
    let mut words = || loop {
        rig.run(4_800);
        let word = rig.words()[1];
        if word != 300 {
            break word;
        }
    };
    assert_eq!(words(), 513 & 0xFF00 | 300 & 0xFF);
    assert_eq!(rig.words()[1], 513);
}

#[test]
fn a_co_processor_that_refuses_frames_clicks_and_still_answers() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.set("fault.coprocessor_refuses", 1.0);
    for _ in 0..1_000 {
        rig.drive([50, 0, 0], 1);
        rig.run(milliseconds(2));
    }
    assert_eq!(rig.board.motor_command(MotorPort::A).duty, 0);
    assert_eq!(rig.words()[1], 300);
    rig.run(milliseconds(100));
    assert!(rig
        .events()
        .iter()
        .any(|(_, kind)| *kind == BoardEventKind::Click));
    rig.set("fault.coprocessor_refuses", 0.0);
    rig.drive([50, 0, 0], 1);
    rig.run(milliseconds(4));
    assert_eq!(rig.board.motor_command(MotorPort::A).duty, 50);
}

#[test]
fn a_duty_cycle_beyond_100_percent_is_reported_and_full_power() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.drive([0, 120, 0], 2);
    rig.run(milliseconds(3));
    let fault = BoardFault::DutyBeyondRange {
        motor: MotorPort::B,
        duty: 120,
    };
    assert!(rig
        .events()
        .iter()
        .any(|(_, kind)| *kind == BoardEventKind::Fault(fault)));
    assert_eq!(rig.signal("motor.B.duty"), 1.0);
}

#[test]
fn duty_cycles_have_the_resolution_of_the_timer() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    let mut duty_at = |frequency: u8, percent: u8| {
        rig.send([0, frequency, 0, percent, 0, 0, 2, 0]);
        rig.run(milliseconds(3));
        rig.signal("motor.B.duty")
    };
    assert_eq!(duty_at(8, 1), 1.0 / 125.0);
    assert_eq!(duty_at(8, 3), 3.0 / 125.0);
    assert_eq!(duty_at(8, 50), 62.0 / 125.0);
    assert_eq!(duty_at(8, 100), 1.0);
    assert_eq!(duty_at(4, 1), 2.0 / 250.0);
    assert_eq!(duty_at(32, 3), 0.0);
    assert_eq!(duty_at(32, 4), 1.0 / 31.0);
    assert_eq!(duty_at(2, 50), 31.0 / 62.0);
    assert_eq!(duty_at(0, 50), 31.0 / 62.0);
    assert_eq!(duty_at(33, 50), 31.0 / 62.0);
}

#[test]
fn positive_duty_turns_the_shaft_forwards_with_the_mean_voltage() {
    let mut rig = Rig::running(r#"{"battery": {"voltage": 8.0}}"#, &three_motors());
    rig.drive([60, -60, 0], 0b111);
    rig.run(milliseconds(500));
    assert_eq!(rig.signal("motor.A.voltage"), 8.0 * 75.0 / 125.0);
    let speed = rig.signal("motor.A.angular_velocity");
    assert!((speed - 4.8 * 2.029).abs() < 0.01, "{speed}");
    assert!((rig.signal("motor.B.angular_velocity") + speed).abs() < 1e-9);
    assert_eq!(rig.signal("motor.C.angle"), 0.0);
}

#[test]
fn brake_mode_shorts_the_winding_and_float_mode_opens_it() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.drive([100, 100, 0], 0b111);
    rig.run(milliseconds(300));
    rig.drive([0, 0, 0], 0b001);
    rig.run(milliseconds(50));
    assert_eq!(rig.signal("motor.A.voltage"), 0.0);
    assert!(rig.signal("motor.A.current") < 0.0);
    assert_eq!(rig.signal("motor.B.current"), 0.0);
    let (braked, coasting) = (
        rig.signal("motor.A.angular_velocity"),
        rig.signal("motor.B.angular_velocity"),
    );
    assert!(braked < 0.5 * coasting, "{braked} {coasting}");
}

#[test]
fn low_duty_gives_more_torque_in_brake_mode_than_in_float_mode() {
    let locked = r#""coulomb_friction": 0.0, "inductance": 0.0047"#;
    let motor = crate::common::motor().replace(r#""inertia""#, &format!(r#"{locked}, "inertia""#));
    let motor = motor.replace("}}", r#"}, "held_by_hand": true, "hand_rate": 1}"#);
    let robot = format!(r#"{{"motors": {{"B": {motor}, "C": {motor}}}}}"#);
    let mut rig = Rig::running(SENSORS, &robot);
    rig.drive([0, 20, 20], 0b010);
    rig.run(milliseconds(100));
    let (braked, floating) = (rig.signal("motor.B.current"), rig.signal("motor.C.current"));
    assert!(
        braked > 10.0 * floating && floating > 0.0,
        "{braked} {floating}"
    );
}

#[test]
fn sensor_supplies_follow_the_nibbles_of_their_byte() {
    let mut rig = Rig::running(SENSORS, "{}");
    assert_eq!(rig.board.sensor_supply(1), Some(SensorSupply::Pulsed));
    rig.send([0, 8, 0, 0, 0, 0, 0, 0b0100_0010]);
    rig.run(milliseconds(4));
    let supplies = [1, 2, 3, 4].map(|port| rig.board.sensor_supply(port).unwrap());
    let wanted = [
        SensorSupply::Off,
        SensorSupply::Pulsed,
        SensorSupply::Constant,
        SensorSupply::Off,
    ];
    assert_eq!(supplies, wanted);
    assert_eq!(rig.board.sensor_supply(0), None);
    assert_eq!(rig.board.sensor_supply(5), None);
}

#[test]
fn without_the_handshake_the_brick_switches_off_after_298_s() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.run_until(milliseconds(297_000));
    assert!(rig.board.powered());
    rig.run_until(milliseconds(299_000));
    assert!(!rig.board.powered());
    assert_eq!(power_off(&mut rig).unwrap().1, PowerOffReason::NoHandshake);
}

#[test]
fn with_the_handshake_the_brick_stays_on() {
    for tail in ["", "\0", "more"] {
        let mut rig = Rig::running(SENSORS, "{}");
        let mut string = HANDSHAKE.to_vec();
        string.extend(tail.bytes());
        assert!(rig.write(&string));
        rig.run_until(milliseconds(300_000));
        assert!(rig.board.powered());
    }
}

#[test]
fn a_wrong_handshake_does_not_count() {
    let mut rig = Rig::running(SENSORS, "{}");
    let mut wrong = HANDSHAKE.to_vec();
    wrong[20] ^= 1;
    rig.write(&wrong);
    rig.write(&HANDSHAKE[..46]);
    rig.run_until(milliseconds(300_000));
    assert!(!rig.board.powered());
}

#[test]
fn power_down_obeys_its_outputs_for_six_ticks_then_cuts_the_supply() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.drive([100, 0, 0], 1);
    rig.run(milliseconds(20));
    rig.send([0x5A, 0, 50, 0, 0, 0, 1, 0]);
    let asked = rig.now;
    rig.run(milliseconds(17));
    assert!(rig.board.powered());
    assert_eq!(rig.board.motor_command(MotorPort::A).duty, 50);
    rig.run(milliseconds(5));
    assert!(!rig.board.powered());
    let (at, reason) = power_off(&mut rig).unwrap();
    let expected = milliseconds(17)..milliseconds(22);
    assert!(reason == PowerOffReason::Requested && expected.contains(&(at - asked)));
    assert!(!rig.board.twi_start(rig.now, 1, false).acknowledged);
    rig.run(milliseconds(1));
    assert_eq!(rig.signal("motor.A.current"), 0.0);
}

#[test]
fn power_down_is_forgotten_if_another_frame_comes_before_the_tick() {
    let mut rig = Rig::running(SENSORS, &three_motors());
    rig.run(milliseconds(1));
    rig.send([0x5A, 0, 0, 0, 0, 0, 1, 0]);
    rig.drive([0; 3], 1);
    rig.run(milliseconds(100));
    assert!(rig.board.powered());
}

#[test]
fn a_request_for_the_boot_monitor_ends_the_run() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.send([0xA5, 0x5A, 0, 0, 0, 0, 0, 0]);
    rig.run(milliseconds(200));
    assert!(!rig.board.powered());
    let kinds: Vec<_> = rig.events().into_iter().map(|(_, kind)| kind).collect();
    assert!(kinds.contains(&BoardEventKind::PowerOff(PowerOffReason::BootMonitor)));
}

#[test]
fn a_pack_below_6_5_volt_does_not_start_the_brick_but_cells_do() {
    for (kind, starts) in [("li_ion", false), ("aa", true)] {
        let board = format!(r#"{{"battery": {{"kind": "{kind}", "voltage": 6.4}}}}"#);
        let mut rig = Rig::new(&board, "{}", 1);
        rig.run_until(milliseconds(1_090));
        assert!(rig.board.powered(), "the pack has a second to recover");
        rig.run_until(milliseconds(1_300));
        assert_eq!(rig.board.powered(), starts, "{kind}");
    }
}

#[test]
fn after_2_s_without_a_frame_the_amplifier_clicks_twice_a_second() {
    let mut rig = Rig::running(SENSORS, "{}");
    rig.run_until(milliseconds(5_000));
    let clicks: Vec<_> = rig.events().into_iter().collect();
    assert!(clicks
        .iter()
        .all(|(_, kind)| *kind == BoardEventKind::Click));
    assert_eq!(clicks.len(), 7);
    assert!((milliseconds(1_970)..milliseconds(2_010)).contains(&clicks[0].0));
    assert!((clicks[1].0 - clicks[0].0).abs_diff(milliseconds(495)) < milliseconds(5));
    rig.drive([0; 3], 0);
    rig.run(milliseconds(1_900));
    assert_eq!(
        rig.events()
            .iter()
            .filter(|(_, k)| *k == BoardEventKind::Click)
            .count(),
        0
    );
}

#[test]
fn motor_current_sags_the_battery_through_its_resistance() {
    let board = r#"{"battery": {"kind": "aa", "voltage": 8.0, "internal_resistance": 0.5}}"#;
    let mut rig = Rig::running(board, &three_motors());
    assert_eq!(rig.signal("battery.voltage"), 8.0);
    rig.drive([100, 100, 100], 0b111);
    rig.run(milliseconds(4));
    let sagged = rig.signal("battery.voltage");
    assert!(sagged < 7.2 && sagged > 6.0, "{sagged}");
    let count = rig.words()[5] & 0x3FF;
    assert!(count < (7.5 / 0.013_848) as u16, "{count}");
    rig.set("battery.voltage", 9.0);
    assert!(rig.signal("battery.voltage") > sagged + 0.9);
}
