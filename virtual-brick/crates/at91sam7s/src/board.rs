// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The border between the chip and the board: pins, the two-wire bus, the SPI lines, analogue
//! inputs and time. The chip knows nothing of what is connected.

/// Master clock cycles since power-on.
pub type Cycles = u64;

/// Levels that the board puts on the 32 pins of port A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PinLevels {
    /// Bit n set: the board drives pin n (push-pull or a pull stronger than the chip's).
    pub driven: u32,
    /// Level of each driven pin.
    pub level: u32,
}

/// What the chip drives on the 32 pins of port A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PinOutputs {
    /// Bit n set: the chip drives pin n now (open-drain pins only while they drive low).
    pub driven: u32,
    /// Level of each driven pin.
    pub level: u32,
    /// Bit n set: the chip's pull-up on pin n is on.
    pub pull_up: u32,
}

/// Answer of the addressed two-wire slave to one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwiReply {
    /// The slave pulled SDA low in the ninth bit.
    pub acknowledged: bool,
    /// How long the slave holds SCL low after this byte.
    pub stretch_cycles: Cycles,
}

/// What the chip reports to whoever watches the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChipEvent {
    /// The core took the interrupt of this AIC source (vector read or, in protect mode, written).
    InterruptEntered {
        /// AIC source number, 0 to 31.
        source: u8,
    },
    /// End of interrupt was written to the AIC.
    InterruptLeft,
    /// The periodic interval timer was enabled: its counter is 0 at this cycle.
    IntervalTimerStarted,
    /// The processor clock was stopped until the next interrupt.
    ProcessorStopped,
    /// The processor clock runs again.
    ProcessorResumed,
}

/// What is soldered around the chip. Called at exact cycle times, in the order of time.
pub trait Board {
    /// The chip's pin outputs changed.
    fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs);
    /// Levels on the pins now; called after `advance` and after `outputs_changed`.
    fn pin_levels(&self) -> PinLevels;
    /// START (or repeated START) and address byte ended.
    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply;
    /// A byte written to the slave ended.
    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply;
    /// The slave gives a byte: value and stretch before it.
    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles);
    /// STOP on the bus.
    fn twi_stop(&mut self, now: Cycles);
    /// One SPI frame of `bits` bits with chip select `select` (0 to 3; 4 when none) was shifted.
    fn spi_frame(&mut self, now: Cycles, select: u8, frame: u16, bits: u8) -> u16;
    /// Voltage on analogue input `channel` (0 to 7), in counts of the 10-bit converter.
    fn analogue_input(&mut self, now: Cycles, channel: u8) -> u16;
    /// When the board itself wants to be advanced next (encoder edge, co-processor tick).
    fn next_event(&self) -> Cycles;
    /// Bring the board to `now`; its pins may change. `now` never passes `next_event` unserved.
    fn advance(&mut self, now: Cycles);
    /// The chip's supply is on; false ends the run as a power-off.
    fn powered(&self) -> bool;
    /// Something an observer may want to record.
    fn observe(&mut self, now: Cycles, event: ChipEvent);
}
