// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Serial peripheral interface with its data controller channel.
use crate::common::{
    bus_log, bus_sequence, read, run_to, running_chip, try_write, wait_for, write, Seen, TestChip,
    PIOA, SPI, SRAM,
};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::FaultKind;

registers! {
    SPI; CR = 0x00, MR = 0x04, RDR = 0x08, TDR = 0x0C, SR = 0x10, IER = 0x14, CSR0 = 0x30,
    CSR2 = 0x38, RPR = 0x100, RCR = 0x104, TPR = 0x108, TCR = 0x10C, RNPR = 0x110, RNCR = 0x114,
    TNPR = 0x118, TNCR = 0x11C, PTCR = 0x120,
}
const TDRE: u32 = 1 << 1;
const ENDTX: u32 = 1 << 5;
const TXBUFE: u32 = 1 << 7;
const TXEMPTY: u32 = 1 << 9;

/// Pins of the SPI: its clock and data, its select line 2 (B) and its select line 1 (A).
const LINES: u32 = 1 << 13 | 1 << 14;
const LINE_2: u32 = 1 << 10;
const LINE_1: u32 = 1 << 31;

/// Give these pins to the peripherals A.
fn give(chip: &mut TestChip, pins: u32) {
    write(chip, PIOA + 0x04, pins);
}

/// Display settings with the chip select driven by the peripheral: 8 bits at MCK/24, no delays.
fn select_by_peripheral() -> TestChip {
    let mut chip = running_chip();
    give(&mut chip, LINES | LINE_2);
    write(&mut chip, PIOA + 0x74, LINE_2);
    write(&mut chip, MR, 0x000B_0011);
    write(&mut chip, CSR2, 0x1801);
    write(&mut chip, CR, 1);
    chip
}

/// Display settings with the chip select on a PIO pin: DLYBS and DLYBCT of 24.
fn select_by_pin() -> TestChip {
    let mut chip = running_chip();
    give(&mut chip, LINES);
    write(&mut chip, MR, 0x0600_0001);
    write(&mut chip, CSR0, 0x1818_1801);
    write(&mut chip, CR, 1);
    chip
}

fn frames(chip: &TestChip, start: u64) -> Vec<(u64, u32, u16)> {
    let frame = |(at, seen)| match seen {
        Seen::Spi {
            selected,
            frame,
            bits: 8,
        } => (at, selected, frame),
        other => panic!("{other:?}"),
    };
    bus_log(chip, start).into_iter().map(frame).collect()
}

#[test]
fn one_byte_takes_the_lead_and_eight_clock_periods() {
    let mut chip = select_by_peripheral();
    assert_eq!(read(&mut chip, SR), 0x0001_02F2);
    write(&mut chip, TDR, 0xA5);
    let start = chip.now();
    assert_eq!(read(&mut chip, SR) & (TDRE | TXEMPTY), TDRE);
    wait_for(&mut chip, SR, TXEMPTY);
    assert_eq!(frames(&chip, start), [(12 + 8 * 24, LINE_2, 0xA5)]);
}

/// SPI_MR.FDIV of the datasheet: the interface runs at a 32nd of the master clock.
#[test]
fn the_clock_may_be_divided_by_32_first() {
    let mut chip = select_by_peripheral();
    write(&mut chip, MR, 0x000B_0019);
    write(&mut chip, TDR, 0xA5);
    let start = chip.now();
    wait_for(&mut chip, SR, TXEMPTY);
    assert_eq!(frames(&chip, start), [(32 * (12 + 8 * 24), LINE_2, 0xA5)]);
}

#[test]
fn a_frame_carries_no_more_than_its_bits_of_the_data_register() {
    let mut chip = select_by_peripheral();
    let start = chip.now();
    write(&mut chip, TDR, 0xFFFF_FF5A);
    wait_for(&mut chip, SR, TXEMPTY);
    // Nine bits.
    write(&mut chip, CSR2, 0x1811);
    write(&mut chip, TDR, 0xFFFF_FF5A);
    wait_for(&mut chip, SR, TXEMPTY);
    let seen = bus_log(&chip, start).into_iter().map(|(_, seen)| seen);
    let frame = |frame, bits| Seen::Spi {
        selected: LINE_2,
        frame,
        bits,
    };
    assert!(seen.eq([frame(0x5A, 8), frame(0x15A, 9)]));
}

#[test]
fn the_data_controller_sends_a_hundred_bytes_at_192_cycles_each() {
    let mut chip = select_by_peripheral();
    let line: Vec<u8> = (0..100).collect();
    chip.load(SRAM + 0x100, &line).unwrap();
    write(&mut chip, PTCR, 1 << 8);
    write(&mut chip, TPR, SRAM + 0x100);
    write(&mut chip, TCR, 100);
    let start = chip.now() - 2;
    assert_eq!(read(&mut chip, SR) & (ENDTX | TXBUFE), 0);
    wait_for(&mut chip, SR, TXEMPTY);
    let expected: Vec<_> = (0..100)
        .map(|k| (12 + 192 * (k + 1), LINE_2, line[k as usize].into()))
        .collect();
    assert_eq!(frames(&chip, start), expected);
    assert_eq!(read(&mut chip, TPR), SRAM + 0x100 + 100);
    assert_eq!(read(&mut chip, SR) & (ENDTX | TXBUFE), ENDTX | TXBUFE);
}

