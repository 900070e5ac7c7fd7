// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Two-wire interface against a scripted slave: exact bus log and timing.
use crate::common::Seen::{TwiRead, TwiStart, TwiStop, TwiWrite};
use crate::common::{
    bus_log, bus_sequence, cold_chip, read, run_to, running_chip, running_chip_with, try_write,
    wait_for, write, Seen, TestChip, AIC, PIOA, TWI,
};
use arm7tdmi::bus::Width;
use at91sam7s::{FaultKind, TimingProfile, TwiStopDecision};

registers! {
    TWI; CR = 0x00, MMR = 0x04, CWGR = 0x10, SR = 0x20, IER = 0x24, RHR = 0x30, THR = 0x34,
}
const START: u32 = 1 << 0;
const STOP: u32 = 1 << 1;
const MSEN: u32 = 1 << 2;
const SWRST: u32 = 1 << 7;
const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const OVRE: u32 = 1 << 6;
const NACK: u32 = 1 << 8;
const WRITE_TO_1: u32 = 0x0001_0000;
const READ_FROM_1: u32 = 0x0001_1000;

/// A chip whose TWI has its pins and the given clock waveform.
fn two_wire_chip(waveform: u32) -> TestChip {
    set_up(running_chip(), waveform)
}

fn set_up(mut chip: TestChip, waveform: u32) -> TestChip {
    write(&mut chip, PIOA + 0x04, 3 << 3);
    write(&mut chip, CWGR, waveform);
    write(&mut chip, CR, MSEN);
    chip
}

/// Write all bytes as an interrupt handler would; returns when the first reached THR.
fn send(chip: &mut TestChip, bytes: &[u8]) -> u64 {
    write(chip, MMR, WRITE_TO_1);
    let mut start = 0;
    for (index, byte) in bytes.iter().enumerate() {
        wait_for(chip, SR, TXRDY);
        write(chip, THR, u32::from(*byte));
        if index == 0 {
            start = chip.now();
        }
    }
    start
}

/// What a write frame of `bytes` looks like when one bit lasts `bit` cycles.
fn write_frame(bytes: &[u8], bit: u64) -> Vec<(u64, Seen)> {
    let mut at = 10 * bit;
    let mut log = vec![(
        at,
        TwiStart {
            address: 1,
            read: false,
        },
    )];
    for byte in bytes {
        at += 9 * bit;
        log.push((at, TwiWrite(*byte)));
    }
    log.push((at + bit, TwiStop));
    log
}

#[test]
fn a_nine_byte_frame_takes_92_bits_at_both_usual_clocks() {
    let frame = [0, 8, 100, 0x9C, 0, 0, 7, 0, 0xF2];
    for (waveform, bit) in [(0x02_0F0F, 126), (0x00_3939, 120)] {
        let mut chip = two_wire_chip(waveform);
        let start = send(&mut chip, &frame);
        wait_for(&mut chip, SR, TXCOMP);
        assert_eq!(bus_log(&chip, start), write_frame(&frame, bit));
        assert_eq!(bus_log(&chip, start).last(), Some(&(92 * bit, TwiStop)));
    }
}

#[test]
fn taking_the_byte_takes_the_interrupt_back() {
    let mut chip = two_wire_chip(0x3939);
    let pending = |chip: &mut TestChip| read(chip, AIC + 0x10C) >> 9 & 1;
    write(&mut chip, IER, RXRDY);
    write(&mut chip, MMR, READ_FROM_1);
    write(&mut chip, CR, START | STOP);
    assert_eq!(pending(&mut chip), 0);
    wait_for(&mut chip, SR, RXRDY);
    let now = chip.now();
    run_to(&mut chip, now + 10);
    assert_eq!(pending(&mut chip), 1);
    read(&mut chip, RHR);
    assert_eq!(pending(&mut chip), 0);
}

#[test]
fn enabling_the_master_sets_transmit_ready() {
    let mut chip = running_chip();
    assert_eq!(read(&mut chip, SR), TXCOMP);
    write(&mut chip, CR, MSEN);
    assert_eq!(read(&mut chip, SR), TXCOMP | TXRDY);
}

#[test]
fn start_in_write_direction_with_an_empty_holding_register_does_nothing() {
    let mut chip = two_wire_chip(0x3939);
    write(&mut chip, MMR, WRITE_TO_1);
    write(&mut chip, CR, START | MSEN);
    let now = chip.now();
    run_to(&mut chip, now + 10_000);
    assert_eq!(read(&mut chip, SR), TXCOMP | TXRDY);
    assert!(bus_log(&chip, 0).is_empty());
}

#[test]
fn the_first_byte_stays_in_the_holding_register_until_the_address_is_acknowledged() {
    let mut chip = two_wire_chip(0x3939);
    let start = send(&mut chip, &[0xAA]);
    run_to(&mut chip, start + 1190);
    assert_eq!(read(&mut chip, SR) & TXRDY, 0);
    write(&mut chip, THR, 0xBB);
    run_to(&mut chip, start + 1201);
    assert_eq!(read(&mut chip, SR) & TXRDY, TXRDY);
    wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(bus_log(&chip, start), write_frame(&[0xBB], 120));
}

