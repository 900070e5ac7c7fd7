// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bluetooth, USB and device scripts, for Python.

use nxt::{
    AirMessage, AirSignal, BluetoothAddress, BluetoothDevice, BluetoothText, ModuleTurn, TwiTurn,
    UsbCompletion, UsbError, UsbRequest, UsbTransfer,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{raise, InputError};

/// Class of a computer; the same for every device made in Python.
const COMPUTER: [u8; 4] = [0, 0, 0x01, 0x04];
/// A bit of the RS485 line at 924 kbit/s, which is what drivers make of 921,600.
pub(crate) const RS485_BIT_CYCLES: u64 = 52;

/// A scripted slave's turn: bytes that it acknowledges, bytes that it gives, stretch in cycles.
pub(crate) fn twi_turn((acknowledged, data, stretch_cycles): (usize, Vec<u8>, u64)) -> TwiTurn {
    TwiTurn {
        acknowledged,
        data,
        stretch_cycles,
    }
}

/// A scripted module's turn: bytes heard before it, delay in cycles, bytes that it sends.
pub(crate) fn module_turn((after_bytes, delay_cycles, bytes): (usize, u64, Vec<u8>)) -> ModuleTurn {
    ModuleTurn {
        after_bytes,
        delay_cycles,
        bytes,
    }
}

/// A message of the air for Python: cycle, peer, kind, bytes, name, PIN code.
pub(crate) type Message<'py> = (
    u64,
    String,
    &'static str,
    Bound<'py, PyBytes>,
    String,
    Option<String>,
);
/// A completed transfer: cycle, number, bytes, error.
pub(crate) type Completion<'py> = (u64, u64, Option<Bound<'py, PyBytes>>, Option<&'static str>);

/// A signal from Python's words.
pub(crate) fn message_from_python(
    at_cycles: u64,
    peer: &str,
    kind: &str,
    data: &[u8],
    name: &str,
    pin: Option<&str>,
) -> PyResult<AirMessage> {
    let peer: BluetoothAddress = peer.parse().map_err(raise::<InputError>)?;
    let text = |text: &str| text.parse::<BluetoothText>().map_err(raise::<InputError>);
    let device = || {
        Ok::<_, PyErr>(BluetoothDevice {
            address: peer,
            name: text(name)?,
            class: COMPUTER,
        })
    };
    let signal = match kind {
        "in_range" => AirSignal::InRange(device()?),
        "out_of_range" => AirSignal::OutOfRange,
        "page" => AirSignal::Page {
            device: device()?,
            pin: pin.map(text).transpose()?,
        },
        "accept" => AirSignal::Accept,
        "refuse" => AirSignal::Refuse,
        "data" => AirSignal::Data(data.to_vec()),
        "close" => AirSignal::Close,
        other => {
            return Err(raise::<InputError>(format!(
                "Bluetooth signal '{other}': expected in_range, out_of_range, page, accept, \
                 refuse, data or close"
            )))
        }
    };
    Ok(AirMessage {
        at_cycles,
        peer,
        signal,
    })
}

/// A message in Python's words.
pub(crate) fn message_to_python(py: Python<'_>, message: AirMessage) -> Message<'_> {
    let (mut bytes, mut name, mut code) = (Vec::new(), String::new(), None);
    let kind = match message.signal {
        AirSignal::InRange(device) => {
            name = device.name.to_string();
            "in_range"
        }
        AirSignal::OutOfRange => "out_of_range",
        AirSignal::Page { device, pin } => {
            name = device.name.to_string();
            code = pin.map(|pin| pin.to_string());
            "page"
        }
        AirSignal::Accept => "accept",
        AirSignal::Refuse => "refuse",
        AirSignal::Data(data) => {
            bytes = data;
            "data"
        }
        AirSignal::Close => "close",
    };
    let peer = message.peer.to_string();
    let data = PyBytes::new(py, &bytes);
    (message.at_cycles, peer, kind, data, name, code)
}

/// A transfer from Python's words.
pub(crate) fn transfer(
    (at_cycles, id, timeout_cycles): (u64, u64, u64),
    kind: &str,
    endpoint: u8,
    data: &[u8],
    length: usize,
) -> PyResult<UsbTransfer> {
    let request = match kind {
        "reset" => UsbRequest::Reset,
        "control" => {
            let refused = || {
                raise::<InputError>(
                    "USB control transfer: expected a request of 8 bytes, then data",
                )
            };
            let (setup, data) = data.split_first_chunk::<8>().ok_or_else(refused)?;
            UsbRequest::Control {
                setup: *setup,
                data: data.to_vec(),
            }
        }
        "out" => UsbRequest::Out {
            endpoint,
            data: data.to_vec(),
        },
        "in" => UsbRequest::In { endpoint, length },
        other => {
            return Err(raise::<InputError>(format!(
                "USB transfer '{other}': expected reset, control, out or in"
            )))
        }
    };
    Ok(UsbTransfer {
        at_cycles,
        id,
        timeout_cycles,
        request,
    })
}

/// A completion in Python's words.
pub(crate) fn completion_to_python(py: Python<'_>, completion: UsbCompletion) -> Completion<'_> {
    let (data, error) = match completion.result {
        Ok(bytes) => (Some(PyBytes::new(py, &bytes)), None),
        Err(UsbError::Stalled) => (None, Some("stalled")),
        Err(UsbError::TimedOut) => (None, Some("timed_out")),
        Err(UsbError::NoAnswer) => (None, Some("no_answer")),
    };
    (completion.at_cycles, completion.id, data, error)
}
