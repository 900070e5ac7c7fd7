// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Threads of the program, watched from outside through three symbols of the run-time.
//!
//! `ravenbrick_running_thread` holds the address of the running thread's control block (0: idle),
//! `ravenbrick_first_thread` the head of the list of all control blocks, and
//! `ravenbrick_thread_layout` tells where the fields lie in a control block. The program is not
//! changed by being watched: the chip reports each write of the watched words.

mod clock;
mod layout;
mod names;
mod observer;
mod report;
#[cfg(test)]
mod tests;

pub(crate) use layout::Layout;
pub(crate) use observer::{Sink, ThreadObserver};
pub use report::Thread;

/// Memory as the program sees it, read without side effects.
pub(crate) trait Memory {
    /// Fill `bytes` from `address`; false when some of it is no memory.
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool;

    /// A word; none when the address is no memory.
    fn word(&self, address: u32) -> Option<u32> {
        let mut bytes = [0; 4];
        self.read(address, &mut bytes)
            .then(|| u32::from_le_bytes(bytes))
    }
}
