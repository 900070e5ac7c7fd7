// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Which register answers at which address, and what each access sets in motion.

use crate::board::{Board, ChipEvent};
use crate::chip::Chip;
use crate::dbgu;
use crate::fault::{Access, FaultKind};
use crate::pins;
use crate::pmc::{Pmc, Request};
use crate::rstc::ResetCause;
use crate::streams::SERIAL_CLOCKS;
use crate::{pwmc, spi, ssc, twi};

pub(crate) const SPI_BASE: u32 = 0xFFFE_0000;
const TWI_BASE: u32 = 0xFFFB_8000;
const AIC_BASE: u32 = 0xFFFF_F000;

/// A peripheral that answers at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Peripheral {
    Tc,
    Udp,
    Twi,
    Usart0,
    Usart1,
    Pwmc,
    Ssc,
    Adc,
    Spi,
    Aic,
    Dbgu,
    Pioa,
    Pmc,
    Rstc,
    Rtt,
    Pit,
    Wdt,
    Regulator,
    Mc,
}

/// The peripheral at `address` and the register offset in it. Interrupt controller and two-wire
/// interface, which running programs access most, are found first.
#[inline]
fn decode(address: u32) -> Access<(Peripheral, u32)> {
    match address & !0x1FF {
        AIC_BASE => Ok((Peripheral::Aic, address - AIC_BASE)),
        TWI_BASE => Ok((Peripheral::Twi, address - TWI_BASE)),
        _ => decode_any(address),
    }
}

#[inline(never)]
fn decode_any(address: u32) -> Access<(Peripheral, u32)> {
    let slot = address & 0xFFFF_C000;
    let peripheral = match slot {
        0xFFFA_0000 => Peripheral::Tc,
        0xFFFB_0000 => Peripheral::Udp,
        TWI_BASE => Peripheral::Twi,
        0xFFFC_0000 => Peripheral::Usart0,
        0xFFFC_4000 => Peripheral::Usart1,
        0xFFFC_C000 => Peripheral::Pwmc,
        0xFFFD_4000 => Peripheral::Ssc,
        0xFFFD_8000 => Peripheral::Adc,
        SPI_BASE => Peripheral::Spi,
        0xFFFF_C000 => return decode_system(address),
        _ => return Err(FaultKind::NoPeripheral),
    };
    Ok((peripheral, address - slot))
}

fn decode_system(address: u32) -> Access<(Peripheral, u32)> {
    let (peripheral, base) = match address {
        0xFFFF_F000..=0xFFFF_F1FF => (Peripheral::Aic, AIC_BASE),
        0xFFFF_F200..=0xFFFF_F3FF => (Peripheral::Dbgu, 0xFFFF_F200),
        0xFFFF_F400..=0xFFFF_F5FF => (Peripheral::Pioa, 0xFFFF_F400),
        0xFFFF_FC00..=0xFFFF_FCFF => (Peripheral::Pmc, 0xFFFF_FC00),
        0xFFFF_FD00..=0xFFFF_FD0F => (Peripheral::Rstc, 0xFFFF_FD00),
        0xFFFF_FD20..=0xFFFF_FD2F => (Peripheral::Rtt, 0xFFFF_FD20),
        0xFFFF_FD30..=0xFFFF_FD3F => (Peripheral::Pit, 0xFFFF_FD30),
        0xFFFF_FD40..=0xFFFF_FD4F => (Peripheral::Wdt, 0xFFFF_FD40),
        0xFFFF_FD60 => (Peripheral::Regulator, 0xFFFF_FD60),
        0xFFFF_FF00..=0xFFFF_FFFF => (Peripheral::Mc, 0xFFFF_FF00),
        _ => return Err(FaultKind::NoPeripheral),
    };
    Ok((peripheral, address - base))
}

