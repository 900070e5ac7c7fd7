// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reading images: what is accepted, what is refused and in which words.
#![allow(clippy::unwrap_used)]

mod support;

use support::elf::ElfBuilder;
use virtual_brick::{Image, ImageError, Placement, ScalarKind};

const RAM: u32 = 0x0020_2000;
const FLASH: u32 = 0x0010_0000;

fn small() -> ElfBuilder {
    ElfBuilder::new(RAM).words(RAM, &[0xEAFF_FFFE])
}

fn refusal(elf: &[u8]) -> String {
    Image::parse(elf).unwrap_err().to_string()
}

#[test]
fn a_ram_image_is_recognised_by_its_segments() {
    let image = Image::parse(&small().build()).unwrap();
    assert_eq!(image.placement(), Placement::Ram);
    assert_eq!(image.entry(), RAM);
    assert_eq!(image.segments()[0].bytes, 0xEAFF_FFFEu32.to_le_bytes());
}

#[test]
fn a_flash_image_loads_its_data_by_physical_address() {
    let elf = ElfBuilder::new(FLASH)
        .words(FLASH, &[0xEAFF_FFFE])
        .load(0x0020_0000, FLASH + 4, &[1, 2, 3, 4], 64)
        .build();
    let image = Image::parse(&elf).unwrap();
    assert_eq!(image.placement(), Placement::Flash);
    assert_eq!(image.segments()[1].address, FLASH + 4);
    assert_eq!(image.segments()[1].bytes, [1, 2, 3, 4]);
}

#[test]
fn a_segment_without_contents_is_not_loaded() {
    let elf = small().load(0x0020_3000, 0x0020_3000, &[], 4096).build();
    assert_eq!(Image::parse(&elf).unwrap().segments().len(), 1);
}

#[test]
fn a_file_that_is_not_elf_is_refused() {
    assert_eq!(Image::parse(b"MZ rest").unwrap_err(), ImageError::NotElf);
}

#[test]
fn an_empty_file_is_refused_as_truncated() {
    assert!(refusal(b"").contains("truncated: 0 bytes"));
}

#[test]
fn a_file_cut_in_a_segment_is_refused_as_truncated() {
    let elf = small().segment(0x0020_4000, &[0; 4096]).build();
    let cut = &elf[..52 + 64 + 100];
    let message = refusal(cut);
    assert!(
        message.contains("truncated") || message.contains("not a valid ELF"),
        "{message}"
    );
}

