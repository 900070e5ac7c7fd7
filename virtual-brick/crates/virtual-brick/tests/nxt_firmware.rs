// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
#![allow(clippy::unwrap_used)]
mod support;
use support::elf::ElfBuilder;
use virtual_brick::{Configuration, VirtualBrick};

#[test]
fn prototype() {
    let image = std::fs::read("/usr/share/nxt-firmware/nxt_firmware.bin").unwrap();
    let elf = ElfBuilder::new(0x0010_0000)
        .segment(0x0010_0000, &image)
        .build();
    let configuration = Configuration::from_json(r#"{"seed":1,"body":{"kind":"bench"}}"#).unwrap();
    let mut brick = VirtualBrick::new(&configuration, &elf).unwrap();
    let seconds: u64 = std::env::var("SECONDS_RUN").map_or(12, |s| s.parse().unwrap());
    let mut last = vec![];
    for half in 1..=2 * seconds {
        let stop = brick.run_until(half * 24_027_429);
        let lcd = brick.lcd();
        if lcd != last {
            println!(
                "--- {} s pc {:#x}",
                half as f64 / 2.0,
                brick.processor().next_instruction_address()
            );
            for row in lcd.chunks(200) {
                let line: String = (0..100)
                    .map(|c| match (row[c], row[100 + c]) {
                        (0, 0) => ' ',
                        (1, 0) => '▀',
                        (0, 1) => '▄',
                        _ => '█',
                    })
                    .collect();
                println!("|{line}|");
            }
        }
        last = lcd;
        if stop.reason != virtual_brick::StopReason::Reached {
            println!("{stop:?}");
            break;
        }
    }
}
