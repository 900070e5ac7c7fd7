// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Transports of a run, Bluetooth and USB: each message and transfer has its instant.

use std::fmt;

use nxt::{AirMessage, BluetoothDevice, UsbCompletion, UsbRequest, UsbTransfer};

use crate::brick::VirtualBrick;

/// A message or transfer that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TransportError {
    /// Its instant has passed.
    InPast {
        /// Instant wanted.
        at_cycles: u64,
        /// The present.
        now_cycles: u64,
    },
    /// Too much of the kind waits already, or it is too long.
    TooMuch {
        /// Where it would wait.
        place: &'static str,
    },
    /// The host's endpoints have the numbers 1 to 15.
    Endpoint(u8),
}

impl fmt::Display for TransportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InPast {
                at_cycles,
                now_cycles,
            } => write!(
                f,
                "cycle {at_cycles} has passed, it is cycle {now_cycles}; choose that or a later one"
            ),
            Self::TooMuch { place } => {
                write!(f, "too much waits for the {place}; run the brick first")
            }
            Self::Endpoint(number) => {
                write!(f, "USB endpoint {number}: expected 1 to 15")
            }
        }
    }
}

impl std::error::Error for TransportError {}

impl VirtualBrick {
    pub(crate) fn check_not_past(&self, at_cycles: u64) -> Result<(), TransportError> {
        let now_cycles = self.cycles();
        if at_cycles < now_cycles {
            return Err(TransportError::InPast {
                at_cycles,
                now_cycles,
            });
        }
        Ok(())
    }

    /// The brick's Bluetooth module as other devices see it.
    #[must_use]
    pub fn bluetooth_device(&self) -> BluetoothDevice {
        self.chip.board().bluetooth().device()
    }

    /// The module answers inquiries.
    #[must_use]
    pub fn bluetooth_discoverable(&self) -> bool {
        self.chip.board().bluetooth().discoverable()
    }

    /// Bytes from the air that the program has not read yet.
    #[must_use]
    pub fn bluetooth_waiting(&self) -> usize {
        self.chip.board().bluetooth().waiting_bytes()
    }

    /// Let a message of another Bluetooth device reach the brick.
    ///
    /// # Errors
    /// Its instant has passed, or too many wait.
    pub fn bluetooth_send(&mut self, message: AirMessage) -> Result<(), TransportError> {
        self.check_not_past(message.at_cycles)?;
        let taken = self.chip.board_mut().bluetooth_mut().schedule(message);
        let refused = TransportError::TooMuch {
            place: "Bluetooth module",
        };
        taken.then_some(()).ok_or(refused)
    }

    /// What the brick sent to other Bluetooth devices since the last call.
    pub fn bluetooth_sent(&mut self) -> Vec<AirMessage> {
        self.chip.board_mut().bluetooth_mut().take_sent()
    }

    /// A USB host sees the brick: cable plugged in, pull-up on.
    #[must_use]
    pub fn usb_attached(&self) -> bool {
        self.chip.board().usb().attached()
    }

    /// Let the USB host begin a transfer. The cable is the input `usb.plugged`.
    ///
    /// # Errors
    /// Its instant has passed, its endpoint does not exist, it is too long, or too many wait.
    pub fn usb_transfer(&mut self, transfer: UsbTransfer) -> Result<(), TransportError> {
        self.check_not_past(transfer.at_cycles)?;
        if let UsbRequest::Out { endpoint, .. } | UsbRequest::In { endpoint, .. } = transfer.request
        {
            if !(1..=15).contains(&endpoint) {
                return Err(TransportError::Endpoint(endpoint));
            }
        }
        let taken = self.chip.board_mut().usb_mut().schedule(transfer);
        let refused = TransportError::TooMuch { place: "USB host" };
        taken.then_some(()).ok_or(refused)
    }

    /// Transfers that ended since the last call.
    pub fn usb_completed(&mut self) -> Vec<UsbCompletion> {
        self.chip.board_mut().usb_mut().take_completed()
    }
}
