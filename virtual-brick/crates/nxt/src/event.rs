// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the board reports to whoever watches the run.

use std::fmt;

use at91sam7s::board::{ChipEvent, Cycles};
use plant::MotorPort;

/// Something happened on the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoardEvent {
    /// When, in master clock cycles.
    pub at_cycles: Cycles,
    /// What.
    pub kind: BoardEventKind,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BoardEventKind {
    /// The chip reported this.
    Chip(ChipEvent),
    /// The display shows another picture; 64-bit digest of it.
    DisplayChanged(u64),
    /// Another command for a motor took effect.
    MotorCommand {
        /// The motor.
        motor: MotorPort,
        /// Duty cycle in percent.
        duty: i8,
        /// Winding shorted in the off phase.
        brake: bool,
    },
    /// The co-processor toggles the amplifier because it has heard nothing for 2 s: a click.
    Click,
    /// The supply of the chip is off.
    PowerOff(PowerOffReason),
    /// The program asked for something that the model does not have.
    Fault(BoardFault),
}

/// Why the co-processor switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerOffReason {
    /// The program asked for it.
    Requested,
    /// The handshake string did not come within 298 s.
    NoHandshake,
    /// The rechargeable pack was below 6.5 V at power-on.
    BatteryLow,
    /// The program asked for the boot monitor, which follows a power cycle.
    BootMonitor,
    /// The battery's voltage fell too low for anything to work.
    SupplyLost,
}

/// Something that the board does not model and therefore does not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardFault {
    /// A motor's duty cycle beyond 100 %, taken as 100 %.
    DutyBeyondRange {
        /// The motor.
        motor: MotorPort,
        /// The value in the frame.
        duty: i8,
    },
    /// The display controller does not know this command.
    DisplayCommand {
        /// The byte.
        byte: u8,
    },
    /// The Bluetooth module does not know this message, or the model does not carry it out.
    BluetoothMessage {
        /// Code of the message.
        code: u8,
    },
    /// The display takes frames of 8 bits.
    DisplayFrame {
        /// Length of the frame that came.
        bits: u8,
    },
}

impl fmt::Display for BoardFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DutyBeyondRange { motor, duty } => write!(
                formatter,
                "co-processor: motor {}: duty cycle {duty} %, expected -100 to 100",
                motor.letter()
            ),
            Self::DisplayCommand { byte } => {
                write!(
                    formatter,
                    "display: command 16#{byte:02X}# is not one of the UC1601"
                )
            }
            Self::BluetoothMessage { code } => write!(
                formatter,
                "Bluetooth module: message 16#{code:02X}# is not modelled"
            ),
            Self::DisplayFrame { bits } => {
                write!(formatter, "display: SPI frame of {bits} bits, expected 8")
            }
        }
    }
}

/// Events in the order in which they happened.
#[derive(Clone, Debug, Default)]
pub struct EventLog {
    events: Vec<BoardEvent>,
    /// One of them may end the run.
    ends: bool,
    /// As many end no run because they are too many.
    room: usize,
}

impl EventLog {
    pub fn add(&mut self, at_cycles: Cycles, kind: BoardEventKind) {
        self.ends |= matches!(kind, BoardEventKind::Fault(_) | BoardEventKind::PowerOff(_));
        self.events.push(BoardEvent { at_cycles, kind });
        self.ends |= self.events.len() > self.room;
    }

    pub fn set_room(&mut self, events: usize) {
        self.room = events;
    }

    pub fn fault(&mut self, at_cycles: Cycles, fault: BoardFault) {
        self.add(at_cycles, BoardEventKind::Fault(fault));
    }

    #[inline]
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
    }

    pub fn ends(&self) -> bool {
        self.ends
    }

    /// Hands the events over; `taken` is emptied first, its room is used again.
    #[inline]
    pub fn take(&mut self, taken: &mut Vec<BoardEvent>) {
        taken.clear();
        self.ends = false;
        std::mem::swap(&mut self.events, taken);
    }
}
