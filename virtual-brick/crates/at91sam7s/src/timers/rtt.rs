// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Real-time timer (AT91SAM7S datasheet, 6175M, chapter 14): counts the slow clock.

use crate::clock::{slow_clock_cycles, Cycles, NEVER, SLOW_CLOCK_HZ};
use crate::clock::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR};
use crate::fault::{no_register, Access};
use crate::registers::registers;

registers! {
    RTT_MR = 0x00, RTT_AR = 0x04, RTT_VR = 0x08, RTT_SR = 0x0C,
}

const ALMIEN: u32 = 1 << 16;
const RTTINCIEN: u32 = 1 << 17;
const RTTRST: u32 = 1 << 18;
const ALMS: u32 = 1 << 0;
const RTTINC: u32 = 1 << 1;

/// Mode, alarm, counter.
#[derive(Clone, Debug)]
pub(crate) struct Rtt {
    mode: u32,
    alarm: u32,
    started: Cycles,
    offset: u32,
    seen: u32,
    status: u32,
}

impl Rtt {
    pub(crate) fn new(now: Cycles) -> Self {
        Self {
            mode: 0x8000,
            alarm: 0xFFFF_FFFF,
            started: now,
            offset: 0,
            seen: 0,
            status: 0,
        }
    }

    fn divider(&self) -> u64 {
        match self.mode & 0xFFFF {
            0 => 0x1_0000,
            n => u64::from(n),
        }
    }

    /// Cycle at which the counter has made `count` steps since the last restart.
    fn step_at(&self, count: u64) -> Cycles {
        self.started + slow_clock_cycles(count * self.divider())
    }

    fn steps(&self, now: Cycles) -> u64 {
        let scale = MASTER_CLOCK_HZ_DENOMINATOR * SLOW_CLOCK_HZ;
        let elapsed = now - self.started;
        ((elapsed + 1) * scale - 1) / (self.divider() * MASTER_CLOCK_HZ_NUMERATOR)
    }

    fn advance(&mut self, now: Cycles) {
        let value = self.offset.wrapping_add(self.steps(now) as u32);
        let passed = value.wrapping_sub(self.seen);
        if passed == 0 {
            return;
        }
        self.status |= RTTINC;
        let to_alarm = self.alarm.wrapping_add(1).wrapping_sub(self.seen);
        if to_alarm != 0 && to_alarm <= passed {
            self.status |= ALMS;
        }
        self.seen = value;
    }

    pub(crate) fn serve(&mut self, at: Cycles) {
        self.advance(at);
    }

    pub(crate) fn interrupt(&self) -> bool {
        (self.status & ALMS != 0 && self.mode & ALMIEN != 0)
            || (self.status & RTTINC != 0 && self.mode & RTTINCIEN != 0)
    }

    pub(crate) fn next_event(&self, now: Cycles) -> Cycles {
        let done = self.steps(now);
        if self.mode & RTTINCIEN != 0 && self.status & RTTINC == 0 {
            return self.step_at(done + 1);
        }
        if self.mode & ALMIEN != 0 && self.status & ALMS == 0 {
            let to_alarm = self.alarm.wrapping_add(1).wrapping_sub(self.seen);
            if to_alarm != 0 {
                let value = self.offset.wrapping_add(done as u32);
                let since_seen = u64::from(value.wrapping_sub(self.seen));
                return self.step_at(done - since_seen + u64::from(to_alarm));
            }
        }
        NEVER
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        self.advance(now);
        match offset {
            RTT_MR => Ok(self.mode),
            RTT_AR => Ok(self.alarm),
            RTT_VR => Ok(self.seen),
            RTT_SR => Ok(std::mem::take(&mut self.status)),
            _ => no_register("RTT", offset),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access {
        self.advance(now);
        match offset {
            RTT_MR => {
                let changed = (self.mode ^ value) & 0xFFFF != 0;
                if value & RTTRST != 0 || changed {
                    self.offset = if value & RTTRST != 0 { 0 } else { self.seen };
                    self.seen = self.offset;
                    self.started = now;
                }
                self.mode = value & (0xFFFF | ALMIEN | RTTINCIEN);
            }
            RTT_AR => self.alarm = value,
            RTT_VR | RTT_SR => {}
            _ => return no_register("RTT", offset),
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_alarm_comes_one_step_after_the_alarm_value() {
        let mut timer = Rtt::new(0);
        timer.write(RTT_AR, 2, 0).unwrap();
        timer.write(RTT_MR, 32 | ALMIEN | RTTRST, 0).unwrap();
        let at = timer.next_event(0);
        assert_eq!(at, slow_clock_cycles(96));
        // Who asks again later gets the same answer.
        assert_eq!(timer.next_event(slow_clock_cycles(70)), at);
        timer.serve(at - 1);
        assert!(!timer.interrupt());
        timer.serve(at);
        assert!(timer.interrupt());
        assert_eq!(timer.read(RTT_VR, at).unwrap(), 3);
        assert_eq!(timer.read(RTT_SR, at).unwrap(), ALMS | RTTINC);
        assert_eq!(timer.read(RTT_SR, at).unwrap(), 0);
    }

    /// 2^32 - 2 more steps of 2^16 periods of the slow clock.
    #[test]
    fn an_alarm_in_272_years_does_not_come_now() {
        let mut timer = Rtt::new(0);
        timer.write(RTT_AR, 0, 0).unwrap();
        timer.write(RTT_MR, ALMIEN | RTTRST, 0).unwrap();
        let now = slow_clock_cycles(2 << 16);
        timer.read(RTT_SR, now).unwrap();
        timer.write(RTT_AR, 0xFFFF_FFFF, now).unwrap();
        let years = timer.next_event(now) / (slow_clock_cycles(SLOW_CLOCK_HZ) * 31_557_600);
        assert!((270..275).contains(&years), "{years}");
    }
}
