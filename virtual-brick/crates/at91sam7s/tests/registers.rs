// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Every word of every peripheral slot: its reset value, or a typed fault.

use std::collections::BTreeMap;

use crate::common::{cold_chip, read, running_chip, try_read, try_write, write};
use arm7tdmi::bus::Width;
use at91sam7s::FaultKind;

/// Modelled offsets of a peripheral and what they read as after power-on.
type Table = Vec<(u32, u32)>;

fn constant(offsets: impl IntoIterator<Item = u32>) -> Table {
    offsets.into_iter().map(|offset| (offset, 0)).collect()
}

fn with(mut table: Table, values: &[(u32, u32)]) -> Table {
    for (offset, value) in values {
        table.retain(|(o, _)| o != offset);
        table.push((*offset, *value));
    }
    table
}

fn words(first: u32, last: u32) -> impl Iterator<Item = u32> {
    (first..=last).step_by(4)
}

fn timer_table() -> Table {
    let channel = [0x00, 0x04, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C];
    let mut table = constant((0..3).flat_map(|n| channel.map(|offset| 0x40 * n + offset)));
    // TIOA0 to TIOB2 are pulled up: MTIOA and MTIOB read 1.
    table = with(table, &[(0x20, 3 << 17), (0x60, 3 << 17), (0xA0, 3 << 17)]);
    table.extend([(0xC0, 0), (0xC4, 0)]);
    table
}

fn pio_table() -> Table {
    let offsets = words(0x00, 0x08)
        .chain(words(0x10, 0x18))
        .chain(words(0x20, 0x28))
        .chain(words(0x30, 0x4C))
        .chain(words(0x50, 0x58))
        .chain(words(0x60, 0x68))
        .chain(words(0x70, 0x78))
        .chain(words(0xA0, 0xA8));
    with(constant(offsets), &[(0x08, 0xFFFF_FFFF)])
}

fn usart_table(status: u32) -> Table {
    let offsets = words(0x00, 0x28).chain([0x40, 0x44, 0x4C]);
    let table = constant(offsets.chain(words(0x100, 0x124)));
    with(table, &[(0x14, status), (0x40, 0x174)])
}

fn debug_unit_table() -> Table {
    let offsets = words(0x00, 0x20).chain([0x44, 0x48]);
    let table = constant(offsets.chain(words(0x100, 0x124)));
    with(table, &[(0x14, 0x1818), (0x40, 0x270B_0941)])
}

fn ssc_table() -> Table {
    let offsets = [0x00, 0x04, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24, 0x30, 0x34]
        .into_iter()
        .chain(words(0x38, 0x4C))
        .chain(words(0x100, 0x124));
    with(constant(offsets), &[(0x40, 0xCC)])
}

fn pwmc_table() -> Table {
    let channels = (0..4).map(|n| 0x200 + 0x20 * n);
    let channels = channels.flat_map(|first| words(first, first + 0x10));
    constant(words(0x00, 0x1C).chain(channels))
}

fn udp_table() -> Table {
    let offsets = words(0x00, 0x08)
        .chain(words(0x10, 0x20))
        .chain([0x28])
        .chain(words(0x30, 0x3C))
        .chain(words(0x50, 0x5C))
        .chain([0x74]);
    with(
        constant(offsets),
        &[(0x04, 0x10), (0x08, 0x100), (0x18, 0x1000)],
    )
}

fn twi_table() -> Table {
    let offsets = [0x00, 0x04, 0x0C, 0x10, 0x20, 0x24, 0x28, 0x2C, 0x30, 0x34];
    with(constant(offsets), &[(0x20, 1)])
}

fn adc_table() -> Table {
    let offsets = [0x00, 0x04, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C];
    let table = constant(offsets.into_iter().chain(words(0x30, 0x4C)));
    with(table, &[(0x1C, 0x000C_0000)])
}

