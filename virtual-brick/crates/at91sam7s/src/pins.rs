// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Pins and SPI: what passes between the peripherals, the pins and the board.

use crate::board::{Board, Cycles};
use crate::chip::Chip;
use crate::event::EventKind;
use crate::pio::PeripheralLines;
use crate::spi;
use crate::tc::Line;

/// Peripheral identifier and interrupt source of the PIO controller.
pub(crate) const PIOA: u8 = 2;
/// Pins that carry TIOA and TIOB of the three channels (peripheral B).
const TIMER_PINS: [(u32, u32); 3] = [(0, 1), (15, 16), (26, 27)];
/// Pins of the SPI's data to its slaves and of its clock (peripheral A).
const SPI_PINS: [u32; 2] = [13, 14];
/// Pins of the SPI's select lines 0 to 3, as peripheral A and as peripheral B (data sheet 6175M,
/// PIO controller A multiplexing).
const SELECT_PINS: [(u32, u32); 4] = [
    (1 << 11, 0),
    (1 << 31, 1 << 9),
    (0, 1 << 10 | 1 << 30),
    (0, 1 << 3 | 1 << 5 | 1 << 22),
];
/// Pins of the external interrupts: (pin, source).
const INTERRUPT_PINS: [(u32, u8); 3] = [(19, 0), (20, 30), (30, 31)];

impl<B: Board> Chip<B> {
    /// Levels that the timer channels drive.
    pub(crate) fn lines_of_timers(&self) -> PeripheralLines {
        let mut lines = PeripheralLines::default();
        for (channel, (pin_a, pin_b)) in self.tc.channels.iter().zip(TIMER_PINS) {
            let (out_a, out_b) = channel.output_lines();
            for (pin, level) in [(pin_a, out_a), (pin_b, out_b)] {
                if let Some(level) = level {
                    lines.driven |= 1 << pin;
                    lines.level |= u32::from(level) << pin;
                }
            }
        }
        lines
    }

    /// Tell the board what the chip drives, read the pins back, pass changes on.
    pub(crate) fn update_pins(&mut self, at: Cycles) {
        // A pin may trigger a channel whose output drives another pin, at most once per channel.
        for _ in 0..=TIMER_PINS.len() {
            self.timers_drive(at);
            self.serial_lines = self.lines_of_serial();
            let outputs = self.pio.outputs(self.serial_lines, self.timer_lines);
            if outputs != self.outputs {
                self.outputs = outputs;
                self.board.outputs_changed(at, outputs);
                self.refresh_board(at);
            }
            let clocked = self.pmc.clocked(PIOA);
            let (changed, seen) = self.pio.sample(outputs, self.board.pin_levels(), clocked);
            if changed != 0 {
                self.pins_changed(changed, at);
            }
            self.refresh_pio(at, seen);
            if self.lines_of_timers() == self.timer_lines {
                return;
            }
        }
    }

    /// Note the lines of the timers; a rising TIOA may trigger the converter.
    fn timers_drive(&mut self, at: Cycles) {
        let lines = self.lines_of_timers();
        let risen = lines.level & !self.timer_lines.level;
        self.timer_lines = lines;
        if let Some(channel) = self.adc.trigger_channel() {
            if risen >> TIMER_PINS[channel].0 & 1 != 0 {
                self.adc.trigger(at);
                self.refresh_adc(at);
            }
        }
    }

    fn pins_changed(&mut self, changed: u32, at: Cycles) {
        let pins = self.pio.pins();
        self.pin_log.changed(changed, at, pins);
        for (number, (pin_a, pin_b)) in TIMER_PINS.into_iter().enumerate() {
            if changed & (1 << pin_a | 1 << pin_b) == 0 {
                continue;
            }
            let channel = &mut self.tc.channels[number];
            channel.set_line(Line::A, pins >> pin_a & 1 != 0, at);
            channel.set_line(Line::B, pins >> pin_b & 1 != 0, at);
            self.schedule
                .set(EventKind::TIMERS[number], channel.next_event());
            let level = channel.interrupt();
            self.set_line(12 + number as u8, level, at, 0);
        }
        if changed & Self::modem_pins() != 0 {
            self.update_modem_lines(true, at);
        }
        for (pin, source) in INTERRUPT_PINS {
            if changed >> pin & 1 != 0 {
                self.set_line(source, pins >> pin & 1 != 0, at, 0);
            }
        }
    }

    /// Interrupt line of the PIO controller; `seen` are the pins that have just changed.
    pub(crate) fn refresh_pio(&mut self, at: Cycles, seen: u32) {
        let timing = &self.configuration.timing;
        let filter = if self.pio.filtered(seen & self.pio.mask()) {
            timing.pio_filter_cycles
        } else {
            0
        };
        let delay = if seen == 0 {
            0
        } else {
            timing.pio_input_cycles + filter
        };
        let level = self.pio.interrupt();
        self.set_line(PIOA, level, at, delay);
    }

    pub(crate) fn refresh_spi(&mut self, at: Cycles) {
        self.feed_spi(at);
        self.schedule.set(EventKind::Serial, self.spi.next_event());
        let level = self.spi.interrupt();
        self.set_line(spi::IDENTIFIER, level, at, 0);
    }

    pub(crate) fn serve_spi(&mut self, at: Cycles) {
        if let Some(frame) = self.spi.shifted(at) {
            let wired = SPI_PINS.iter().all(|&pin| self.pio.is_peripheral_a(pin));
            let answer = if wired {
                let selected = self.selected_pins(frame.select);
                self.board.spi_frame(at, selected, frame.data, frame.bits)
            } else {
                0
            };
            self.refresh_board(at);
            self.spi.receive(frame, answer);
            self.drain_spi(at);
        }
        if let Err(kind) = self.spi.continue_at(at) {
            self.record_fault(kind, crate::registers::SPI_BASE, None);
        }
        self.refresh_spi(at);
    }

    /// Pins that the SPI holds low by a select line (0 to 3; 4 when none).
    fn selected_pins(&self, select: u8) -> u32 {
        let (a, b) = SELECT_PINS
            .get(usize::from(select))
            .copied()
            .unwrap_or_default();
        self.pio.given_to_peripherals(a, b)
    }

    /// Memory to transmit register, as long as the data controller may.
    fn feed_spi(&mut self, at: Cycles) {
        while self.spi.wants_data() {
            let size = self.spi.transfer_size();
            let pointer = self.spi.pdc.transmit.pointer();
            let Some(value) = self.transfer_from(spi::NAME, pointer, size) else {
                return;
            };
            self.spi.pdc.transmit.transferred(size);
            if let Err(kind) = self.spi.transmit(value, at) {
                return self.record_fault(kind, pointer, None);
            }
        }
    }

    /// Receive register to memory.
    fn drain_spi(&mut self, at: Cycles) {
        if !self.spi.has_data() {
            return;
        }
        let size = self.spi.transfer_size();
        let pointer = self.spi.pdc.receive.pointer();
        let value = self.spi.take_received();
        if self.transfer_to(spi::NAME, pointer, size, value, at) {
            self.spi.pdc.receive.transferred(size);
        }
    }
}
