// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Serial lines, sound line and USB: what passes between the peripherals, the data controller
//! and the board.

use arm7tdmi::bus::Width;

use crate::board::{Board, Cycles, SerialPort};
use crate::chip::Chip;
use crate::event::EventKind;
use crate::fault::FaultKind;
use crate::pio::PeripheralLines;
use crate::usart::{CTS, MODEM_LEVELS};
use crate::{pwmc, ssc, udp};

/// Pins of the lines that the chip drives as peripheral A: (TXD, RTS) of each serial port.
const SERIAL_PINS: [(u32, Option<u32>); 3] = [(6, Some(7)), (22, Some(24)), (10, None)];
/// Pin of the sound line, peripheral A.
const SOUND_PIN: u32 = 17;
/// Pins of the modem inputs and their bits in the status: (port, pin, bit).
const MODEM_PINS: [(usize, u32, u32); 5] = [
    (0, 8, CTS),
    (1, 25, CTS),
    (1, 29, 1 << 20),
    (1, 28, 1 << 21),
    (1, 26, 1 << 22),
];
/// Identifiers of the serial ports' clocks; the debug unit always has one.
pub(crate) const SERIAL_CLOCKS: [Option<u8>; 3] = [Some(6), Some(7), None];

impl<B: Board> Chip<B> {
    /// Levels that the serial lines rest at. The bits of characters are not shown on the pins.
    pub(crate) fn lines_of_serial(&self) -> PeripheralLines {
        let mut lines = PeripheralLines {
            driven: 1 << SOUND_PIN,
            level: 0,
        };
        for (port, (txd, rts)) in self.serial.iter().zip(SERIAL_PINS) {
            lines.driven |= 1 << txd;
            lines.level |= 1 << txd;
            if let Some(rts) = rts {
                lines.driven |= 1 << rts;
                lines.level |= u32::from(port.rts_level()) << rts;
            }
        }
        lines
    }

    /// Pass the levels of the modem pins on; `flag` unless they come from a reset.
    pub(crate) fn update_modem_lines(&mut self, flag: bool, at: Cycles) {
        let pins = self.pio.pins();
        let mut levels = [0; 2];
        for (port, pin, bit) in MODEM_PINS {
            if pins >> pin & 1 != 0 {
                levels[port] |= bit & MODEM_LEVELS;
            }
        }
        for (number, levels) in levels.into_iter().enumerate() {
            self.serial[number].set_modem_lines(levels, flag, at);
            self.refresh_serial(number, at);
        }
    }

    /// Pins whose level a serial port looks at.
    pub(crate) fn modem_pins() -> u32 {
        MODEM_PINS
            .iter()
            .fold(0, |pins, (_, pin, _)| pins | 1 << pin)
    }

    pub(crate) fn refresh_serial(&mut self, number: usize, at: Cycles) {
        self.feed_serial(number, at);
        self.drain_serial(number, at);
        self.schedule_serial();
        match SERIAL_CLOCKS[number] {
            Some(source) => {
                let level = self.serial[number].interrupt();
                self.set_line(source, level, at, 0);
            }
            None => self.refresh_system(at),
        }
        if self.lines_of_serial() != self.serial_lines {
            self.update_pins(at);
        }
    }

    fn schedule_serial(&mut self) {
        let [a, b, c] = &self.serial;
        let next = a.next_event().min(b.next_event()).min(c.next_event());
        self.schedule.set(EventKind::Characters, next);
    }

    pub(crate) fn serve_serial(&mut self, at: Cycles) {
        for (number, port) in SerialPort::ALL.into_iter().enumerate() {
            if self.serial[number].next_event() > at {
                continue;
            }
            if let Some(character) = self.serial[number].shifted(at) {
                if self.pio.is_peripheral_a(SERIAL_PINS[number].0) {
                    self.board.serial_sent(at, port, character);
                    self.refresh_board(at);
                }
            }
            self.serial[number].continue_at(at);
            self.refresh_serial(number, at);
        }
    }

    /// Take what the board's lines brought by now.
    pub(crate) fn take_from_board(&mut self, at: Cycles) {
        for (number, port) in SerialPort::ALL.into_iter().enumerate() {
            while let Some(character) = self.board.serial_received(at, port) {
                self.serial[number].receive(character, at);
                self.refresh_serial(number, at);
            }
        }
        while let Some(signal) = self.board.usb_signal(at) {
            let clocked = self.udp_clocked();
            if let Some(answer) = self.udp.signal(signal, at, clocked) {
                self.board.usb_answer(at, answer);
            }
            self.refresh_udp(at);
        }
    }

