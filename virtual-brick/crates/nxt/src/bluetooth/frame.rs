// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Frames of the command mode: length of what follows, message code, arguments, sum (high byte
//! first). The sum makes the total of a frame zero modulo 65,536. The module counts the length
//! byte in what it sends. Firmware leaves it out, but the module does not judge what it receives:
//! nxtOSEK sends the sum one byte too late (`send_bt_command` of `ecrobot_bluetooth.c`, 2.18), and
//! its Bluetooth works.

/// Bytes of a frame besides the arguments and the length byte.
const OVERHEAD: usize = 3;
/// A frame between its bytes for longer than this many characters is given up (chosen).
pub const LONGEST_ARGUMENTS: usize = u8::MAX as usize - OVERHEAD;

/// A message of the command mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    pub code: u8,
    pub arguments: Vec<u8>,
}

impl Message {
    pub fn new(code: u8, arguments: &[u8]) -> Self {
        let length = arguments.len().min(LONGEST_ARGUMENTS);
        Self {
            code,
            arguments: arguments[..length].to_vec(),
        }
    }

    /// The frame as the module sends it.
    pub fn frame(&self) -> Vec<u8> {
        let mut frame = vec![(self.arguments.len() + OVERHEAD) as u8, self.code];
        frame.extend(&self.arguments);
        let sum = sum(&frame).wrapping_neg();
        frame.extend(sum.to_be_bytes());
        frame
    }
}

fn sum(bytes: &[u8]) -> u16 {
    bytes
        .iter()
        .fold(0, |sum, byte| sum.wrapping_add(u16::from(*byte)))
}

/// Collects the bytes of a frame from the chip.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    bytes: Vec<u8>,
}

impl Receiver {
    /// Takes a byte; the message when it ends a frame. A frame too short to hold a message is
    /// dropped.
    pub fn push(&mut self, byte: u8) -> Option<Message> {
        self.bytes.push(byte);
        let length = usize::from(*self.bytes.first()?);
        if self.bytes.len() <= length {
            return None;
        }
        let frame = std::mem::take(&mut self.bytes);
        let (body, _sum) = frame.get(1..)?.split_at(length.checked_sub(2)?);
        let (code, arguments) = body.split_first()?;
        Some(Message::new(*code, arguments))
    }

    /// Forget what has come of a frame.
    pub fn clear(&mut self) {
        self.bytes.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn received(bytes: &[u8]) -> Vec<Message> {
        let mut receiver = Receiver::default();
        bytes.iter().filter_map(|b| receiver.push(*b)).collect()
    }

    #[test]
    fn a_frame_of_the_module_counts_its_length() {
        assert_eq!(Message::new(0x14, &[]).frame(), [0x03, 0x14, 0xFF, 0xE9]);
    }

    #[test]
    fn a_frame_for_the_module_may_have_any_sum() {
        let bytes = [0x03, 0x27, 0xFF, 0xD9, 0x03, 0x27, 0x00, 0xFF];
        let address = Message::new(0x27, &[]);
        assert_eq!(received(&bytes), [address.clone(), address]);
    }

    #[test]
    fn frames_too_short_for_a_message_are_dropped() {
        let bytes = [0x00, 0x01, 0x55, 0x02, 0x00, 0x00, 0x03, 0x27, 0xFF, 0xD9];
        assert_eq!(received(&bytes), [Message::new(0x27, &[])]);
    }
}
