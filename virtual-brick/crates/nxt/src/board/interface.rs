// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The board as the chip sees it: pins, buses, analogue inputs, time.

use at91sam7s::board::{
    Board, Character, ChipEvent, Cycles, PinLevels, PinOutputs, SerialPort, SoundBits, TwiReply,
    UsbAnswer, UsbSignal,
};

use super::NxtBoard;
use crate::battery::BROWN_OUT_VOLTAGE;
use crate::bluetooth::ChipLines;
use crate::bus_log::BusEvent;
use crate::coprocessor::ADDRESS;
use crate::event::{BoardEventKind, BoardFault};
use crate::ports::PORT_LINES;
use crate::usb::CABLE_COUNT;

const DISPLAY_SELECT: u32 = 1 << 10;
const DISPLAY_DATA: u32 = 1 << 12;
const DISPLAY_FRAME_BITS: u8 = 8;
/// Lines that the brick pulls up: two-wire bus (PA3, PA4) and the digital lines of the ports.
const PULLED_UP: u32 = 1 << 3 | BUS_CLOCK | PORT_LINES;
const BUS_CLOCK: u32 = 1 << 4;
/// Analogue channels of the ports' second digital lines: (channel, pin).
const ANALOGUE_PINS: [(u8, u32); 4] = [(1, 18), (2, 19), (3, 20), (7, 2)];
const ANALOGUE_FULL_SCALE: u16 = 1023;
/// Analogue channel on which the Bluetooth module tells its mode.
const MODULE_MODE_CHANNEL: u8 = 6;
/// Analogue channel that senses the 5 V of the USB cable.
const CABLE_CHANNEL: u8 = 4;
/// Pull-up of the USB, on while the pin is low.
const USB_PULL_UP: u32 = 1 << 16;
const MODULE_RESET: u32 = 1 << 11;
const MODULE_RXD: u32 = 1 << 21;
const MODULE_RTS: u32 = 1 << 24;
const MODULE_CTS: u32 = 1 << 25;
const MODULE_STREAM_WANTED: u32 = 1 << 27;
/// What the two-wire bus answers when nobody does.
const REFUSED: TwiReply = TwiReply {
    acknowledged: false,
    stretch_cycles: 0,
};
const SOUND: u32 = 1 << 17;
/// Pins whose changes by the chip are followed; others are looked at when they matter.
const FOLLOWED: u32 =
    PORT_LINES | USB_PULL_UP | MODULE_RESET | MODULE_RTS | MODULE_STREAM_WANTED | SOUND;
/// Direction of port 4's RS485 transceiver: high while the brick drives the line.
const RS485_DRIVES: u32 = 1 << 7;

impl NxtBoard {
    /// Outputs have changed on which something depends.
    #[inline(never)]
    fn follow(&mut self, now: Cycles, outputs: PinOutputs) {
        let high = |pin: u32| {
            let pulled = outputs.driven & pin == 0 && outputs.pull_up & pin != 0;
            pulled || outputs.driven & outputs.level & pin != 0
        };
        let lines = ChipLines {
            reset: !high(MODULE_RESET),
            stream_wanted: high(MODULE_STREAM_WANTED),
            ready: !high(MODULE_RTS),
        };
        if self.driven(USB_PULL_UP, true) {
            self.boot_monitor = None;
        }
        let sound = outputs.driven & SOUND != 0;
        self.sound
            .drive(now, sound.then_some(outputs.level & SOUND != 0));
        let on = self.boot_monitor.is_some() || self.driven(USB_PULL_UP, false);
        let devices = self.devices.get();
        if devices.ports.has_outputs(outputs)
            && devices.bluetooth.has_lines(lines)
            && devices.usb.has_pull_up(on)
        {
            return;
        }
        let devices = self.devices.change();
        devices.ports.outputs_changed(now, outputs);
        devices.bluetooth.lines_changed(now, lines);
        devices.usb.set_pull_up(now, on);
    }
}

