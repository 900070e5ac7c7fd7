// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Builders for tests: small ELF files, hand-assembled programs, whole bricks.
#![allow(dead_code, clippy::unwrap_used)]

pub mod arm;
pub mod cases;
#[path = "../../../plant/tests/common/catalogue.rs"]
pub mod catalogue;
pub mod devices;
#[path = "../../../image/tests/support/elf.rs"]
pub mod elf;
pub mod random;
pub mod requests;

use std::sync::LazyLock;

use arm::Program;
use elf::ElfBuilder;
use virtual_brick::{Configuration, VirtualBrick};

pub const RAM: u32 = 0x0020_2000;
pub static VEHICLE: LazyLock<String> =
    LazyLock::new(|| include_str!("vehicle.json").replace(r#""nxt""#, &catalogue::TABLE_1));

pub fn vehicle() -> Configuration {
    Configuration::from_json(&VEHICLE).unwrap()
}

/// An image in RAM whose code symbol `start` is the program.
pub fn image(program: &Program) -> ElfBuilder {
    ElfBuilder::new(RAM)
        .words(RAM, &program.words())
        .function("start", RAM)
}

/// A vehicle that runs the program from RAM.
pub fn brick(program: &Program) -> VirtualBrick {
    VirtualBrick::new(&vehicle(), &image(program).build()).unwrap()
}
