// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The border between the chip and the board: pins, the two-wire bus, serial lines, the sound
//! line, the USB, analogue inputs and time. The chip knows nothing of what is connected.
//!
//! Serial lines and the USB work in both directions. What the board has for the chip is asked
//! for whenever the board was advanced, so the board puts the end of each character and packet
//! in [`Board::next_event`]. The defaults of these methods are lines with nothing at the far end.

use std::fmt;

pub use crate::clock::Cycles;

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

impl PinOutputs {
    /// Pins of which something differs.
    #[must_use]
    pub const fn differences(self, other: Self) -> u32 {
        self.driven ^ other.driven | self.level ^ other.level | self.pull_up ^ other.pull_up
    }
}

/// Answer of the addressed two-wire slave to one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwiReply {
    /// The slave pulled SDA low in the ninth bit.
    pub acknowledged: bool,
    /// How long the slave holds SCL low after this byte.
    pub stretch_cycles: Cycles,
}

/// A serial line of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SerialPort {
    /// USART0: RXD0 on PA5, TXD0 on PA6, RTS0 on PA7, CTS0 on PA8.
    Usart0,
    /// USART1: RXD1 on PA21, TXD1 on PA22, RTS1 on PA24, CTS1 on PA25.
    Usart1,
    /// Debug unit: DRXD on PA9, DTXD on PA10.
    DebugUnit,
}

impl SerialPort {
    /// The three lines.
    pub const ALL: [Self; 3] = [Self::Usart0, Self::Usart1, Self::DebugUnit];
}

/// One character on a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Character {
    /// Its data bits, 5 to 9, without parity.
    pub data: u16,
    /// Duration of one bit.
    pub bit_cycles: Cycles,
}

/// Bits on the data line of the synchronous serial controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoundBits {
    /// The bits; the first one sent is the highest of the `count` lowest bits.
    pub bits: u32,
    /// How many, 1 to 32.
    pub count: u8,
    /// Duration of one bit.
    pub bit_cycles: Cycles,
}

/// Data of one USB packet, at most 64 bytes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct UsbPacket {
    bytes: [u8; UsbPacket::CAPACITY],
    length: u8,
}

impl UsbPacket {
    /// Largest number of bytes in a packet of a full-speed bulk endpoint.
    pub const CAPACITY: usize = 64;

    /// A packet without data.
    pub const EMPTY: Self = Self {
        bytes: [0; Self::CAPACITY],
        length: 0,
    };

    /// A packet of these bytes; nothing when there are more than 64.
    pub fn new(data: &[u8]) -> Option<Self> {
        let mut packet = Self::EMPTY;
        packet.bytes.get_mut(..data.len())?.copy_from_slice(data);
        packet.length = data.len() as u8;
        Some(packet)
    }

    /// The bytes.
    pub fn data(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }

    /// Adds a byte; false when the packet is full.
    pub(crate) fn push(&mut self, byte: u8) -> bool {
        let Some(slot) = self.bytes.get_mut(usize::from(self.length)) else {
            return false;
        };
        *slot = byte;
        self.length += 1;
        true
    }
}

impl fmt::Debug for UsbPacket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("UsbPacket").field(&self.data()).finish()
    }
}

/// What the USB host puts on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsbSignal {
    /// A bus reset begins: the host pulls both lines low.
    ResetBegins,
    /// A bus reset has ended.
    Reset,
    /// The bus has been idle for 3 ms.
    Suspend,
    /// The host resumed the bus.
    Resume,
    /// Start of the frame of this number (11 bits).
    StartOfFrame {
        /// Frame number.
        number: u16,
    },
    /// A transaction with an endpoint, answered through [`Board::usb_answer`].
    Transaction {
        /// Device address, 0 to 127.
        address: u8,
        /// Endpoint number.
        endpoint: u8,
        /// Its kind and data.
        transaction: UsbTransaction,
    },
}

/// Kind of a USB transaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsbTransaction {
    /// Begin of a control transfer, with its request.
    Setup([u8; 8]),
    /// Data from the host.
    Out(UsbPacket),
    /// The host asks for data and acknowledges what it gets.
    In,
}

/// How the device answered a transaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsbAnswer {
    /// ACK: the data were taken.
    Acknowledged,
    /// NAK: not now.
    NotReady,
    /// STALL: the endpoint refuses.
    Stalled,
    /// Data for the host.
    Data(UsbPacket),
    /// No answer: nobody has this address or endpoint.
    Silent,
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
    /// Pins whose outputs can change something on the board, its pins and next event included.
    fn followed_pins(&self) -> u32 {
        u32::MAX
    }
    /// Levels on the pins now; called after `advance` and after `outputs_changed`.
    fn pin_levels(&self) -> PinLevels;
    /// START (or repeated START) and address byte ended.
    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply;
    /// A byte written to the slave ended.
    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply;
    /// The slave gives a byte: value and stretch before it.
    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles);
    /// The master did not acknowledge the last byte: how long the slave holds SCL before STOP.
    fn twi_end_of_read(&mut self, _now: Cycles) -> Cycles {
        0
    }
    /// STOP on the bus.
    fn twi_stop(&mut self, now: Cycles);
    /// One SPI frame of `bits` bits was shifted through the pins of the SPI while its select line
    /// held the pins in `selected` low.
    fn spi_frame(&mut self, now: Cycles, selected: u32, frame: u16, bits: u8) -> u16;
    /// Voltage on analogue input `channel` (0 to 7), in counts of the 10-bit converter.
    fn analogue_input(&mut self, now: Cycles, channel: u8) -> u16;
    /// When the board itself wants to be advanced next (encoder edge, co-processor tick).
    fn next_event(&self) -> Cycles;
    /// Bring the board to `now`; its pins may change. `now` never passes `next_event` unserved.
    fn advance(&mut self, now: Cycles);
    /// Something may have come on a serial line or the USB since the chip took what there was.
    fn has_received(&mut self, _now: Cycles) -> bool {
        true
    }
    /// The chip's supply is on; false ends the run as a power-off.
    fn powered(&self) -> bool;
    /// The core's supply is below the level of the brown-out detector.
    fn supply_is_low(&self) -> bool {
        false
    }
    /// Something has happened that may end the run.
    fn wants_attention(&self) -> bool {
        false
    }
    /// Something an observer may want to record.
    fn observe(&mut self, now: Cycles, event: ChipEvent);

    /// A command was written to the flash controller: its code, 0 to 15, and the number of the
    /// page or bit.
    fn flash_command(&mut self, _now: Cycles, _command: u8, _page: u16) {}

    /// Bits left the synchronous serial controller on PA17; the last one ended at `now`. Called
    /// only while the pin belongs to the controller.
    fn sound_bits(&mut self, _now: Cycles, _sound: SoundBits) {}

    /// A character left a serial line; its last stop bit ended at `now`. Called only while the
    /// pin belongs to the line.
    fn serial_sent(&mut self, _now: Cycles, _port: SerialPort, _character: Character) {}
    /// A character whose stop bit reached the chip at `now`; nothing when there is none (any
    /// more) at this time.
    fn serial_received(&mut self, _now: Cycles, _port: SerialPort) -> Option<Character> {
        None
    }

    /// What the host put on the USB by `now`; nothing when there is nothing (any more) at this
    /// time. The board knows from PA16, or whatever switches its pull-up, whether a host is
    /// there.
    fn usb_signal(&mut self, _now: Cycles) -> Option<UsbSignal> {
        None
    }
    /// How the device answered the transaction that [`Board::usb_signal`] gave last.
    fn usb_answer(&mut self, _now: Cycles, _answer: UsbAnswer) {}
}
