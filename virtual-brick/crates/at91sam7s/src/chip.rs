// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip as a whole: memories, peripherals, board and time.

use std::fmt;

use crate::adc::Adc;
use crate::aic::{Aic, Outcome};
use crate::board::{Board, ChipEvent, Cycles, PinOutputs, SerialPort};
use crate::event::{EventKind, Schedule};
use crate::fault::{Fault, FaultKind};
use crate::flash::{Flash, FLASH_BYTES};
use crate::mc::Mc;
use crate::pin_log::PinLog;
use crate::pins::PIOA;
use crate::pio::{PeripheralLines, Pio};
use crate::pit::Pit;
use crate::pmc::Pmc;
use crate::pwmc::Pwmc;
use crate::rstc::{ResetCause, Rstc};
use crate::rtt::Rtt;
use crate::spi::Spi;
use crate::sram::{Sram, WatchHit};
use crate::ssc::Ssc;
use crate::tc::TimerBlock;
use crate::timing::ChipConfiguration;
use crate::twi::Twi;
use crate::udp::Udp;
use crate::usart::Usart;
use crate::wdt::{Expiry, Wdt};
use crate::{slow_clock_cycles, NEVER};

/// Interrupt source of the system peripherals.
const SYSTEM: u8 = 1;
const SRAM_BASE: u32 = 0x0020_0000;
const SRAM_BYTES: u32 = 0x1_0000;
const FLASH_BASE: u32 = 0x0010_0000;

/// An address range that is not wholly inside SRAM or flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressError {
    /// First address of the range.
    pub address: u32,
    /// Its length in bytes.
    pub length: usize,
}

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} bytes at {:#010x} are not inside SRAM (0x00200000, 64 KiB) or flash \
             (0x00100000, 256 KiB)",
            self.length, self.address
        )
    }
}

impl std::error::Error for AddressError {}

/// An AT91SAM7S256 on a board; the bus of its ARM7TDMI core.
///
/// A new chip is in the state of power-on: remap off, slow clock, watchdog running.
#[derive(Clone, Debug)]
pub struct Chip<B: Board> {
    pub(crate) now: Cycles,
    /// Cycles of the time base in one processor cycle.
    pub(crate) ratio: Cycles,
    pub(crate) schedule: Schedule,
    pub(crate) sram: Sram,
    /// Window number of the SRAM's second appearance: 0 when remapped, else that of the first.
    pub(crate) sram_alias: u32,
    pub(crate) flash: Flash,
    pub(crate) configuration: ChipConfiguration,
    pub(crate) aic: Aic,
    pub(crate) mc: Mc,
    /// Code at which no block of instructions begins.
    pub(crate) looked_at: Vec<u32>,
    pub(crate) pit: Pit,
    pub(crate) tc: TimerBlock,
    pub(crate) pio: Pio,
    pub(crate) pmc: Pmc,
    pub(crate) rstc: Rstc,
    pub(crate) wdt: Wdt,
    pub(crate) rtt: Rtt,
    pub(crate) twi: Twi,
    pub(crate) spi: Spi,
    pub(crate) adc: Adc,
    pub(crate) ssc: Ssc,
    pub(crate) serial: [Usart; 3],
    pub(crate) pwmc: Pwmc,
    pub(crate) udp: Udp,
    pub(crate) regulator_mode: u32,
    pub(crate) board: B,
    /// The board is served now because it may have been changed from outside.
    board_reached_for: bool,
    pub(crate) outputs: PinOutputs,
    pub(crate) pin_log: PinLog,
    pub(crate) timer_lines: PeripheralLines,
    pub(crate) serial_lines: PeripheralLines,
    pub(crate) stopped: bool,
    pub(crate) stolen: Cycles,
    pub(crate) transfers_stored: u64,
    pub(crate) fault: Option<Fault>,
    pub(crate) reset: Option<ResetCause>,
    pub(crate) supply_low: bool,
    /// Held in reset by the brown-out detector.
    pub(crate) held: bool,
}

