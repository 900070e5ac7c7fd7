// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The on-chip peripherals together: the address of each, its registers, its interrupt line and
//! its next event. Knows neither memory nor board.

use crate::adc::{self, Adc};
use crate::clock::Cycles;
use crate::fault::{not_modelled, Access, FaultKind};
use crate::registers::registers;
use crate::schedule::EventKind;
use crate::serial::ports::{SerialPorts, DEBUG_UNIT, IDENTIFIERS};
use crate::serial::spi::{self, Spi};
use crate::serial::ssc::{self, Ssc};
use crate::serial::twi::Twi;
use crate::serial::udp::{self, Udp};
use crate::system::aic::Aic;
use crate::system::pmc::Pmc;
use crate::system::rstc::{ResetRequest, Rstc};
use crate::timers::pit::Pit;
use crate::timers::pwmc::{self, Pwmc};
use crate::timers::rtt::Rtt;
use crate::timers::tc::block::TimerBlock;
use crate::timers::wdt::{Expiry, Wdt};
use crate::timing::ChipConfiguration;

registers! { DBGU_CIDR = 0x40, DBGU_EXID = 0x44 }

/// Address of the registers of the SPI.
pub(crate) const SPI_BASE: u32 = 0xFFFE_0000;
const TWI_BASE: u32 = 0xFFFB_8000;
pub(crate) const AIC_BASE: u32 = 0xFFFF_F000;
/// Bits of an address within its registers.
pub(crate) const AIC_BITS: u32 = 9;
pub(crate) const PIOA_BASE: u32 = 0xFFFF_F400;

/// A peripheral that answers at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Peripheral {
    Tc,
    Udp,
    Twi,
    Usart(usize),
    Pwmc,
    Ssc,
    Adc,
    Spi,
    Aic,
    Pioa,
    Pmc,
    Rstc,
    Rtt,
    Pit,
    Wdt,
    /// The voltage regulator's mode controller.
    Vreg,
    Mc,
}

/// The peripheral at `address` and the register offset in it. Interrupt controller, two-wire
/// interface and port, which running programs access most, are found first.
#[inline]
pub(crate) fn decode(address: u32) -> Access<(Peripheral, u32)> {
    match address & !0x1FF {
        AIC_BASE => Ok((Peripheral::Aic, address - AIC_BASE)),
        TWI_BASE => Ok((Peripheral::Twi, address - TWI_BASE)),
        PIOA_BASE => Ok((Peripheral::Pioa, address - PIOA_BASE)),
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
        0xFFFC_0000 => Peripheral::Usart(0),
        0xFFFC_4000 => Peripheral::Usart(1),
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
        0xFFFF_F200..=0xFFFF_F3FF => (Peripheral::Usart(DEBUG_UNIT), 0xFFFF_F200),
        0xFFFF_FC00..=0xFFFF_FCFF => (Peripheral::Pmc, 0xFFFF_FC00),
        0xFFFF_FD00..=0xFFFF_FD0F => (Peripheral::Rstc, 0xFFFF_FD00),
        0xFFFF_FD20..=0xFFFF_FD2F => (Peripheral::Rtt, 0xFFFF_FD20),
        0xFFFF_FD30..=0xFFFF_FD3F => (Peripheral::Pit, 0xFFFF_FD30),
        0xFFFF_FD40..=0xFFFF_FD4F => (Peripheral::Wdt, 0xFFFF_FD40),
        0xFFFF_FD60 => (Peripheral::Vreg, 0xFFFF_FD60),
        0xFFFF_FF00..=0xFFFF_FFFF => (Peripheral::Mc, 0xFFFF_FF00),
        _ => return Err(FaultKind::NoPeripheral),
    };
    Ok((peripheral, address - base))
}

/// Effect of a write to a register beyond its peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    Nothing,
    IntervalTimerStarted,
    Reset(ResetRequest),
    Watchdog(Expiry),
}

