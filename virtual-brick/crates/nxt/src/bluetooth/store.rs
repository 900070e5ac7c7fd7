// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the module keeps without supply: name, settings, known devices and their keys.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::code;
use super::device::{BluetoothAddress, BluetoothDevice, BluetoothText};

/// Devices that the list holds.
pub const LIST_LENGTH: usize = 30;
/// Class of a computer toy: major class 8, toy; the class that the real module announces.
const TOY_CLASS: [u8; 4] = [0, 0, 0x08, 0x04];
const DEFAULT_ADDRESS: BluetoothAddress = BluetoothAddress([0x00, 0x16, 0x53, 0x01, 0x02, 0x03]);

/// A device that the brick knows from before the run; each has the other's key.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownDevice {
    /// Its address.
    pub address: BluetoothAddress,
    /// Its name.
    pub name: BluetoothText,
}

/// The module as it stands in a configuration.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BluetoothConfiguration {
    /// Its address.
    pub address: BluetoothAddress,
    /// The brick's name.
    pub name: BluetoothText,
    /// Others find it.
    pub discoverable: bool,
    /// Devices it knows, at most 30; more are not taken.
    pub known: Vec<KnownDevice>,
}

impl Default for BluetoothConfiguration {
    fn default() -> Self {
        Self {
            address: DEFAULT_ADDRESS,
            name: factory_name(),
            discoverable: true,
            known: Vec::new(),
        }
    }
}

const fn factory_name() -> BluetoothText {
    let mut name = [0; 16];
    (name[0], name[1], name[2]) = (b'N', b'X', b'T');
    BluetoothText(name)
}

/// The module's memory.
#[derive(Clone, Debug)]
pub struct Store {
    address: BluetoothAddress,
    name: BluetoothText,
    pub discoverable: bool,
    /// On or off, and the time-out that firmware keeps here.
    pub status: [u8; 2],
    pub operating_mode: u8,
    devices: Vec<BluetoothDevice>,
    keys: BTreeSet<BluetoothAddress>,
}

impl Store {
    pub fn new(configuration: &BluetoothConfiguration) -> Self {
        let device = |known: &KnownDevice| BluetoothDevice {
            address: known.address,
            name: known.name,
            class: TOY_CLASS,
        };
        let known = configuration.known.iter().take(LIST_LENGTH);
        let devices: Vec<_> = known.map(device).collect();
        Self {
            address: configuration.address,
            name: configuration.name,
            discoverable: configuration.discoverable,
            status: [0; 2],
            operating_mode: 0,
            keys: devices.iter().map(|device| device.address).collect(),
            devices,
        }
    }

    /// The state in which it leaves the factory.
    pub fn reset_to_factory(&mut self) {
        let address = self.address;
        *self = Self::new(&BluetoothConfiguration {
            address,
            ..BluetoothConfiguration::default()
        });
    }

    /// The module as others see it.
    pub const fn device(&self) -> BluetoothDevice {
        BluetoothDevice {
            address: self.address,
            name: self.name,
            class: TOY_CLASS,
        }
    }

    pub fn set_name(&mut self, name: BluetoothText) {
        self.name = name;
    }

    pub fn devices(&self) -> &[BluetoothDevice] {
        &self.devices
    }

    pub fn is_paired(&self, address: BluetoothAddress) -> bool {
        self.keys.contains(&address)
    }

    pub fn pair(&mut self, address: BluetoothAddress) {
        self.keys.insert(address);
    }

    /// Adds a device or writes it anew; the result as in the message.
    pub fn add(&mut self, device: BluetoothDevice) -> u8 {
        let known = self.devices.iter_mut();
        if let Some(known) = known.into_iter().find(|d| d.address == device.address) {
            *known = device;
        } else if self.devices.len() < LIST_LENGTH {
            self.devices.push(device);
        } else {
            return code::LIST_FULL;
        }
        code::LIST_SUCCESS
    }

    /// Forgets a device and its key; the result as in the message.
    pub fn remove(&mut self, address: BluetoothAddress) -> u8 {
        let before = self.devices.len();
        self.devices.retain(|device| device.address != address);
        self.keys.remove(&address);
        if self.devices.len() < before {
            code::LIST_REMOVED
        } else {
            code::LIST_UNKNOWN_ADDRESS
        }
    }
}
