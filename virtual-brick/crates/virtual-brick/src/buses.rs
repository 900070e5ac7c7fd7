// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The RS485 line of port 4, a record of the chip's buses, and scripts in place of devices.

use nxt::{BusEvent, ModuleTurn, TwiTurn};

use crate::brick::VirtualBrick;
use crate::transports::TransportError;

impl VirtualBrick {
    /// Let bytes of another device reach the brick on the RS485 line, the first of which begins at
    /// an instant or after those before; a bit lasts `bit_cycles`.
    ///
    /// # Errors
    /// The instant has passed, or too many wait.
    pub fn rs485_send(
        &mut self,
        at_cycles: u64,
        bytes: &[u8],
        bit_cycles: u64,
    ) -> Result<(), TransportError> {
        self.check_not_past(at_cycles)?;
        let line = self.chip.board_mut().rs485_mut();
        let taken = line.schedule(at_cycles, bytes, bit_cycles);
        let refused = TransportError::TooMuch {
            place: "RS485 line",
        };
        taken.then_some(()).ok_or(refused)
    }

    /// What the brick sent on the RS485 line since the last call: end of each byte, and the byte.
    pub fn rs485_sent(&mut self) -> Vec<(u64, u8)> {
        self.chip.board_mut().rs485_mut().take_sent()
    }

    /// Record from now on what passes on the chip's buses; the run is the same.
    pub fn record_buses(&mut self) {
        self.chip.board_mut().record_buses();
    }

    /// What passed on the buses since the last call, each with its cycle.
    pub fn take_bus_log(&mut self) -> Vec<(u64, BusEvent)> {
        self.chip.board_mut().take_bus_log()
    }

    /// Let a script answer on the two-wire bus in place of the co-processor.
    pub fn script_twi(&mut self, turns: Vec<TwiTurn>) {
        self.chip.board_mut().script_twi(turns);
    }

    /// Give the chip's converter these counts on a channel, the last one for good.
    pub fn script_converter(&mut self, channel: u8, counts: &[u16]) {
        self.chip.board_mut().script_converter(channel, counts);
    }

    /// Let a script speak in place of the Bluetooth module.
    pub fn script_module(&mut self, turns: Vec<ModuleTurn>) {
        let now = self.cycles();
        self.chip.board_mut().script_module(now, turns);
    }
}
