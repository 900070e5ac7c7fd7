// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Small hand-assembled programs on the whole brick: clock, co-processor, motor, display, power.

use crate::support::arm::{Program, CC};
use crate::support::{brick, image, vehicle};
use trace::{Event, EventKind};
use virtual_brick::{StopReason, VirtualBrick};

const MILLISECOND: u64 = 48_055;
const RESULT: u32 = 0x0020_8000;

const PIT_MR: u32 = 0xFFFF_FD30;
const PIT_PIIR: u32 = 0xFFFF_FD3C;
const PMC_PCER: u32 = 0xFFFF_FC10;
const PIO: u32 = 0xFFFF_F400;
const TWI: u32 = 0xFFFB_8000;
const SPI: u32 = 0xFFFE_0000;

const TXCOMP: u32 = 1;
const RXRDY: u32 = 2;
const TXRDY: u32 = 4;
const TDRE: u32 = 2;
/// Bit 9 as an ARM immediate: 2 rotated right by 24.
const TXEMPTY: u32 = 0xC02;

/// Lines and clock of the two-wire interface, about 381 kHz.
fn open_two_wire(program: &mut Program) {
    program
        .poke(PMC_PCER, 1 << 9 | 1 << 2)
        .poke(PIO + 0x04, 0x18)
        .poke(PIO + 0x70, 0x18)
        .poke(TWI, 0x80)
        .poke(TWI, 0x04)
        .poke(TWI + 0x10, 0x0002_0F0F);
}

/// Send a frame of the co-processor's protocol: eight bytes and the ones' complement of the sum.
fn send(program: &mut Program, frame: [u8; 8]) {
    let sum = frame.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    program.poke(TWI + 0x04, 1 << 16);
    for byte in frame.iter().chain(&[!sum]) {
        program
            .poke(TWI + 0x34, u32::from(*byte))
            .wait(TWI + 0x20, TXRDY);
    }
    program.wait(TWI + 0x20, TXCOMP);
}

/// Read the thirteen bytes of the co-processor into words at `RESULT`.
fn receive(program: &mut Program) {
    program.poke(TWI + 0x04, 1 << 16 | 1 << 12).poke(TWI, 1);
    for index in 0..13 {
        if index == 12 {
            program.poke(TWI, 2);
        }
        program.wait(TWI + 0x20, RXRDY).load(1, TWI).ldr(0, 1, 0x30);
        program.load(1, RESULT).str(0, 1, 4 * index);
    }
}

fn events(brick: &VirtualBrick, kind: EventKind) -> Vec<Event> {
    brick
        .trace()
        .events()
        .iter()
        .filter(|event| event.kind == kind)
        .collect()
}

fn last(brick: &VirtualBrick, signal: &str) -> f64 {
    *brick
        .trace()
        .signals()
        .get(signal)
        .unwrap()
        .values
        .last()
        .unwrap()
}

#[test]
fn the_interval_timer_counts_sixteenths_of_the_master_clock() {
    let mut program = Program::new();
    program
        .poke(PIT_MR, 0x010F_FFFF)
        .load(2, 1_000)
        .load(1, PIT_PIIR);
    let again = program.here();
    program.ldr(0, 1, 0).cmp(0, 2).branch(CC, again).stop();
    let stop = brick(&program).run_until(100 * MILLISECOND);
    assert_eq!(stop.reason, StopReason::Halted);
    assert!((16_000..16_060).contains(&stop.at_cycles), "{stop:?}");
}

#[test]
fn a_frame_to_the_co_processor_turns_a_motor() {
    let mut program = Program::new();
    open_two_wire(&mut program);
    send(&mut program, [0, 8, 0, 60, 0, 0, 0b010, 0]);
    program.status(0x13).stop();
    let mut brick = brick(&program);
    assert_eq!(
        brick.run_until(300 * MILLISECOND).reason,
        StopReason::Reached
    );
    let commands = events(&brick, EventKind::MotorCommand);
    assert!(
        commands
            .iter()
            .any(|e| (e.subject, e.value) == (1, 60 | 256)),
        "{commands:?}"
    );
    assert!(last(&brick, "motor.B.angle") > 0.2);
    assert!(last(&brick, "motor.B.encoder") > 10.0);
    assert!(last(&brick, "motor.A.angle") == 0.0);
    assert!(last(&brick, "body.heading") < -0.01);
}