impl Board for NxtBoard {
    #[inline]
    fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs) {
        let before = std::mem::replace(&mut self.outputs, outputs);
        if outputs.differences(before) & FOLLOWED != 0 {
            self.follow(now, outputs);
        }
    }

    fn followed_pins(&self) -> u32 {
        FOLLOWED
    }

    fn pin_levels(&self) -> PinLevels {
        let (driven, level) = self.physics.pins();
        let held_back = if self.devices.get().bluetooth.refuses_characters() {
            MODULE_CTS
        } else {
            0
        };
        PinLevels {
            driven: driven | PULLED_UP | MODULE_RXD | MODULE_CTS,
            level: (level | PULLED_UP | MODULE_RXD | held_back)
                & !self.devices.get().ports.low()
                & !self.bus_low(),
        }
    }

    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        let reply = match &mut self.twi_script {
            Some(script) => script.start(),
            None => self.address_coprocessor(now, address, read),
        };
        let event = BusEvent::TwiStart {
            byte: address << 1 | u8::from(read),
            acknowledged: reply.acknowledged,
        };
        self.bus_log.add(now, event);
        reply
    }

    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply {
        let reply = match &mut self.twi_script {
            Some(script) => script.written(),
            None if self.addressed => self.coprocessor.write(now, byte),
            None => REFUSED,
        };
        let acknowledged = reply.acknowledged;
        let event = BusEvent::TwiWritten { byte, acknowledged };
        self.bus_log.add(now, event);
        reply
    }

    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles) {
        let (byte, stretch_cycles) = match &mut self.twi_script {
            Some(script) => script.read(),
            None if self.addressed => self.coprocessor.read(),
            None => (0xFF, 0),
        };
        self.bus_log.add(now, BusEvent::TwiRead(byte));
        (byte, stretch_cycles)
    }

    fn twi_end_of_read(&mut self, _now: Cycles) -> Cycles {
        if self.addressed {
            self.coprocessor.stretch_cycles(0)
        } else {
            0
        }
    }

    fn twi_stop(&mut self, now: Cycles) {
        self.addressed = false;
        self.bus_log.add(now, BusEvent::TwiStop);
    }

    fn spi_frame(&mut self, now: Cycles, selected: u32, frame: u16, bits: u8) -> u16 {
        if self.display_selected(selected) {
            let data = self.driven(DISPLAY_DATA, true);
            self.bus_log.add(now, BusEvent::Display { data, frame });
            match u8::try_from(frame) {
                Ok(byte) if bits == DISPLAY_FRAME_BITS => self.display_frame(now, byte),
                _ => self.log.fault(now, BoardFault::DisplayFrame { bits }),
            }
        }
        0
    }

    fn analogue_input(&mut self, now: Cycles, channel: u8) -> u16 {
        let scripted = self.converter_script.next(channel);
        let count = scripted.unwrap_or_else(|| self.voltage_at(now, channel));
        self.bus_log
            .add(now, BusEvent::Converted { channel, count });
        count
    }

    fn flash_command(&mut self, now: Cycles, command: u8, page: u16) {
        self.bus_log.add(now, BusEvent::Flash { command, page });
    }

    fn supply_is_low(&self) -> bool {
        self.battery.voltage() < BROWN_OUT_VOLTAGE
    }

    fn next_event(&self) -> Cycles {
        self.next_time()
    }

    fn advance(&mut self, now: Cycles) {
        self.advance_to(now);
    }

    fn has_received(&mut self, now: Cycles) -> bool {
        self.devices.have_sent(now)
    }

    fn powered(&self) -> bool {
        self.coprocessor.powered()
    }

    fn sound_bits(&mut self, now: Cycles, sound: SoundBits) {
        self.sound.add(now, sound);
    }

    fn serial_sent(&mut self, now: Cycles, port: SerialPort, character: Character) {
        let event = BusEvent::Sent(port, character.data as u8);
        self.bus_log.add(now, event);
        let devices = self.devices.change();
        match (port, &mut devices.module_script) {
            (SerialPort::Usart0, _) => devices.rs485.sent(now, character),
            (SerialPort::Usart1, Some(script)) => script.receive(now),
            (SerialPort::Usart1, None) => {
                devices.bluetooth.character(now, character, &mut self.log);
            }
            (SerialPort::DebugUnit, _) => {}
        }
    }

    fn serial_received(&mut self, now: Cycles, port: SerialPort) -> Option<Character> {
        if !self.devices.get().has_character(port, now) {
            return None;
        }
        let drives = self.driven(RS485_DRIVES, true);
        let devices = self.devices.change();
        let character = match (port, &mut devices.module_script) {
            (SerialPort::Usart0, _) => devices.rs485.take(now, drives),
            (SerialPort::Usart1, Some(script)) => script.take(now),
            (SerialPort::Usart1, None) => devices.bluetooth.take_character(),
            (SerialPort::DebugUnit, _) => None,
        }?;
        let event = BusEvent::Received(port, character.data as u8);
        self.bus_log.add(now, event);
        Some(character)
    }

    fn usb_signal(&mut self, now: Cycles) -> Option<UsbSignal> {
        if self.devices.get().usb.next_signal() > now {
            return None;
        }
        let usb = &mut self.devices.change().usb;
        let Some(monitor) = &mut self.boot_monitor else {
            return usb.signal(now);
        };
        while let Some(signal) = usb.signal(now) {
            if let Some(answer) = monitor.signal(signal) {
                usb.answer(now, answer);
            }
        }
        None
    }

    fn usb_answer(&mut self, now: Cycles, answer: UsbAnswer) {
        self.devices.change().usb.answer(now, answer);
    }

    fn wants_attention(&self) -> bool {
        self.log.ends()
    }

    fn observe(&mut self, now: Cycles, event: ChipEvent) {
        self.log.add(now, BoardEventKind::Chip(event));
    }
}

