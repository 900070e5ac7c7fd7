// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! USART0, USART1 and the line of the debug unit.

use crate::common::{
    bus_log, read, run_to, running_chip, try_write, write, Seen, TestChip, AIC, PIOA, SRAM,
};
use arm7tdmi::bus::{Bus, Width};
use at91sam7s::board::{Character, PinLevels, SerialPort};
use at91sam7s::FaultKind;

const USART0: u32 = 0xFFFC_0000;
const USART1: u32 = 0xFFFC_4000;
const DBGU: u32 = 0xFFFF_F200;
const CR: u32 = 0x00;
const MR: u32 = 0x04;
const IER: u32 = 0x08;
const CSR: u32 = 0x14;
const RHR: u32 = 0x18;
const THR: u32 = 0x1C;
const BRGR: u32 = 0x20;
const RTOR: u32 = 0x24;
const TTGR: u32 = 0x28;
const RPR: u32 = 0x100;
const RCR: u32 = 0x104;
const TPR: u32 = 0x108;
const TCR: u32 = 0x10C;
const RNPR: u32 = 0x110;
const RNCR: u32 = 0x114;
const PTCR: u32 = 0x120;
const RXRDY: u32 = 1 << 0;
const TXRDY: u32 = 1 << 1;
const ENDRX: u32 = 1 << 3;
const OVRE: u32 = 1 << 5;
const FRAME: u32 = 1 << 6;
const TIMEOUT: u32 = 1 << 8;
const TXEMPTY: u32 = 1 << 9;
const RXBUFF: u32 = 1 << 12;
const CTSIC: u32 = 1 << 19;
const CTS_LEVEL: u32 = 1 << 23;
/// 8 bits, no parity, one stop bit, eight samples a bit.
const EIGHT_N_ONE: u32 = 3 << 6 | 4 << 9 | 1 << 19;
const BOTH_ON: u32 = 1 << 4 | 1 << 6;
const RTS1: u32 = 1 << 24;
const CTS1: u32 = 1 << 25;

/// A port at 104 cycles a bit (460.8 kBd within 0.3 %), its pins given to it, both directions on.
fn serial_chip(base: u32, mode: u32) -> TestChip {
    let mut chip = running_chip();
    write(&mut chip, PIOA + 0x04, 0x0360_01E0);
    write(&mut chip, base + MR, EIGHT_N_ONE | mode);
    write(&mut chip, base + BRGR, 13);
    write(&mut chip, base + CR, BOTH_ON);
    chip.board_mut().log.clear();
    chip
}

fn send_to(chip: &mut TestChip, port: SerialPort, characters: &[(u64, u16)]) {
    let queue = &mut chip.board_mut().characters;
    let character = |data| Character {
        data,
        bit_cycles: 104,
    };
    queue.extend(
        characters
            .iter()
            .map(|(at, data)| (*at, port, character(*data))),
    );
}

fn sent(chip: &TestChip, start: u64) -> Vec<(u64, u16)> {
    let data = |(at, seen)| match seen {
        Seen::Sent(_, Character { data, .. }) => (at, data),
        other => panic!("{other:?}"),
    };
    bus_log(chip, start).into_iter().map(data).collect()
}

fn pin(chip: &mut TestChip, mask: u32) -> bool {
    read(chip, PIOA + 0x3C) & mask != 0
}

#[test]
fn a_character_lasts_ten_bits_and_its_time_guard() {
    let mut chip = serial_chip(USART1, 0);
    assert_eq!(read(&mut chip, USART1 + CSR) & 0xF_FFFF, 0x1A1A);
    write(&mut chip, USART1 + TTGR, 5);
    write(&mut chip, USART1 + THR, 0x1A5);
    let start = chip.now();
    assert_eq!(read(&mut chip, USART1 + CSR) & (TXRDY | TXEMPTY), TXRDY);
    run_to(&mut chip, start + 1041);
    let expected = Character {
        data: 0xA5,
        bit_cycles: 104,
    };
    let log = bus_log(&chip, start);
    assert_eq!(log, [(1040, Seen::Sent(SerialPort::Usart1, expected))]);
    assert_eq!(read(&mut chip, USART1 + CSR) & TXEMPTY, 0);
    run_to(&mut chip, start + 1040 + 520 + 1);
    assert_eq!(read(&mut chip, USART1 + CSR) & TXEMPTY, TXEMPTY);
}

