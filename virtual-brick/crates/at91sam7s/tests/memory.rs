// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Memory regions, their costs, remap, aborts, flash programming, observation.

use crate::common::{
    read, running_chip, try_read, try_write, write, ScriptedBoard, TestChip, MC, SRAM,
};
use arm7tdmi::bus::{Bus, Cycle, Width};
use at91sam7s::board::Cycles;
use at91sam7s::{Chip, ChipConfiguration, CodeBufferLoss, FaultKind, TimingProfile, WatchHit};

const FLASH: u32 = 0x0010_0000;
const FMR: u32 = MC + 0x60;
const FCR: u32 = MC + 0x64;
const FSR: u32 = MC + 0x68;

fn cost(chip: &mut TestChip, access: impl FnOnce(&mut TestChip)) -> Cycles {
    let before = chip.now();
    access(chip);
    chip.now() - before
}

fn thumb(chip: &mut TestChip, address: u32) -> Cycles {
    cost(chip, |c| {
        c.fetch_halfword(address, Cycle::Sequential).unwrap();
    })
}

fn arm(chip: &mut TestChip, address: u32) -> Cycles {
    cost(chip, |c| {
        c.fetch_word(address, Cycle::Sequential).unwrap();
    })
}

#[test]
fn sram_takes_one_cycle_for_every_width_and_kind() {
    let mut chip = running_chip();
    for width in [Width::Byte, Width::Halfword, Width::Word] {
        assert_eq!(
            cost(&mut chip, |c| try_write(c, SRAM + 8, width, 5).unwrap()),
            1
        );
        assert_eq!(
            cost(&mut chip, |c| assert_eq!(
                try_read(c, SRAM + 8, width),
                Ok(5)
            )),
            1
        );
    }
    assert_eq!(arm(&mut chip, SRAM), 1);
    assert_eq!(thumb(&mut chip, SRAM + 2), 1);
}

#[test]
fn a_peripheral_register_takes_two_cycles() {
    let mut chip = running_chip();
    assert_eq!(cost(&mut chip, |c| write(c, MC + 0x60, 0x100)), 2);
    assert_eq!(
        cost(&mut chip, |c| assert_eq!(read(c, MC + 0x60), 0x100)),
        2
    );
}

#[test]
fn flash_without_wait_state_takes_one_cycle() {
    let mut chip = running_chip();
    write(&mut chip, FMR, 0x0048_0000);
    assert_eq!(arm(&mut chip, FLASH), 1);
    assert_eq!(arm(&mut chip, FLASH + 4), 1);
    assert_eq!(thumb(&mut chip, FLASH + 0x102), 1);
    assert_eq!(
        cost(&mut chip, |c| assert_eq!(read(c, FLASH), 0xFFFF_FFFF)),
        1
    );
}

#[test]
fn flash_with_one_wait_state_favours_sequential_thumb_code() {
    let mut chip = running_chip();
    write(&mut chip, FMR, 0x0048_0100);
    assert_eq!(arm(&mut chip, FLASH), 2);
    assert_eq!(arm(&mut chip, FLASH + 4), 2);
    assert_eq!(thumb(&mut chip, FLASH + 0x100), 2);
    assert_eq!(thumb(&mut chip, FLASH + 0x102), 1);
    assert_eq!(thumb(&mut chip, FLASH + 0x104), 1);
    assert_eq!(
        cost(&mut chip, |c| assert_eq!(read(c, FLASH), 0xFFFF_FFFF)),
        2
    );
    assert_eq!(
        thumb(&mut chip, FLASH + 0x106),
        1,
        "a data read keeps the prefetch buffer"
    );
    assert_eq!(
        thumb(&mut chip, FLASH + 0x100),
        2,
        "a branch pays the wait state"
    );
}

#[test]
fn the_pessimistic_profile_charges_a_thumb_branch_to_an_upper_halfword() {
    let timing = TimingProfile::pessimistic();
    let configuration = ChipConfiguration {
        timing,
        ..ChipConfiguration::default()
    };
    let mut chip = Chip::new(ScriptedBoard::default(), configuration);
    chip.enter_as_boot_monitor();
    assert_eq!(thumb(&mut chip, FLASH + 0x102), 2);
    assert_eq!(thumb(&mut chip, FLASH + 0x104), 2);
    assert_eq!(thumb(&mut chip, FLASH + 0x106), 1);
}

/// Cycles of the third of three Thumb fetches in sequence, after `between`.
fn third_fetch(loss: CodeBufferLoss, between: impl FnOnce(&mut TestChip)) -> u64 {
    let timing = TimingProfile {
        code_buffer_loss: loss,
        ..TimingProfile::nominal()
    };
    let configuration = ChipConfiguration {
        timing,
        ..ChipConfiguration::default()
    };
    let mut chip = Chip::new(ScriptedBoard::default(), configuration);
    chip.enter_as_boot_monitor();
    write(&mut chip, FMR, 0x0048_0100);
    assert_eq!(thumb(&mut chip, FLASH + 0x100), 2);
    assert_eq!(thumb(&mut chip, FLASH + 0x102), 1);
    between(&mut chip);
    let third = thumb(&mut chip, FLASH + 0x104);
    assert_eq!(
        thumb(&mut chip, FLASH + 0x106),
        1,
        "the buffer is full again"
    );
    third
}