#[test]
fn files_for_other_machines_are_named() {
    for (offset, value, words) in [
        (4, 2, "64-bit"),
        (5, 2, "big-endian"),
        (18, 62, "machine 62"),
        (16, 1, "not linked"),
        (16, 3, "type 3"),
    ] {
        let mut elf = small().build();
        elf[offset] = value;
        let message = refusal(&elf);
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_segment_outside_the_memory_is_refused_with_its_address() {
    let message = refusal(
        &ElfBuilder::new(0x8000_0000)
            .words(0x8000_0000, &[0])
            .build(),
    );
    assert!(message.contains("0x80000000"), "{message}");
}

#[test]
fn a_segment_in_the_boot_monitors_ram_is_refused() {
    let message = refusal(&small().words(0x0020_0000, &[0]).build());
    assert!(message.contains("0x00200000"), "{message}");
}

#[test]
fn an_image_too_large_for_ram_is_refused_with_the_bytes_over() {
    let elf = ElfBuilder::new(RAM)
        .segment(RAM, &vec![0; 57_344 + 12])
        .build();
    assert_eq!(
        refusal(&elf),
        "the image is 12 bytes too large for the 57344 bytes of RAM"
    );
}

#[test]
fn zeroed_memory_counts_as_part_of_the_image() {
    let elf = small().load(0x0020_3000, 0x0020_3000, &[], 0xD001).build();
    assert_eq!(
        refusal(&elf),
        "the image is 1 bytes too large for the 57344 bytes of RAM"
    );
}

#[test]
fn an_entry_outside_the_image_is_refused() {
    let message = refusal(&ElfBuilder::new(0x0020_8000).words(RAM, &[0]).build());
    assert!(message.contains("entry 0x00208000"), "{message}");
}

#[test]
fn an_image_without_contents_is_refused() {
    assert_eq!(
        Image::parse(&ElfBuilder::new(RAM).build()).unwrap_err(),
        ImageError::Empty
    );
}

#[test]
fn segments_in_ram_and_flash_together_are_refused() {
    let message = refusal(&small().words(FLASH, &[0]).build());
    assert!(
        message.contains("both into flash and into RAM"),
        "{message}"
    );
}

#[test]
fn symbols_are_found_by_name_and_the_nearest_code_by_address() {
    let elf = small()
        .function("start", RAM)
        .function("thumb", RAM + 0x101)
        .object("counter", 0x0020_8000, 4)
        .symbol("counter", 0x0020_9000, 2, false, false)
        .build();
    let image = Image::parse(&elf).unwrap();
    let symbols = image.symbols();
    assert_eq!(symbols.get("counter").unwrap().address, 0x0020_8000);
    assert_eq!(symbols.get("thumb").unwrap().address, RAM + 0x100);
    assert_eq!(symbols.nearest_code(RAM + 0x20), Some(("start", 0x20)));
    assert_eq!(symbols.nearest_code(RAM + 0x104), Some(("thumb", 4)));
    assert_eq!(symbols.nearest_code(RAM - 4), None);
}

#[test]
fn an_unknown_symbol_is_reported_with_similar_names() {
    let elf = small().object("tasks__counter", 0x0020_8000, 4).build();
    let image = Image::parse(&elf).unwrap();
    let message = image.variable("Counter").unwrap_err().to_string();
    assert_eq!(
        message,
        "the image has no symbol `Counter`; similar: tasks__counter"
    );
}

#[test]
fn an_ada_name_with_dots_finds_the_linker_name() {
    let elf = small().object("tasks__counter", 0x0020_8000, 4).build();
    let variable = Image::parse(&elf)
        .unwrap()
        .variable("Tasks.Counter")
        .unwrap();
    assert_eq!((variable.address, variable.size), (0x0020_8000, 4));
    assert_eq!(variable.kind, None);
}

#[test]
fn scalars_are_read_little_endian_and_sign_extended() {
    assert_eq!(ScalarKind::I16.to_i64(&[0xFE, 0xFF]), -2);
    assert_eq!(ScalarKind::U16.to_i64(&[0xFE, 0xFF]), 0xFFFE);
    assert_eq!(ScalarKind::I8.to_f64(&[0x80]), -128.0);
    assert_eq!(ScalarKind::F32.to_f64(&1.5f32.to_le_bytes()), 1.5);
    assert_eq!(ScalarKind::F64.to_f64(&(-2.5f64).to_le_bytes()), -2.5);
    assert_eq!(
        ScalarKind::U64.to_f64(&u64::MAX.to_le_bytes()),
        18_446_744_073_709_551_616.0
    );
    assert!("i24"
        .parse::<ScalarKind>()
        .unwrap_err()
        .contains("known: i8"));
}

#[test]
fn every_truncation_of_an_image_is_handled() {
    let elf = small()
        .function("start", RAM)
        .object("counter", 0x0020_8000, 4)
        .build();
    assert!(
        (0..elf.len())
            .filter(|&length| Image::parse(&elf[..length]).is_err())
            .count()
            > 80
    );
}

#[test]
fn bytes_without_headers_lie_where_they_are_put() {
    let image = Image::binary(&[1, 2, 3, 4], 0x0010_0000).unwrap();
    assert_eq!(image.placement(), Placement::Flash);
    assert_eq!(image.segments()[0].bytes, [1, 2, 3, 4]);
    assert!(Image::binary(&[], 0x0010_0000).is_err());
    assert!(Image::binary(&[0; 0x4_0001], 0x0010_0000).is_err());
    assert!(Image::binary(&[0; 4], 0x0020_0000).is_err());
}