#[test]
fn stop_written_before_the_last_byte_is_deferred_until_it_is_sent() {
    let mut chip = two_wire_chip(0x02_0F0F);
    write(&mut chip, MMR, WRITE_TO_1);
    write(&mut chip, CR, START | MSEN);
    write(&mut chip, THR, 1);
    let start = chip.now();
    wait_for(&mut chip, SR, TXRDY);
    write(&mut chip, CR, STOP);
    write(&mut chip, THR, 2);
    wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(bus_log(&chip, start), write_frame(&[1, 2], 126));
}

#[test]
fn a_byte_written_too_late_begins_a_new_frame_after_the_stop() {
    let mut chip = two_wire_chip(0x3939);
    let start = send(&mut chip, &[1]);
    run_to(&mut chip, start + 19 * 120 + 60);
    write(&mut chip, THR, 2);
    wait_for(&mut chip, SR, TXCOMP);
    let log = bus_log(&chip, start);
    let second: Vec<_> = log[3..]
        .iter()
        .map(|(at, seen)| (at - 2400, seen.clone()))
        .collect();
    assert_eq!(second, write_frame(&[2], 120));
}

#[test]
fn an_absent_slave_gives_nack_with_completion_and_empties_the_holding_register() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().slave_address = 0x50;
    let start = send(&mut chip, &[1]);
    run_to(&mut chip, start + 11 * 120 - 2);
    assert_eq!(read(&mut chip, SR) & (NACK | TXCOMP), NACK | TXCOMP);
    assert_eq!(
        read(&mut chip, SR),
        TXCOMP | TXRDY,
        "NACK clears on reading"
    );
    let address = TwiStart {
        address: 1,
        read: false,
    };
    assert_eq!(bus_log(&chip, start), [(1200, address), (1320, TwiStop)]);
}

#[test]
fn a_refused_data_byte_ends_the_frame() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().acknowledges = Some(1);
    let start = send(&mut chip, &[1, 2, 3]);
    let status = wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(status & NACK, NACK);
    assert_eq!(bus_log(&chip, start), write_frame(&[1, 2], 120));
}

#[test]
fn without_the_pins_nothing_reaches_the_slave() {
    let mut chip = running_chip();
    write(&mut chip, CWGR, 0x3939);
    write(&mut chip, CR, MSEN);
    send(&mut chip, &[1]);
    assert_eq!(wait_for(&mut chip, SR, TXCOMP) & NACK, NACK);
    assert!(bus_log(&chip, 0).is_empty());
}

/// Read `count` bytes, with STOP written when one byte remains.
fn receive(chip: &mut TestChip, count: usize) -> (u64, Vec<u8>) {
    write(chip, MMR, READ_FROM_1);
    let stop = if count == 1 { STOP } else { 0 };
    write(chip, CR, START | MSEN | stop);
    let start = chip.now();
    let mut bytes = Vec::new();
    while bytes.len() < count {
        wait_for(chip, SR, RXRDY);
        bytes.push(read(chip, RHR) as u8);
        if bytes.len() + 1 == count {
            write(chip, CR, STOP);
        }
    }
    wait_for(chip, SR, TXCOMP);
    (start, bytes)
}

#[test]
fn thirteen_bytes_are_read_in_128_bits_and_the_last_is_not_acknowledged() {
    for (waveform, bit) in [(0x02_0F0F, 126), (0x00_3939, 120)] {
        let mut chip = two_wire_chip(waveform);
        let script: Vec<u8> = (10..23).collect();
        chip.board_mut().slave_bytes = script.iter().copied().collect();
        let (start, bytes) = receive(&mut chip, 13);
        assert_eq!(bytes, script);
        let mut expected = vec![(
            10 * bit,
            TwiStart {
                address: 1,
                read: true,
            },
        )];
        let reads = script
            .iter()
            .zip(0..)
            .map(|(byte, k)| ((10 + 9 * k) * bit, TwiRead(*byte)));
        expected.extend(reads);
        expected.push((128 * bit, TwiStop));
        assert_eq!(bus_log(&chip, start), expected);
    }
}

#[test]
fn one_byte_is_read_with_start_and_stop_together() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().slave_bytes = [7, 8].into();
    let (start, bytes) = receive(&mut chip, 1);
    assert_eq!(bytes, [7]);
    assert_eq!(bus_log(&chip, start).last(), Some(&(20 * 120, TwiStop)));
}

#[test]
fn an_unread_byte_is_overrun_by_the_next() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().slave_bytes = [1, 2, 3].into();
    write(&mut chip, MMR, READ_FROM_1);
    write(&mut chip, CR, START);
    let start = chip.now();
    run_to(&mut chip, start + 29 * 120);
    write(&mut chip, CR, STOP);
    let status = wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(status & OVRE, 0, "cleared by the earlier polls");
    assert_eq!(read(&mut chip, RHR), 3);
    assert_eq!(bus_log(&chip, start).last(), Some(&(38 * 120, TwiStop)));
}