impl NxtBoard {
    fn driven(&self, pin: u32, level: bool) -> bool {
        self.outputs.driven & pin != 0 && (self.outputs.level & pin != 0) == level
    }

    /// The display hears frames while PA10 is low, as an output or as the SPI's own select line.
    fn display_selected(&self, selected: u32) -> bool {
        selected & DISPLAY_SELECT != 0 || self.driven(DISPLAY_SELECT, false)
    }

    fn address_coprocessor(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        self.addressed = address == ADDRESS && self.powered();
        if !self.addressed {
            return REFUSED;
        }
        if read {
            self.first_readings_cycles.get_or_insert(now);
        }
        self.coprocessor.start(read)
    }

    fn display_frame(&mut self, now: Cycles, byte: u8) {
        let data = self.driven(DISPLAY_DATA, true);
        let refresh = &mut self.devices.change().refresh;
        if data {
            refresh.data_written(now, byte);
        } else if let Err(fault) = refresh.command_written(now, byte) {
            self.log.fault(now, fault);
        }
    }

    /// Counts of the chip's converter on a channel.
    fn voltage_at(&self, now: Cycles, channel: u8) -> u16 {
        match channel {
            MODULE_MODE_CHANNEL if self.devices.get().bluetooth.stream_mode() => {
                return ANALOGUE_FULL_SCALE
            }
            CABLE_CHANNEL if self.devices.get().usb.plugged() => return CABLE_COUNT,
            _ => {}
        }
        let line = ANALOGUE_PINS
            .into_iter()
            .position(|(number, _)| number == channel);
        line.map_or(0, |index| self.port_voltage(now, index))
    }

    /// Counts on the second digital line of a port: a sensor's voltage, or a level.
    fn port_voltage(&self, now: Cycles, index: usize) -> u16 {
        let level = if self.is_low(1 << ANALOGUE_PINS[index].1) {
            0
        } else {
            ANALOGUE_FULL_SCALE
        };
        self.devices
            .get()
            .ports
            .analogue(now, index)
            .unwrap_or(level)
    }

    /// The pin is driven low from either side.
    fn is_low(&self, pin: u32) -> bool {
        self.driven(pin, false)
            || self.outputs.driven & pin == 0 && self.devices.get().ports.low() & pin != 0
    }

    /// The clock of the two-wire bus while the co-processor holds it.
    const fn bus_low(&self) -> u32 {
        if self.coprocessor.faults.holds_bus {
            BUS_CLOCK
        } else {
            0
        }
    }
}
