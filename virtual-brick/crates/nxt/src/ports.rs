// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The four sensor ports: analogue line, two digital lines and supply of each.
//!
//! The brick's ends of the digital lines have series resistors: while the chip drives a line, it
//! reads its own level, and the sensor at the other end pulls the line down all the same.

use at91sam7s::board::{Cycles, PinOutputs};

use crate::configuration::SensorPorts;
use crate::coprocessor::SensorSupply;
use crate::sensors::{Lines, Nothing, Sensor, OPEN};
use crate::time::NEVER;

/// Pins of the two digital lines of each port.
const PINS: [[u32; 2]; 4] = [[23, 18], [28, 19], [29, 20], [30, 2]];
/// The digital lines of all ports.
pub const PORT_LINES: u32 =
    1 << 2 | 1 << 18 | 1 << 19 | 1 << 20 | 1 << 23 | 1 << 28 | 1 << 29 | 1 << 30;

/// A port and what is plugged into it.
#[derive(Clone, Debug)]
struct Port {
    sensor: Sensor,
    plugged: bool,
    shorted: [bool; 2],
    lines: Lines,
    supply: SensorSupply,
}

impl Port {
    fn raw(&self) -> u16 {
        if self.plugged {
            self.sensor.raw(self.lines)
        } else {
            OPEN
        }
    }

    /// Counts of the chip's converter on the second digital line.
    fn analogue(&self, now: Cycles) -> Option<u16> {
        let connected = self.plugged && !self.shorted[1] && self.lines.driven[1].is_none();
        connected.then(|| self.sensor.analogue(now))?
    }

    fn supply_changed(&mut self, now: Cycles) {
        let on = self.plugged && self.supply != SensorSupply::Off;
        self.sensor.set_supply(now, on);
    }

    /// Lines that are low at the chip's end as long as the chip does not drive them.
    fn low(&self) -> [bool; 2] {
        let sensor = self.sensor.pulls_low();
        [0, 1].map(|line| self.shorted[line] || self.plugged && sensor[line])
    }

    /// The sensor sees the lines, shorts included.
    fn seen(&self) -> Lines {
        let level = |line: usize| {
            if self.shorted[line] {
                Some(false)
            } else {
                self.lines.driven[line]
            }
        };
        Lines {
            driven: [level(0), level(1)],
        }
    }
}

/// What the chip drives on the digital lines, and which of these are high.
const fn on_lines(outputs: PinOutputs) -> (u32, u32) {
    let driven = outputs.driven & PORT_LINES;
    (driven, driven & outputs.level)
}

/// All ports.
#[derive(Clone, Debug)]
pub struct Ports {
    ports: [Port; 4],
    /// What the chip drives on the digital lines, and which of these are high.
    outputs: (u32, u32),
    low: u32,
}

impl Ports {
    pub fn new(configuration: &SensorPorts) -> Self {
        let port = |sensor: Option<&Sensor>| Port {
            sensor: sensor.cloned().unwrap_or(Sensor::Nothing(Nothing)),
            plugged: true,
            shorted: [false; 2],
            lines: Lines::default(),
            supply: SensorSupply::Off,
        };
        Self {
            ports: configuration.all().map(port),
            outputs: (0, 0),
            low: 0,
        }
    }

    pub fn sensors(&self) -> [&Sensor; 4] {
        let [one, two, three, four] = &self.ports;
        [&one.sensor, &two.sensor, &three.sensor, &four.sensor]
    }

    /// Counts that the co-processor's converter reads.
    pub fn raw(&self) -> [u16; 4] {
        let [one, two, three, four] = &self.ports;
        [one.raw(), two.raw(), three.raw(), four.raw()]
    }

    /// Counts of the chip's converter on the second digital line of a port, when a sensor puts a
    /// voltage there.
    pub fn analogue(&self, now: Cycles, index: usize) -> Option<u16> {
        self.ports[index].analogue(now)
    }

    /// Digital lines that something outside the chip pulls low.
    pub const fn low(&self) -> u32 {
        self.low
    }

    /// These outputs of the chip change nothing on the digital lines.
    pub fn has_outputs(&self, outputs: PinOutputs) -> bool {
        self.outputs == on_lines(outputs)
    }

    pub fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs) {
        if self.has_outputs(outputs) {
            return;
        }
        self.outputs = on_lines(outputs);
        let driven = self.outputs.0;
        for (index, pins) in PINS.into_iter().enumerate() {
            let level = |pin: u32| {
                let mask = 1 << pin;
                (driven & mask != 0).then_some(outputs.level & mask != 0)
            };
            let lines = Lines {
                driven: pins.map(level),
            };
            if lines != self.ports[index].lines {
                self.ports[index].lines = lines;
                self.lines_changed(now, index);
            }
        }
    }

    fn lines_changed(&mut self, now: Cycles, index: usize) {
        let port = &mut self.ports[index];
        let seen = port.seen();
        if port.plugged {
            port.sensor.lines_changed(now, seen);
        }
        self.refresh_low();
    }

    fn refresh_low(&mut self) {
        self.low = 0;
        for (port, pins) in self.ports.iter().zip(PINS) {
            for (low, pin) in port.low().into_iter().zip(pins) {
                self.low |= u32::from(low) << pin;
            }
        }
    }

    /// The 9 V supplies in force.
    pub fn supplies(&self) -> [SensorSupply; 4] {
        let [one, two, three, four] = &self.ports;
        [one.supply, two.supply, three.supply, four.supply]
    }

    /// The co-processor's switches of the 9 V.
    pub fn set_supplies(&mut self, now: Cycles, supplies: [SensorSupply; 4]) {
        for (port, supply) in self.ports.iter_mut().zip(supplies) {
            if port.supply != supply {
                port.supply = supply;
                port.supply_changed(now);
            }
        }
        self.refresh_low();
    }

    /// A quantity given from outside, which the lines follow at once.
    pub fn set_input(&mut self, index: usize, key: &str, value: f64) {
        self.set_quantity(index, key, value);
        self.refresh_low();
    }

    pub fn set_quantity(&mut self, index: usize, key: &str, value: f64) {
        self.ports[index].sensor.set(key, value);
    }

    /// Pulls the sensor's cable out or puts it in.
    pub fn set_plugged(&mut self, now: Cycles, index: usize, plugged: bool) {
        let port = &mut self.ports[index];
        if port.plugged != plugged {
            port.plugged = plugged;
            port.sensor.set_plugged(now);
            port.supply_changed(now);
        }
        self.refresh_low();
    }

    /// Shorts a digital line to ground or ends that.
    pub fn set_short(&mut self, now: Cycles, index: usize, line: usize, shorted: bool) {
        self.ports[index].shorted[line] = shorted;
        self.lines_changed(now, index);
    }

    pub fn next_event(&self) -> Cycles {
        let events = self.ports.iter().map(|port| port.sensor.next_event());
        events.min().unwrap_or(NEVER)
    }

    pub fn advance(&mut self, now: Cycles) {
        for port in &mut self.ports {
            port.sensor.advance(now);
        }
    }
}
