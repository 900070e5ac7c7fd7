// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A two-wire slave made in software, from the levels of its lines: the first digital line is the
//! clock, the second one the data. A write begins with the number of a register.
//!
//! What it does not do as the specification of the bus wants (seen in what every known master
//! does for it): a START without a STOP before it is not heard, and a STOP is digested only with
//! the next clock pulse, or after a while.

use at91sam7s::board::Cycles;

use crate::time::{microseconds, milliseconds};

/// Clock edges that come faster are missed, and the transfer is lost (chosen; known masters clock
/// with 9.6 to 11.7 kHz).
const SHORTEST_HALF_PERIOD: Cycles = microseconds(10);
/// Time after which a STOP is digested without a clock pulse (chosen).
const DIGESTED: Cycles = milliseconds(1);
const BITS: u8 = 8;

/// What the slave's bytes mean.
pub trait Registers {
    /// A byte for the master: number `index`, from 0 on, of what begins at `register`.
    fn read(&mut self, register: u8, index: u8) -> u8;
    /// A byte from the master.
    fn write(&mut self, now: Cycles, register: u8, value: u8);
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waits for a START.
    Idle,
    Address,
    Register,
    Write,
    Read,
}

/// The slave's side of the lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Slave {
    /// Address byte of a write.
    address: u8,
    state: State,
    /// State after the acknowledge that is under way.
    then: State,
    /// Clock pulses of this byte, with that of the acknowledge.
    pulses: u8,
    byte: u8,
    register: u8,
    index: u8,
    pulls_data_low: bool,
    clock: bool,
    data: bool,
    edge_at: Cycles,
    stopped_at: Option<Cycles>,
}

impl Slave {
    /// A slave with the address byte of a write, at rest.
    pub const fn new(address: u8) -> Self {
        Self {
            address,
            state: State::Idle,
            then: State::Idle,
            pulses: 0,
            byte: 0,
            register: 0,
            index: 0,
            pulls_data_low: false,
            clock: true,
            data: true,
            edge_at: 0,
            stopped_at: None,
        }
    }

    pub const fn pulls_data_low(&self) -> bool {
        self.pulls_data_low
    }

    /// The master's levels; lines that it leaves alone are high.
    pub fn levels(&mut self, now: Cycles, clock: bool, data: bool, device: &mut impl Registers) {
        let data = data && !self.pulls_data_low;
        let (clock_before, data_before) = (self.clock, self.data);
        (self.clock, self.data) = (clock, data);
        if clock != clock_before {
            self.clock_changed(now, device);
            self.data = data && !self.pulls_data_low;
        } else if clock && data != data_before {
            if data {
                self.stop(now);
            } else {
                self.start(now);
            }
        }
    }

    fn start(&mut self, now: Cycles) {
        let digested = self.stopped_at.is_none_or(|at| now >= at + DIGESTED);
        let heard = self.state == State::Idle && digested;
        self.enter(if heard { State::Address } else { State::Idle });
        self.edge_at = 0;
    }

    fn stop(&mut self, now: Cycles) {
        self.stopped_at = (self.state != State::Idle).then_some(now);
        self.enter(State::Idle);
    }

    fn enter(&mut self, state: State) {
        self.state = state;
        self.pulses = 0;
        self.pulls_data_low = false;
    }

    fn clock_changed(&mut self, now: Cycles, device: &mut impl Registers) {
        let too_fast = now < self.edge_at + SHORTEST_HALF_PERIOD;
        self.edge_at = now;
        if self.state == State::Idle {
            self.stopped_at = None;
        } else if too_fast {
            self.enter(State::Idle);
        } else if self.clock {
            self.clock_rose();
        } else {
            self.clock_fell(now, device);
        }
    }

    fn clock_rose(&mut self) {
        if self.state != State::Read {
            self.byte = self.byte << 1 | u8::from(self.data);
        }
        self.pulses += 1;
        if self.state == State::Read && self.pulses > BITS && self.data {
            self.enter(State::Idle);
        }
    }

    fn clock_fell(&mut self, now: Cycles, device: &mut impl Registers) {
        match (self.pulses, self.state) {
            (BITS, State::Read) => self.pulls_data_low = false,
            (BITS, _) => {
                self.then = self.received(now, device);
                self.pulls_data_low = self.then != State::Idle;
            }
            (0..BITS, State::Read) => self.put_bit(),
            (0..BITS, _) => {}
            (_, State::Read) => self.put_byte(device),
            (_, _) => {
                self.enter(self.then);
                if self.state == State::Read {
                    self.put_byte(device);
                }
            }
        }
    }

    /// A byte is complete: what follows, or idleness when it is not acknowledged.
    fn received(&mut self, now: Cycles, device: &mut impl Registers) -> State {
        match self.state {
            State::Address if self.byte == self.address => State::Register,
            State::Address if self.byte == self.address | 1 => State::Read,
            State::Register => {
                (self.register, self.index) = (self.byte, 0);
                State::Write
            }
            State::Write => {
                let register = self.register.wrapping_add(self.index);
                device.write(now, register, self.byte);
                self.index = self.index.wrapping_add(1);
                State::Write
            }
            State::Address | State::Idle | State::Read => State::Idle,
        }
    }

    fn put_byte(&mut self, device: &mut impl Registers) {
        self.byte = device.read(self.register, self.index);
        self.index = self.index.wrapping_add(1);
        self.pulses = 0;
        self.put_bit();
    }

    fn put_bit(&mut self) {
        self.pulls_data_low = self.byte >> (BITS - 1 - self.pulses) & 1 == 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl Registers for Nothing {
        fn read(&mut self, _register: u8, _index: u8) -> u8 {
            0
        }
        fn write(&mut self, _now: Cycles, _register: u8, _value: u8) {}
    }

    /// The specification of the bus has minimum times for the clock's phases; a START in one of
    /// them begins anew.
    #[test]
    fn the_first_clock_after_a_start_may_be_close_to_the_one_before_it() {
        let mut slave = Slave::new(2);
        let half = SHORTEST_HALF_PERIOD;
        let mut now = 10 * half;
        let mut levels = |slave: &mut Slave, after, clock, data| {
            now += after;
            slave.levels(now, clock, data, &mut Nothing);
        };
        levels(&mut slave, half, false, true);
        levels(&mut slave, half, true, true);
        levels(&mut slave, half / 4, true, false);
        for place in 0..8 {
            let bit = 2 >> (7 - place) & 1 != 0;
            levels(
                &mut slave,
                if place == 0 { half / 4 } else { half },
                false,
                false,
            );
            levels(&mut slave, 0, false, bit);
            levels(&mut slave, half, true, bit);
        }
        levels(&mut slave, half, false, true);
        assert!(slave.pulls_data_low(), "the address is acknowledged");
    }
}