impl<B: Board> Chip<B> {
    /// A chip at power-on.
    pub fn new(board: B, configuration: ChipConfiguration) -> Self {
        let timing = configuration.timing;
        let mut chip = Self {
            now: 0,
            ratio: slow_clock_cycles(1),
            schedule: Schedule::new(),
            sram: Sram::new(),
            sram_alias: SRAM_BASE >> 20,
            flash: Flash::new(&timing),
            configuration,
            aic: Aic::new(&timing),
            mc: Mc::default(),
            looked_at: Vec::new(),
            pit: Pit::new(),
            tc: TimerBlock::new(),
            pio: Pio::new(),
            pmc: Pmc::new(),
            rstc: Rstc::new(),
            wdt: Wdt::new(0),
            rtt: Rtt::new(0),
            twi: Twi::new(),
            spi: Spi::new(),
            adc: Adc::new(),
            ssc: Ssc::new(),
            serial: SerialPort::ALL.map(Usart::new),
            pwmc: Pwmc::new(),
            udp: Udp::new(),
            regulator_mode: 0,
            board,
            board_reached_for: false,
            pin_log: PinLog::default(),
            outputs: PinOutputs::default(),
            timer_lines: PeripheralLines::default(),
            serial_lines: PeripheralLines::default(),
            stopped: false,
            stolen: 0,
            transfers_stored: 0,
            fault: None,
            reset: None,
            supply_low: false,
            held: false,
        };
        chip.update_pins(0);
        chip.update_modem_lines(false, 0);
        chip.refresh_all(0);
        chip
    }

    /// Master clock cycles since power-on.
    #[inline(always)]
    pub fn now(&self) -> Cycles {
        self.now
    }

    /// The board.
    pub fn board(&self) -> &B {
        &self.board
    }

    /// The board, to change it from outside; the chip looks at its pins again before the next
    /// access takes effect.
    pub fn board_mut(&mut self) -> &mut B {
        self.board_reached_for = true;
        self.schedule.set(EventKind::Board, self.now);
        &mut self.board
    }

    /// The board, to take from it what it has reported: its pins and its next event stay.
    pub fn board_reports(&mut self) -> &mut B {
        &mut self.board
    }

    /// Levels of pins PA0 to PA31 as the PIO controller last saw them, one bit each.
    pub fn pins(&self) -> u32 {
        self.pio.pins()
    }

    /// The processor clock is stopped until an interrupt is asserted.
    #[inline(always)]
    pub fn processor_stopped(&self) -> bool {
        self.stopped
    }

    /// The first thing that the model could not do; the run cannot go on.
    #[inline(always)]
    pub fn fault(&self) -> Option<&Fault> {
        self.fault.as_ref()
    }

    /// The data controller may write memory without the processor.
    #[must_use]
    pub fn memory_is_written_besides(&self) -> bool {
        let serial = self.serial.iter().any(|port| port.pdc.receive.ready());
        serial || self.spi.pdc.receive.ready()
    }

    /// A reset of the processor happened since the last call: reset the core.
    #[inline]
    pub fn take_reset(&mut self) -> Option<ResetCause> {
        if self.reset.is_none() {
            return None;
        }
        self.reset.take()
    }

    /// Let time pass without the processor: to the next event, or to `limit` if that is sooner.
    pub fn skip_to_next_event(&mut self, limit: Cycles) {
        let target = self.schedule.earliest().min(limit);
        self.now = self.now.max(target);
        if self.now >= self.schedule.earliest() {
            self.serve_events();
        }
    }

    /// Put bytes in SRAM or flash without taking time.
    ///
    /// # Errors
    /// The range is not wholly inside SRAM or flash.
    pub fn load(&mut self, address: u32, bytes: &[u8]) -> Result<(), AddressError> {
        let in_sram = self.memory(address, bytes.len())?;
        for (address, byte) in (address..).zip(bytes) {
            if in_sram {
                self.sram.load_byte(address, *byte);
            } else {
                self.flash.load_byte(address, *byte);
            }
        }
        Ok(())
    }

