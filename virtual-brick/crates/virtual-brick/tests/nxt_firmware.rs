// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Software that nobody here wrote: the brick's own firmware 1.29 as Debian packages it
//! (`nxt-firmware`) starts from power-on, shows its menu and is used through the buttons.

use std::sync::OnceLock;

use crate::support::elf::ElfBuilder;
use crate::support::vehicle;
use trace::EventKind;
use virtual_brick::{StopReason, VirtualBrick};

const IMAGE: &str = "/usr/share/nxt-firmware/nxt_firmware.bin";
const FLASH: u32 = 0x0010_0000;
const FLASH_BYTES: usize = 0x4_0000;
const MILLISECOND: u64 = 48_055;
/// The menu stands well before this.
const MENU_MS: u64 = 7_000;
const COLUMNS: usize = 100;
/// Lines of two pixel rows that hold the caption of the chosen menu entry.
const CAPTION: std::ops::Range<usize> = 16..20;

/// FNV-1a of the menu below its status line, as the firmware of package version 1.29.2-1 draws
/// it: three icons in a row, the middle one framed, its name above.
const MENU_DIGEST: u64 = 0xBA34_7249_17E8_50D3;

const MY_FILES: [&str; 4] = [
    "                          █▄ ▄█             █▀▀▀▀   ▀     █",
    "                          █ ▀ █ █  █        █▄▄▄    █     █   ▄▀▀▀▄ ▄▀▀▀",
    "                          █   █ ▀▄▄█        █       █     █   █▀▀▀   ▀▀▀▄",
    "                          ▀   ▀ ▄▄▀         ▀       ▀▀    ▀▀   ▀▀▀   ▀▀▀",
];
const NXT_PROGRAM: [&str; 4] = [
    "                 █▄  █ █   █ ▀▀█▀▀       █▀▀▀▄",
    "                 █ ▀▄█  ▀▄▀    █         █▄▄▄▀ ▀▄▀▀▄ ▄▀▀▀▄ ▄▀▀▀█ ▀▄▀▀▄  ▀▀▀▄ █▀▄▀▄",
    "                 █   █ ▄▀ ▀▄   █         █      █    █   █ ▀▄▄▄█  █    ▄▀▀▀█ █ ▀ █",
    "                 ▀   ▀ ▀   ▀   ▀         ▀     ▀▀▀    ▀▀▀    ▄▄█ ▀▀▀    ▀▀▀▀ ▀   ▀",
];
const VIEW: [&str; 4] = [
    "                                      █   █   ▀",
    "                                      █   █   █   ▄▀▀▀▄ █   █",
    "                                      ▀▄ ▄▀   █   █▀▀▀  █▄█▄█",
    "                                        ▀     ▀▀   ▀▀▀   ▀ ▀",
];
const TURN_OFF: [&str; 4] = [
    "                       ▀▀█▀▀                                ▄▀▀   ▄▀▀  ▄▀▀▀▄",
    "                         █   █  █  ▀▄▀▀▄ █▀▀▄        ▄▀▀▀▄ ▄█▄▄  ▄█▄▄    ▄▄▀",
    "                         █   █ ▄█   █    █  █        █   █  █     █      ▀",
    "                         ▀    ▀ ▀  ▀▀▀   ▀  ▀         ▀▀▀   ▀     ▀      ▀",
];
/// The frame of the value display with 670 degrees in it.
const DEGREES_670: [&str; 4] = [
    "              ██                                   ▄▀▀  ▀▀▀▀█ ▄▀▀▀▄        ▄▀▄     ███",
    "              ██                                  █▄▄▄    ▄▀  █ ▄▀█         ▀      ███",
    "              ██                                  █   █  █    █▀  █                ███",
    "              ██                                   ▀▀▀   ▀     ▀▀▀                 ███",
];

/// The picture as lines of half-height blocks, without trailing blanks.
fn lines(brick: &VirtualBrick) -> Vec<String> {
    let block = |upper, lower| match (upper, lower) {
        (0, 0) => ' ',
        (_, 0) => '▀',
        (0, _) => '▄',
        _ => '█',
    };
    let line = |rows: &[u8]| {
        let (upper, lower) = rows.split_at(COLUMNS);
        let blocks = upper.iter().zip(lower).map(|(u, l)| block(*u, *l));
        blocks.collect::<String>().trim_end().to_owned()
    };
    brick.lcd().chunks(2 * COLUMNS).map(line).collect()
}