#[test]
fn the_fraction_of_the_divider_and_the_frame_set_the_duration() {
    // (mode, divider, cycles of one character)
    let cases = [
        (EIGHT_N_ONE, 4 << 16 | 6, 10 * 52),
        (3 << 6 | 4 << 9, 4 << 16 | 6, 10 * 104),
        (EIGHT_N_ONE | 1 << 4, 2, 10 * 128),
        (3 << 6 | 1 << 19, 10, 11 * 80),
        (4 << 9 | 1 << 19 | 1 << 12, 10, 75 * 8),
        (4 << 9 | 1 << 19 | 1 << 17 | 2 << 12, 10, 12 * 80),
    ];
    for (mode, divider, cycles) in cases {
        let mut chip = serial_chip(USART0, 0);
        write(&mut chip, USART0 + MR, mode);
        write(&mut chip, USART0 + BRGR, divider);
        write(&mut chip, USART0 + THR, 1);
        let start = chip.now();
        run_to(&mut chip, start + 2000);
        assert_eq!(sent(&chip, start), [(cycles, 1)], "mode {mode:#x}");
    }
}

#[test]
fn the_data_controller_sends_without_gaps() {
    let mut chip = serial_chip(USART1, 0);
    chip.load(SRAM, b"abc").unwrap();
    write(&mut chip, USART1 + TPR, SRAM);
    write(&mut chip, USART1 + TCR, 3);
    write(&mut chip, USART1 + PTCR, 1 << 8);
    let start = chip.now() - 2;
    run_to(&mut chip, start + 4000);
    let expected = [(1040, 0x61), (2080, 0x62), (3120, 0x63)];
    assert_eq!(sent(&chip, start), expected);
}

#[test]
fn a_clear_to_send_line_that_is_high_holds_the_transmitter() {
    let mut chip = serial_chip(USART1, 2);
    write(&mut chip, USART1 + THR, 0x55);
    let start = chip.now();
    let low = PinLevels {
        driven: CTS1,
        level: 0,
    };
    chip.board_mut().pins.push_back((start + 5000, low));
    run_to(&mut chip, start + 5000);
    assert_eq!(sent(&chip, start), []);
    assert_eq!(
        read(&mut chip, USART1 + CSR) & (CTSIC | CTS_LEVEL),
        CTSIC,
        "the line fell"
    );
    assert_eq!(read(&mut chip, USART1 + CSR) & CTSIC, 0);
    run_to(&mut chip, start + 6100);
    assert_eq!(sent(&chip, start), [(6040, 0x55)]);
}

/// Pins and bits: chapters "Peripheral Signals Multiplexing" and USART Channel Status Register.
#[test]
fn a_change_of_a_modem_line_is_seen_at_its_own_bit() {
    for (pin, changed, level) in [
        (29, 1 << 16, 1 << 20), // RI1
        (28, 1 << 17, 1 << 21), // DSR1
        (26, 1 << 18, 1 << 22), // DCD1
        (25, CTSIC, CTS_LEVEL),
    ] {
        let mut chip = serial_chip(USART1, 2);
        write(&mut chip, PIOA + 0x04, 0x3F00_0000);
        read(&mut chip, USART1 + CSR);
        let bits = 0xF << 16 | 0xF << 20;
        let before = read(&mut chip, USART1 + CSR) & bits;
        let low = PinLevels {
            driven: 1 << pin,
            level: 0,
        };
        let now = chip.now();
        chip.board_mut().pins.push_back((now + 10, low));
        run_to(&mut chip, now + 20);
        let after = read(&mut chip, USART1 + CSR) & bits;
        assert_eq!(after, before & !level | changed, "PA{pin}");
    }
}

#[test]
fn request_to_send_is_low_while_a_buffer_can_take_characters() {
    let mut chip = serial_chip(USART1, 2);
    assert!(pin(&mut chip, RTS1), "no buffer");
    write(&mut chip, USART1 + RPR, SRAM);
    write(&mut chip, USART1 + RCR, 2);
    assert!(!pin(&mut chip, RTS1), "two places");
    write(&mut chip, USART1 + PTCR, 1);
    let now = chip.now();
    send_to(
        &mut chip,
        SerialPort::Usart1,
        &[(now + 100, 1), (now + 200, 2)],
    );
    run_to(&mut chip, now + 150);
    assert!(!pin(&mut chip, RTS1), "one place");
    run_to(&mut chip, now + 250);
    assert!(pin(&mut chip, RTS1), "full");
    write(&mut chip, USART1 + RNPR, SRAM + 2);
    write(&mut chip, USART1 + RNCR, 1);
    assert!(!pin(&mut chip, RTS1), "a new buffer");
    write(&mut chip, USART1 + CR, 1 << 5);
    assert!(pin(&mut chip, RTS1), "receiver off");
    assert_eq!(chip.peek(SRAM, 2).unwrap(), [1, 2]);
}

