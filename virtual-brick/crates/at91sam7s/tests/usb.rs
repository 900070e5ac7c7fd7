// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! USB device port: bus, control transfers, banks.
use crate::common::{bus_log, read, running_chip, try_write, write, Seen, TestChip, AIC, PMC};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::board::{UsbAnswer, UsbPacket, UsbSignal, UsbTransaction};
use at91sam7s::FaultKind;

const UDP: u32 = 0xFFFB_0000;
registers! {
    UDP; FRM_NUM = 0x00, GLB_STAT = 0x04, FADDR = 0x08, IER = 0x10, ISR = 0x1C, ICR = 0x20,
    RST_EP = 0x28,
}
const CSR: [u32; 4] = [UDP + 0x30, UDP + 0x34, UDP + 0x38, UDP + 0x3C];
const FDR: [u32; 4] = [UDP + 0x50, UDP + 0x54, UDP + 0x58, UDP + 0x5C];
const TXVC: u32 = UDP + 0x74;
const TXCOMP: u32 = 1 << 0;
const RX_DATA_BK0: u32 = 1 << 1;
const RXSETUP: u32 = 1 << 2;
const STALLSENT: u32 = 1 << 3;
const TXPKTRDY: u32 = 1 << 4;
const FORCESTALL: u32 = 1 << 5;
const RX_DATA_BK1: u32 = 1 << 6;
const DIR: u32 = 1 << 7;
const BULK_OUT: u32 = 2 << 8;
const BULK_IN: u32 = 6 << 8;
const EPEDS: u32 = 1 << 15;
/// Flags that stay when 1 is written.
const KEPT: u32 = TXCOMP | RX_DATA_BK0 | RXSETUP | STALLSENT | RX_DATA_BK1;

/// Clocks and transceiver on, nothing on the bus yet.
fn usb_chip() -> TestChip {
    let mut chip = running_chip();
    write(&mut chip, PMC, 1 << 7);
    write(&mut chip, TXVC, 0);
    chip
}

/// The bus was reset and endpoint 0 is enabled.
fn default_chip() -> TestChip {
    let mut chip = usb_chip();
    host(&mut chip, UsbSignal::Reset);
    write(&mut chip, ICR, 1 << 12);
    set(&mut chip, 0, EPEDS);
    chip
}

/// Let the host do something now; the device's answer to a transaction.
fn host(chip: &mut TestChip, signal: UsbSignal) -> Option<UsbAnswer> {
    let at = chip.now() + 1;
    chip.board_mut().log.clear();
    chip.board_mut().usb.push_back((at, signal));
    chip.internal(3);
    match bus_log(chip, 0).as_slice() {
        [] => None,
        [(_, Seen::Usb(answer))] => Some(*answer),
        other => panic!("{other:?}"),
    }
}

fn transact(chip: &mut TestChip, address: u8, endpoint: u8, kind: UsbTransaction) -> UsbAnswer {
    let signal = UsbSignal::Transaction {
        address,
        endpoint,
        transaction: kind,
    };
    host(chip, signal).unwrap()
}

fn setup(chip: &mut TestChip, request: [u8; 8]) -> UsbAnswer {
    transact(chip, 0, 0, UsbTransaction::Setup(request))
}

fn out(chip: &mut TestChip, endpoint: u8, data: &[u8]) -> UsbAnswer {
    let packet = UsbPacket::new(data).unwrap();
    transact(chip, 0, endpoint, UsbTransaction::Out(packet))
}

fn data(bytes: &[u8]) -> UsbAnswer {
    UsbAnswer::Data(UsbPacket::new(bytes).unwrap())
}

/// Set bits of a control register the way drivers do: write, then poll.
fn set(chip: &mut TestChip, endpoint: usize, bits: u32) {
    let value = read(chip, CSR[endpoint]) | KEPT | bits;
    write(chip, CSR[endpoint], value);
    while read(chip, CSR[endpoint]) & bits != bits {}
}

/// Clear bits of a control register the way drivers do.
fn clear(chip: &mut TestChip, endpoint: usize, bits: u32) {
    let value = (read(chip, CSR[endpoint]) | KEPT) & !bits;
    write(chip, CSR[endpoint], value);
    while read(chip, CSR[endpoint]) & bits != 0 {}
}

fn received(chip: &mut TestChip, endpoint: usize) -> Vec<u8> {
    let count = read(chip, CSR[endpoint]) >> 16;
    (0..count)
        .map(|_| read(chip, FDR[endpoint]) as u8)
        .collect()
}

fn give(chip: &mut TestChip, endpoint: usize, bytes: &[u8]) {
    for byte in bytes {
        write(chip, FDR[endpoint], u32::from(*byte));
    }
    set(chip, endpoint, TXPKTRDY);
}

#[test]
fn the_port_is_refused_while_its_clock_is_not_48_mhz() {
    let mut chip = usb_chip();
    // As the boot monitor leaves it, but with USBDIV = 0: 96 MHz.
    write(&mut chip, PMC + 0x2C, 0x0048_1C0E);
    assert!(try_write(&mut chip, CSR[0], Width::Word, EPEDS).is_err());
    let text = chip.fault().unwrap().to_string();
    assert!(text.starts_with("UDP: a USB clock other than 48 MHz (USBDIV)"));
}

