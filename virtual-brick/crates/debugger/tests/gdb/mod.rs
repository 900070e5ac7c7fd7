// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The client's side of the protocol for tests: packets in, replies out, no socket.
#![allow(clippy::unwrap_used)]

use std::collections::VecDeque;

use debugger::{session, DebugTarget, SessionEnd};
use gdbstub::conn::{Connection, ConnectionExt};

/// Bytes that a client sends, and what it got.
pub struct Client<'a> {
    pub sent: VecDeque<u8>,
    pub got: &'a mut Vec<u8>,
    /// The client's bytes interrupt a run.
    pub impatient: bool,
}

impl Connection for Client<'_> {
    type Error = String;

    fn write(&mut self, byte: u8) -> Result<(), String> {
        self.got.push(byte);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), String> {
        Ok(())
    }
}

impl ConnectionExt for Client<'_> {
    fn read(&mut self) -> Result<u8, String> {
        self.sent.pop_front().ok_or_else(|| "the end".to_owned())
    }

    fn peek(&mut self) -> Result<Option<u8>, String> {
        match self.sent.front() {
            Some(byte) if self.impatient => Ok(Some(*byte)),
            None if self.impatient => Err("the end".to_owned()),
            _ => Ok(None),
        }
    }
}

pub fn packet(body: &[u8]) -> Vec<u8> {
    let sum = body.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    let mut bytes = vec![b'$'];
    bytes.extend(body);
    bytes.extend(format!("#{sum:02x}").bytes());
    bytes
}

/// Send packets in one session; the reply to each.
pub fn talk(target: &mut DebugTarget, bodies: &[&str]) -> Vec<String> {
    let mut got = Vec::new();
    let client = Client {
        sent: bodies
            .iter()
            .flat_map(|body| packet(body.as_bytes()))
            .collect(),
        got: &mut got,
        impatient: false,
    };
    let end = session(target, client);
    assert!(
        matches!(&end, SessionEnd::Broken(why) if why.contains("the end")),
        "{end:?}"
    );
    let text = String::from_utf8(got).unwrap();
    text.split('$')
        .skip(1)
        .map(|reply| expand(reply.split('#').next().unwrap()))
        .collect()
}

/// Undo the protocol's run-length encoding.
pub fn expand(reply: &str) -> String {
    let mut text = String::new();
    let mut letters = reply.chars();
    while let Some(letter) = letters.next() {
        if letter == '*' {
            let last = text.chars().last().unwrap();
            let count = u32::from(letters.next().unwrap()) - 29;
            text.extend((0..count).map(|_| last));
        } else {
            text.push(letter);
        }
    }
    text
}
