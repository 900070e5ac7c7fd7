// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Codes of the messages between the chip and the module.

pub const BEGIN_INQUIRY: u8 = 0x00;
pub const CANCEL_INQUIRY: u8 = 0x01;
pub const CONNECT: u8 = 0x02;
pub const OPEN_PORT: u8 = 0x03;
pub const LOOK_UP_NAME: u8 = 0x04;
pub const ADD_DEVICE: u8 = 0x05;
pub const REMOVE_DEVICE: u8 = 0x06;
pub const DUMP_LIST: u8 = 0x07;
pub const CLOSE_CONNECTION: u8 = 0x08;
pub const ACCEPT_CONNECTION: u8 = 0x09;
pub const PIN_CODE: u8 = 0x0A;
pub const OPEN_STREAM: u8 = 0x0B;
pub const START_HEART: u8 = 0x0C;
pub const HEARTBEAT: u8 = 0x0D;
pub const INQUIRY_RUNNING: u8 = 0x0E;
pub const INQUIRY_RESULT: u8 = 0x0F;
pub const INQUIRY_STOPPED: u8 = 0x10;
pub const NAME_RESULT: u8 = 0x11;
pub const NAME_FAILURE: u8 = 0x12;
pub const CONNECT_RESULT: u8 = 0x13;
pub const RESET_INDICATION: u8 = 0x14;
pub const REQUEST_PIN_CODE: u8 = 0x15;
pub const REQUEST_CONNECTION: u8 = 0x16;
pub const LIST_RESULT: u8 = 0x17;
pub const LIST_ITEM: u8 = 0x18;
pub const LIST_DUMP_STOPPED: u8 = 0x19;
pub const CLOSE_CONNECTION_RESULT: u8 = 0x1A;
pub const PORT_OPEN_RESULT: u8 = 0x1B;
pub const SET_DISCOVERABLE: u8 = 0x1C;
pub const CLOSE_PORT: u8 = 0x1D;
pub const CLOSE_PORT_RESULT: u8 = 0x1E;
pub const PIN_CODE_ACKNOWLEDGED: u8 = 0x1F;
pub const DISCOVERABLE_ACKNOWLEDGED: u8 = 0x20;
pub const SET_NAME: u8 = 0x21;
pub const NAME_ACKNOWLEDGED: u8 = 0x22;
pub const GET_LINK_QUALITY: u8 = 0x23;
pub const LINK_QUALITY: u8 = 0x24;
pub const FACTORY_SETTINGS: u8 = 0x25;
pub const FACTORY_ACKNOWLEDGED: u8 = 0x26;
pub const GET_ADDRESS: u8 = 0x27;
pub const ADDRESS: u8 = 0x28;
pub const GET_NAME: u8 = 0x29;
pub const GET_DISCOVERABLE: u8 = 0x2A;
pub const GET_PORT_OPEN: u8 = 0x2B;
pub const NAME: u8 = 0x2C;
pub const DISCOVERABLE: u8 = 0x2D;
pub const PORT_OPEN: u8 = 0x2E;
pub const GET_VERSION: u8 = 0x2F;
pub const VERSION: u8 = 0x30;
pub const STATUS: u8 = 0x31;
pub const STATUS_SET: u8 = 0x32;
pub const GET_STATUS: u8 = 0x33;
pub const SET_STATUS: u8 = 0x34;
pub const GET_OPERATING_MODE: u8 = 0x35;
pub const SET_OPERATING_MODE: u8 = 0x36;
pub const OPERATING_MODE: u8 = 0x37;
pub const GET_CONNECTION_STATUS: u8 = 0x38;
pub const CONNECTION_STATUS: u8 = 0x39;

/// Results of operations on the list of devices and on the status bytes.
pub const LIST_SUCCESS: u8 = 0x50;
pub const LIST_FULL: u8 = 0x52;
pub const LIST_REMOVED: u8 = 0x53;
pub const LIST_UNKNOWN_ADDRESS: u8 = 0x54;