#[test]
fn the_end_of_a_bus_reset_interrupts_whatever_the_mask() {
    let mut chip = usb_chip();
    write(&mut chip, FADDR, 0x105);
    set(&mut chip, 1, EPEDS | BULK_OUT);
    host(&mut chip, UsbSignal::Reset);
    assert_eq!(read(&mut chip, ISR), 1 << 12);
    chip.internal(10);
    assert_ne!(read(&mut chip, AIC + 0x10C) & 1 << 11, 0);
    assert_eq!(read(&mut chip, FADDR), 0x100);
    assert_eq!(read(&mut chip, CSR[1]), 0, "endpoints are disabled");
    write(&mut chip, ICR, 1 << 12);
    assert_eq!(read(&mut chip, ISR), 0);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 1 << 11, 0);
}

#[test]
fn a_written_control_register_reads_back_after_it_has_crossed_the_clocks() {
    let mut chip = usb_chip();
    write(&mut chip, CSR[1], EPEDS | BULK_OUT);
    assert_eq!(read(&mut chip, CSR[1]), 0);
    assert_eq!(read(&mut chip, CSR[1]), EPEDS | BULK_OUT);
}

#[test]
fn a_setup_packet_is_read_and_answered_in_pieces_of_eight_bytes() {
    let mut chip = default_chip();
    write(&mut chip, IER, 1);
    let request = [0x80, 6, 0, 1, 0, 0, 18, 0];
    assert_eq!(setup(&mut chip, request), UsbAnswer::Acknowledged);
    assert_eq!(read(&mut chip, ISR), 1);
    let status = read(&mut chip, CSR[0]);
    assert_eq!(status, EPEDS | RXSETUP | 8 << 16);
    assert_eq!(received(&mut chip, 0), request);
    let input = UsbTransaction::In;
    assert_eq!(transact(&mut chip, 0, 0, input), UsbAnswer::NotReady);
    set(&mut chip, 0, DIR);
    clear(&mut chip, 0, RXSETUP);
    for piece in [&[1u8, 2, 3, 4, 5, 6, 7, 8][..], &[9, 10]] {
        give(&mut chip, 0, piece);
        assert_eq!(transact(&mut chip, 0, 0, input), data(piece));
        assert_eq!(read(&mut chip, CSR[0]) & (TXCOMP | TXPKTRDY), TXCOMP);
        assert_eq!(transact(&mut chip, 0, 0, input), UsbAnswer::NotReady);
        clear(&mut chip, 0, TXCOMP);
    }
    assert_eq!(out(&mut chip, 0, &[]), UsbAnswer::Acknowledged);
    let status = read(&mut chip, CSR[0]);
    assert_eq!(status & (RX_DATA_BK0 | 0x7FF << 16), RX_DATA_BK0);
    clear(&mut chip, 0, RX_DATA_BK0);
    assert_eq!(read(&mut chip, ISR), 0);
}

#[test]
fn a_setup_packet_ends_the_transfer_before() {
    let mut chip = default_chip();
    give(&mut chip, 0, &[]);
    let input = UsbTransaction::In;
    assert_eq!(transact(&mut chip, 0, 0, input), data(&[]));
    give(&mut chip, 0, b"stale");
    assert_eq!(setup(&mut chip, [0; 8]), UsbAnswer::Acknowledged);
    assert_eq!(read(&mut chip, CSR[0]), EPEDS | RXSETUP | 8 << 16);
    received(&mut chip, 0);
    clear(&mut chip, 0, RXSETUP);
    assert_eq!(transact(&mut chip, 0, 0, input), UsbAnswer::NotReady);
}

#[test]
fn only_the_own_address_answers() {
    let mut chip = default_chip();
    write(&mut chip, FADDR, 0x105);
    write(&mut chip, GLB_STAT, 1);
    let request = UsbTransaction::Setup([0; 8]);
    assert_eq!(transact(&mut chip, 0, 0, request), UsbAnswer::Silent);
    assert_eq!(transact(&mut chip, 5, 0, request), UsbAnswer::Acknowledged);
    write(&mut chip, TXVC, 1 << 8);
    assert_eq!(transact(&mut chip, 5, 0, request), UsbAnswer::Silent);
}

#[test]
fn the_two_banks_of_an_endpoint_fill_and_empty_in_turn() {
    let mut chip = default_chip();
    set(&mut chip, 1, EPEDS | BULK_OUT);
    assert_eq!(out(&mut chip, 1, b"first"), UsbAnswer::Acknowledged);
    assert_eq!(out(&mut chip, 1, &[7; 64]), UsbAnswer::Acknowledged);
    assert_eq!(out(&mut chip, 1, b"third"), UsbAnswer::NotReady);
    let status = read(&mut chip, CSR[1]);
    let both = RX_DATA_BK0 | RX_DATA_BK1;
    assert_eq!(status & (both | 0x7FF << 16), both | 5 << 16);
    assert_eq!(received(&mut chip, 1), b"first");
    clear(&mut chip, 1, RX_DATA_BK0);
    assert_eq!(out(&mut chip, 1, b"third"), UsbAnswer::Acknowledged);
    assert_eq!(received(&mut chip, 1), [7; 64]);
    clear(&mut chip, 1, RX_DATA_BK1);
    assert_eq!(received(&mut chip, 1), b"third");
}

