// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! USB device port (AT91SAM7S datasheet, 6175M, chapter 35): control, bulk and interrupt
//! endpoints, two banks on endpoints 1 and 2.
//!
//! The host's transactions are whole and without transmission errors. A write of `UDP_CSRx`
//! takes effect after it has crossed into the USB clock domain; until then the register reads
//! as before.

use crate::board::{Cycles, UsbAnswer, UsbSignal};
use crate::clock::NEVER;
use crate::fault::{clock_disabled, no_register, Access};
use crate::registers::{check_written, number_in_row, registers, unmodelled, Unmodelled};

mod endpoint;

use endpoint::{Endpoint, FLAGS_THAT_INTERRUPT, NAME};

registers! {
    UDP_FRM_NUM = 0x00, UDP_GLB_STAT = 0x04, UDP_FADDR = 0x08, UDP_IER = 0x10, UDP_IDR = 0x14,
    UDP_IMR = 0x18, UDP_ISR = 0x1C, UDP_ICR = 0x20, UDP_RST_EP = 0x28, UDP_CSR0 = 0x30,
    UDP_CSR3 = 0x3C, UDP_FDR0 = 0x50, UDP_FDR3 = 0x5C, UDP_TXVC = 0x74,
}

pub(crate) const IDENTIFIER: u8 = 11;
/// Bit of `PMC_SCER` that switches the 48 MHz clock of the port.
pub(crate) const SYSTEM_CLOCK: u32 = 1 << 7;

/// Isochronous endpoints are refused where their type is written.
const UNMODELLED: &[Unmodelled] = &[unmodelled(UDP_GLB_STAT, 1 << 2, "remote wake-up (ESR)")];
/// Fields of the global state that software writes.
const GLOBAL_FIELDS: u32 = 0x17;
/// Time for a write of `UDP_CSRx` to cross into the USB clock domain: one period of each clock,
/// which are equal, and one of uncertainty.
const CROSSING_CYCLES: Cycles = 3;
const ENDPOINTS: usize = 4;
const FUNCTION_ENABLED: u32 = 1 << 8;
const TRANSCEIVER_DISABLED: u32 = 1 << 8;
const SUSPENDED: u32 = 1 << 8;
const RESUMED: u32 = 1 << 9;
const START_OF_FRAME: u32 = 1 << 11;
const END_OF_RESET: u32 = 1 << 12;
const WAKE_UP: u32 = 1 << 13;
/// Interrupts of the bus, cleared through `UDP_ICR`.
const BUS_FLAGS: u32 = SUSPENDED | RESUMED | START_OF_FRAME | END_OF_RESET | WAKE_UP;
/// Interrupts that can be masked; the end of a bus reset cannot.
const MASKABLE: u32 = 0xF | SUSPENDED | RESUMED | START_OF_FRAME | WAKE_UP;

/// Registers and endpoints.
#[derive(Clone, Debug)]
pub(crate) struct Udp {
    frame: u32,
    global: u32,
    function: u32,
    mask: u32,
    bus: u32,
    /// The bus was idle for 3 ms, and nothing has happened on it since.
    idle: bool,
    reset: u32,
    transceiver: u32,
    endpoints: [Endpoint; ENDPOINTS],
}

impl Udp {
    pub(crate) fn new() -> Self {
        Self {
            frame: 0,
            global: 0x10,
            function: FUNCTION_ENABLED,
            mask: 0,
            bus: 0,
            idle: false,
            reset: 0,
            transceiver: 0,
            endpoints: std::array::from_fn(Endpoint::new),
        }
    }

    /// Let the writes that have crossed the clock domains by `now` take effect.
    pub(crate) fn advance(&mut self, now: Cycles) {
        for endpoint in &mut self.endpoints {
            endpoint.settle(now);
        }
    }

    pub(crate) fn next_event(&self) -> Cycles {
        let crossings = self.endpoints.iter().filter_map(Endpoint::settles_at);
        crossings.min().unwrap_or(NEVER)
    }

    fn status(&self) -> u32 {
        let endpoints = self.endpoints.iter().enumerate();
        let ready = |(number, endpoint): (usize, &Endpoint)| {
            u32::from(endpoint.control() & FLAGS_THAT_INTERRUPT != 0) << number
        };
        self.bus | endpoints.map(ready).sum::<u32>()
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status() & (self.mask | END_OF_RESET) != 0
    }

