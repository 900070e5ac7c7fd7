// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Register accesses, clocks, resets and the supply: what each sets in motion.

use crate::board::{Board, ChipEvent, Cycles};
use crate::chip::Chip;
use crate::clock::slow_clock_cycles;
use crate::fault::Access;
use crate::memory;
use crate::peripherals::{decode, Effect, Peripheral};
use crate::pins::pio::Pio;
use crate::pins::PIOA;
use crate::serial::twi;
use crate::system::aic::Outcome;
use crate::system::pmc::{Pmc, Request};
use crate::system::rstc::ResetCause;
use crate::timers::tc;
use crate::timers::wdt::Wdt;

/// General purpose bits of the flash: brown-out detector on, and its reset.
const DETECTOR: u32 = 0;
const DETECTOR_RESETS: u32 = 1;

/// Register accesses.
impl<B: Board> Chip<B> {
    /// Read the register at a word address; effects take place now.
    pub(super) fn read_register(&mut self, address: u32) -> Access<u32> {
        let (peripheral, offset) = decode(address)?;
        match peripheral {
            Peripheral::Aic => {
                let (value, outcome) = self.peripherals.aic.read(offset, self.now)?;
                self.interrupt_acknowledged(outcome);
                Ok(value)
            }
            Peripheral::Twi => {
                let before = self.peripherals.twi.interrupt();
                let value = self.peripherals.twi.read(offset)?;
                // A read takes flags back and begins nothing on the bus.
                if self.peripherals.twi.interrupt() != before {
                    self.refresh_twi(self.now);
                }
                Ok(value)
            }
            _ => self.read_other_register(peripheral, offset),
        }
    }

    #[inline(never)]
    fn read_other_register(&mut self, peripheral: Peripheral, offset: u32) -> Access<u32> {
        let now = self.now;
        if let Some((value, _)) = self.polled(peripheral, offset, now) {
            return Ok(value);
        }
        let value = match peripheral {
            Peripheral::Pioa => self.pins.pio.read(offset)?,
            Peripheral::Mc => self.memories.read_register(offset, now)?,
            _ => {
                let configuration = &self.configuration;
                self.peripherals
                    .read(peripheral, offset, now, configuration)?
            }
        };
        self.refresh_after_access(peripheral, offset);
        Ok(value)
    }

    /// What a read at `at`, before which nothing is due, gives of a register that programs poll, if
    /// it changes nothing; and whether a read gives the same until something is due.
    #[inline(always)]
    pub(super) fn polled(
        &self,
        peripheral: Peripheral,
        offset: u32,
        at: Cycles,
    ) -> Option<(u32, bool)> {
        let peripherals = &self.peripherals;
        Some(match peripheral {
            Peripheral::Pioa => (self.pins.pio.polled(offset)?, true),
            Peripheral::Twi => (peripherals.twi.polled(offset)?, true),
            Peripheral::Adc => (peripherals.adc.polled(offset)?, true),
            Peripheral::Tc => peripherals.tc.polled(offset, at)?,
            Peripheral::Pit => (peripherals.pit.polled(offset, at)?, false),
            _ => return None,
        })
    }

    /// Write the register at a word address; effects take place now.
    pub(super) fn write_register(&mut self, address: u32, value: u32) -> Access {
        let (peripheral, offset) = decode(address)?;
        match peripheral {
            Peripheral::Aic => {
                let outcome = self.peripherals.aic.write(offset, value, self.now)?;
                self.interrupt_acknowledged(outcome);
                Ok(())
            }
            Peripheral::Twi => self.write_two_wire(offset, value),
            _ => self.write_other_register(peripheral, offset, value),
        }
    }

    #[inline(never)]
    fn write_other_register(&mut self, peripheral: Peripheral, offset: u32, value: u32) -> Access {
        let now = self.now;
        let effect = match peripheral {
            Peripheral::Pioa => {
                self.pins.pio.write(offset, value)?;
                self.pins_written(now);
                return Ok(());
            }
            Peripheral::Pmc => return self.write_clocks(offset, value),
            Peripheral::Mc => {
                self.write_memory_controller(offset, value)?;
                Effect::Nothing
            }
            _ => self.peripherals.write(peripheral, offset, value, now)?,
        };
        if matches!(peripheral, Peripheral::Usart(_) | Peripheral::Spi) {
            self.data_controller_may_write = self.data_controller_writes();
        }
        self.follow_effect(effect);
        self.refresh_after_access(peripheral, offset);
        Ok(())
    }

    fn follow_effect(&mut self, effect: Effect) {
        let now = self.now;
        match effect {
            Effect::IntervalTimerStarted => {
                self.board.observe(now, ChipEvent::IntervalTimerStarted);
            }
            Effect::Reset(request) => {
                if request.processor || request.peripherals {
                    let cause = ResetCause::Software;
                    self.reset_now(cause, request.processor, request.peripherals, now);
                }
            }
            Effect::Watchdog(expiry) => self.watchdog_expired(expiry, now),
            Effect::Nothing => {}
        }
    }