#[test]
fn delays_between_transfers_make_a_byte_960_cycles_long() {
    let mut chip = select_by_pin();
    chip.load(SRAM, &[1, 2, 3]).unwrap();
    write(&mut chip, PTCR, 1 << 8);
    write(&mut chip, TPR, SRAM);
    write(&mut chip, TCR, 3);
    let start = chip.now() - 2;
    wait_for(&mut chip, SR, TXEMPTY);
    let end = chip.now() - start;
    let expected = [
        (24 + 192, 0, 1),
        (24 + 192 + 960, 0, 2),
        (24 + 192 + 1920, 0, 3),
    ];
    assert_eq!(frames(&chip, start), expected);
    assert!(
        (2904..2909).contains(&end),
        "TXEMPTY comes after the last delay: {end}"
    );
}

#[test]
fn a_next_buffer_becomes_the_current_one_at_once_when_none_is_running() {
    let mut chip = select_by_peripheral();
    write(&mut chip, TNPR, SRAM + 8);
    assert_eq!(read(&mut chip, SR) & ENDTX, ENDTX);
    write(&mut chip, TNCR, 4);
    assert_eq!(read(&mut chip, SR) & ENDTX, 0);
    assert_eq!(read(&mut chip, TNCR), 0);
    assert_eq!(read(&mut chip, TCR), 4);
    assert_eq!(read(&mut chip, TPR), SRAM + 8);
}

#[test]
fn the_next_buffer_follows_the_current_one_and_the_end_of_the_first_is_flagged() {
    let mut chip = select_by_peripheral();
    chip.load(SRAM, &[1, 2, 3, 4]).unwrap();
    write(&mut chip, TPR, SRAM);
    write(&mut chip, TCR, 3);
    write(&mut chip, TNPR, SRAM + 3);
    write(&mut chip, TNCR, 1);
    write(&mut chip, PTCR, 1 << 8);
    let status = wait_for(&mut chip, SR, ENDTX);
    assert_eq!(status & TXBUFE, 0, "the second buffer is still there");
    wait_for(&mut chip, SR, TXBUFE);
    wait_for(&mut chip, SR, TXEMPTY);
    let bytes: Vec<_> = frames(&chip, 0)
        .into_iter()
        .map(|(_, _, byte)| byte)
        .collect();
    assert_eq!(bytes, [1, 2, 3, 4]);
}

#[test]
fn end_of_transmission_interrupts() {
    let mut chip = select_by_peripheral();
    chip.load(SRAM, &[1, 2]).unwrap();
    write(&mut chip, TNPR, SRAM);
    write(&mut chip, TNCR, 2);
    write(&mut chip, IER, ENDTX);
    let pending = |chip: &mut TestChip| read(chip, 0xFFFF_F10C) & 1 << 5 != 0;
    chip.internal(10);
    assert!(!pending(&mut chip));
    write(&mut chip, PTCR, 1 << 8);
    chip.internal(10);
    assert!(
        pending(&mut chip),
        "both bytes have left memory: one shifts, one waits"
    );
}

#[test]
fn received_frames_go_to_memory() {
    let mut chip = select_by_peripheral();
    chip.board_mut().spi_answer = 0x5A;
    chip.load(SRAM, &[1, 2]).unwrap();
    for (register, value) in [(RPR, SRAM + 0x20), (RCR, 2), (TPR, SRAM), (TCR, 2)] {
        write(&mut chip, register, value);
    }
    write(&mut chip, PTCR, 1 << 8 | 1);
    wait_for(&mut chip, SR, 1 << 6);
    assert_eq!(chip.peek(SRAM + 0x20, 3).unwrap(), [0x5A, 0x5A, 0]);
}