    /// Read SRAM or flash without side effects.
    ///
    /// # Errors
    /// The range is not wholly inside SRAM or flash.
    pub fn peek(&self, address: u32, length: usize) -> Result<Vec<u8>, AddressError> {
        self.memory(address, length)?;
        let mut bytes = vec![0; length];
        self.peek_into(address, &mut bytes)?;
        Ok(bytes)
    }

    /// Read as many bytes of SRAM or flash as there is room for, without side effects.
    ///
    /// # Errors
    /// The range is not wholly inside SRAM or flash.
    pub fn peek_into(&self, address: u32, bytes: &mut [u8]) -> Result<(), AddressError> {
        let in_sram = self.memory(address, bytes.len())?;
        for (at, byte) in (address..).zip(bytes) {
            let word = if in_sram {
                self.sram.word(at)
            } else {
                self.flash.word(at)
            };
            *byte = (word >> ((at & 3) * 8)) as u8;
        }
        Ok(())
    }

    /// Transfers that the peripheral data controller has stored in SRAM so far.
    #[must_use]
    pub fn transfers_stored(&self) -> u64 {
        self.transfers_stored
    }

    /// Read one aligned word of SRAM or flash without side effects.
    ///
    /// # Errors
    /// The word is not inside SRAM or flash.
    pub fn peek_word(&self, address: u32) -> Result<u32, AddressError> {
        let address = address & !3;
        let in_sram = self.memory(address, 4)?;
        Ok(if in_sram {
            self.sram.word(address)
        } else {
            self.flash.word(address)
        })
    }

    /// True for SRAM, false for flash; the first appearances only.
    fn memory(&self, address: u32, length: usize) -> Result<bool, AddressError> {
        let inside = |base: u32, size: usize| {
            address >= base
                && (address - base) as usize <= size.saturating_sub(length)
                && length <= size
        };
        if inside(SRAM_BASE, SRAM_BYTES as usize) {
            Ok(true)
        } else if inside(FLASH_BASE, FLASH_BYTES) {
            Ok(false)
        } else {
            Err(AddressError { address, length })
        }
    }

    /// Address of the last access that the memory controller aborted; whether it was misaligned.
    #[must_use]
    pub fn aborted_access(&self) -> (u32, bool) {
        (self.mc.abort_address(), self.mc.abort_misaligned())
    }

    /// Let each arrival at these addresses of code, if by a branch, be a step of its own.
    pub fn look_at(&mut self, addresses: &[u32]) {
        self.looked_at = addresses.to_vec();
    }

    /// Record every processor write to the SRAM word at `address`.
    ///
    /// # Errors
    /// The word is not inside SRAM.
    pub fn watch_word(&mut self, address: u32) -> Result<(), AddressError> {
        if !self.memory(address & !3, 4)? {
            return Err(AddressError { address, length: 4 });
        }
        self.sram.watch(address);
        Ok(())
    }

    /// Some watched word was written since the hits were last taken.
    #[inline(always)]
    pub fn has_watch_hits(&self) -> bool {
        self.sram.has_hits()
    }

    /// Writes to watched words, in the order of time, in place of what `taken` holds.
    pub fn take_watch_hits(&mut self, taken: &mut Vec<WatchHit>) {
        self.sram.take_hits(taken);
    }

    pub(crate) fn record_fault(&mut self, kind: FaultKind, address: u32, write: Option<u32>) {
        if self.fault.is_none() {
            self.fault = Some(Fault {
                at_cycles: self.now,
                kind,
                address,
                write: write.is_some(),
                value: write.unwrap_or(0),
            });
        }
    }

    /// Let processor cycles pass.
    #[inline(always)]
    pub(crate) fn spend(&mut self, cycles: Cycles) {
        self.now += cycles * self.ratio;
        if self.now >= self.schedule.earliest() {
            self.serve_events();
        }
    }