#[test]
fn the_loss_of_the_code_buffer_is_a_parameter() {
    use CodeBufferLoss::{Branch, FlashData, Gap};
    for loss in [Branch, FlashData, Gap] {
        assert_eq!(third_fetch(loss, |_| {}), 1);
    }
    let flash_data = |chip: &mut TestChip| assert_eq!(read(chip, FLASH), 0xFFFF_FFFF);
    let sram_data = |chip: &mut TestChip| assert_eq!(read(chip, SRAM), 0);
    let internal = |chip: &mut TestChip| chip.internal(1);
    for (loss, wanted) in [
        (Branch, [1, 1, 1]),
        (FlashData, [2, 1, 1]),
        (Gap, [2, 2, 2]),
    ] {
        let seen = [
            third_fetch(loss, flash_data),
            third_fetch(loss, sram_data),
            third_fetch(loss, internal),
        ];
        assert_eq!(seen, wanted, "{loss:?}");
    }
}

#[test]
fn the_remap_register_toggles_what_is_at_address_zero() {
    let mut chip = running_chip();
    chip.load(FLASH, &[1, 2, 3, 4]).unwrap();
    write(&mut chip, SRAM, 0x0807_0605);
    assert_eq!(read(&mut chip, 0), 0x0403_0201);
    write(&mut chip, MC, 1);
    assert_eq!(read(&mut chip, 0), 0x0807_0605);
    write(&mut chip, 4, 9);
    assert_eq!(read(&mut chip, SRAM + 4), 9);
    write(&mut chip, MC, 1);
    assert_eq!(read(&mut chip, 0), 0x0403_0201);
}

#[test]
fn memories_repeat_through_their_windows() {
    let mut chip = running_chip();
    chip.load(FLASH + 8, &[0x78, 0x56, 0x34, 0x12]).unwrap();
    write(&mut chip, SRAM + 0x10, 77);
    assert_eq!(read(&mut chip, SRAM + 0x1_0010), 77);
    assert_eq!(read(&mut chip, SRAM + 0xF_0010), 77);
    assert_eq!(read(&mut chip, FLASH + 0x4_0008), 0x1234_5678);
    assert_eq!(read(&mut chip, 0xC_0008), 0x1234_5678);
}

#[test]
fn an_undefined_address_aborts_and_leaves_its_mark_without_a_fault() {
    let mut chip = running_chip();
    assert!(try_read(&mut chip, 0x1234_5678, Width::Word).is_err());
    assert!(chip.fault().is_none());
    let status = read(&mut chip, MC + 4);
    assert_eq!(status, 1 | 2 << 8 | 1 << 17 | 1 << 25);
    assert_eq!(read(&mut chip, MC + 8), 0x1234_5678);
    assert_eq!(
        read(&mut chip, MC + 4),
        1 | 2 << 8 | 1 << 17,
        "the saved flag clears on reading"
    );
    assert!(chip.fetch_word(0x0040_0000, Cycle::Nonsequential).is_err());
    assert_eq!(read(&mut chip, MC + 4) >> 10 & 3, 2);
}

#[test]
fn a_misaligned_access_aborts_and_changes_nothing() {
    let mut chip = running_chip();
    write(&mut chip, SRAM, 0x1111_1111);
    assert!(try_write(&mut chip, SRAM + 2, Width::Word, 0).is_err());
    assert!(try_read(&mut chip, SRAM + 1, Width::Halfword).is_err());
    assert_eq!(read(&mut chip, MC + 4) & 0xFFF, 2 | 1 << 8);
    assert_eq!(read(&mut chip, SRAM), 0x1111_1111);
}

#[test]
fn the_boot_rom_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_read(&mut chip, 0x0030_0010, Width::Word).is_err());
    assert!(chip.fault().unwrap().to_string().contains("boot ROM"));
}

fn program_page(chip: &mut TestChip, page: u32, command: u32) {
    for word in 0..64 {
        write(
            chip,
            FLASH + 256 * page + 4 * word,
            0x0101_0101 * (word + 1),
        );
    }
    write(chip, FCR, 0x5A00_0000 | page << 8 | command);
}

#[test]
fn a_page_is_programmed_in_six_milliseconds() {
    let mut chip = running_chip();
    program_page(&mut chip, 1023, 1);
    let start = chip.now();
    assert_eq!(read(&mut chip, FSR) & 1, 0);
    while read(&mut chip, FSR) & 1 == 0 {}
    let took = chip.now() - start;
    assert!((288_329..288_334).contains(&took), "{took}");
    assert_eq!(chip.peek_word(FLASH + 0x3_FF00).unwrap(), 0x0101_0101);
    assert_eq!(chip.peek_word(FLASH + 0x3_FFFC).unwrap(), 0x4040_4040);
}