    fn refresh_after_access(&mut self, peripheral: Peripheral, offset: u32) {
        let now = self.now;
        match peripheral {
            Peripheral::Tc => {
                let numbers = tc::channels_at(offset);
                numbers.for_each(|number| self.refresh_timer(number, now));
            }
            _ => self.refresh(peripheral, now),
        }
    }

    /// After an access to the interrupt controller.
    #[inline]
    fn interrupt_acknowledged(&mut self, outcome: Outcome) {
        self.reschedule_wake(self.now);
        let event = match outcome {
            Outcome::Nothing => return,
            Outcome::Entered(source) => ChipEvent::InterruptEntered { source },
            Outcome::Left => ChipEvent::InterruptLeft,
        };
        self.board.observe(self.now, event);
    }

    fn write_two_wire(&mut self, offset: u32, value: u32) -> Access {
        let clocked = self.peripherals.pmc.clocked(twi::IDENTIFIER);
        self.peripherals
            .twi
            .write(offset, value, self.now, clocked)?;
        if offset == twi::TWI_CR {
            let high = self.pins.pio.pins() & twi::LINES == twi::LINES;
            self.peripherals.twi.follow_lines(value, high);
        }
        self.refresh_twi(self.now);
        Ok(())
    }

    fn write_memory_controller(&mut self, offset: u32, value: u32) -> Access {
        let command = memory::flash_command(offset, value);
        if let Some((code, number)) = command {
            self.board.flash_command(self.now, code, number);
        }
        self.memories.write_register(offset, value, self.now)?;
        if command.is_some() && self.supply_low {
            self.memories.flash.interrupt_programming(self.now);
        }
        Ok(())
    }

    /// A clock register: the change reaches the processor, the timers and the pin sampling.
    fn write_clocks(&mut self, offset: u32, value: u32) -> Access {
        let now = self.now;
        if Pmc::only_stops_processor(offset, value) {
            self.follow_board_pins(now);
            self.stop_processor(now);
            return Ok(());
        }
        let pmc = &mut self.peripherals.pmc;
        let pins_were_clocked = pmc.clocked(PIOA);
        let request = pmc.write(offset, value, now)?;
        if pmc.clocked(PIOA) && !pins_were_clocked {
            self.pins.pio.clock_started();
        }
        self.ratio = pmc.processor_ratio()?;
        for number in 0..3 {
            let clocked = self.peripherals.pmc.clocked(tc::IDENTIFIERS[number]);
            self.peripherals.tc.channels[number].set_clocked(now, clocked);
            self.refresh_timer(number, now);
        }
        self.update_pins(now);
        self.refresh_system(now);
        if request == Request::StopProcessor {
            self.stop_processor(now);
        }
        Ok(())
    }
}

/// Resets and the supply.
impl<B: Board> Chip<B> {
    pub(super) fn reset_now(
        &mut self,
        cause: ResetCause,
        processor: bool,
        peripherals: bool,
        at: Cycles,
    ) {
        if processor {
            self.peripherals.rstc.set_cause(cause);
            self.reset = Some(cause);
            self.stopped = false;
            self.peripherals.wdt = Wdt::new(at);
        }
        if peripherals {
            self.reset_peripherals(at);
        }
        self.update_all(at);
    }

    fn reset_peripherals(&mut self, at: Cycles) {
        self.memories.reset();
        self.peripherals.reset(&self.configuration, at);
        self.pins.pio = Pio::new();
        self.ratio = slow_clock_cycles(1);
    }

    /// Follow the supply (datasheet, 6175M, chapter 13 and section 8.8): programming fails without
    /// it; the brown-out detector, when its bit in flash is set, tells, and with a second bit
    /// resets the chip for as long as the supply is low. Without the detector the program goes on.
    pub(super) fn check_supply(&mut self, at: Cycles) {
        let flash = &mut self.memories.flash;
        if !self.board.powered() {
            flash.interrupt_programming(at);
        }
        let low = self.board.supply_is_low();
        if low == self.supply_low {
            return;
        }
        self.supply_low = low;
        if low {
            flash.interrupt_programming(at);
            let detected = flash.general_purpose_bit(DETECTOR);
            if detected && flash.general_purpose_bit(DETECTOR_RESETS) {
                self.hold_in_reset(at);
            } else if detected {
                self.peripherals.rstc.brown_out();
                self.refresh_system(at);
            }
        } else if self.held {
            self.held = false;
            self.reset_now(ResetCause::BrownOut, true, true, at);
        }
    }

    fn hold_in_reset(&mut self, at: Cycles) {
        self.held = true;
        self.stopped = true;
        self.peripherals.wdt = Wdt::new(at);
        self.reset_peripherals(at);
        self.update_all(at);
    }

    /// Pins, modem lines, interrupt lines and next events after a reset.
    pub(super) fn update_all(&mut self, at: Cycles) {
        self.update_pins(at);
        self.update_modem_lines(false, at);
        self.refresh_all(at);
    }
}