/// All peripherals but the PIO controller and the memory controller.
#[derive(Clone, Debug)]
pub(crate) struct Peripherals {
    pub(crate) aic: Aic,
    pub(crate) pit: Pit,
    pub(crate) tc: TimerBlock,
    pub(crate) pmc: Pmc,
    pub(crate) rstc: Rstc,
    pub(crate) wdt: Wdt,
    pub(crate) rtt: Rtt,
    pub(crate) twi: Twi,
    pub(crate) spi: Spi,
    pub(crate) adc: Adc,
    pub(crate) ssc: Ssc,
    pub(crate) serial: SerialPorts,
    pub(crate) pwmc: Pwmc,
    pub(crate) udp: Udp,
    regulator_mode: u32,
}

impl Peripherals {
    pub(crate) fn new(configuration: &ChipConfiguration, now: Cycles) -> Self {
        Self {
            aic: Aic::new(&configuration.timing),
            pit: Pit::new(),
            tc: TimerBlock::new(),
            pmc: Pmc::new(),
            rstc: Rstc::new(),
            wdt: Wdt::new(now),
            rtt: Rtt::new(now),
            twi: Twi::new(configuration.timing.twi_stop_decision, configuration.errata),
            spi: Spi::new(configuration.errata.spi_reset_needs_two),
            adc: Adc::new(configuration.errata.adc_channel_read_clears_drdy),
            ssc: Ssc::new(),
            serial: SerialPorts::new(),
            pwmc: Pwmc::new(),
            udp: Udp::new(),
            regulator_mode: 0,
        }
    }

    /// The reset line of the peripherals: reset controller, watchdog and regulator keep their
    /// state.
    pub(crate) fn reset(&mut self, configuration: &ChipConfiguration, now: Cycles) {
        *self = Self {
            rstc: self.rstc.clone(),
            wdt: self.wdt.clone(),
            regulator_mode: self.regulator_mode,
            ..Self::new(configuration, now)
        };
    }

    /// Both clocks of the USB device port are on.
    pub(crate) fn udp_clocked(&self) -> bool {
        self.pmc.clocked(udp::IDENTIFIER) && self.pmc.system_clocked(udp::SYSTEM_CLOCK)
    }

    /// Next event of a peripheral with an interrupt line of its own, the line and its level.
    #[inline]
    pub(crate) fn state(&self, peripheral: Peripheral) -> Option<(EventKind, Cycles, u8, bool)> {
        Some(match peripheral {
            Peripheral::Spi => {
                let spi = &self.spi;
                (
                    EventKind::Spi,
                    spi.next_event(),
                    spi::IDENTIFIER,
                    spi.interrupt(),
                )
            }
            Peripheral::Adc => {
                let adc = &self.adc;
                (
                    EventKind::Adc,
                    adc.next_event(),
                    adc::IDENTIFIER,
                    adc.interrupt(),
                )
            }
            Peripheral::Ssc => {
                let ssc = &self.ssc;
                (
                    EventKind::Ssc,
                    ssc.next_event(),
                    ssc::IDENTIFIER,
                    ssc.interrupt(),
                )
            }
            Peripheral::Pwmc => {
                let pwmc = &self.pwmc;
                (
                    EventKind::Pwmc,
                    pwmc.next_event(),
                    pwmc::IDENTIFIER,
                    pwmc.interrupt(),
                )
            }
            Peripheral::Udp => {
                let udp = &self.udp;
                (
                    EventKind::Udp,
                    udp.next_event(),
                    udp::IDENTIFIER,
                    udp.interrupt(),
                )
            }
            _ => return None,
        })
    }

    /// Level that the peripherals behind the system interrupt give it.
    pub(crate) fn system_interrupt(&self, now: Cycles) -> bool {
        self.pit.interrupt()
            || self.rtt.interrupt()
            || self.wdt.interrupt()
            || self.serial.0[DEBUG_UNIT].interrupt()
            || self.pmc.interrupt(now)
            || self.rstc.interrupt()
    }