#[test]
fn code_in_flash_waits_for_the_end_of_programming() {
    let mut chip = running_chip();
    program_page(&mut chip, 5, 1);
    let waited = arm(&mut chip, FLASH);
    assert_eq!(waited, 288_329 + 2);
}

#[test]
fn without_erase_a_page_only_loses_ones() {
    let mut chip = running_chip();
    chip.load(FLASH + 256, &[0x0F; 4]).unwrap();
    write(&mut chip, FMR, 0x0048_0180);
    write(&mut chip, FLASH + 256, 0x3C3C_3C3C);
    write(&mut chip, FCR, 0x5A00_0101);
    assert_eq!(chip.peek_word(FLASH + 256).unwrap(), 0x0C0C_0C0C);
}

#[test]
fn a_locked_region_refuses_programming_until_it_is_unlocked() {
    let mut chip = running_chip();
    write(&mut chip, FCR, 0x5A00_0002 | 64 << 8);
    let _ = arm(&mut chip, FLASH);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 17);
    program_page(&mut chip, 70, 1);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 2 | 1 << 17);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 17, "LOCKE clears on reading");
    assert_eq!(chip.peek_word(FLASH + 70 * 256).unwrap(), 0xFFFF_FFFF);
    write(&mut chip, FCR, 0x5A00_0004 | 64 << 8);
    let _ = arm(&mut chip, FLASH);
    program_page(&mut chip, 70, 3);
    assert_eq!(chip.peek_word(FLASH + 70 * 256).unwrap(), 0x0101_0101);
    let _ = arm(&mut chip, FLASH);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 17, "write and lock");
}

#[test]
fn erase_all_fills_the_array_with_ones() {
    let mut chip = running_chip();
    chip.load(FLASH + 0x2_0000, &[0; 16]).unwrap();
    write(&mut chip, FCR, 0x5A00_0008);
    assert_eq!(arm(&mut chip, FLASH), 720_822 + 2);
    assert_eq!(chip.peek_word(FLASH + 0x2_0000).unwrap(), 0xFFFF_FFFF);
}

#[test]
fn a_wrong_key_or_command_is_a_programming_error() {
    let mut chip = running_chip();
    write(&mut chip, FCR, 0x0000_0001);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 3);
    write(&mut chip, FCR, 0x5A00_0007);
    assert_eq!(read(&mut chip, FSR), 1 | 1 << 3);
    assert_eq!(read(&mut chip, FSR), 1);
}

#[test]
fn a_narrow_write_to_flash_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_write(&mut chip, FLASH, Width::Byte, 1).is_err());
    assert_eq!(chip.fault().unwrap().kind, FaultKind::FlashWriteWidth);
}

#[test]
fn watched_words_report_every_write_with_its_cycle() {
    let mut chip = running_chip();
    chip.watch_word(SRAM + 0x40).unwrap();
    write(&mut chip, SRAM + 0x44, 1);
    assert!(!chip.has_watch_hits());
    write(&mut chip, SRAM + 0x40, 0xAABB_CCDD);
    let first = chip.now();
    try_write(&mut chip, SRAM + 0x41, Width::Byte, 0xEE).unwrap();
    assert!(chip.has_watch_hits());
    let hit = |at_cycles, value| WatchHit {
        at_cycles,
        address: SRAM + 0x40,
        value,
    };
    let mut hits = vec![hit(0, 0)];
    chip.take_watch_hits(&mut hits);
    assert_eq!(hits, [hit(first, 0xAABB_CCDD), hit(first + 1, 0xAABB_EEDD)]);
    assert!(!chip.has_watch_hits());
    assert!(chip.watch_word(FLASH).is_err());
}

#[test]
fn loading_and_peeking_take_no_time_and_check_the_range() {
    let mut chip = running_chip();
    let before = chip.now();
    chip.load(SRAM + 0xFFFE, &[1, 2]).unwrap();
    assert_eq!(chip.peek(SRAM + 0xFFFD, 3).unwrap(), [0, 1, 2]);
    let error = chip.load(SRAM + 0xFFFE, &[1, 2, 3]).unwrap_err();
    assert!(error
        .to_string()
        .starts_with("3 bytes at 0x0020fffe are not inside"));
    assert!(chip.peek(0xFFFF_FFFF, 2).is_err());
    assert!(chip.peek(0, 4).is_err());
    assert_eq!(chip.now(), before);
}

#[test]
fn a_cloned_chip_goes_its_own_way() {
    let mut chip = running_chip();
    write(&mut chip, SRAM, 1);
    let mut copy = chip.clone();
    write(&mut copy, SRAM, 2);
    assert_eq!((read(&mut chip, SRAM), read(&mut copy, SRAM)), (1, 2));
    assert_eq!(chip.now() + 1, copy.now());
}