    /// What the host put on the bus; an answer when it was a transaction.
    pub(crate) fn signal(
        &mut self,
        signal: UsbSignal,
        now: Cycles,
        clocked: bool,
    ) -> Option<UsbAnswer> {
        self.advance(now);
        let on = self.transceiver & TRANSCEIVER_DISABLED == 0;
        let UsbSignal::Transaction {
            address,
            endpoint,
            transaction,
        } = signal
        else {
            if on {
                self.bus_signal(signal, clocked);
            }
            return None;
        };
        let number = usize::from(endpoint);
        let mine = self.function & FUNCTION_ENABLED != 0
            && self.function & 0x7F == u32::from(address)
            && number < ENDPOINTS
            && self.reset >> number & 1 == 0;
        if !on || !clocked || !mine {
            return Some(UsbAnswer::Silent);
        }
        Some(self.endpoints[number].transaction(transaction))
    }

    fn bus_signal(&mut self, signal: UsbSignal, clocked: bool) {
        match signal {
            UsbSignal::ResetBegins => self.wake_up(clocked),
            UsbSignal::Reset => {
                self.function = FUNCTION_ENABLED;
                self.global &= !3;
                self.endpoints = std::array::from_fn(Endpoint::new);
                self.bus |= END_OF_RESET;
            }
            UsbSignal::Suspend => {
                self.bus |= SUSPENDED;
                self.idle = true;
            }
            UsbSignal::Resume => {
                self.bus |= RESUMED;
                self.wake_up(clocked);
            }
            UsbSignal::StartOfFrame { number } if clocked => {
                self.frame = u32::from(number) & 0x7FF | 1 << 17;
                self.bus |= START_OF_FRAME;
            }
            UsbSignal::StartOfFrame { .. } | UsbSignal::Transaction { .. } => {}
        }
    }

    /// Activity on a bus that was idle, or while the port's clocks are off, wakes it up. That the
    /// clocks may be on is inferred: the USB framework of the chip's maker, which pbLua runs on
    /// bricks, waits for this flag with its clocks on before it heeds the first bus reset.
    fn wake_up(&mut self, clocked: bool) {
        if self.idle || !clocked {
            self.bus |= WAKE_UP;
        }
        self.idle = false;
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        self.advance(now);
        Ok(match offset {
            UDP_FRM_NUM => self.frame,
            UDP_GLB_STAT => self.global,
            UDP_FADDR => self.function,
            UDP_IER | UDP_IDR | UDP_ICR => 0,
            UDP_IMR => self.mask | END_OF_RESET,
            UDP_ISR => self.status(),
            UDP_RST_EP => self.reset,
            UDP_CSR0..=UDP_CSR3 => self.endpoints[number_in_row(offset, UDP_CSR0)].control(),
            UDP_FDR0..=UDP_FDR3 => self.endpoints[number_in_row(offset, UDP_FDR0)].take(),
            UDP_TXVC => self.transceiver,
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles, clocked: bool) -> Access {
        check_written(NAME, UNMODELLED, offset, value)?;
        self.advance(now);
        match offset {
            UDP_GLB_STAT => self.global = value & GLOBAL_FIELDS,
            UDP_FADDR => self.function = value & 0x17F,
            UDP_IER => self.mask |= value & MASKABLE,
            UDP_IDR => self.mask &= !value,
            UDP_ICR => self.bus &= !(value & BUS_FLAGS),
            UDP_RST_EP => {
                self.reset = value & 0xF;
                let endpoints = self.endpoints.iter_mut().enumerate();
                let reset = endpoints.filter(|(number, _)| value >> number & 1 != 0);
                reset.for_each(|(_, endpoint)| endpoint.reset());
            }
            UDP_CSR0..=UDP_CSR3 => {
                if !clocked {
                    return clock_disabled(NAME, IDENTIFIER);
                }
                let endpoint = &mut self.endpoints[number_in_row(offset, UDP_CSR0)];
                endpoint.write_control(value, now + CROSSING_CYCLES)?;
            }
            UDP_FDR0..=UDP_FDR3 => self.endpoints[number_in_row(offset, UDP_FDR0)].put(value)?,
            UDP_TXVC => self.transceiver = value & TRANSCEIVER_DISABLED,
            UDP_FRM_NUM | UDP_IMR | UDP_ISR => {}
            _ => return no_register(NAME, offset),
        }
        Ok(())
    }
}
