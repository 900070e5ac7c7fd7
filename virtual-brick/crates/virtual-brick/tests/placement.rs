// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Images in the brick's memory: where they are loaded, which are refused and in which words.

use crate::support::elf::ElfBuilder;
use crate::support::{vehicle, RAM};
use virtual_brick::{Image, VirtualBrick};

const FLASH: u32 = 0x0010_0000;
const ENDLESS_LOOP: u32 = 0xEAFF_FFFE;

fn small() -> ElfBuilder {
    ElfBuilder::new(RAM).words(RAM, &[ENDLESS_LOOP])
}

fn refusal(elf: &ElfBuilder) -> String {
    let refused = VirtualBrick::new(&vehicle(), &elf.build());
    refused.unwrap_err().to_string()
}

#[test]
fn a_ram_image_starts_at_its_entry() {
    let brick = VirtualBrick::new(&vehicle(), &small().build()).unwrap();
    assert_eq!(brick.processor().next_instruction_address(), RAM);
    let loaded = brick.read_memory(RAM, 4).unwrap();
    assert_eq!(loaded, ENDLESS_LOOP.to_le_bytes());
}

#[test]
fn a_flash_image_starts_at_reset_and_loads_its_data_by_physical_address() {
    let elf = ElfBuilder::new(FLASH).words(FLASH, &[ENDLESS_LOOP]).load(
        0x0020_0000,
        FLASH + 4,
        &[1, 2, 3, 4],
        64,
    );
    let brick = VirtualBrick::new(&vehicle(), &elf.build()).unwrap();
    assert_eq!(brick.processor().next_instruction_address(), 0);
    assert_eq!(brick.read_memory(FLASH + 4, 4).unwrap(), [1, 2, 3, 4]);
    assert_eq!(brick.read_memory(0x0020_0000, 4).unwrap(), [0; 4]);
}

#[test]
fn a_segment_outside_the_memory_for_programs_is_refused_with_its_address() {
    let message = refusal(&small().words(0x8000_0000, &[0]));
    assert!(message.contains("0x80000000"), "{message}");
}

#[test]
fn an_image_in_the_boot_monitors_ram_starts_as_a_debug_probe_starts_it() {
    let start = 0x0020_0000;
    let elf = ElfBuilder::new(start + 4).words(start, &[0, ENDLESS_LOOP]);
    let brick = VirtualBrick::new(&vehicle(), &elf.build()).unwrap();
    assert_eq!(brick.processor().next_instruction_address(), start + 4);
    let monitor = VirtualBrick::new(&vehicle(), &small().build()).unwrap();
    assert_eq!(brick.processor().cpsr(), monitor.processor().cpsr());
}

#[test]
fn an_image_too_large_for_ram_is_refused_with_the_bytes_over() {
    let words =
        |over: u32| format!("the image is {over} bytes too large for the 65536 bytes of RAM");
    let loaded = ElfBuilder::new(RAM).segment(RAM, &vec![0; 57_344 + 12]);
    assert_eq!(refusal(&loaded), words(12));
    let zeroed = small().load(0x0020_3000, 0x0020_3000, &[], 0xD001);
    assert_eq!(refusal(&zeroed), words(1));
}

#[test]
fn segments_in_ram_and_flash_together_are_refused() {
    let message = refusal(&small().words(FLASH, &[0]));
    assert!(
        message.contains("both into flash and into RAM"),
        "{message}"
    );
}

#[test]
fn bytes_without_headers_must_fit_where_they_are_put() {
    let brick = |bytes: &[u8], address| {
        VirtualBrick::with_image(&vehicle(), Image::binary(bytes, address).unwrap())
    };
    let fits = brick(&[1, 2, 3, 4], FLASH).unwrap();
    assert_eq!(fits.read_memory(FLASH, 4).unwrap(), [1, 2, 3, 4]);
    assert!(brick(&[0; 0x4_0001], FLASH).is_err());
    let whole_ram = brick(&[0; 0x1_0000], 0x0020_0000).unwrap();
    assert_eq!(
        whole_ram.processor().next_instruction_address(),
        0x0020_0000
    );
    assert!(brick(&[0; 0x1_0001], 0x0020_0000).is_err());
}
