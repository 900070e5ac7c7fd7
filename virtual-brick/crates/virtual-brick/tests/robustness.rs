// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Nothing that comes from outside makes the facade panic.

use crate::support::arm::Program;
use crate::support::cases::cases;
use crate::support::elf::ElfBuilder;
use crate::support::{image, vehicle, RAM, VEHICLE};
use proptest::prelude::*;
use virtual_brick::{Configuration, Image, VirtualBrick};

fn small_image() -> Vec<u8> {
    let mut program = Program::new();
    program.poke(0x0020_8000, 1).stop();
    image(&program).object("counter", 0x0020_8000, 4).build()
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn random_bytes_as_an_image_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        prop_assert!(Image::parse(&bytes).is_err());
    }

    #[test]
    fn an_image_with_damaged_bytes_is_read_or_refused(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut elf = small_image();
        for (index, value) in damage {
            let length = elf.len();
            elf[index.index(length)] = value;
        }
        if let Ok(image) = Image::parse(&elf) {
            let _ = image.variable("counter.part");
            let _ = image.symbols().nearest_code(RAM);
        }
    }

    #[test]
    fn a_truncated_image_is_read_or_refused(cut in any::<prop::sample::Index>()) {
        let elf = small_image();
        let _ = Image::parse(&elf[..cut.index(elf.len())]);
    }

    #[test]
    fn random_text_as_a_configuration_is_refused(text in any::<String>()) {
        prop_assert!(Configuration::from_json(&text).is_err());
    }

    #[test]
    fn a_configuration_with_a_damaged_byte_is_read_or_refused(
        index in any::<prop::sample::Index>(),
        value in 0x20u8..0x7F,
    ) {
        let mut json = VEHICLE.as_bytes().to_vec();
        let length = json.len();
        json[index.index(length)] = value;
        let json = String::from_utf8(json).unwrap();
        if let Err(error) = Configuration::from_json(&json) {
            prop_assert!(!error.to_string().is_empty());
        }
    }
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn random_words_as_a_program_run_without_panic(
        words in prop::collection::vec(any::<u32>(), 16..256),
        thumb in any::<bool>(),
    ) {
        let elf = ElfBuilder::new(RAM | u32::from(thumb)).words(RAM, &words).build();
        let mut brick = VirtualBrick::new(&vehicle(), &elf).unwrap();
        let stop = brick.run_until(100_000);
        prop_assert!(stop.at_cycles <= brick.cycles());
    }

    #[test]
    fn random_register_writes_run_without_panic(
        writes in prop::collection::vec((0x3E80u32..0x4000, 0u32..128, any::<u32>()), 1..40),
    ) {
        let mut program = Program::new();
        for (page, register, value) in writes {
            program.poke(0xFFFF_0000 | page << 2 & 0xFF80 | register << 2 & 0x7C, value);
        }
        program.stop();
        let mut brick = VirtualBrick::new(&vehicle(), &image(&program).build()).unwrap();
        brick.run_until(100_000);
        prop_assert!(!brick.trace().digest().to_string().is_empty());
    }
}
