// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The wiring between the parts: events, interrupt lines, transfers and pins.

use crate::board::{Board, ChipEvent, Cycles, SerialPort};
use crate::chip::Chip;
use crate::clock::NEVER;
use crate::fault::TransferFault;
use crate::peripherals::{Peripheral, SPI_BASE};
use crate::pins::{Pins, EXTERNAL_INTERRUPTS, INTERRUPT_PINS, PIOA};
use crate::schedule::EventKind;
use crate::serial::pdc;
use crate::serial::ports::{SerialPorts, DEBUG_UNIT, IDENTIFIERS};
use crate::serial::twi;
use crate::system::rstc::ResetCause;
use crate::timers::tc;
use crate::timers::wdt::{Expiry, Wdt};

/// Interrupt source of the system peripherals.
const SYSTEM: u8 = 1;

impl<B: Board> Chip<B> {
    pub(super) fn serve(&mut self, kind: EventKind, at: Cycles) {
        match kind {
            EventKind::Board => self.serve_board(at),
            EventKind::Pmc | EventKind::Flash => self.refresh_system(at),
            EventKind::Wdt => {
                let expiry = self.peripherals.wdt.serve(at);
                self.watchdog_expired(expiry, at);
            }
            EventKind::Rtt => {
                self.peripherals.rtt.serve(at);
                self.refresh_system(at);
            }
            EventKind::Pit => {
                self.peripherals.pit.serve(at);
                self.refresh_system(at);
            }
            EventKind::Tc0 => self.serve_timer(0, at),
            EventKind::Tc1 => self.serve_timer(1, at),
            EventKind::Tc2 => self.serve_timer(2, at),
            EventKind::Twi => self.serve_twi(at),
            EventKind::Spi => self.serve_spi(at),
            EventKind::Adc => self.serve_adc(at),
            EventKind::Ssc => {
                let pio = &self.pins.pio;
                if self.peripherals.ssc.send(at, &mut self.board, pio) {
                    self.refresh_board(at);
                }
                self.refresh(Peripheral::Ssc, at);
            }
            EventKind::Usart => self.serve_usarts(at),
            EventKind::Pwmc => {
                self.peripherals.pwmc.advance(at);
                self.refresh(Peripheral::Pwmc, at);
            }
            EventKind::Udp => {
                self.peripherals.udp.advance(at);
                self.refresh(Peripheral::Udp, at);
            }
            EventKind::Wake => self.wake(at),
        }
    }

    fn serve_board(&mut self, at: Cycles) {
        let changed = std::mem::take(&mut self.board_changed);
        if !changed || self.board.next_event() <= at {
            self.board.advance(at);
        }
        self.follow_board_pins(at);
        if self.board.has_received(at) {
            self.receive_from_board(at);
        }
        self.check_supply(at);
        self.refresh_board(at);
    }

    /// Take what the board's lines brought by now.
    fn receive_from_board(&mut self, at: Cycles) {
        for (number, port) in SerialPort::ALL.into_iter().enumerate() {
            while let Some(character) = self.board.serial_received(at, port) {
                self.peripherals.serial.0[number].receive(character, at);
                self.refresh_usart(number, at);
            }
        }
        while let Some(signal) = self.board.usb_signal(at) {
            let clocked = self.peripherals.udp_clocked();
            if let Some(answer) = self.peripherals.udp.signal(signal, at, clocked) {
                self.board.usb_answer(at, answer);
            }
            self.refresh(Peripheral::Udp, at);
        }
    }

    fn serve_timer(&mut self, number: usize, at: Cycles) {
        self.peripherals.tc.channels[number].advance(at);
        self.refresh_timer(number, at);
    }

    fn serve_twi(&mut self, at: Cycles) {
        let pio = &self.pins.pio;
        let connected = pio.is_peripheral_a(3) && pio.is_peripheral_a(4);
        self.peripherals.twi.serve(at, &mut self.board, connected);
        self.refresh_board(at);
        self.refresh_twi(at);
    }

    fn serve_spi(&mut self, at: Cycles) {
        let spi = &mut self.peripherals.spi;
        if spi.exchange(at, &mut self.board, &self.pins.pio) {
            let stored = pdc::drain(spi, &mut self.memories, at);
            self.refresh_board(at);
            self.check_transfer(stored);
        }
        if let Err(kind) = self.peripherals.spi.continue_at(at) {
            self.record_fault(kind, SPI_BASE, None);
        }
        self.refresh(Peripheral::Spi, at);
    }