    /// Serve every event that is due, in order; cycles taken by the data controller delay the
    /// processor.
    #[cold]
    pub(crate) fn serve_events(&mut self) {
        loop {
            if self.schedule.earliest() <= self.now {
                let (kind, at) = self.schedule.first();
                self.serve(kind, at);
            } else if self.stolen != 0 && !self.stopped {
                self.now += std::mem::take(&mut self.stolen) * self.ratio;
            } else {
                self.stolen = 0;
                return;
            }
        }
    }

    fn serve(&mut self, kind: EventKind, at: Cycles) {
        match kind {
            EventKind::Board => self.serve_board(at),
            EventKind::Clocks | EventKind::Flash => self.refresh_system(at),
            EventKind::Watchdog => {
                let expiry = self.wdt.serve(at);
                self.watchdog_expired(expiry, at);
            }
            EventKind::RealTimeTimer => {
                self.rtt.serve(at);
                self.refresh_system(at);
            }
            EventKind::IntervalTimer => {
                self.pit.serve(at);
                self.refresh_system(at);
            }
            EventKind::Timer0 => self.serve_timer(0, at),
            EventKind::Timer1 => self.serve_timer(1, at),
            EventKind::Timer2 => self.serve_timer(2, at),
            EventKind::TwoWire => self.serve_twi(at),
            EventKind::Serial => self.serve_spi(at),
            EventKind::Converter => self.serve_adc(at),
            EventKind::Sound => self.serve_ssc(at),
            EventKind::Characters => self.serve_serial(at),
            EventKind::Periods => {
                self.pwmc.advance(at);
                self.refresh_pwmc(at);
            }
            EventKind::Usb => {
                self.udp.advance(at);
                self.refresh_udp(at);
            }
            EventKind::Wake => self.wake(at),
        }
    }

    fn serve_board(&mut self, at: Cycles) {
        let reached_for = std::mem::take(&mut self.board_reached_for);
        if !reached_for || self.board.next_event() <= at {
            self.board.advance(at);
        }
        self.follow_board_pins(at);
        if self.board.brings(at) {
            self.take_from_board(at);
        }
        self.look_at_supply(at);
        self.refresh_board(at);
    }

    /// Look at the pins again if the board has changed them.
    pub(crate) fn follow_board_pins(&mut self, at: Cycles) {
        let clocked = self.pmc.clocked(PIOA);
        let levels = self.board.pin_levels();
        if !self.pio.settled(self.outputs, levels, clocked) {
            self.update_pins(at);
        }
    }

    /// Ask the board when it wants to be advanced; never at or before the present.
    pub(crate) fn refresh_board(&mut self, at: Cycles) {
        let next = self.board.next_event().max(at + 1);
        self.schedule.set(EventKind::Board, next);
    }

    fn serve_timer(&mut self, number: usize, at: Cycles) {
        self.tc.channels[number].advance(at);
        self.refresh_timer(number, at);
    }

    fn serve_twi(&mut self, at: Cycles) {
        let connected = self.pio.is_peripheral_a(3) && self.pio.is_peripheral_a(4);
        self.twi.serve(at, &mut self.board, connected);
        self.refresh_board(at);
        self.refresh_twi(at);
    }

    fn serve_adc(&mut self, at: Cycles) {
        let channel = self.adc.converted();
        let count = self.board.analogue_input(at, channel);
        self.adc.store(at, count);
        self.refresh_board(at);
        self.refresh_adc(at);
    }

    fn wake(&mut self, at: Cycles) {
        self.schedule.set(EventKind::Wake, NEVER);
        if self.stopped && !self.held {
            self.stopped = false;
            self.wdt.processor_resumed(at);
            self.schedule
                .set(EventKind::Watchdog, self.wdt.next_event());
            self.board.observe(at, ChipEvent::ProcessorResumed);
        }
    }