fn assert_lines(brick: &VirtualBrick, range: std::ops::Range<usize>, expected: &[&str]) {
    let picture = lines(brick);
    assert_eq!(picture[range], *expected, "\n{}", picture.join("\n"));
}

fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

/// Run for some time; the run must go on.
fn run(brick: &mut VirtualBrick, milliseconds: u64) {
    let stop = brick.run_until(brick.cycles() + milliseconds * MILLISECOND);
    assert_eq!(stop.reason, StopReason::Reached, "{}", stop.message);
}

/// Hold a button for 150 ms and give the firmware time to draw.
fn press(brick: &mut VirtualBrick, button: &str) {
    let name = format!("button.{button}");
    brick.schedule_input(brick.cycles(), &name, 1.0).unwrap();
    let released = brick.cycles() + 150 * MILLISECOND;
    brick.schedule_input(released, &name, 0.0).unwrap();
    run(brick, 550);
}

/// A brick whose firmware has drawn its menu; nothing, with the reason printed, where the package
/// is not installed.
fn at_the_menu() -> Option<VirtualBrick> {
    static BRICK: OnceLock<Option<VirtualBrick>> = OnceLock::new();
    let brick = BRICK.get_or_init(|| {
        let image = std::fs::read(IMAGE).ok()?;
        assert_eq!(image.len(), FLASH_BYTES, "{IMAGE} fills the flash");
        let elf = ElfBuilder::new(FLASH).segment(FLASH, &image).build();
        let mut brick = VirtualBrick::new(&vehicle(), &elf).unwrap();
        run(&mut brick, MENU_MS);
        Some(brick)
    });
    if brick.is_none() {
        eprintln!("skipped: {IMAGE} is absent (Debian package nxt-firmware)");
    }
    brick.clone()
}

#[test]
fn the_firmware_boots_to_its_menu() {
    let Some(brick) = at_the_menu() else { return };
    assert_lines(&brick, CAPTION, &MY_FILES);
    let below_status_line = &brick.lcd()[10 * COLUMNS..];
    assert_eq!(
        digest(below_status_line),
        MENU_DIGEST,
        "\n{}",
        lines(&brick).join("\n")
    );
}

#[test]
fn the_arrow_buttons_move_through_the_menu() {
    let Some(mut brick) = at_the_menu() else {
        return;
    };
    press(&mut brick, "right");
    assert_lines(&brick, CAPTION, &NXT_PROGRAM);
    press(&mut brick, "right");
    press(&mut brick, "right");
    assert_lines(&brick, CAPTION, &VIEW);
    for _ in 0..3 {
        press(&mut brick, "left");
    }
    assert_lines(&brick, CAPTION, &MY_FILES);
}

#[test]
fn the_firmware_counts_the_degrees_that_a_motor_is_turned() {
    let Some(mut brick) = at_the_menu() else {
        return;
    };
    let to_motor_degrees = ["right"; 7];
    let at_port_a = ["orange", "orange"];
    let keys = ["right", "right", "right", "orange"];
    for key in keys.iter().chain(&to_motor_degrees).chain(&at_port_a) {
        press(&mut brick, key);
    }
    let now = brick.cycles();
    let angle = 11.7_f64;
    brick
        .schedule_input(now, "motor.A.hand_angle", angle)
        .unwrap();
    run(&mut brick, 4_000);
    assert_eq!(angle.to_degrees().floor(), 670.0);
    assert_lines(&brick, 12..16, &DEGREES_670);
}

#[test]
fn the_firmware_switches_the_brick_off() {
    let Some(mut brick) = at_the_menu() else {
        return;
    };
    press(&mut brick, "grey");
    assert_lines(&brick, CAPTION, &TURN_OFF);
    brick
        .schedule_input(brick.cycles(), "button.orange", 1.0)
        .unwrap();
    let stop = brick.run_until(brick.cycles() + 1_000 * MILLISECOND);
    assert_eq!(stop.reason, StopReason::PowerOff, "{}", stop.message);
    let last = brick.trace().events().iter().last().unwrap();
    assert_eq!(last.kind, EventKind::PowerOff);
}