#[test]
fn overrun_is_reported_once() {
    let mut chip = two_wire_chip(0x3939);
    write(&mut chip, MMR, READ_FROM_1);
    write(&mut chip, CR, START);
    let start = chip.now();
    run_to(&mut chip, start + 28 * 120 + 1);
    assert_eq!(read(&mut chip, SR) & OVRE, OVRE);
    assert_eq!(read(&mut chip, SR) & OVRE, 0);
}

#[test]
fn a_read_started_while_the_stop_of_a_write_is_pending_follows_it() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().slave_bytes = [9, 9].into();
    let start = send(&mut chip, &[1]);
    run_to(&mut chip, start + 19 * 120 + 10);
    write(&mut chip, MMR, READ_FROM_1);
    write(&mut chip, CR, START | STOP);
    wait_for(&mut chip, SR, RXRDY);
    let address = TwiStart {
        address: 1,
        read: true,
    };
    assert_eq!(bus_log(&chip, start)[3], (30 * 120, address));
    wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(bus_log(&chip, start).last(), Some(&(40 * 120, TwiStop)));
}

#[test]
fn the_slave_may_hold_the_clock_after_its_address() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().stretch_after_address = 333;
    let start = send(&mut chip, &[5]);
    wait_for(&mut chip, SR, TXCOMP);
    let log = bus_log(&chip, start);
    assert_eq!(log[1], (19 * 120 + 333, TwiWrite(5)));
    assert_eq!(log[2], (20 * 120 + 333, TwiStop));
}

#[test]
fn a_byte_that_comes_while_the_slave_holds_the_clock_is_in_time_if_the_stop_waits_for_that() {
    use TwiStopDecision::{Acknowledge, Release};
    for (twi_stop_decision, goes_on) in [(Acknowledge, false), (Release, true)] {
        let timing = TimingProfile {
            twi_stop_decision,
            ..TimingProfile::nominal()
        };
        let mut chip = set_up(running_chip_with(timing), 0x3939);
        chip.board_mut().stretch_after_write = 960;
        let start = send(&mut chip, &[5]);
        run_to(&mut chip, start + 19 * 120 + 800);
        write(&mut chip, THR, 6);
        wait_for(&mut chip, SR, TXCOMP);
        let stop_follows = bus_log(&chip, start)[2].1 == TwiStop;
        assert_eq!(stop_follows, !goes_on, "{twi_stop_decision:?}");
    }
}

#[test]
fn the_slave_may_hold_the_clock_before_the_stop_of_a_read() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().stretch_after_read = 444;
    write(&mut chip, MMR, READ_FROM_1);
    write(&mut chip, CR, START | STOP);
    let start = chip.now();
    wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(bus_log(&chip, start)[2], (20 * 120 + 444, TwiStop));
}

#[test]
fn internal_address_bytes_go_first_and_a_read_repeats_the_start() {
    let mut chip = two_wire_chip(0x3939);
    chip.board_mut().slave_bytes = [0x42].into();
    write(&mut chip, TWI + 0x0C, 0x1234);
    write(&mut chip, MMR, READ_FROM_1 | 2 << 8);
    write(&mut chip, CR, START | STOP);
    wait_for(&mut chip, SR, TXCOMP);
    assert_eq!(
        bus_sequence(&chip),
        [
            TwiStart {
                address: 1,
                read: false
            },
            TwiWrite(0x12),
            TwiWrite(0x34),
            TwiStart {
                address: 1,
                read: true
            },
            TwiRead(0x42),
            TwiStop
        ]
    );
    assert_eq!(read(&mut chip, RHR), 0x42);
}

#[test]
fn the_interrupt_line_follows_status_and_mask() {
    let mut chip = two_wire_chip(0x3939);
    let pending = |chip: &mut TestChip| {
        use arm7tdmi::bus::Bus;
        chip.internal(8);
        read(chip, 0xFFFF_F10C) & 1 << 9 != 0
    };
    assert!(!pending(&mut chip));
    write(&mut chip, IER, TXRDY);
    assert!(pending(&mut chip));
    write(&mut chip, THR, 0);
    assert!(!pending(&mut chip));
}

#[test]
fn software_reset_returns_to_the_reset_state() {
    let mut chip = two_wire_chip(0x3939);
    send(&mut chip, &[1]);
    write(&mut chip, CR, SWRST);
    assert_eq!(read(&mut chip, SR), TXCOMP);
    assert_eq!(read(&mut chip, CWGR), 0);
    let now = chip.now();
    run_to(&mut chip, now + 5000);
    assert!(bus_log(&chip, 0).is_empty());
}

#[test]
fn starting_a_frame_without_the_peripheral_clock_is_a_fault() {
    let mut chip = cold_chip();
    chip.enter_as_boot_monitor();
    write(&mut chip, CR, MSEN);
    assert!(try_write(&mut chip, THR, Width::Word, 0).is_err());
    let kind = FaultKind::ClockDisabled {
        peripheral: "TWI",
        identifier: 9,
    };
    assert_eq!(chip.fault().unwrap().kind, kind);
}
