// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the module does with each message of the chip.

use at91sam7s::board::Cycles;

use super::code;
use super::device::{address_bytes, address_from, BluetoothDevice, BluetoothText};
use super::frame::Message;
use super::links::{HANDLES, PORT_HANDLE};
use super::{
    not_modelled, Action, Bluetooth, Inquiry, ANSWER, HEARTBEAT_PERIOD, INQUIRY_RESULT_PERIOD,
    INQUIRY_UNIT, NAME_LOOK_UP, PAGE_TIME_OUT,
};
use crate::event::BoardFault;

/// Version of LEGO's firmware for the module: major, minor.
const VERSION: [u8; 2] = [1, 1];
const BEST_QUALITY: u8 = 0xFF;
const YES: u8 = 1;

impl Bluetooth {
    /// LineMode a message out. One with too few arguments has no effect.
    pub(super) fn command(&mut self, now: Cycles, message: &Message) -> Result<(), BoardFault> {
        let arguments = message.arguments.as_slice();
        let first = arguments.first().copied();
        match message.code {
            code::BEGIN_INQUIRY => self.begin_inquiry(now, arguments),
            code::CANCEL_INQUIRY => self.end_inquiry(now),
            code::CONNECT
            | code::LOOK_UP_NAME
            | code::ADD_DEVICE
            | code::REMOVE_DEVICE
            | code::PIN_CODE => self.device_command(now, message.code, arguments),
            code::OPEN_PORT => {
                self.port_open = true;
                self.answer(now, code::PORT_OPEN_RESULT, &[YES, PORT_HANDLE]);
            }
            code::CLOSE_PORT => {
                self.port_open = false;
                self.answer(now, code::CLOSE_PORT_RESULT, &[YES, PORT_HANDLE]);
            }
            code::DUMP_LIST => self.dump_list(now),
            code::START_HEART => self.start_heart(now),
            code::CLOSE_CONNECTION | code::OPEN_STREAM | code::ACCEPT_CONNECTION => {
                if let Some(first) = first {
                    self.connection_command(now, message.code, first);
                }
            }
            code::GET_LINK_QUALITY => {
                let open = first.is_some_and(|handle| self.links.is_open(handle));
                let quality = if open { BEST_QUALITY } else { 0 };
                self.answer(now, code::LINK_QUALITY, &[quality]);
            }
            code::GET_CONNECTION_STATUS => {
                let mut status = [0; HANDLES];
                for (handle, status) in (0..).zip(&mut status) {
                    *status = u8::from(self.links.is_open(handle));
                }
                self.answer(now, code::CONNECTION_STATUS, &status);
            }
            _ => return self.store_command(now, message),
        }
        Ok(())
    }

    /// Messages about what the module keeps.
    fn store_command(&mut self, now: Cycles, message: &Message) -> Result<(), BoardFault> {
        let arguments = message.arguments.as_slice();
        match message.code {
            code::GET_ADDRESS => {
                let address = address_bytes(self.device().address);
                self.answer(now, code::ADDRESS, &address);
            }
            code::GET_NAME => self.answer(now, code::NAME, &self.device().name.0),
            code::SET_NAME => {
                if let Ok(name) = arguments.try_into() {
                    self.store.set_name(BluetoothText(name));
                    self.answer(now, code::NAME_ACKNOWLEDGED, &[YES]);
                }
            }
            code::GET_DISCOVERABLE => {
                let discoverable = u8::from(self.store.discoverable);
                self.answer(now, code::DISCOVERABLE, &[discoverable]);
            }
            code::SET_DISCOVERABLE => {
                self.store.discoverable = arguments.first().is_some_and(|wish| *wish != 0);
                self.answer(now, code::DISCOVERABLE_ACKNOWLEDGED, &[YES]);
            }
            code::GET_PORT_OPEN => self.answer(now, code::PORT_OPEN, &[u8::from(self.port_open)]),
            code::GET_VERSION => self.answer(now, code::VERSION, &VERSION),
            code::GET_STATUS => self.answer(now, code::STATUS, &self.store.status.clone()),
            code::SET_STATUS => {
                if let Ok(status) = arguments.try_into() {
                    self.store.status = status;
                    self.answer(now, code::STATUS_SET, &[code::LIST_SUCCESS]);
                }
            }
            code::GET_OPERATING_MODE => {
                self.answer(now, code::OPERATING_MODE, &[self.store.operating_mode]);
            }
            code::SET_OPERATING_MODE => {
                let mode = arguments.first().copied();
                self.store.operating_mode = mode.unwrap_or(self.store.operating_mode);
                self.answer(now, code::OPERATING_MODE, &[self.store.operating_mode]);
            }
            code::FACTORY_SETTINGS => {
                self.store.reset_to_factory();
                self.answer(now, code::FACTORY_ACKNOWLEDGED, &[]);
            }
            other => return Err(not_modelled(other)),
        }
        Ok(())
    }