    /// Memory to holding register, as long as the data controller may.
    fn feed_serial(&mut self, number: usize, at: Cycles) {
        while self.serial[number].wants_data() {
            let size = self.serial[number].transfer_size();
            let pointer = self.serial[number].pdc.transmit.pointer();
            let name = self.serial[number].name();
            let Some(value) = self.transfer_from(name, pointer, size) else {
                return;
            };
            self.serial[number].pdc.transmit.transferred(size);
            self.serial[number].transmit(value, at);
        }
    }

    /// Receive register to memory.
    fn drain_serial(&mut self, number: usize, at: Cycles) {
        if !self.serial[number].has_data() {
            return;
        }
        let size = self.serial[number].transfer_size();
        let pointer = self.serial[number].pdc.receive.pointer();
        let name = self.serial[number].name();
        let value = self.serial[number].take_received();
        if self.transfer_to(name, pointer, size, value, at) {
            self.serial[number].pdc.receive.transferred(size);
        }
    }

    pub(crate) fn refresh_ssc(&mut self, at: Cycles) {
        while self.ssc.wants_data() {
            let size = self.ssc.transfer_size();
            let pointer = self.ssc.pdc.transmit.pointer();
            let Some(value) = self.transfer_from(ssc::NAME, pointer, size) else {
                break;
            };
            self.ssc.pdc.transmit.transferred(size);
            if let Err(kind) = self.ssc.transmit(value, at) {
                self.record_fault(kind, pointer, None);
                break;
            }
        }
        self.schedule.set(EventKind::Sound, self.ssc.next_event());
        let level = self.ssc.interrupt();
        self.set_line(ssc::IDENTIFIER, level, at, 0);
    }

    pub(crate) fn serve_ssc(&mut self, at: Cycles) {
        if let Some(sound) = self.ssc.shifted(at) {
            if self.pio.is_peripheral_a(SOUND_PIN) {
                self.board.sound_bits(at, sound);
                self.refresh_board(at);
            }
        }
        self.refresh_ssc(at);
    }

    pub(crate) fn refresh_pwmc(&mut self, at: Cycles) {
        self.schedule
            .set(EventKind::Periods, self.pwmc.next_event());
        let level = self.pwmc.interrupt();
        self.set_line(pwmc::IDENTIFIER, level, at, 0);
    }

    /// Both clocks of the USB device port are on.
    pub(crate) fn udp_clocked(&self) -> bool {
        self.pmc.clocked(udp::IDENTIFIER) && self.pmc.system_clocked(udp::SYSTEM_CLOCK)
    }

    pub(crate) fn refresh_udp(&mut self, at: Cycles) {
        self.schedule.set(EventKind::Usb, self.udp.next_event());
        let level = self.udp.interrupt();
        self.set_line(udp::IDENTIFIER, level, at, 0);
    }

    /// A transfer of the data controller from memory; a pointer elsewhere is a fault.
    pub(crate) fn transfer_from(
        &mut self,
        peripheral: &'static str,
        pointer: u32,
        size: u32,
    ) -> Option<u32> {
        if self.fault.is_some() {
            return None;
        }
        let value = self.transfer_read(pointer, size);
        if value.is_none() {
            self.record_fault(FaultKind::TransferAddress { peripheral }, pointer, None);
        }
        self.stolen += self.configuration.timing.pdc_steal_cycles;
        value
    }

    /// A transfer of the data controller to SRAM; false after the fault of a pointer elsewhere.
    pub(crate) fn transfer_to(
        &mut self,
        peripheral: &'static str,
        pointer: u32,
        size: u32,
        value: u32,
        at: Cycles,
    ) -> bool {
        if pointer >> 20 != 2 && pointer >> 20 != self.sram_alias {
            let kind = FaultKind::TransferAddress { peripheral };
            self.record_fault(kind, pointer, Some(value));
            return false;
        }
        self.sram.write(at, pointer, width_of(size), value);
        self.transfers_stored += 1;
        self.stolen += self.configuration.timing.pdc_steal_cycles;
        true
    }

    /// What the data controller reads from SRAM or flash.
    fn transfer_read(&self, pointer: u32, size: u32) -> Option<u32> {
        let window = pointer >> 20;
        let word = if window == 2 || window == self.sram_alias {
            self.sram.word(pointer)
        } else if window < 2 {
            self.flash.word(pointer)
        } else {
            return None;
        };
        Some(match size {
            1 => word >> ((pointer & 3) * 8) & 0xFF,
            2 => word >> ((pointer & 2) * 8) & 0xFFFF,
            _ => word,
        })
    }
}

fn width_of(size: u32) -> Width {
    match size {
        1 => Width::Byte,
        2 => Width::Halfword,
        _ => Width::Word,
    }
}