impl<B: Board> Chip<B> {
    /// Read the register at a word address; effects take place now.
    pub(crate) fn read_register(&mut self, address: u32) -> Access<u32> {
        let (peripheral, offset) = decode(address)?;
        let now = self.now;
        match peripheral {
            Peripheral::Aic => {
                let (value, outcome) = self.aic.read(offset, now)?;
                self.reschedule_wake(now);
                self.report(outcome);
                Ok(value)
            }
            Peripheral::Tc => {
                let value = self.tc.read(offset, now)?;
                self.refresh_timers_at(offset);
                Ok(value)
            }
            Peripheral::Twi => {
                let value = self.twi.read(offset)?;
                self.refresh_twi(now);
                Ok(value)
            }
            Peripheral::Adc => {
                let value = self.adc.read(offset)?;
                self.refresh_adc(now);
                Ok(value)
            }
            Peripheral::Spi => {
                let value = self.spi.read(offset)?;
                self.refresh_spi(now);
                Ok(value)
            }
            Peripheral::Pioa => {
                let value = self.pio.read(offset)?;
                self.refresh_pio(now, 0);
                Ok(value)
            }
            Peripheral::Udp => {
                let value = self.udp.read(offset, now)?;
                self.refresh_udp(now);
                Ok(value)
            }
            Peripheral::Usart0 => self.read_serial(0, offset),
            Peripheral::Usart1 => self.read_serial(1, offset),
            Peripheral::Pwmc => {
                let value = self.pwmc.read(offset, now)?;
                self.refresh_pwmc(now);
                Ok(value)
            }
            Peripheral::Ssc => {
                let value = self.ssc.read(offset)?;
                self.refresh_ssc(now);
                Ok(value)
            }
            _ => {
                let value = self.read_system(peripheral, offset)?;
                self.refresh_system(now);
                Ok(value)
            }
        }
    }

    fn read_serial(&mut self, number: usize, offset: u32) -> Access<u32> {
        let value = self.serial[number].read(offset)?;
        self.refresh_serial(number, self.now);
        Ok(value)
    }

    fn read_debug_unit(&mut self, offset: u32) -> Access<u32> {
        match dbgu::identifier(offset, self.configuration.chip_identifier) {
            Some(value) => Ok(value),
            None => self.read_serial(2, offset),
        }
    }

    fn read_system(&mut self, peripheral: Peripheral, offset: u32) -> Access<u32> {
        let now = self.now;
        match peripheral {
            Peripheral::Dbgu => self.read_debug_unit(offset),
            Peripheral::Pmc => self.pmc.read(offset, now),
            Peripheral::Rstc => self.rstc.read(offset),
            Peripheral::Rtt => self.rtt.read(offset, now),
            Peripheral::Pit => self.pit.read(offset, now),
            Peripheral::Wdt => self.wdt.read(offset),
            Peripheral::Regulator => Ok(self.regulator_mode),
            _ => self.read_memory_controller(offset),
        }
    }

    fn read_memory_controller(&mut self, offset: u32) -> Access<u32> {
        match offset {
            0x00 | 0x64 => Ok(0),
            0x04 => Ok(self.mc.read_abort_status()),
            0x08 => Ok(self.mc.abort_address()),
            0x60 => Ok(self.flash.mode()),
            0x68 => Ok(self.flash.read_status(self.now)),
            _ => Err(FaultKind::RegisterNotModelled {
                peripheral: "MC",
                offset,
            }),
        }
    }

    /// Write the register at a word address; effects take place now.
    pub(crate) fn write_register(&mut self, address: u32, value: u32) -> Access<()> {
        let (peripheral, offset) = decode(address)?;
        let now = self.now;
        match peripheral {
            Peripheral::Aic => {
                let outcome = self.aic.write(offset, value, now)?;
                self.reschedule_wake(now);
                self.report(outcome);
            }
            Peripheral::Tc => {
                self.tc.write(offset, value, now)?;
                self.refresh_timers_at(offset);
            }
            Peripheral::Twi => {
                let clocked = self.pmc.clocked(twi::IDENTIFIER);
                self.twi.write(offset, value, now, clocked)?;
                self.refresh_twi(now);
            }
            Peripheral::Adc => {
                self.adc.write(offset, value, now)?;
                self.refresh_adc(now);
            }
            Peripheral::Spi => {
                let clocked = self.pmc.clocked(spi::IDENTIFIER);
                self.spi.write(offset, value, now, clocked)?;
                self.refresh_spi(now);
            }
            Peripheral::Pioa => {
                self.pio.write(offset, value)?;
                self.update_pins(now);
            }
            Peripheral::Udp => {
                let clocked = self.udp_clocked();
                self.udp.write(offset, value, now, clocked)?;
                self.refresh_udp(now);
            }
            Peripheral::Usart0 => self.write_serial(0, offset, value)?,
            Peripheral::Usart1 => self.write_serial(1, offset, value)?,
            Peripheral::Pwmc => {
                let clocked = self.pmc.clocked(pwmc::IDENTIFIER);
                self.pwmc.write(offset, value, now, clocked)?;
                self.refresh_pwmc(now);
            }
            Peripheral::Ssc => {
                let clocked = self.pmc.clocked(ssc::IDENTIFIER);
                self.ssc.write(offset, value, now, clocked)?;
                self.refresh_ssc(now);
            }
            _ => return self.write_system(peripheral, offset, value),
        }
        Ok(())
    }

