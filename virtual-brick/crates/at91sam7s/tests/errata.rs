// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Faults of the silicon, each alone.
use crate::common::Seen::{Spi, TwiStart, TwiStop, TwiWrite};
use crate::common::{
    bus_sequence, faulty_chip, read, wait_for, write, TestChip, ADC, AIC, PIOA, SPI, TWI,
};
use arm7tdmi::bus::Bus;
use at91sam7s::Errata;

registers! {
    TWI; CR = 0x00, MMR = 0x04, CWGR = 0x10, SR = 0x20, IER = 0x24, RHR = 0x30, THR = 0x34,
}
const START: u32 = 1 << 0;
const STOP: u32 = 1 << 1;
const MSEN: u32 = 1 << 2;
const MSDIS: u32 = 1 << 3;
const SWRST: u32 = 1 << 7;
const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const NACK: u32 = 1 << 8;
const LINES: u32 = 3 << 3;
const WRITE_TO_1: u32 = 0x0001_0000;
const READ_FROM_1: u32 = 0x0001_1000;

fn two_wire_chip(errata: Errata) -> TestChip {
    let mut chip = faulty_chip(errata);
    write(&mut chip, PIOA + 0x04, LINES);
    write(&mut chip, CWGR, 0x3939);
    write(&mut chip, CR, MSEN);
    chip
}

fn send(chip: &mut TestChip, byte: u32) {
    write(chip, MMR, WRITE_TO_1);
    write(chip, THR, byte);
}

#[test]
fn by_default_a_chip_has_the_faults_that_drivers_of_others_name() {
    let named = Errata {
        twi_nack_lost: true,
        twi_locked_by_low_line: true,
        ..Errata::NONE
    };
    assert_eq!(Errata::default(), named);
}

#[test]
fn a_missing_acknowledge_is_lost_on_who_polls_the_status() {
    for (polled, expected) in [(true, TXCOMP), (false, TXCOMP | NACK)] {
        let mut chip = two_wire_chip(Errata {
            twi_nack_lost: true,
            ..Errata::NONE
        });
        chip.board_mut().slave_address = 0x50;
        send(&mut chip, 1);
        let status = if polled {
            wait_for(&mut chip, SR, TXCOMP)
        } else {
            // An interrupt tells the end.
            write(&mut chip, IER, TXCOMP);
            wait_for(&mut chip, AIC + 0x10C, 1 << 9);
            read(&mut chip, SR)
        };
        assert_eq!(status & (TXCOMP | NACK), expected);
    }
}

/// Pull TWCK low as a program that clears the bus would, and write the control register.
fn control_with_low_clock(chip: &mut TestChip, command: u32) {
    for register in [0x34, 0x10, 0x00] {
        write(chip, PIOA + register, 1 << 4);
    }
    write(chip, CR, command);
    write(chip, PIOA + 0x30, 1 << 4);
    write(chip, PIOA + 0x04, 1 << 4);
}

#[test]
fn enabled_or_reset_with_a_low_line_the_interface_is_dead_until_a_reset_with_both_high() {
    for command in [MSEN, SWRST] {
        let mut chip = two_wire_chip(Errata {
            twi_locked_by_low_line: true,
            ..Errata::NONE
        });
        control_with_low_clock(&mut chip, command);
        write(&mut chip, CWGR, 0x3939);
        write(&mut chip, CR, MSEN);
        send(&mut chip, 1);
        chip.internal(5_000);
        assert!(bus_sequence(&chip).is_empty(), "{command:#x}");
        write(&mut chip, CR, SWRST);
        write(&mut chip, CWGR, 0x3939);
        write(&mut chip, CR, MSEN);
        send(&mut chip, 1);
        chip.internal(5_000);
        let address = TwiStart {
            address: 1,
            read: false,
        };
        assert_eq!(bus_sequence(&chip), [address, TwiWrite(1), TwiStop]);
    }
}

#[test]
fn disabled_in_a_frame_the_interface_freezes() {
    for (freezes, expected) in [(true, 0), (false, TXCOMP)] {
        let mut chip = two_wire_chip(Errata {
            twi_disable_freezes: freezes,
            ..Errata::NONE
        });
        send(&mut chip, 1);
        wait_for(&mut chip, SR, TXRDY);
        write(&mut chip, CR, MSDIS);
        chip.internal(5_000);
        assert_eq!(read(&mut chip, SR) & TXCOMP, expected);
    }
}

#[test]
fn a_received_byte_that_was_left_is_overwritten_by_the_next_written_one() {
    for (overwritten, expected) in [(true, 0x5A), (false, 7)] {
        let mut chip = two_wire_chip(Errata {
            twi_received_byte_overwritten: overwritten,
            ..Errata::NONE
        });
        chip.board_mut().slave_bytes.push_back(7);
        write(&mut chip, MMR, READ_FROM_1);
        write(&mut chip, CR, START | STOP);
        wait_for(&mut chip, SR, TXCOMP);
        send(&mut chip, 0x5A);
        assert_eq!(wait_for(&mut chip, SR, TXCOMP) & RXRDY, RXRDY);
        assert_eq!(read(&mut chip, RHR), expected);
    }
}

#[test]
fn after_a_single_reset_the_display_port_sends_without_its_select_line() {
    for (resets, select) in [(0, 1 << 10), (1, 0), (2, 1 << 10)] {
        let mut chip = faulty_chip(Errata {
            spi_reset_needs_two: true,
            ..Errata::NONE
        });
        write(&mut chip, PIOA + 0x04, 1 << 10 | 3 << 13);
        write(&mut chip, PIOA + 0x74, 1 << 10);
        (0..resets).for_each(|_| write(&mut chip, SPI, 1 << 7));
        write(&mut chip, SPI + 0x04, 0x000B_0011);
        write(&mut chip, SPI + 0x38, 0x1801);
        write(&mut chip, SPI, 1);
        write(&mut chip, SPI + 0x0C, 0x5A);
        chip.internal(1_000);
        let frame = Spi {
            selected: select,
            frame: 0x5A,
            bits: 8,
        };
        assert_eq!(bus_sequence(&chip), [frame], "{resets} resets");
    }
}

#[test]
fn reading_a_channel_clears_data_ready_too() {
    for (clears, expected) in [(true, 0), (false, 1 << 16)] {
        let mut chip = faulty_chip(Errata {
            adc_channel_read_clears_drdy: clears,
            ..Errata::NONE
        });
        write(&mut chip, ADC + 0x10, 1 << 1);
        write(&mut chip, ADC, 2);
        wait_for(&mut chip, ADC + 0x1C, 1 << 16);
        read(&mut chip, ADC + 0x34);
        assert_eq!(read(&mut chip, ADC + 0x1C) & 1 << 16, expected);
    }
}
