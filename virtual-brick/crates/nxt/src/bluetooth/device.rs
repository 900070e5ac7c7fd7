// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Devices: address, name, class; and what passes between two of them through the air.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

/// Address of a device, the company's three bytes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(try_from = "String")]
pub struct BluetoothAddress(pub [u8; 6]);

/// A text that is not an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddressError(String);

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "'{}' is not an address: expected six bytes in hexadecimal, as in 00:16:53:01:02:03",
            self.0
        )
    }
}

impl std::error::Error for AddressError {}

impl FromStr for BluetoothAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let refused = || AddressError(text.to_owned());
        let mut bytes = [0; 6];
        let mut parts = text.split(':');
        for byte in &mut bytes {
            let part = parts.next().filter(|part| part.len() == 2);
            let part = part.ok_or_else(refused)?;
            *byte = u8::from_str_radix(part, 16).map_err(|_| refused())?;
        }
        parts.next().map_or(Ok(Self(bytes)), |_| Err(refused()))
    }
}

impl TryFrom<String> for BluetoothAddress {
    type Error = AddressError;

    fn try_from(text: String) -> Result<Self, AddressError> {
        text.parse()
    }
}

impl fmt::Display for BluetoothAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c, d, e, g] = self.0;
        write!(f, "{a:02X}:{b:02X}:{c:02X}:{d:02X}:{e:02X}:{g:02X}")
    }
}

/// A name or PIN code: at most 16 bytes, the rest zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(try_from = "String")]
pub struct BluetoothText(pub [u8; 16]);

/// A text that is too long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextError(usize);

impl fmt::Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes; a name or PIN code has 1 to 15", self.0)
    }
}

impl std::error::Error for TextError {}

impl FromStr for BluetoothText {
    type Err = TextError;

    fn from_str(text: &str) -> Result<Self, TextError> {
        let mut bytes = [0; 16];
        if !(1..16).contains(&text.len()) {
            return Err(TextError(text.len()));
        }
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Ok(Self(bytes))
    }
}

impl TryFrom<String> for BluetoothText {
    type Error = TextError;

    fn try_from(text: String) -> Result<Self, TextError> {
        text.parse()
    }
}

impl fmt::Display for BluetoothText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap_or(16);
        f.write_str(&String::from_utf8_lossy(&self.0[..end]))
    }
}

/// A device as others see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BluetoothDevice {
    /// Its address.
    pub address: BluetoothAddress,
    /// Its name.
    pub name: BluetoothText,
    /// Its class of device, high byte first.
    pub class: [u8; 4],
}

impl BluetoothDevice {
    /// Bytes in a message: address and a zero, name, class.
    pub(super) fn to_bytes(self) -> Vec<u8> {
        let mut bytes = address_bytes(self.address).to_vec();
        bytes.extend(self.name.0);
        bytes.extend(self.class);
        bytes
    }

    /// From the bytes of a message; nothing when there are too few.
    pub(super) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        Some(Self {
            address: address_from(bytes)?,
            name: BluetoothText(bytes.get(7..23)?.try_into().ok()?),
            class: bytes.get(23..27)?.try_into().ok()?,
        })
    }
}

/// The seven bytes of an address in a message.
pub(super) const fn address_bytes(address: BluetoothAddress) -> [u8; 7] {
    let [a, b, c, d, e, f] = address.0;
    [a, b, c, d, e, f, 0]
}

/// The address at the head of a message's arguments.
pub(super) fn address_from(bytes: &[u8]) -> Option<BluetoothAddress> {
    let bytes = bytes.get(..6)?;
    bytes.try_into().ok().map(BluetoothAddress)
}

/// What one device sends another through the air.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AirSignal {
    /// It is in range and answers inquiries.
    InRange(BluetoothDevice),
    /// It does not answer inquiries any more.
    OutOfRange,
    /// It wants a connection. The PIN code comes with it unless both know each other's key.
    Page {
        /// Who it is.
        device: BluetoothDevice,
        /// The PIN code entered on its side.
        pin: Option<BluetoothText>,
    },
    /// The connection stands.
    Accept,
    /// There will be no connection.
    Refuse,
    /// Bytes of the connection's stream.
    Data(Vec<u8>),
    /// The connection has ended.
    Close,
}

/// A signal with its other end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AirMessage {
    /// When it left the sender or reached the receiver.
    pub at_cycles: u64,
    /// The other device: receiver of what was sent, sender of what came.
    pub peer: BluetoothAddress,
    /// What.
    pub signal: AirSignal,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_reads_as_it_is_written() {
        let address: BluetoothAddress = "00:16:53:0a:0B:0c".parse().unwrap_or_default();
        assert_eq!(address.0, [0, 0x16, 0x53, 10, 11, 12]);
        assert_eq!(address.to_string(), "00:16:53:0A:0B:0C");
        for wrong in [
            "",
            "00:16:53:01:02",
            "00:16:53:01:02:03:04",
            "0:16:53:01:02:03",
            "gg:16:53:01:02:03",
        ] {
            assert!(wrong.parse::<BluetoothAddress>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_name_has_one_to_fifteen_bytes() {
        let name = "fifteen letters".parse::<BluetoothText>();
        assert_eq!(
            name.map(|n| n.to_string()),
            Ok("fifteen letters".to_owned())
        );
        assert!("sixteen letters!".parse::<BluetoothText>().is_err());
        assert!("".parse::<BluetoothText>().is_err());
    }
}