#[test]
fn the_co_processor_answers_with_buttons_battery_and_checksum() {
    let mut program = Program::new();
    open_two_wire(&mut program);
    program.delay(100_000);
    receive(&mut program);
    program.stop();
    let mut brick = brick(&program);
    brick.schedule_input(1_000, "button.orange", 1.0).unwrap();
    assert_eq!(brick.run_until(50 * MILLISECOND).reason, StopReason::Halted);
    let words = brick.read_memory(RESULT, 52).unwrap();
    let frame: Vec<u16> = words.chunks(4).map(|word| u16::from(word[0])).collect();
    assert_eq!(frame.iter().sum::<u16>() & 0xFF, 0xFF, "{frame:?}");
    let (buttons, battery) = (frame[8] | frame[9] << 8, frame[10] | frame[11] << 8);
    assert!(buttons >= 0x7FF, "{buttons:#X}");
    assert!((577..=578).contains(&(battery & 0x3FF)), "{battery:#X}");
}

#[test]
fn bytes_to_the_display_become_pixels() {
    let mut program = Program::new();
    program
        .poke(PMC_PCER, 1 << 5 | 1 << 2)
        .poke(PIO + 0x04, 1 << 13 | 1 << 14)
        .poke(PIO + 0x70, 1 << 13 | 1 << 14)
        .poke(PIO, 1 << 10 | 1 << 12)
        .poke(PIO + 0x34, 1 << 10 | 1 << 12)
        .poke(PIO + 0x10, 1 << 10 | 1 << 12)
        .poke(SPI, 1)
        .poke(SPI + 0x04, 0x000E_0011)
        .poke(SPI + 0x30, 0x1801);
    for command in [0xAF, 0xC4, 0xB2, 0x00, 0x10] {
        program.poke(SPI + 0x0C, command).wait(SPI + 0x10, TDRE);
    }
    program.wait(SPI + 0x10, TXEMPTY).poke(PIO + 0x30, 1 << 12);
    for byte in [0x01, 0x80] {
        program.poke(SPI + 0x0C, byte).wait(SPI + 0x10, TDRE);
    }
    program.status(0x13).stop();
    let mut brick = brick(&program);
    assert_eq!(
        brick.run_until(10 * MILLISECOND).reason,
        StopReason::Reached
    );
    let picture = brick.lcd();
    let dark: Vec<(usize, usize)> = (0..6_400)
        .filter(|&at| picture[at] == 1)
        .map(|at| (at / 100, at % 100))
        .collect();
    assert_eq!(dark, [(16, 0), (23, 1)]);
    assert_eq!(events(&brick, EventKind::DisplayChanged).len(), 1);
}

#[test]
fn the_power_down_command_ends_the_run() {
    let mut program = Program::new();
    open_two_wire(&mut program);
    send(&mut program, [0x5A, 8, 0, 0, 0, 0, 0, 0]);
    program.status(0x13).stop();
    let mut brick = brick(&program);
    let stop = brick.run_until(100 * MILLISECOND);
    assert_eq!(stop.reason, StopReason::PowerOff);
    assert_eq!(stop.message, "the program switched the brick off");
    let off = events(&brick, EventKind::PowerOff);
    assert_eq!((off.len(), off[0].value), (1, 0));
    assert!(off[0].at_cycles <= stop.at_cycles);
}

#[test]
fn a_request_for_the_boot_monitor_ends_the_run() {
    let mut program = Program::new();
    open_two_wire(&mut program);
    send(&mut program, [0xA5, 0x5A, 0, 0, 0, 0, 0, 0]);
    program.status(0x13).stop();
    let stop = brick(&program).run_until(200 * MILLISECOND);
    assert_eq!(stop.reason, StopReason::PowerOff);
    assert!(stop.message.contains("boot monitor"), "{}", stop.message);
}

#[test]
fn a_hand_on_the_joystick_and_the_touch_sensor_are_inputs() {
    let mut program = Program::new();
    open_two_wire(&mut program);
    program.delay(400_000);
    receive(&mut program);
    program.stop();
    let mut brick = VirtualBrick::new(&vehicle(), &image(&program).build()).unwrap();
    brick.schedule_input(0, "motor.A.hand_angle", -0.1).unwrap();
    brick.schedule_input(1_000, "touch.1", 1.0).unwrap();
    brick.run_until(100 * MILLISECOND);
    assert!((last(&brick, "motor.A.angle") + 0.1).abs() < 0.03);
    let words = brick.read_memory(RESULT, 8).unwrap();
    let pressed = u16::from(words[0]) | u16::from(words[4]) << 8;
    assert!(pressed < 512, "{pressed}");
    assert_eq!(events(&brick, EventKind::Input).len(), 2);
}