#[test]
fn a_packet_is_filled_while_the_one_before_waits() {
    let mut chip = default_chip();
    set(&mut chip, 2, EPEDS | BULK_IN);
    give(&mut chip, 2, b"one");
    for byte in b"two" {
        write(&mut chip, FDR[2], u32::from(*byte));
    }
    let input = UsbTransaction::In;
    assert_eq!(transact(&mut chip, 0, 2, input), data(b"one"));
    clear(&mut chip, 2, TXCOMP);
    set(&mut chip, 2, TXPKTRDY);
    assert_eq!(transact(&mut chip, 0, 2, input), data(b"two"));
}

#[test]
fn a_forced_stall_refuses_and_is_reported() {
    let mut chip = default_chip();
    set(&mut chip, 0, FORCESTALL);
    let input = UsbTransaction::In;
    assert_eq!(transact(&mut chip, 0, 0, input), UsbAnswer::Stalled);
    assert_eq!(read(&mut chip, CSR[0]) & STALLSENT, STALLSENT);
    clear(&mut chip, 0, FORCESTALL | STALLSENT);
    assert_eq!(transact(&mut chip, 0, 0, input), UsbAnswer::NotReady);
    assert_eq!(setup(&mut chip, [0; 8]), UsbAnswer::Acknowledged);
}

#[test]
fn an_endpoint_reset_empties_the_banks_and_keeps_the_settings() {
    let mut chip = default_chip();
    set(&mut chip, 1, EPEDS | BULK_OUT);
    out(&mut chip, 1, b"lost");
    write(&mut chip, RST_EP, 2);
    assert_eq!(out(&mut chip, 1, b"deaf"), UsbAnswer::Silent);
    write(&mut chip, RST_EP, 0);
    assert_eq!(read(&mut chip, CSR[1]), EPEDS | BULK_OUT);
    assert_eq!(out(&mut chip, 1, b"new"), UsbAnswer::Acknowledged);
    assert_eq!(received(&mut chip, 1), b"new");
}

#[test]
fn signals_of_the_bus_are_flagged() {
    let mut chip = usb_chip();
    let signals = [
        (UsbSignal::Resume, 1 << 9),
        (UsbSignal::StartOfFrame { number: 0x123 }, 1 << 11),
        (UsbSignal::ResetBegins, 0),
        (UsbSignal::Suspend, 1 << 8),
    ];
    for (signal, flag) in signals {
        host(&mut chip, signal);
        assert_eq!(read(&mut chip, ISR), flag);
        write(&mut chip, ICR, flag);
    }
    assert_eq!(read(&mut chip, FRM_NUM) & 0x7FF, 0x123);
}

/// UDP_ICR of the datasheet: a bit that is written as 0 has no effect.
#[test]
fn clearing_one_signal_of_the_bus_keeps_the_others() {
    let mut chip = usb_chip();
    host(&mut chip, UsbSignal::Resume);
    host(&mut chip, UsbSignal::StartOfFrame { number: 1 });
    write(&mut chip, ICR, 1 << 9);
    assert_eq!(read(&mut chip, ISR), 1 << 11);
}

#[test]
fn what_ends_the_rest_of_the_bus_or_finds_no_clock_wakes_it_up() {
    for (signal, flag) in [(UsbSignal::Resume, 1 << 9), (UsbSignal::ResetBegins, 0)] {
        let mut chip = usb_chip();
        host(&mut chip, UsbSignal::Suspend);
        write(&mut chip, ICR, 1 << 8);
        host(&mut chip, signal);
        assert_eq!(read(&mut chip, ISR), flag | 1 << 13);
        write(&mut chip, ICR, flag | 1 << 13);
        host(&mut chip, signal);
        assert_eq!(read(&mut chip, ISR), flag, "only the first");
        write(&mut chip, PMC + 0x04, 1 << 7);
        host(&mut chip, signal);
        assert_eq!(read(&mut chip, ISR), flag | 1 << 13, "asks for its clock");
    }
}

#[test]
fn misuse_is_a_fault() {
    let mut chip = running_chip();
    assert!(try_write(&mut chip, CSR[0], Width::Word, EPEDS).is_err());
    let kind = FaultKind::ClockDisabled {
        peripheral: "UDP",
        identifier: 11,
    };
    assert_eq!(chip.fault().unwrap().kind, kind);
    let mut chip = default_chip();
    (0..8).for_each(|_| write(&mut chip, FDR[0], 0));
    assert!(try_write(&mut chip, FDR[0], Width::Word, 0).is_err());
    let mut chip = default_chip();
    assert!(try_write(&mut chip, CSR[1], Width::Word, EPEDS | 1 << 8).is_err());
}