fn spi_table() -> Table {
    let offsets = words(0x00, 0x1C)
        .chain(words(0x30, 0x3C))
        .chain(words(0x100, 0x124));
    with(constant(offsets), &[(0x10, 0xF0)])
}

fn aic_table() -> Table {
    constant(
        words(0x000, 0x114)
            .chain(words(0x120, 0x138))
            .chain([0x140, 0x144, 0x148]),
    )
}

fn pmc_table() -> Table {
    let offsets = words(0x00, 0x08)
        .chain(words(0x10, 0x18))
        .chain([0x20, 0x24, 0x2C, 0x30])
        .chain(words(0x40, 0x48))
        .chain([0x60, 0x64, 0x68, 0x6C]);
    with(constant(offsets), &[(0x08, 1), (0x2C, 0x3F00), (0x68, 8)])
}

fn memory_controller_table() -> Table {
    with(constant([0x00, 0x04, 0x08, 0x60, 0x64]), &[(0x68, 1)])
}

/// All modelled registers of the chip by address.
pub fn modelled() -> BTreeMap<u32, u32> {
    let peripherals: [(u32, Table); 19] = [
        (0xFFFA_0000, timer_table()),
        (0xFFFB_0000, udp_table()),
        (0xFFFB_8000, twi_table()),
        // CTS0 is pulled up; so are RI1, DSR1, DCD1 and CTS1.
        (0xFFFC_0000, usart_table(0x0080_1818)),
        (0xFFFC_4000, usart_table(0x00F0_1818)),
        (0xFFFC_C000, pwmc_table()),
        (0xFFFD_4000, ssc_table()),
        (0xFFFD_8000, adc_table()),
        (0xFFFE_0000, spi_table()),
        (0xFFFF_F000, aic_table()),
        (0xFFFF_F200, debug_unit_table()),
        (0xFFFF_F400, pio_table()),
        (0xFFFF_FC00, pmc_table()),
        (0xFFFF_FD00, vec![(0, 0), (4, 0x0001_0000), (8, 0)]),
        (
            0xFFFF_FD20,
            vec![(0, 0x8000), (4, 0xFFFF_FFFF), (8, 0), (12, 0)],
        ),
        (0xFFFF_FD30, vec![(0, 0x000F_FFFF), (4, 0), (8, 0), (12, 0)]),
        (0xFFFF_FD40, vec![(0, 0), (4, 0x3FFF_2FFF), (8, 0)]),
        (0xFFFF_FD60, vec![(0, 0)]),
        (0xFFFF_FF00, memory_controller_table()),
    ];
    let flat = |(base, table): (u32, Table)| table.into_iter().map(move |(o, v)| (base + o, v));
    peripherals.into_iter().flat_map(flat).collect()
}

#[test]
fn every_modelled_register_has_its_reset_value() {
    for (address, value) in modelled() {
        let mut chip = cold_chip();
        assert_eq!(read(&mut chip, address), value, "register {address:#010x}");
        assert!(chip.fault().is_none());
    }
}

#[test]
fn every_other_word_of_a_modelled_slot_is_a_typed_fault() {
    let modelled = modelled();
    let slots = [
        0xFFFA_0000u32,
        0xFFFB_0000,
        0xFFFB_8000,
        0xFFFC_0000,
        0xFFFC_4000,
        0xFFFC_C000,
        0xFFFD_4000,
        0xFFFD_8000,
        0xFFFE_0000,
        0xFFFF_C000,
    ];
    let mut chip = cold_chip();
    for address in slots
        .into_iter()
        .flat_map(|slot| words(slot, slot + 0x3FFC))
    {
        let answer = try_read(&mut chip, address, Width::Word);
        assert_eq!(
            answer.is_ok(),
            modelled.contains_key(&address),
            "{address:#010x}"
        );
        if let Some(fault) = chip.fault() {
            assert!(matches!(
                fault.kind,
                FaultKind::RegisterNotModelled { .. } | FaultKind::NoPeripheral
            ));
            assert_eq!(fault.address, address);
            chip = cold_chip();
        }
    }
}