    /// Stop the processor clock, unless an interrupt is already asserted.
    pub(crate) fn stop_processor(&mut self, at: Cycles) {
        if self.aic.wake_at() <= at {
            return;
        }
        self.stopped = true;
        self.wdt.processor_stopped(at);
        self.schedule
            .set(EventKind::Watchdog, self.wdt.next_event());
        self.schedule.set(EventKind::Wake, self.aic.wake_at());
        self.board.observe(at, ChipEvent::ProcessorStopped);
    }

    pub(crate) fn watchdog_expired(&mut self, expiry: Expiry, at: Cycles) {
        match expiry {
            _ if self.held => {
                self.wdt = Wdt::new(at);
                self.refresh_system(at);
            }
            Expiry::Nothing => self.refresh_system(at),
            Expiry::ResetProcessor => self.reset_now(ResetCause::Watchdog, true, false, at),
            Expiry::ResetAll => self.reset_now(ResetCause::Watchdog, true, true, at),
        }
    }

    /// Pass an interrupt line on to the controller.
    #[inline]
    pub(crate) fn set_line(&mut self, source: u8, level: bool, at: Cycles, delay: Cycles) {
        self.aic.set_line(source, level, at, delay);
        self.reschedule_wake(at);
    }

    pub(crate) fn reschedule_wake(&mut self, at: Cycles) {
        if self.stopped {
            self.schedule
                .set(EventKind::Wake, self.aic.wake_at().max(at));
        }
    }

    pub(crate) fn report(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Nothing => {}
            Outcome::Entered(source) => {
                self.board
                    .observe(self.now, ChipEvent::InterruptEntered { source });
            }
            Outcome::Left => self.board.observe(self.now, ChipEvent::InterruptLeft),
        }
    }

    pub(crate) fn refresh_system(&mut self, at: Cycles) {
        self.schedule
            .set(EventKind::IntervalTimer, self.pit.next_event());
        self.schedule
            .set(EventKind::RealTimeTimer, self.rtt.next_event(at));
        self.schedule
            .set(EventKind::Watchdog, self.wdt.next_event());
        self.schedule
            .set(EventKind::Clocks, self.pmc.next_event(at));
        self.schedule
            .set(EventKind::Flash, self.flash.next_event(at));
        let level = self.pit.interrupt()
            || self.rtt.interrupt()
            || self.wdt.interrupt()
            || self.serial[2].interrupt()
            || self.pmc.interrupt(at)
            || self.rstc.interrupt()
            || self.flash.interrupt(at);
        self.set_line(SYSTEM, level, at, 0);
    }

    pub(crate) fn refresh_timer(&mut self, number: usize, at: Cycles) {
        let channel = &self.tc.channels[number];
        let level = channel.interrupt();
        self.schedule
            .set(EventKind::TIMERS[number], channel.next_event());
        self.set_line(12 + number as u8, level, at, 0);
        if self.lines_of_timers() != self.timer_lines {
            self.update_pins(at);
        }
    }

    pub(crate) fn refresh_twi(&mut self, at: Cycles) {
        self.schedule.set(EventKind::TwoWire, self.twi.next_event());
        let level = self.twi.interrupt();
        self.set_line(crate::twi::IDENTIFIER, level, at, 0);
    }

    pub(crate) fn refresh_adc(&mut self, at: Cycles) {
        self.schedule
            .set(EventKind::Converter, self.adc.next_event());
        let level = self.adc.interrupt();
        self.set_line(4, level, at, 0);
    }

    pub(crate) fn refresh_all(&mut self, at: Cycles) {
        self.refresh_board(at);
        self.refresh_system(at);
        (0..3).for_each(|number| self.refresh_timer(number, at));
        self.refresh_twi(at);
        self.refresh_spi(at);
        self.refresh_adc(at);
        self.refresh_ssc(at);
        (0..3).for_each(|number| self.refresh_serial(number, at));
        self.refresh_pwmc(at);
        self.refresh_udp(at);
        self.refresh_pio(at, 0);
    }
}