#[test]
fn received_characters_fill_two_buffers_in_turn() {
    let mut chip = serial_chip(USART1, 0);
    let registers = [(RPR, SRAM), (RCR, 2), (RNPR, SRAM + 0x10), (RNCR, 2)];
    for (register, value) in registers {
        write(&mut chip, USART1 + register, value);
    }
    write(&mut chip, USART1 + PTCR, 1);
    let now = chip.now();
    let characters: Vec<_> = (1..=4).map(|n| (now + 1040 * n, n as u16)).collect();
    send_to(&mut chip, SerialPort::Usart1, &characters);
    run_to(&mut chip, now + 2081);
    let flags = read(&mut chip, USART1 + CSR) & (ENDRX | RXBUFF);
    assert_eq!(flags, ENDRX, "the first buffer is full, the second is not");
    assert_eq!(read(&mut chip, USART1 + RCR), 2);
    assert_eq!(read(&mut chip, USART1 + RNCR), 0);
    run_to(&mut chip, now + 4161);
    assert_eq!(read(&mut chip, USART1 + CSR) & RXBUFF, RXBUFF);
    assert_eq!(chip.peek(SRAM, 2).unwrap(), [1, 2]);
    assert_eq!(chip.peek(SRAM + 0x10, 2).unwrap(), [3, 4]);
}

#[test]
fn a_received_character_interrupts_until_it_is_read() {
    let mut chip = serial_chip(USART0, 0);
    write(&mut chip, USART0 + IER, RXRDY);
    let now = chip.now();
    send_to(&mut chip, SerialPort::Usart0, &[(now + 50, 0x7E)]);
    run_to(&mut chip, now + 60);
    assert_ne!(read(&mut chip, AIC + 0x10C) & 1 << 6, 0);
    assert_eq!(read(&mut chip, USART0 + RHR), 0x7E);
    assert_eq!(read(&mut chip, AIC + 0x10C) & 1 << 6, 0);
}

#[test]
fn an_unread_character_is_overrun_and_a_wrong_rate_is_a_framing_error() {
    let mut chip = serial_chip(USART0, 0);
    let now = chip.now();
    send_to(
        &mut chip,
        SerialPort::Usart0,
        &[(now + 50, 1), (now + 90, 2)],
    );
    let slow = Character {
        data: 3,
        bit_cycles: 110,
    };
    let late = (now + 500, SerialPort::Usart0, slow);
    chip.board_mut().characters.push_back(late);
    run_to(&mut chip, now + 100);
    let errors = |chip: &mut TestChip| read(chip, USART0 + CSR) & (OVRE | FRAME);
    assert_eq!(errors(&mut chip), OVRE);
    assert_eq!(read(&mut chip, USART0 + RHR), 2, "the last one stays");
    write(&mut chip, USART0 + CR, 1 << 8);
    assert_eq!(errors(&mut chip), 0);
    run_to(&mut chip, now + 510);
    assert_eq!(errors(&mut chip), FRAME);
}

#[test]
fn silence_after_a_character_times_out() {
    let mut chip = serial_chip(USART1, 0);
    write(&mut chip, USART1 + RTOR, 100);
    write(&mut chip, USART1 + CR, 1 << 11);
    let now = chip.now();
    let characters = [(now + 50_000, 1), (now + 55_000, 2)];
    send_to(&mut chip, SerialPort::Usart1, &characters);
    run_to(&mut chip, now + 55_000 + 10_390);
    assert_eq!(read(&mut chip, USART1 + CSR) & TIMEOUT, 0);
    run_to(&mut chip, now + 55_000 + 10_400);
    assert_eq!(read(&mut chip, USART1 + CSR) & TIMEOUT, TIMEOUT);
    write(&mut chip, USART1 + CR, 1 << 15);
    let again = chip.now();
    assert_eq!(read(&mut chip, USART1 + CSR) & TIMEOUT, 0);
    run_to(&mut chip, again + 10_400);
    assert_eq!(read(&mut chip, USART1 + CSR) & TIMEOUT, TIMEOUT);
}

