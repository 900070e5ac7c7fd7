// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reading images: what is accepted, what is refused and in which words.

use crate::elf::ElfBuilder;
use image::{Content, Image, ImageError, ScalarKind};

const RAM: u32 = 0x0020_2000;

fn small() -> ElfBuilder {
    ElfBuilder::new(RAM).words(RAM, &[0xEAFF_FFFE])
}

fn refusal(elf: &[u8]) -> String {
    Image::parse(elf).unwrap_err().to_string()
}

#[test]
fn segments_have_both_addresses_their_memory_and_their_contents() {
    let elf = small().load(0x0020_0000, 0x0010_0004, &[1, 2, 3, 4], 64);
    let image = Image::parse(&elf.build()).unwrap();
    assert_eq!(image.entry(), RAM);
    let [data, code] = image.segments() else {
        panic!("{:?}", image.segments());
    };
    assert_eq!(
        (data.address, data.virtual_address),
        (0x0010_0004, 0x0020_0000)
    );
    assert_eq!(
        (data.memory_size, data.bytes.as_slice()),
        (64, &[1, 2, 3, 4][..])
    );
    assert_eq!(code.bytes, 0xEAFF_FFFEu32.to_le_bytes());
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
fn a_function_has_all_its_names_and_an_end() {
    let elf = small()
        .function("start", RAM)
        .function("alias", RAM)
        .function("thumb", RAM + 0x101)
        .build();
    let image = Image::parse(&elf).unwrap();
    let symbols = image.symbols();
    let (address, function) = symbols.function_at(RAM + 3).unwrap();
    assert_eq!((address, function.thumb), (RAM, false));
    assert_eq!(function.names, ["start", "alias"]);
    assert_eq!(symbols.function_at(RAM + 4), None);
    assert!(symbols.functions()[&(RAM + 0x100)].thumb);
}

#[test]
fn mapping_symbols_tell_code_from_data() {
    let elf = small()
        .object("$a", RAM, 0)
        .object("$d.7", RAM + 8, 0)
        .object("$txt", RAM + 12, 0)
        .build();
    let image = Image::parse(&elf).unwrap();
    let content_at = |address| image.symbols().content_at(address);
    assert_eq!(content_at(RAM - 1), None);
    assert_eq!(content_at(RAM + 4), Some((RAM, Content::Arm)));
    assert_eq!(content_at(RAM + 16), Some((RAM + 8, Content::Data)));
    assert_eq!(image.symbols().get("$a"), None);
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
