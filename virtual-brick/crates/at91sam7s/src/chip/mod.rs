// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip joins memories, peripherals, pins and board, and lets time pass.

mod access;
mod blocks;
mod bus;
mod wiring;

use crate::board::{Board, Cycles};
use crate::clock::slow_clock_cycles;
use crate::fault::{Fault, FaultKind};
use crate::memory::sram::WatchHit;
use crate::memory::{AddressError, Memories};
use crate::peripherals::Peripherals;
use crate::pins::pin_log::{LoggedPins, PinLog};
use crate::pins::Pins;
use crate::schedule::{EventKind, Schedule};
use crate::system::rstc::ResetCause;
use crate::timing::ChipConfiguration;

/// An AT91SAM7S256 on a board; the bus of its ARM7TDMI core.
///
/// A new chip is in the state of power-on: remap off, slow clock, watchdog running.
#[derive(Clone, Debug)]
pub struct Chip<B: Board> {
    now: Cycles,
    /// Cycles of the time base in one processor cycle.
    ratio: Cycles,
    schedule: Schedule,
    configuration: ChipConfiguration,
    memories: Memories,
    peripherals: Peripherals,
    pins: Pins,
    board: B,
    /// The board is served now because it may have been changed from outside.
    board_changed: bool,
    /// If not, the data controller writes no memory before the next write to a serial port's or
    /// the SPI's registers.
    data_controller_may_write: bool,
    /// Code that no block of instructions contains, in order.
    observed_arrivals: Vec<u32>,
    /// The processor clock is stopped.
    stopped: bool,
    /// The brown-out detector holds the chip in reset.
    held: bool,
    supply_low: bool,
    fault: Option<Fault>,
    reset: Option<ResetCause>,
}

impl<B: Board> Chip<B> {
    /// A chip at power-on.
    pub fn new(board: B, configuration: ChipConfiguration) -> Self {
        let mut chip = Self {
            now: 0,
            ratio: slow_clock_cycles(1),
            schedule: Schedule::new(),
            configuration,
            memories: Memories::new(&configuration.timing),
            peripherals: Peripherals::new(&configuration, 0),
            pins: Pins::new(),
            board,
            board_changed: false,
            data_controller_may_write: false,
            observed_arrivals: Vec::new(),
            stopped: false,
            held: false,
            supply_low: false,
            fault: None,
            reset: None,
        };
        chip.update_all(0);
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
        self.board_changed = true;
        self.schedule.set(EventKind::Board, self.now);
        &mut self.board
    }

    /// The board, to take from it what it has reported: its pins and its next event stay.
    pub fn board_reports(&mut self) -> &mut B {
        &mut self.board
    }

    /// The board was changed from outside: follow its supply now.
    pub fn follow_supply(&mut self) {
        self.check_supply(self.now);
    }

    /// Levels of pins PA0 to PA31 as the PIO controller last saw them, one bit each.
    pub fn pins(&self) -> u32 {
        self.pins.pio.pins()
    }

    /// Log the pins whose bits are set, from now on; what was logged before is forgotten.
    pub fn log_pins(&mut self, chosen: u32) {
        let now = LoggedPins {
            at_cycles: self.now,
            pins: self.pins(),
        };
        self.pins.log = PinLog::new(chosen, now);
    }

