// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The record of what passes on the buses, and the far end of the RS485 line.

use crate::common::Rig;
use at91sam7s::board::{Board, Character, SerialPort};
use nxt::BusEvent;

#[test]
fn the_record_has_each_byte_between_start_and_stop() {
    let mut rig = Rig::running("{}", "{}");
    rig.write(&[1]);
    rig.board.record_buses();
    rig.write(&[7]);
    let status = rig.read(1)[0];
    let log = rig.board.take_bus_log();
    let (acknowledged, byte) = (true, 2);
    let expected = [
        BusEvent::TwiStart { byte, acknowledged },
        BusEvent::TwiWritten {
            byte: 7,
            acknowledged,
        },
        BusEvent::TwiStop,
        BusEvent::TwiStart {
            byte: 3,
            acknowledged,
        },
        BusEvent::TwiRead(status),
        BusEvent::TwiStop,
    ];
    assert_eq!(
        log.iter().map(|(_, event)| *event).collect::<Vec<_>>(),
        expected
    );
    assert!(log.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    assert_eq!(rig.board.take_bus_log(), []);
}

#[test]
fn of_what_nobody_takes_from_the_rs485_line_the_first_65536_characters_are_kept() {
    let mut rig = Rig::running("{}", "{}");
    for number in 0..65_540_u32 {
        let character = Character {
            data: number as u16 & 0xFF,
            bit_cycles: 52,
        };
        rig.board
            .serial_sent(rig.now, SerialPort::Usart0, character);
    }
    let sent = rig.board.rs485_mut().take_sent();
    assert_eq!(sent.len(), 65_536);
    assert_eq!(sent[257].1, 1);
}
