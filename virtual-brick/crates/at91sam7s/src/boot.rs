// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! How a chip starts: reset, and the state that the boot monitor hands to a RAM image.

use crate::adc::Adc;
use crate::aic::Aic;
use crate::board::{Board, Cycles, SerialPort};
use crate::chip::Chip;
use crate::mc::Mc;
use crate::pio::Pio;
use crate::pit::Pit;
use crate::pmc::Pmc;
use crate::pwmc::Pwmc;
use crate::rstc::ResetCause;
use crate::rtt::Rtt;
use crate::slow_clock_cycles;
use crate::spi::Spi;
use crate::ssc::Ssc;
use crate::tc::TimerBlock;
use crate::twi::Twi;
use crate::udp::Udp;
use crate::usart::Usart;
use crate::wdt::Wdt;

/// General purpose bits of the flash: brown-out detector on, and its reset.
const DETECTOR: u32 = 0;
const DETECTOR_RESETS: u32 = 1;

impl<B: Board> Chip<B> {
    /// The state in which the boot monitor jumps to a program in RAM: crystal and PLL on,
    /// master clock 48.05 MHz, remap off, watchdog mode register written (disabled), flash with
    /// one wait state. The caller sets the core to the entry point, supervisor mode, interrupts
    /// masked.
    pub fn enter_as_boot_monitor(&mut self) {
        self.pmc.as_boot_monitor(self.now);
        self.wdt.as_boot_monitor();
        self.flash.set_mode(0x0034_0100, &self.configuration.timing);
        self.ratio = 1;
        self.refresh_all(self.now);
    }

    /// Reset the chip as its NRST pin does; the caller resets the core.
    pub fn reset(&mut self, cause: ResetCause) {
        self.reset_now(cause, true, true, self.now);
    }

    pub(crate) fn reset_now(
        &mut self,
        cause: ResetCause,
        processor: bool,
        peripherals: bool,
        at: Cycles,
    ) {
        self.rstc.set_cause(cause);
        if processor {
            self.reset = Some(cause);
            self.stopped = false;
            self.wdt = Wdt::new(at);
        }
        if peripherals {
            self.reset_peripherals(at);
        }
        self.update_pins(at);
        self.update_modem_lines(false, at);
        self.refresh_all(at);
    }

    /// The board was changed from outside: follow its supply now.
    pub fn follow_supply(&mut self) {
        self.look_at_supply(self.now);
    }

    /// Follow the supply (datasheet, 6175M, chapter 13 and section 8.8): programming fails without
    /// it; the brown-out detector, when its bit in flash is set, tells, and with a second bit
    /// resets the chip for as long as the supply is low. Without the detector the program goes on.
    pub(crate) fn look_at_supply(&mut self, at: Cycles) {
        if !self.board.powered() {
            self.flash.interrupt_programming(at);
        }
        let low = self.board.supply_is_low();
        if low == self.supply_low {
            return;
        }
        self.supply_low = low;
        if low {
            self.flash.interrupt_programming(at);
            let detected = self.flash.general_purpose_bit(DETECTOR);
            if detected && self.flash.general_purpose_bit(DETECTOR_RESETS) {
                self.hold(at);
            } else if detected {
                self.rstc.brown_out();
                self.refresh_system(at);
            }
        } else if self.held {
            self.held = false;
            self.reset_now(ResetCause::BrownOut, true, true, at);
        }
    }

    fn hold(&mut self, at: Cycles) {
        self.held = true;
        self.stopped = true;
        self.wdt = Wdt::new(at);
        self.reset_peripherals(at);
        self.update_pins(at);
        self.update_modem_lines(false, at);
        self.refresh_all(at);
    }

    fn reset_peripherals(&mut self, at: Cycles) {
        let timing = self.configuration.timing;
        self.aic = Aic::new(&timing);
        self.flash.reset(&timing);
        self.mc = Mc::default();
        self.sram_alias = 2;
        self.flash.remapped();
        self.pit = Pit::new();
        self.tc = TimerBlock::new();
        self.pio = Pio::new();
        self.pmc = Pmc::new();
        self.rtt = Rtt::new(at);
        self.twi = Twi::new();
        self.spi = Spi::new();
        self.adc = Adc::new();
        self.ssc = Ssc::new();
        self.serial = SerialPort::ALL.map(Usart::new);
        self.pwmc = Pwmc::new();
        self.udp = Udp::new();
        self.ratio = slow_clock_cycles(1);
    }
}