#[test]
fn an_unmodelled_register_is_reported_by_name_and_address() {
    let mut chip = running_chip();
    assert!(try_write(&mut chip, 0xFFFD_4000, Width::Word, 1).is_err());
    let text = chip.fault().unwrap().to_string();
    let expected = format!(
        "SSC: reception is not modelled; write of 0x00000001 to 0xfffd4000 at cycle {}",
        chip.now()
    );
    assert_eq!(text, expected);
}

#[test]
fn an_empty_slot_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_read(&mut chip, 0xFFFA_4000, Width::Word).is_err());
    assert_eq!(chip.fault().unwrap().kind, FaultKind::NoPeripheral);
}

#[test]
fn the_first_fault_is_kept() {
    let mut chip = running_chip();
    assert!(try_read(&mut chip, 0xFFFD_4050, Width::Word).is_err());
    assert!(try_read(&mut chip, 0xFFFC_0054, Width::Word).is_err());
    assert_eq!(chip.fault().unwrap().address, 0xFFFD_4050);
}

#[test]
fn mask_registers_set_with_ier_and_clear_with_idr() {
    // (IER, IDR, IMR, bits)
    let masks = [
        (0xFFFA_0024u32, 0xFFFA_0028u32, 0xFFFA_002Cu32, 0xFFu32),
        (0xFFFB_8024, 0xFFFB_8028, 0xFFFB_802C, 0x1C7),
        (0xFFFD_8024, 0xFFFD_8028, 0xFFFD_802C, 0xF_FFFF),
        (0xFFFE_0014, 0xFFFE_0018, 0xFFFE_001C, 0x3FF),
        (0xFFFB_0010, 0xFFFB_0014, 0xFFFB_0018, 0x3B0F),
        (0xFFFC_0008, 0xFFFC_000C, 0xFFFC_0010, 0x000F_3FFF),
        (0xFFFC_C010, 0xFFFC_C014, 0xFFFC_C018, 0xF),
        (0xFFFD_4044, 0xFFFD_4048, 0xFFFD_404C, 0xFFF),
        (0xFFFF_F208, 0xFFFF_F20C, 0xFFFF_F210, 0x1AFB),
        (0xFFFF_F120, 0xFFFF_F124, 0xFFFF_F110, 0xFFFF_FFFF),
        (0xFFFF_F440, 0xFFFF_F444, 0xFFFF_F448, 0xFFFF_FFFF),
        (0xFFFF_FC60, 0xFFFF_FC64, 0xFFFF_FC6C, 0x70D),
    ];
    let mut chip = running_chip();
    for (enable, disable, mask, bits) in masks {
        write(&mut chip, enable, 0x3FFF_FFFF);
        write(&mut chip, enable, bits);
        assert_eq!(read(&mut chip, mask), bits, "{mask:#010x}");
        write(&mut chip, disable, 0xFFFF_FFFE);
        // The end of a USB bus reset cannot be masked.
        let fixed = if mask == 0xFFFB_0018 { 1 << 12 } else { 0 };
        assert_eq!(read(&mut chip, mask), bits & 1 | fixed, "{mask:#010x}");
    }
}

#[test]
fn a_byte_store_reaches_a_register_and_a_byte_load_picks_its_lane() {
    let mut chip = running_chip();
    try_write(&mut chip, 0xFFFF_F138, Width::Byte, 0x01).unwrap();
    assert_eq!(try_read(&mut chip, 0xFFFF_F138, Width::Byte), Ok(1));
    assert_eq!(try_read(&mut chip, 0xFFFF_F243, Width::Byte), Ok(0x27));
    assert_eq!(
        try_read(&mut chip, 0xFFFF_F242, Width::Halfword),
        Ok(0x270B)
    );
}
