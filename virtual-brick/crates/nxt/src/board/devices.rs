// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The devices that act rarely: display, sensor ports, Bluetooth module, USB host and the far ends
//! of the serial lines. The times of their next events are kept until one of them is changed.

use at91sam7s::board::{Cycles, SerialPort};

use super::refresh::Refresh;
use crate::bluetooth::Bluetooth;
use crate::event::EventLog;
use crate::ports::Ports;
use crate::rs485::Rs485Line;
use crate::scripts::ModuleScript;
use crate::time::NEVER;
use crate::usb::UsbHost;

/// The devices themselves.
#[derive(Clone, Debug)]
pub(super) struct Devices {
    pub(super) refresh: Refresh,
    pub(super) ports: Ports,
    pub(super) bluetooth: Bluetooth,
    pub(super) usb: UsbHost,
    pub(super) rs485: Rs485Line,
    /// Stands for the Bluetooth module while it is there.
    pub(super) module_script: Option<ModuleScript>,
}

/// Times of their next events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Times {
    /// When one of them changes by itself next.
    pub(super) changes_at: Cycles,
    /// When one of them has something for the chip that it can be asked for: transactions on the
    /// USB come on top of what changes by itself.
    pub(super) sends_at: Cycles,
}

impl Devices {
    fn times(&self) -> Times {
        let script = self.module_script.as_ref();
        Times {
            changes_at: self
                .refresh
                .due_at
                .min(self.ports.next_event())
                .min(self.bluetooth.next_event())
                .min(self.usb.next_event()),
            sends_at: self
                .usb
                .next_signal()
                .min(self.rs485.next_event())
                .min(script.map_or(NEVER, ModuleScript::next_event)),
        }
    }

    /// A character has reached the chip on this line, or is lost there.
    pub(super) fn has_character(&self, port: SerialPort, now: Cycles) -> bool {
        match (port, &self.module_script) {
            (SerialPort::Usart0, _) => self.rs485.next_event() <= now,
            (SerialPort::Usart1, Some(script)) => script.next_event() <= now,
            (SerialPort::Usart1, None) => self.bluetooth.has_character(),
            (SerialPort::DebugUnit, _) => false,
        }
    }

    fn advance(&mut self, at: Cycles, log: &mut EventLog) {
        if self.ports.next_event() <= at {
            self.ports.advance(at);
        }
        self.bluetooth.advance(at);
        self.usb.advance(at);
        self.refresh.advance(at, log);
    }
}

/// The devices with the times kept. They are changed through [`Self::change`] only, so no change
/// can leave stale times behind.
#[derive(Clone, Debug)]
pub(super) struct TimedDevices {
    devices: Devices,
    kept: Option<Times>,
    /// One of them was advanced since the chip took what they sent.
    advanced: bool,
}

impl TimedDevices {
    pub(super) fn new(devices: Devices) -> Self {
        Self {
            devices,
            kept: None,
            advanced: false,
        }
    }

    pub(super) const fn get(&self) -> &Devices {
        &self.devices
    }

    /// The devices, to change them: the kept times are dropped.
    pub(super) fn change(&mut self) -> &mut Devices {
        self.kept = None;
        &mut self.devices
    }

    pub(super) fn times(&self) -> Times {
        self.kept.unwrap_or_else(|| self.devices.times())
    }

    /// Serve what is due at `at`, and everything if a device was changed.
    pub(super) fn advance(&mut self, at: Cycles, log: &mut EventLog) {
        if self.kept.is_none_or(|times| times.changes_at <= at) {
            self.devices.advance(at, log);
            self.kept = Some(self.devices.times());
            self.advanced = true;
        }
    }

    /// Whether the chip has to ask what came since the last time.
    pub(super) fn have_sent(&mut self, now: Cycles) -> bool {
        let advanced = std::mem::take(&mut self.advanced);
        advanced || self.kept.is_none_or(|times| times.sends_at <= now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::SensorPorts;
    use crate::display::Display;
    use crate::scripts::ModuleTurn;

    fn devices() -> TimedDevices {
        TimedDevices::new(Devices {
            refresh: Refresh::new(Display::new()),
            ports: Ports::new(&SensorPorts::default()),
            bluetooth: Bluetooth::new(&Default::default()),
            usb: UsbHost::default(),
            rs485: Rs485Line::default(),
            module_script: None,
        })
    }

    #[test]
    fn kept_times_are_those_of_the_devices_after_each_kind_of_change() {
        let changes: [fn(&mut Devices); 6] = [
            |devices| devices.refresh.data_written(1_000, 0xFF),
            |devices| devices.ports.set_plugged(1_000, 0, false),
            |devices| devices.bluetooth.skip_start_up(1_000),
            |devices| devices.usb.set_plugged(1_000, true),
            |devices| assert!(devices.rs485.schedule(1_000, &[1], 50)),
            |devices| {
                let turns = vec![ModuleTurn {
                    after_bytes: 0,
                    delay_cycles: 500,
                    bytes: vec![1],
                }];
                devices.module_script = Some(ModuleScript::new(1_000, turns));
            },
        ];
        let mut devices = devices();
        let mut changed = 0;
        for change in changes {
            devices.advance(1_000, &mut EventLog::default());
            let before = devices.times();
            assert_eq!(before, devices.get().times());
            change(devices.change());
            assert_eq!(devices.times(), devices.get().times());
            changed += usize::from(devices.times() != before);
        }
        assert!(changed >= 3, "{changed} of these changes moved an event");
    }
}
