// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The three asynchronous serial lines with their pins, clocks and interrupt sources.

use crate::board::{Board, Cycles, SerialPort};
use crate::pins::pio::{PeripheralLines, Pio};
use crate::serial::ssc::DATA_PIN;
use crate::serial::usart::{Usart, CTS, DCD, DSR, RI};

/// Pins of the lines that the chip drives as peripheral A: (TXD, RTS) of each port.
const OUTPUT_PINS: [(u32, Option<u32>); 3] = [(6, Some(7)), (22, Some(24)), (10, None)];
/// Pins of the modem inputs and their bits in the status: (port, pin, bit).
const MODEM_PINS: [(usize, u32, u32); 5] = [
    (0, 8, CTS),
    (1, 25, CTS),
    (1, 29, RI),
    (1, 28, DSR),
    (1, 26, DCD),
];
/// Clock and interrupt source of each port; the debug unit always has a clock, and shares the
/// interrupt of the system peripherals.
pub(crate) const IDENTIFIERS: [Option<u8>; 3] = [Some(6), Some(7), None];
/// Number of the debug unit's port.
pub(crate) const DEBUG_UNIT: usize = 2;

/// USART0, USART1 and the line of the debug unit.
#[derive(Clone, Debug)]
pub(crate) struct SerialPorts(pub(crate) [Usart; 3]);

impl SerialPorts {
    pub(crate) fn new() -> Self {
        Self(SerialPort::ALL.map(Usart::new))
    }

    /// Levels that the lines rest at, that of the synchronous serial controller included. The
    /// bits of characters are not shown on the pins.
    pub(crate) fn lines(&self) -> PeripheralLines {
        let mut lines = PeripheralLines {
            driven: 1 << DATA_PIN,
            level: 0,
        };
        for (port, (txd, rts)) in self.0.iter().zip(OUTPUT_PINS) {
            lines.driven |= 1 << txd;
            lines.level |= 1 << txd;
            if let Some(rts) = rts {
                lines.driven |= 1 << rts;
                lines.level |= u32::from(port.rts_level()) << rts;
            }
        }
        lines
    }

    /// Pass the levels of the modem pins on; `flag` their changes unless they come from a reset.
    pub(crate) fn set_modem_lines(&mut self, pins: u32, flag: bool, at: Cycles) {
        let mut levels = [0; 2];
        for (port, pin, bit) in MODEM_PINS {
            if pins >> pin & 1 != 0 {
                levels[port] |= bit;
            }
        }
        for (port, levels) in self.0.iter_mut().zip(levels) {
            port.set_modem_lines(levels, flag, at);
        }
    }

    /// Pins whose level a port looks at.
    pub(crate) const fn modem_pins() -> u32 {
        let [a, b, c, d, e] = MODEM_PINS;
        1 << a.1 | 1 << b.1 | 1 << c.1 | 1 << d.1 | 1 << e.1
    }

    pub(crate) fn next_event(&self) -> Cycles {
        let [a, b, c] = &self.0;
        a.next_event().min(b.next_event()).min(c.next_event())
    }

    /// Pass the character that has just ended on a line to the board, if the pin belongs to the
    /// line, and begin the next one; true when the board got one.
    pub(crate) fn send<B: Board>(
        &mut self,
        number: usize,
        at: Cycles,
        board: &mut B,
        pio: &Pio,
    ) -> bool {
        let port = &mut self.0[number];
        let owned = pio.is_peripheral_a(OUTPUT_PINS[number].0);
        let sent = port.shifted(at).filter(|_| owned);
        if let Some(character) = sent {
            board.serial_sent(at, SerialPort::ALL[number], character);
        }
        port.continue_at(at);
        sent.is_some()
    }
}
