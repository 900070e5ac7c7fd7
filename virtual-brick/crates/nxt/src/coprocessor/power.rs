// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The co-processor's state machine, which runs once a tick: start, operation, the ways to off.

use super::frame::PowerRequest;
use crate::event::PowerOffReason;

/// Ticks from the chip's supply to the look at a rechargeable pack, and to the first sampling.
const PACK_CHECK: u32 = 35;
const FIRST_SAMPLING: u32 = 37;
/// Ticks for which a pack may be too low: 1 s in ticks of nominally 3 ms.
const PACK_LOW_TICKS: u32 = 333;
/// From the tick that sees the reason to the one that cuts the supply: one for each state on the
/// way, 3 while the amplifier is off already, 67 counted twice each before the boot monitor.
const TICKS_TO_OFF: u32 = 6;
const TICKS_TO_BOOT_MONITOR: u32 = 36;
const TICKS_TO_SLEEP: u32 = 2;
/// Ticks without the handshake until it switches off: about 298 s.
const TICKS_WITHOUT_HANDSHAKE: u32 = 100_000;
/// Ticks without a good frame until it clicks, and between two clicks.
const SILENT_TICKS: u32 = 666;
const CLICK_TICKS: u32 = 166;

#[derive(Clone, Copy, Debug)]
enum State {
    /// Ticks since the chip got its supply.
    Starting { ticks: u32 },
    /// Ticks for which the pack has been too low.
    PackLow { ticks: u32 },
    /// It samples at each tick.
    Operating,
    /// Off after this many ticks.
    Ending { ticks: u32, reason: PowerOffReason },
}

/// What a tick does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tick {
    Wait,
    /// Measure the battery, which is too low to start.
    MeasureBattery,
    Sample,
    CutSupply(PowerOffReason),
}

/// The state machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    state: State,
    ticks_without_handshake: u32,
    silent_ticks: u32,
    /// Since the last click, or since the first sampling.
    ticks_since_click: u32,
}

impl Power {
    /// The chip gets its supply.
    pub(super) const fn on() -> Self {
        Self {
            state: State::Starting { ticks: 0 },
            ticks_without_handshake: 0,
            silent_ticks: 0,
            ticks_since_click: 0,
        }
    }

    pub(super) const fn operating() -> Self {
        Self {
            state: State::Operating,
            ..Self::on()
        }
    }

    pub(super) fn begin_tick(&mut self, battery_too_low: bool) -> Tick {
        let (state, does) = match self.state {
            State::Starting { ticks } if ticks + 1 == FIRST_SAMPLING => {
                (State::Operating, Tick::Sample)
            }
            State::Starting { ticks } if ticks + 1 == PACK_CHECK && battery_too_low => {
                (State::PackLow { ticks: 0 }, Tick::MeasureBattery)
            }
            State::Starting { ticks } => (State::Starting { ticks: ticks + 1 }, Tick::Wait),
            State::PackLow { .. } if !battery_too_low => {
                (State::Starting { ticks: PACK_CHECK }, Tick::MeasureBattery)
            }
            State::PackLow { ticks } if ticks + 1 == PACK_LOW_TICKS => (
                ending(TICKS_TO_SLEEP, PowerOffReason::BatteryLow),
                Tick::MeasureBattery,
            ),
            State::PackLow { ticks } => (State::PackLow { ticks: ticks + 1 }, Tick::MeasureBattery),
            State::Operating => (State::Operating, Tick::Sample),
            State::Ending { ticks: 1, reason } => (self.state, Tick::CutSupply(reason)),
            State::Ending { ticks, reason } => (ending(ticks - 1, reason), Tick::Wait),
        };
        self.state = state;
        does
    }

    /// After the inputs were sampled it looks at what came from the chip since the tick before.
    /// True when the amplifier clicks.
    pub(super) fn end_sampling(
        &mut self,
        good_frame: bool,
        handshake: bool,
        request: PowerRequest,
    ) -> bool {
        self.silent_ticks = if good_frame { 1 } else { self.silent_ticks + 1 };
        self.ticks_since_click += 1;
        let clicks = self.silent_ticks > SILENT_TICKS && self.ticks_since_click > CLICK_TICKS;
        if clicks {
            self.ticks_since_click = 1;
        }
        self.ticks_without_handshake += u32::from(!handshake);
        self.state = match request {
            PowerRequest::BootMonitor => ending(TICKS_TO_BOOT_MONITOR, PowerOffReason::BootMonitor),
            PowerRequest::PowerDown => ending(TICKS_TO_OFF, PowerOffReason::Requested),
            PowerRequest::StayOn if self.ticks_without_handshake >= TICKS_WITHOUT_HANDSHAKE => {
                ending(TICKS_TO_OFF, PowerOffReason::NoHandshake)
            }
            PowerRequest::StayOn => State::Operating,
        };
        clicks
    }
}

const fn ending(ticks: u32, reason: PowerOffReason) -> State {
    State::Ending { ticks, reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pack_that_stays_too_low_has_333_ticks_to_recover() {
        let mut power = Power::on();
        let mut tick = || power.begin_tick(true);
        let waits = (1..).take_while(|_| tick() == Tick::Wait).count();
        assert_eq!(waits, 34, "the 35th looks at the pack");
        let measures = (1..).take_while(|_| tick() == Tick::MeasureBattery).count();
        assert_eq!(measures, 333);
        let off = Tick::CutSupply(PowerOffReason::BatteryLow);
        assert_eq!(tick(), off);
    }
}