    /// Read a register of any peripheral but AIC, PIOA and MC.
    pub(crate) fn read(
        &mut self,
        peripheral: Peripheral,
        offset: u32,
        now: Cycles,
        configuration: &ChipConfiguration,
    ) -> Access<u32> {
        Ok(match peripheral {
            Peripheral::Twi => self.twi.read(offset)?,
            Peripheral::Tc => self.tc.read(offset, now)?,
            Peripheral::Adc => self.adc.read(offset)?,
            Peripheral::Spi => self.spi.read(offset)?,
            Peripheral::Udp => self.udp.read(offset, now)?,
            Peripheral::Usart(DEBUG_UNIT) if offset == DBGU_CIDR => configuration.chip_identifier,
            Peripheral::Usart(DEBUG_UNIT) if offset == DBGU_EXID => 0,
            Peripheral::Usart(number) => self.serial.0[number].read(offset)?,
            Peripheral::Pwmc => self.pwmc.read(offset, now)?,
            Peripheral::Ssc => self.ssc.read(offset)?,
            Peripheral::Pmc => self.pmc.read(offset, now)?,
            Peripheral::Rstc => self.rstc.read(offset, now)?,
            Peripheral::Rtt => self.rtt.read(offset, now)?,
            Peripheral::Pit => self.pit.read(offset, now)?,
            Peripheral::Wdt => self.wdt.read(offset)?,
            Peripheral::Vreg => self.regulator_mode,
            Peripheral::Aic | Peripheral::Pioa | Peripheral::Mc => {
                return Err(FaultKind::NoPeripheral)
            }
        })
    }

    /// Write a register of any peripheral but AIC, PIOA, PMC, MC and TWI.
    pub(crate) fn write(
        &mut self,
        peripheral: Peripheral,
        offset: u32,
        value: u32,
        now: Cycles,
    ) -> Access<Effect> {
        let clocked = |identifier| self.pmc.clocked(identifier);
        match peripheral {
            Peripheral::Tc => self.tc.write(offset, value, now)?,
            Peripheral::Adc => self.adc.write(offset, value, now)?,
            Peripheral::Spi => {
                let clocked = clocked(spi::IDENTIFIER);
                self.spi.write(offset, value, now, clocked)?;
            }
            Peripheral::Udp => {
                let clocked = self.udp_clocked();
                if clocked && !self.pmc.usb_clock_fits() {
                    return not_modelled("UDP", "a USB clock other than 48 MHz (USBDIV)");
                }
                self.udp.write(offset, value, now, clocked)?;
            }
            Peripheral::Usart(DEBUG_UNIT) if matches!(offset, DBGU_CIDR | DBGU_EXID) => {}
            Peripheral::Usart(number) => {
                let unclocked = IDENTIFIERS[number].filter(|clock| !clocked(*clock));
                self.serial.0[number].write(offset, value, now, unclocked)?;
            }
            Peripheral::Pwmc => {
                let clocked = clocked(pwmc::IDENTIFIER);
                self.pwmc.write(offset, value, now, clocked)?;
            }
            Peripheral::Ssc => {
                let clocked = clocked(ssc::IDENTIFIER);
                self.ssc.write(offset, value, now, clocked)?;
            }
            Peripheral::Rstc => return self.rstc.write(offset, value, now).map(Effect::Reset),
            Peripheral::Rtt => self.rtt.write(offset, value, now)?,
            Peripheral::Pit => {
                if self.pit.write(offset, value, now)? {
                    return Ok(Effect::IntervalTimerStarted);
                }
            }
            Peripheral::Wdt => return self.wdt.write(offset, value, now).map(Effect::Watchdog),
            Peripheral::Vreg => self.regulator_mode = value & 1,
            Peripheral::Aic
            | Peripheral::Pioa
            | Peripheral::Pmc
            | Peripheral::Mc
            | Peripheral::Twi => return Err(FaultKind::NoPeripheral),
        }
        Ok(Effect::Nothing)
    }
}