    /// Levels at each change of a logged pin, from those when the log began.
    pub fn logged_pins(&self) -> &[LoggedPins] {
        self.pins.log.levels()
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
    pub fn data_controller_writes(&self) -> bool {
        let ports = &self.peripherals.serial.0;
        ports.iter().any(|port| port.stores_data()) || self.peripherals.spi.stores_data()
    }

    /// A reset of the processor happened since the last call: reset the core.
    #[inline]
    pub fn take_reset(&mut self) -> Option<ResetCause> {
        self.reset?;
        self.reset.take()
    }

    /// Reset the chip as its NRST pin does; the caller resets the core.
    pub fn reset(&mut self, cause: ResetCause) {
        self.reset_now(cause, true, true, self.now);
    }

    /// The state in which the boot monitor jumps to a program in RAM: crystal and PLL on,
    /// master clock 48.05 MHz, remap off, watchdog mode register written (disabled), flash with
    /// one wait state. The caller sets the core to the entry point, supervisor mode, interrupts
    /// masked.
    pub fn enter_as_boot_monitor(&mut self) {
        self.peripherals.pmc.as_boot_monitor(self.now);
        self.peripherals.wdt.as_boot_monitor();
        let timing = &self.configuration.timing;
        self.memories.flash.set_mode(0x0034_0100, timing);
        self.ratio = 1;
        self.refresh_all(self.now);
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
        self.memories.load(address, bytes)
    }

    /// Read SRAM or flash without side effects.
    ///
    /// # Errors
    /// The range is not wholly inside SRAM or flash.
    pub fn peek(&self, address: u32, length: usize) -> Result<Vec<u8>, AddressError> {
        self.memories.check_range(address, length)?;
        let mut bytes = vec![0; length];
        self.memories.peek(address, &mut bytes)?;
        Ok(bytes)
    }

    /// Read as many bytes of SRAM or flash as there is room for, without side effects.
    ///
    /// # Errors
    /// The range is not wholly inside SRAM or flash.
    pub fn peek_into(&self, address: u32, bytes: &mut [u8]) -> Result<(), AddressError> {
        self.memories.peek(address, bytes)
    }

    /// Read one aligned word of SRAM or flash without side effects.
    ///
    /// # Errors
    /// The word is not inside SRAM or flash.
    pub fn peek_word(&self, address: u32) -> Result<u32, AddressError> {
        self.memories.peek_word(address)
    }

    /// Transfers that the peripheral data controller has stored in SRAM so far.
    #[must_use]
    pub fn transfers_stored(&self) -> u64 {
        self.memories.transfers_stored
    }

    /// Address of the last access that the memory controller aborted; whether it was misaligned.
    #[must_use]
    pub fn aborted_access(&self) -> (u32, bool) {
        let mc = &self.memories.mc;
        (mc.abort_address(), mc.abort_misaligned())
    }

    /// Let the instructions at these addresses be steps of their own. Blocks that were decoded
    /// before know nothing of it: the caller forgets them.
    pub fn observe_arrivals_at(&mut self, mut addresses: Vec<u32>) {
        addresses.sort_unstable();
        self.observed_arrivals = addresses;
    }

    /// Log the transfers of the peripheral data controller from now on.
    pub fn log_transfers(&mut self) {
        self.memories.transfer_log.get_or_insert_default();
    }

    /// The logged transfers: when, and of which peripheral.
    #[must_use]
    pub fn logged_transfers(&self) -> &[(Cycles, &'static str)] {
        self.memories.transfer_log.as_deref().unwrap_or_default()
    }

    /// Record every processor write to the SRAM word at `address`.
    ///
    /// # Errors
    /// The word is not inside SRAM.
    pub fn watch_word(&mut self, address: u32) -> Result<(), AddressError> {
        self.memories.watch(address)
    }

    /// Some watched word was written since the hits were last taken.
    #[inline(always)]
    pub fn has_watch_hits(&self) -> bool {
        self.memories.sram.has_hits()
    }

    /// Writes to watched words, in the order of time, in place of what `taken` holds.
    pub fn take_watch_hits(&mut self, taken: &mut Vec<WatchHit>) {
        self.memories.sram.take_hits(taken);
    }

    /// Keep the first fault; `written` is the value of a write.
    fn record_fault(&mut self, kind: FaultKind, address: u32, written: Option<u32>) {
        if self.fault.is_none() {
            self.fault = Some(Fault {
                at_cycles: self.now,
                kind,
                address,
                write: written.is_some(),
                value: written.unwrap_or(0),
            });
        }
    }

    /// Let processor cycles pass.
    #[inline(always)]
    fn spend(&mut self, cycles: Cycles) {
        self.now += cycles * self.ratio;
        if self.now >= self.schedule.earliest() {
            self.serve_events();
        }
    }

    /// Serve every event that is due, in order; cycles taken by the data controller delay the
    /// processor.
    #[cold]
    fn serve_events(&mut self) {
        loop {
            if self.schedule.earliest() <= self.now {
                let (kind, at) = self.schedule.first();
                self.serve(kind, at);
            } else if self.memories.stolen != 0 && !self.stopped {
                self.now += std::mem::take(&mut self.memories.stolen) * self.ratio;
            } else {
                self.memories.stolen = 0;
                return;
            }
        }
    }
}
