// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! When the parts of the board are due, and what they do then. Plant and co-processor are due often
//! and asked each time; of the others one time is kept as long as nobody reaches for them.

use at91sam7s::board::Cycles;

use super::NxtBoard;

/// Times of display, ports, Bluetooth, USB and the far ends of the serial lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slow {
    /// When one of them changes by itself next.
    changes_at: Cycles,
    /// When one of them has something for the chip that it can be asked for.
    brings_at: Cycles,
}

impl NxtBoard {
    /// When anything is due next.
    pub(super) fn next_time(&self) -> Cycles {
        let slow = self.slow_next.unwrap_or_else(|| self.slow_parts());
        self.fast_change().min(slow.changes_at).min(slow.brings_at)
    }

    /// Serves what is due.
    pub(super) fn advance_to(&mut self, now: Cycles) {
        loop {
            let slow = self.slow_next.unwrap_or_else(|| self.slow_parts());
            let at = self.fast_change().min(slow.changes_at);
            if at > now {
                return;
            }
            if self.physics.next_event() <= at {
                self.advance_physics(at);
            }
            if self.coprocessor.next_event() <= at {
                self.advance_coprocessor(at);
            }
            if self.slow_next.is_none_or(|slow| slow.changes_at <= at) {
                self.advance_slow_parts(at);
            }
        }
    }

    /// Whether the chip has to ask what came since the last time.
    pub(super) fn may_bring(&mut self, now: Cycles) -> bool {
        let advanced = std::mem::take(&mut self.slow_advanced);
        advanced || self.slow_next.is_none_or(|slow| slow.brings_at <= now)
    }

    fn advance_physics(&mut self, at: Cycles) {
        let drives = self.coprocessor.drives();
        if self.physics.advance(at, drives, self.battery.voltage()) {
            let (_, robot, _) = self.physics.around(at);
            self.battery.set_current(robot.supply_current());
            if self.measured.update(robot, &mut self.ports) {
                self.slow_next = None;
            }
            self.look_at_battery(at);
        }
    }

    fn advance_coprocessor(&mut self, at: Cycles) {
        let measurable = self.measurable();
        self.coprocessor.advance(at, measurable, &mut self.log);
        self.switch_supplies(at);
    }

    /// The ports get the supplies that are in force.
    pub(super) fn switch_supplies(&mut self, at: Cycles) {
        let supplies = self.coprocessor.sensor_supplies();
        if self.ports.set_supplies(at, supplies) {
            self.slow_next = None;
        }
    }

    fn advance_slow_parts(&mut self, at: Cycles) {
        if self.ports.next_event() <= at {
            self.ports.advance(at);
        }
        self.bluetooth.advance(at);
        self.usb.advance(at);
        if self.refresh.due_at <= at {
            self.report_picture(at);
        }
        self.slow_next = Some(self.slow_parts());
        self.slow_advanced = true;
    }

    /// When plant or co-processor change by themselves next.
    fn fast_change(&self) -> Cycles {
        self.physics.next_event().min(self.coprocessor.next_event())
    }

    /// Transactions on the USB come on top of what changes by itself.
    fn slow_parts(&self) -> Slow {
        Slow {
            changes_at: self
                .refresh
                .due_at
                .min(self.ports.next_event())
                .min(self.bluetooth.next_event())
                .min(self.usb.next_event()),
            brings_at: self
                .usb
                .next_signal()
                .min(self.rs485.next_event())
                .min(self.bench.next_event()),
        }
    }
}