    fn serve_adc(&mut self, at: Cycles) {
        let channel = self.peripherals.adc.converted();
        let count = self.board.analogue_input(at, channel);
        self.peripherals.adc.store(at, count);
        self.refresh_board(at);
        self.refresh(Peripheral::Adc, at);
    }

    fn serve_usarts(&mut self, at: Cycles) {
        for number in 0..SerialPort::ALL.len() {
            let serial = &mut self.peripherals.serial;
            if serial.0[number].next_event() > at {
                continue;
            }
            if serial.send(number, at, &mut self.board, &self.pins.pio) {
                self.refresh_board(at);
            }
            self.refresh_usart(number, at);
        }
    }

    fn wake(&mut self, at: Cycles) {
        self.schedule.set(EventKind::Wake, NEVER);
        if self.stopped && !self.held {
            self.stopped = false;
            self.peripherals.wdt.processor_resumed(at);
            self.reschedule_watchdog();
            self.board.observe(at, ChipEvent::ProcessorResumed);
        }
    }

    /// Stop the processor clock, unless an interrupt is already asserted.
    pub(super) fn stop_processor(&mut self, at: Cycles) {
        let wake_at = self.peripherals.aic.wake_at();
        if wake_at <= at {
            return;
        }
        self.stopped = true;
        self.peripherals.wdt.processor_stopped(at);
        self.reschedule_watchdog();
        self.schedule.set(EventKind::Wake, wake_at);
        self.board.observe(at, ChipEvent::ProcessorStopped);
    }

    pub(super) fn watchdog_expired(&mut self, expiry: Expiry, at: Cycles) {
        match expiry {
            _ if self.held => {
                self.peripherals.wdt = Wdt::new(at);
                self.refresh_system(at);
            }
            Expiry::Nothing => self.refresh_system(at),
            Expiry::ResetProcessor => self.reset_now(ResetCause::Watchdog, true, false, at),
            Expiry::ResetAll => self.reset_now(ResetCause::Watchdog, true, true, at),
        }
    }
}

/// Interrupt lines and times of the next events.
impl<B: Board> Chip<B> {
    /// Pass an interrupt line on to the controller.
    #[inline]
    fn set_line(&mut self, source: u8, level: bool, at: Cycles, delay: Cycles) {
        self.peripherals.aic.set_line(source, level, at, delay);
        self.reschedule_wake(at);
    }

    pub(super) fn reschedule_wake(&mut self, at: Cycles) {
        if self.stopped {
            let wake_at = self.peripherals.aic.wake_at().max(at);
            self.schedule.set(EventKind::Wake, wake_at);
        }
    }

    fn reschedule_watchdog(&mut self) {
        let expires = self.peripherals.wdt.next_event();
        self.schedule.set(EventKind::Wdt, expires);
    }

    /// Ask the board when it wants to be advanced; never at or before the present.
    pub(super) fn refresh_board(&mut self, at: Cycles) {
        let next = self.board.next_event().max(at + 1);
        self.schedule.set(EventKind::Board, next);
    }

    #[inline]
    pub(super) fn refresh_twi(&mut self, at: Cycles) {
        let (next, level) = (
            self.peripherals.twi.next_event(),
            self.peripherals.twi.interrupt(),
        );
        self.schedule.set(EventKind::Twi, next);
        self.set_line(twi::IDENTIFIER, level, at, 0);
    }

    /// After a change in a peripheral: its transfers, its interrupt line and its next event.
    #[inline]
    pub(super) fn refresh(&mut self, peripheral: Peripheral, at: Cycles) {
        match peripheral {
            Peripheral::Spi => self.feed_spi(at),
            Peripheral::Ssc => self.feed_ssc(at),
            Peripheral::Twi => return self.refresh_twi(at),
            Peripheral::Usart(number) => return self.refresh_usart(number, at),
            Peripheral::Pioa => return self.refresh_pio(at, 0),
            _ => {}
        }
        match self.peripherals.state(peripheral) {
            Some((kind, next, source, level)) => {
                self.schedule.set(kind, next);
                self.set_line(source, level, at, 0);
            }
            None => self.refresh_system(at),
        }
    }