    /// Messages whose first argument is an address.
    fn device_command(&mut self, now: Cycles, code: u8, arguments: &[u8]) {
        let Some(address) = address_from(arguments) else {
            return;
        };
        match code {
            code::CONNECT => self.connect(now, address),
            code::LOOK_UP_NAME => self.look_up(now, address),
            code::ADD_DEVICE => {
                if let Some(device) = BluetoothDevice::from_bytes(arguments) {
                    let result = self.store.add(device);
                    self.answer(now, code::LIST_RESULT, &[result]);
                }
            }
            code::REMOVE_DEVICE => {
                let result = self.store.remove(address);
                self.answer(now, code::LIST_RESULT, &[result]);
            }
            _ => {
                let pin = arguments.get(7..23).and_then(|pin| pin.try_into().ok());
                if let Some(pin) = pin {
                    self.pin_code(now, address, BluetoothText(pin));
                }
            }
        }
    }

    fn connection_command(&mut self, now: Cycles, code: u8, first: u8) {
        match code {
            code::CLOSE_CONNECTION => self.close(now, first),
            code::OPEN_STREAM => self.open_stream(now, first),
            _ => self.accept(now, first != 0),
        }
    }

    fn look_up(&mut self, now: Cycles, address: super::BluetoothAddress) {
        let (after, message) = match self.neighbour(address) {
            Some(device) => {
                let result = Message::new(code::NAME_RESULT, &device.to_bytes());
                (NAME_LOOK_UP, result)
            }
            None => {
                let bytes = address_bytes(address);
                (PAGE_TIME_OUT, Message::new(code::NAME_FAILURE, &bytes))
            }
        };
        self.plan(now + after, Action::Send(message));
    }

    fn dump_list(&mut self, now: Cycles) {
        for device in self.store.devices().to_vec() {
            self.answer(now, code::LIST_ITEM, &device.to_bytes());
        }
        self.answer(now, code::LIST_DUMP_STOPPED, &[]);
    }

    fn start_heart(&mut self, now: Cycles) {
        if !self.heart {
            self.heart = true;
            self.plan(now + HEARTBEAT_PERIOD, Action::Heartbeat);
        }
    }

    /// Arguments: most results, duration in units of 1.28 s (high byte first), class wanted.
    fn begin_inquiry(&mut self, now: Cycles, arguments: &[u8]) {
        let [most, high, low, ..] = *arguments else {
            return;
        };
        let duration = Cycles::from(u16::from_be_bytes([high, low])) * INQUIRY_UNIT;
        let ends = now + ANSWER + duration;
        self.answer(now, code::INQUIRY_RUNNING, &[YES]);
        self.inquiry = Some(Inquiry {
            remaining: most,
            next: 0,
            ends,
        });
        if most > 0 && ends > now + INQUIRY_RESULT_PERIOD {
            self.plan(now + INQUIRY_RESULT_PERIOD, Action::InquiryResult);
        }
        self.plan(ends, Action::InquiryEnd);
    }
}