    fn write_serial(&mut self, number: usize, offset: u32, value: u32) -> Access<()> {
        let unclocked = SERIAL_CLOCKS[number].filter(|clock| !self.pmc.clocked(*clock));
        self.serial[number].write(offset, value, self.now, unclocked)?;
        self.refresh_serial(number, self.now);
        Ok(())
    }

    fn write_debug_unit(&mut self, offset: u32, value: u32) -> Access<()> {
        match dbgu::identifier(offset, 0) {
            Some(_) => Ok(()),
            None => self.write_serial(2, offset, value),
        }
    }

    fn write_system(&mut self, peripheral: Peripheral, offset: u32, value: u32) -> Access<()> {
        let now = self.now;
        match peripheral {
            Peripheral::Dbgu => self.write_debug_unit(offset, value)?,
            Peripheral::Pmc => return self.write_clocks(offset, value),
            Peripheral::Rstc => {
                let request = self.rstc.write(offset, value)?;
                if request.processor || request.peripherals {
                    let cause = ResetCause::Software;
                    self.reset_now(cause, request.processor, request.peripherals, now);
                }
            }
            Peripheral::Rtt => self.rtt.write(offset, value, now)?,
            Peripheral::Pit => {
                if self.pit.write(offset, value, now)? {
                    self.board.observe(now, ChipEvent::IntervalTimerStarted);
                }
            }
            Peripheral::Wdt => {
                let expiry = self.wdt.write(offset, value, now)?;
                self.watchdog_expired(expiry, now);
            }
            Peripheral::Regulator => self.regulator_mode = value & 1,
            _ => self.write_memory_controller(offset, value)?,
        }
        self.refresh_system(now);
        Ok(())
    }

    fn write_memory_controller(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => {
                self.mc.write_remap(value);
                self.sram_alias = if self.mc.remapped { 0 } else { 2 };
                self.flash.remapped();
            }
            0x60 => self.flash.set_mode(value, &self.configuration.timing),
            0x64 => {
                let (command, page) = ((value & 0xF) as u8, (value >> 8 & 0x3FF) as u16);
                self.board.flash_command(self.now, command, page);
                self.flash.command(self.now, value)?;
                if self.supply_low {
                    self.flash.interrupt_programming(self.now);
                }
            }
            0x04 | 0x08 | 0x68 => {}
            _ => {
                return Err(FaultKind::RegisterNotModelled {
                    peripheral: "MC",
                    offset,
                })
            }
        }
        Ok(())
    }

    /// A clock register: the change reaches the processor, the timers and the pin sampling.
    fn write_clocks(&mut self, offset: u32, value: u32) -> Access<()> {
        let now = self.now;
        if Pmc::only_stops_processor(offset, value) {
            self.follow_board_pins(now);
            self.stop_processor(now);
            return Ok(());
        }
        let pins_were_clocked = self.pmc.clocked(pins::PIOA);
        let request = self.pmc.write(offset, value, now)?;
        if self.pmc.clocked(pins::PIOA) && !pins_were_clocked {
            self.pio.clock_started();
        }
        self.ratio = self.pmc.processor_ratio()?;
        for number in 0..3 {
            let clocked = self.pmc.clocked(12 + number as u8);
            self.tc.channels[number].set_clocked(now, clocked);
            self.refresh_timer(number, now);
        }
        self.update_pins(now);
        self.refresh_system(now);
        if request == Request::StopProcessor {
            self.stop_processor(now);
        }
        Ok(())
    }

    /// After an access to the timer block: the channel concerned, or all.
    fn refresh_timers_at(&mut self, offset: u32) {
        let now = self.now;
        match offset {
            0x00..=0xBF => self.refresh_timer(offset as usize / 0x40, now),
            _ => (0..3).for_each(|number| self.refresh_timer(number, now)),
        }
    }
}