/// AT91SAM7S datasheet, 23.3.3: ENDRX when RCR reaches 0, RXBUFF when RNCR is 0 as well.
#[test]
fn each_full_receive_buffer_is_flagged_until_a_count_is_written() {
    const ENDRX: u32 = 1 << 4;
    const RXBUFF: u32 = 1 << 6;
    let full = |chip: &mut TestChip| read(chip, SR) & (ENDRX | RXBUFF);
    let send_one = |chip: &mut TestChip| {
        write(chip, TPR, SRAM);
        write(chip, TCR, 1);
        wait_for(chip, SR, TXEMPTY);
    };
    let mut chip = select_by_peripheral();
    write(&mut chip, PTCR, 1 << 8 | 1);
    assert_eq!(full(&mut chip), ENDRX | RXBUFF, "no buffer at all");
    for (register, value) in [(RPR, SRAM + 0x20), (RCR, 2), (RNPR, SRAM + 0x30), (RNCR, 1)] {
        write(&mut chip, register, value);
    }
    assert_eq!(full(&mut chip), 0);
    send_one(&mut chip);
    assert_eq!(full(&mut chip), 0, "one of two");
    send_one(&mut chip);
    assert_eq!(full(&mut chip), ENDRX, "the next buffer has room");
    write(&mut chip, RCR, 1);
    assert_eq!(full(&mut chip), 0, "a count was written");
    write(&mut chip, RCR, 0);
    assert_eq!(
        full(&mut chip),
        ENDRX | RXBUFF,
        "a program takes its buffer back"
    );
    write(&mut chip, RCR, 1);
    send_one(&mut chip);
    assert_eq!(full(&mut chip), ENDRX | RXBUFF);
}

#[test]
fn an_unread_frame_is_overrun() {
    let mut chip = select_by_peripheral();
    chip.board_mut().spi_answer = 0x77;
    write(&mut chip, TDR, 1);
    write(&mut chip, TDR, 2);
    let now = chip.now();
    run_to(&mut chip, now + 500);
    assert_eq!(read(&mut chip, SR) & 9, 9);
    assert_eq!(read(&mut chip, SR) & 9, 1, "OVRES clears on reading");
    assert_eq!(read(&mut chip, RDR), 0x000B_0077);
    assert_eq!(read(&mut chip, SR) & 1, 0);
}

#[test]
fn frames_leave_only_through_pins_that_the_program_gave_to_the_interface() {
    let send = |prepare: &dyn Fn(&mut TestChip)| {
        let mut chip = select_by_peripheral();
        prepare(&mut chip);
        let start = chip.now();
        write(&mut chip, TDR, 0xA5);
        wait_for(&mut chip, SR, TXEMPTY);
        let frames = frames(&chip, start);
        frames
            .into_iter()
            .map(|(_, selected, _)| selected)
            .collect()
    };
    let none: [u32; 0] = [];
    assert_eq!(send(&|_| ()), [LINE_2]);
    for pin in [13, 14] {
        let taken: Vec<u32> = send(&|chip| write(chip, PIOA, 1 << pin));
        assert_eq!(taken, none, "PA{pin} belongs to the PIO controller");
        let other: Vec<u32> = send(&|chip| write(chip, PIOA + 0x74, 1 << pin));
        assert_eq!(other, none, "PA{pin} belongs to peripheral B");
    }
    assert_eq!(send(&|chip| write(chip, PIOA, LINE_2)), [0]);
    assert_eq!(send(&|chip| write(chip, PIOA + 0x70, LINE_2)), [0]);
}

#[test]
fn variable_selection_takes_chip_select_and_size_with_the_data() {
    let mut chip = select_by_peripheral();
    give(&mut chip, LINE_1);
    write(&mut chip, MR, 0x0000_0013);
    write(&mut chip, CSR0 + 4, 0x0882);
    write(&mut chip, TDR, 0x000D_CAFE);
    wait_for(&mut chip, SR, TXEMPTY);
    assert_eq!(
        bus_sequence(&chip),
        [Seen::Spi {
            selected: LINE_1,
            frame: 0xCAFE,
            bits: 16
        }]
    );
}

#[test]
fn each_transfer_of_the_data_controller_delays_the_processor_by_one_cycle() {
    let mut chip = select_by_peripheral();
    write(&mut chip, TPR, SRAM);
    write(&mut chip, TCR, 3);
    write(&mut chip, PTCR, 1 << 8);
    let started = chip.now();
    chip.internal(1000);
    assert_eq!(
        chip.now() - started,
        1001,
        "two transfers were charged to the enabling store"
    );
}

#[test]
fn only_clock_modes_whose_slaves_sample_at_rising_edges_are_modelled() {
    for (settings, modelled) in [
        (0x1800, false),
        (0x1801, true),
        (0x1802, true),
        (0x1803, false),
    ] {
        let mut chip = select_by_peripheral();
        write(&mut chip, CSR2, settings);
        let sent = try_write(&mut chip, TDR, Width::Word, 1);
        assert_eq!(sent.is_ok(), modelled, "{settings:#x}");
    }
}

#[test]
fn a_pointer_outside_memory_is_a_fault() {
    let mut chip = select_by_peripheral();
    write(&mut chip, TPR, 0x4000_0000);
    write(&mut chip, TCR, 1);
    write(&mut chip, PTCR, 1 << 8);
    let fault = chip.fault().unwrap();
    assert_eq!(fault.kind, FaultKind::TransferAddress { peripheral: "SPI" });
    assert_eq!(fault.address, 0x4000_0000);
}