    pub(super) fn refresh_system(&mut self, at: Cycles) {
        let peripherals = &self.peripherals;
        let (pit, rtt) = (peripherals.pit.next_event(), peripherals.rtt.next_event(at));
        let (pmc, flash) = (
            peripherals.pmc.next_event(at),
            self.memories.flash.next_event(at),
        );
        let level = peripherals.system_interrupt(at) || self.memories.flash.interrupt(at);
        self.schedule.set(EventKind::Pit, pit);
        self.schedule.set(EventKind::Rtt, rtt);
        self.reschedule_watchdog();
        self.schedule.set(EventKind::Pmc, pmc);
        self.schedule.set(EventKind::Flash, flash);
        self.set_line(SYSTEM, level, at, 0);
    }

    pub(super) fn refresh_timer(&mut self, number: usize, at: Cycles) {
        self.refresh_timer_alone(number, at);
        if self.peripherals.tc.lines() != self.pins.timer_lines {
            self.update_pins(at);
        }
    }

    fn refresh_timer_alone(&mut self, number: usize, at: Cycles) {
        let channel = &self.peripherals.tc.channels[number];
        let (next, level) = (channel.next_event(), channel.interrupt());
        self.schedule.set(EventKind::TIMERS[number], next);
        self.set_line(tc::IDENTIFIERS[number], level, at, 0);
    }

    fn refresh_usart(&mut self, number: usize, at: Cycles) {
        let port = &mut self.peripherals.serial.0[number];
        if self.fault.is_none() {
            let fed = pdc::feed(port, &mut self.memories, at);
            self.check_transfer(fed);
        }
        let port = &mut self.peripherals.serial.0[number];
        let stored = pdc::drain(port, &mut self.memories, at);
        self.check_transfer(stored);
        let serial = &self.peripherals.serial;
        self.schedule.set(EventKind::Usart, serial.next_event());
        match IDENTIFIERS[number] {
            Some(source) => {
                let level = serial.0[number].interrupt();
                self.set_line(source, level, at, 0);
            }
            None => self.refresh_system(at),
        }
        if self.peripherals.serial.lines() != self.pins.serial_lines {
            self.update_pins(at);
        }
    }

    /// Interrupt line of the PIO controller; `seen` are the pins that have just changed.
    fn refresh_pio(&mut self, at: Cycles, seen: u32) {
        let delay = self.pins.interrupt_delay(seen, &self.configuration.timing);
        let level = self.pins.pio.interrupt();
        self.set_line(PIOA, level, at, delay);
    }

    fn feed_spi(&mut self, at: Cycles) {
        if self.fault.is_none() {
            let fed = pdc::feed(&mut self.peripherals.spi, &mut self.memories, at);
            self.check_transfer(fed);
        }
    }

    fn feed_ssc(&mut self, at: Cycles) {
        if self.fault.is_none() {
            let fed = pdc::feed(&mut self.peripherals.ssc, &mut self.memories, at);
            self.check_transfer(fed);
        }
    }

    fn check_transfer(&mut self, transfer: Result<(), TransferFault>) {
        if let Err(fault) = transfer {
            self.record_fault(fault.kind, fault.pointer, fault.written);
        }
    }

    pub(super) fn refresh_all(&mut self, at: Cycles) {
        self.refresh_board(at);
        self.refresh_system(at);
        (0..3).for_each(|number| self.refresh_timer(number, at));
        self.refresh(Peripheral::Twi, at);
        self.refresh(Peripheral::Spi, at);
        self.refresh(Peripheral::Adc, at);
        self.refresh(Peripheral::Ssc, at);
        (0..3).for_each(|number| self.refresh_usart(number, at));
        self.refresh(Peripheral::Pwmc, at);
        self.refresh(Peripheral::Udp, at);
        self.refresh_pio(at, 0);
    }
}

/// Pins that timers, serial ports or the interrupt controller follow.
const FOLLOWED: u32 = tc::ALL_PINS | SerialPorts::modem_pins() | EXTERNAL_INTERRUPTS;

