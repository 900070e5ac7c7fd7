// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The NXT brick around its processor: co-processor, display, buttons, ports, battery, encoders.
//!
//! [`NxtBoard`] is what the chip sees; each device is one module. Sources: LEGO MINDSTORMS NXT
//! Hardware Developer Kit with its schematics, LEGO's published sources of both processors,
//! UC1601 data sheet. Numbers that no source gives are named as chosen where they stand.
//!
//! What is not modelled never seems to work: a pin without a device stays undriven, an address
//! without a slave is not acknowledged, and a request that real hardware would serve is reported
//! as a [`BoardFault`].

mod battery;
mod bluetooth;
mod board;
mod boot_monitor;
mod bus_log;
mod buttons;
mod configuration;
mod coprocessor;
mod display;
mod encoder;
mod event;
mod inputs;
mod mounted_sensors;
mod physics;
mod ports;
mod rs485;
mod scripts;
mod sensors;
mod signals;
mod sound;
mod time;
mod usb;

pub use battery::{BatteryConfiguration, BatteryKind};
pub use bluetooth::{
    AirMessage, AirSignal, Bluetooth, BluetoothAddress, BluetoothConfiguration, BluetoothDevice,
    BluetoothText, ChipLines, KnownDevice,
};
pub use board::NxtBoard;
pub use boot_monitor::BootMonitor;
pub use bus_log::BusEvent;
pub use buttons::Button;
pub use configuration::{BoardConfiguration, SensorPorts};
pub use coprocessor::{CoprocessorTiming, MotorCommand, SensorSupply};
pub use display::{Display, Picture, COLUMNS, ROWS};
pub use event::{BoardEvent, BoardEventKind, BoardFault, PowerOffReason};
pub use inputs::{InputDescription, InputError};
pub use rs485::Rs485Line;
pub use scripts::{ModuleTurn, TwiTurn};
pub use sensors::{Sensor, SensorInput};
pub use sound::SAMPLE_CYCLES as SOUND_SAMPLE_CYCLES;
pub use usb::{UsbCompletion, UsbError, UsbHost, UsbRequest, UsbTransfer};