#[test]
fn rs485_mode_drives_the_line_while_characters_leave() {
    const RTS0: u32 = 1 << 7;
    let mut chip = serial_chip(USART0, 1);
    assert!(!pin(&mut chip, RTS0));
    write(&mut chip, USART0 + THR, 0x11);
    let start = chip.now();
    assert!(pin(&mut chip, RTS0));
    run_to(&mut chip, start + 1030);
    assert!(pin(&mut chip, RTS0));
    run_to(&mut chip, start + 1041);
    assert!(!pin(&mut chip, RTS0));
}

#[test]
fn local_loopback_receives_what_it_sends_and_nothing_else() {
    let mut chip = serial_chip(USART1, 2 << 14);
    write(&mut chip, USART1 + THR, 0x42);
    let now = chip.now();
    send_to(&mut chip, SerialPort::Usart1, &[(now + 2000, 0x99)]);
    run_to(&mut chip, now + 3000);
    assert_eq!(sent(&chip, 0), []);
    assert_eq!(read(&mut chip, USART1 + RHR), 0x42);
    assert_eq!(read(&mut chip, USART1 + CSR) & RXRDY, 0);
}

#[test]
fn the_debug_unit_sends_at_sixteen_samples_a_bit() {
    let mut chip = running_chip();
    write(&mut chip, PIOA + 0x04, 1 << 9 | 1 << 10);
    write(&mut chip, DBGU + BRGR, 26);
    write(&mut chip, DBGU + MR, 4 << 9);
    write(&mut chip, DBGU + CR, BOTH_ON);
    chip.board_mut().log.clear();
    write(&mut chip, DBGU + IER, RXRDY);
    write(&mut chip, DBGU + THR, 0x21);
    let start = chip.now();
    run_to(&mut chip, start + 5000);
    let character = Character {
        data: 0x21,
        bit_cycles: 416,
    };
    let log = bus_log(&chip, start);
    assert_eq!(log, [(4160, Seen::Sent(SerialPort::DebugUnit, character))]);
    let queue = &mut chip.board_mut().characters;
    queue.push_back((start + 6000, SerialPort::DebugUnit, character));
    run_to(&mut chip, start + 6010);
    assert_ne!(read(&mut chip, AIC + 0x10C) & 2, 0, "the system interrupt");
    assert_eq!(read(&mut chip, DBGU + RHR), 0x21);
}

#[test]
fn a_port_whose_clock_is_off_or_whose_mode_is_unknown_is_a_fault() {
    let mut chip = running_chip();
    write(&mut chip, 0xFFFF_FC14, 1 << 7);
    assert!(try_write(&mut chip, USART1 + CR, Width::Word, BOTH_ON).is_err());
    let kind = FaultKind::ClockDisabled {
        peripheral: "USART1",
        identifier: 7,
    };
    assert_eq!(chip.fault().unwrap().kind, kind);
    for mode in [3, 4, 6, 8, 2 << 4, 3 << 4, 1 << 8, 6 << 9, 1 << 14, 3 << 14] {
        let mut chip = running_chip();
        assert!(try_write(&mut chip, USART0 + MR, Width::Word, mode).is_err());
        let kind = chip.fault().unwrap().kind;
        assert!(matches!(kind, FaultKind::FeatureNotModelled { .. }));
    }
}

#[test]
fn a_character_for_a_receiver_that_is_off_is_lost() {
    let mut chip = serial_chip(USART0, 0);
    write(&mut chip, USART0 + CR, 1 << 5);
    let now = chip.now();
    send_to(&mut chip, SerialPort::Usart0, &[(now + 10, 1)]);
    chip.internal(100);
    assert_eq!(read(&mut chip, USART0 + CSR) & RXRDY, 0);
}

#[test]
fn resets_of_iso_7816_features_do_nothing_and_multidrop_is_a_fault() {
    let mut chip = serial_chip(USART1, 0);
    write(&mut chip, USART1 + CR, 1 << 13 | 1 << 14);
    assert!(chip.fault().is_none());
    assert!(try_write(&mut chip, USART1 + CR, Width::Word, 1 << 12).is_err());
}