/// Pins.
impl<B: Board> Chip<B> {
    /// Look at the pins again if the board has changed them.
    pub(super) fn follow_board_pins(&mut self, at: Cycles) {
        let clocked = self.peripherals.pmc.clocked(PIOA);
        let levels = self.board.pin_levels();
        if !self.pins.pio.settled(self.pins.outputs, levels, clocked) {
            self.update_pins(at);
        }
    }

    /// Tell the board what the chip drives, read the pins back, pass changes on.
    pub(super) fn update_pins(&mut self, at: Cycles) {
        // A pin may trigger a channel whose output drives another pin, at most once per channel.
        for _ in 0..=tc::PINS.len() {
            self.follow_timer_outputs(at);
            self.pins.serial_lines = self.peripherals.serial.lines();
            if !self.drive_pins(at) {
                return;
            }
        }
    }

    /// Write levels of outputs at `at`, unless something besides the controller follows one that
    /// changes; true when written. The pins carry what chip and board drive: no event is due.
    #[inline]
    pub(super) fn write_unfollowed(&mut self, offset: u32, value: u32, at: Cycles) -> bool {
        let clocked = self.peripherals.pmc.clocked(PIOA);
        let Pins {
            pio, outputs, log, ..
        } = &mut self.pins;
        debug_assert!(pio.settled(*outputs, self.board.pin_levels(), clocked));
        let changed = pio.levels_changed(offset, value);
        let followed = FOLLOWED | pio.followed() | log.chosen() | self.board.followed_pins();
        if changed & followed != 0 {
            return false;
        }
        outputs.level ^= pio.invert_levels(changed, clocked);
        self.board.outputs_changed(at, *outputs);
        true
    }

    /// After a write to the PIO controller: the lines of timers and serial ports are known.
    pub(super) fn pins_written(&mut self, at: Cycles) {
        if self.drive_pins(at) {
            self.update_pins(at);
        }
    }

    /// True if the pins have changed what the timers drive.
    fn drive_pins(&mut self, at: Cycles) -> bool {
        let pins = &mut self.pins;
        let outputs = pins.pio.outputs(pins.serial_lines, pins.timer_lines);
        if outputs != pins.outputs {
            pins.outputs = outputs;
            self.board.outputs_changed(at, outputs);
            self.refresh_board(at);
        }
        let clocked = self.peripherals.pmc.clocked(PIOA);
        let levels = self.board.pin_levels();
        let (changed, seen) = self.pins.pio.sample(outputs, levels, clocked);
        if changed != 0 {
            self.pins_changed(changed, at);
        }
        self.refresh_pio(at, seen);
        changed & tc::ALL_PINS != 0 && self.peripherals.tc.lines() != self.pins.timer_lines
    }

    /// Note the lines of the timers; a rising TIOA may trigger the converter.
    fn follow_timer_outputs(&mut self, at: Cycles) {
        let lines = self.peripherals.tc.lines();
        let risen = lines.level & !self.pins.timer_lines.level;
        self.pins.timer_lines = lines;
        if let Some(channel) = self.peripherals.adc.trigger_channel() {
            if risen >> tc::PINS[channel].0 & 1 != 0 {
                self.peripherals.adc.trigger(at);
                self.refresh(Peripheral::Adc, at);
            }
        }
    }

    fn pins_changed(&mut self, changed: u32, at: Cycles) {
        let pins = self.pins();
        self.pins.log.changed(changed, at, pins);
        for (number, (pin_a, pin_b)) in tc::PINS.into_iter().enumerate() {
            if changed & (1 << pin_a | 1 << pin_b) != 0 {
                self.peripherals.tc.channels[number].set_pins(pins, at);
                self.refresh_timer_alone(number, at);
            }
        }
        if changed & SerialPorts::modem_pins() != 0 {
            self.update_modem_lines(true, at);
        }
        for (pin, source) in INTERRUPT_PINS {
            if changed >> pin & 1 != 0 {
                self.set_line(source, pins >> pin & 1 != 0, at, 0);
            }
        }
    }

    /// Pass the levels of the modem pins on; `flag` their changes unless they come from a reset.
    pub(super) fn update_modem_lines(&mut self, flag: bool, at: Cycles) {
        let pins = self.pins();
        self.peripherals.serial.set_modem_lines(pins, flag, at);
        (0..DEBUG_UNIT).for_each(|number| self.refresh_usart(number, at));
    }
}
