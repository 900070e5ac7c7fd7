// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The ATmega48 co-processor: slave 1 of the two-wire bus, motor bridges, analogue inputs, power.

mod frame;
mod main_loop;
mod power;
mod pwm;
mod timing;

use at91sam7s::board::{Cycles, TwiReply};
use plant::{MotorDrive, MotorPort};

use frame::{Command, Incoming, Outgoing, PowerRequest, Received};
pub use frame::{MotorCommand, SensorSupply};
use main_loop::MainLoop;
use power::{Power, Tick};
pub use timing::CoprocessorTiming;

use crate::event::{BoardEventKind, BoardFault, EventLog, PowerOffReason};
use crate::time::{microseconds, NEVER};

/// Address on the two-wire bus.
pub const ADDRESS: u8 = 1;
/// How long it holds SCL when it hangs: until the master gives up.
const HELD: Cycles = 1 << 48;

/// Results in the order in which sampling stores them: when after the tick began, and which word.
/// The first of a port's two conversions is stored too. Measured on LEGO's source in a simulator
/// of the ATmega48.
const STORED: [(Cycles, usize); 10] = [
    (microseconds(42), 0),
    (microseconds(99), 0),
    (microseconds(138), 1),
    (microseconds(195), 1),
    (microseconds(234), 2),
    (microseconds(291), 2),
    (microseconds(334), 3),
    (microseconds(391), 3),
    (microseconds(507), BUTTONS),
    (microseconds(623), BATTERY),
];
const BUTTONS: usize = 4;
const BATTERY: usize = 5;

/// What the co-processor can measure now.
#[derive(Clone, Copy, Debug)]
pub struct Measurable {
    /// Counts of the sensor ports, the button word, the battery word.
    pub words: [u16; 6],
    /// The battery does not suffice to start.
    pub battery_too_low: bool,
}

/// Faults of the link that a scenario can ask for.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkFaults {
    /// Status frames that will have a wrong checksum.
    pub corrupt_checksums: u16,
    /// Status frames that will have changed words half old and half new.
    pub torn_words: u16,
    /// It takes no frame from the chip: each counts as one with a wrong sum.
    pub refuses_frames: bool,
    /// It holds SCL after each byte, for good.
    pub holds_bus: bool,
}

/// The co-processor.
#[derive(Clone, Debug)]
pub struct Coprocessor {
    timing: CoprocessorTiming,
    main_loop: MainLoop,
    power: Power,
    /// Index into [`STORED`] of the next result of this tick.
    stage: Option<usize>,
    readings: [u16; 6],
    /// What they were when this tick began.
    readings_before: [u16; 6],
    incoming: Incoming,
    outgoing: Outgoing,
    handshake: bool,
    /// The frame that came in last.
    command: Command,
    /// It came after the last tick.
    heard: bool,
    in_force: Command,
    /// States of the bridges by that command.
    drives: [MotorDrive; 3],
    /// When the frame that came in last will be in force.
    update_at: Cycles,
    sensor_supplies: [SensorSupply; 4],
    powered: bool,
    /// When something of this is due next.
    next_at: Cycles,
    /// What a scenario has broken.
    pub faults: LinkFaults,
}

impl Coprocessor {
    /// The chip's supply comes on at `now`, after which ticks begin within `phase` cycles.
    /// The battery was measured before.
    pub fn new(timing: CoprocessorTiming, now: Cycles, phase: Cycles, battery: u16) -> Self {
        let in_force = Command::at_reset();
        Self {
            timing,
            main_loop: MainLoop::running(now, now + phase, timing.pass_cycles),
            power: Power::on(),
            stage: None,
            readings: [0, 0, 0, 0, 0, battery],
            readings_before: [0; 6],
            incoming: Incoming::default(),
            outgoing: Outgoing::default(),
            handshake: false,
            command: in_force,
            heard: false,
            in_force,
            drives: drives(&in_force),
            update_at: NEVER,
            sensor_supplies: [SensorSupply::Off; 4],
            powered: true,
            next_at: now + phase,
            faults: LinkFaults::default(),
        }
    }

    /// Times of its program from now on.
    pub fn set_timing(&mut self, timing: CoprocessorTiming) {
        let MainLoop {
            tick_at,
            next_tick_at,
            ..
        } = self.main_loop;
        self.main_loop = MainLoop::running(tick_at, next_tick_at, timing.pass_cycles);
        self.timing = timing;
    }

    /// The co-processor has been sampling for a while already when the run begins: its tick is
    /// `phase` cycles away.
    pub fn skip_start_up(&mut self, now: Cycles, phase: Cycles, measurable: Measurable) {
        self.main_loop = MainLoop::running(now, now + phase, self.timing.pass_cycles);
        self.power = Power::operating();
        self.stage = None;
        self.readings = measurable.words;
        self.readings_before = measurable.words;
        self.sensor_supplies = [0, 1, 2, 3].map(|index| self.command.sensor_supply(index));
        self.plan();
    }

    /// The chip's supply comes back after a power cycle; faults from outside stay.
    pub fn restart(&mut self, now: Cycles, phase: Cycles, battery: u16) {
        *self = Self {
            faults: self.faults,
            ..Self::new(self.timing, now, phase, battery)
        };
    }

    /// The supply is gone: bridges open, chip off.
    pub fn lose_supply(&mut self, now: Cycles, log: &mut EventLog) {
        if self.powered {
            self.turn_off(now, PowerOffReason::SupplyLost, log);
            self.plan();
        }
    }

    fn turn_off(&mut self, now: Cycles, reason: PowerOffReason, log: &mut EventLog) {
        self.powered = false;
        self.apply(now, Command::off(), log);
        self.sensor_supplies = [SensorSupply::Off; 4];
        log.add(now, BoardEventKind::PowerOff(reason));
    }

    /// Whether the chip has its supply.
    pub const fn powered(&self) -> bool {
        self.powered
    }

    /// Command in force for a motor.
    pub const fn motor_command(&self, motor: MotorPort) -> MotorCommand {
        self.in_force.motors[motor.index()]
    }

    /// 9 V supplies of the sensor ports.
    pub const fn sensor_supplies(&self) -> [SensorSupply; 4] {
        self.sensor_supplies
    }

    /// States of the bridges.
    pub const fn drives(&self) -> &[MotorDrive; 3] {
        &self.drives
    }

    /// The chip addresses the co-processor. A read takes the frame to be sent now.
    pub fn start(&mut self, read: bool) -> TwiReply {
        if read {
            self.outgoing = Outgoing::new(self.sent_words());
            if self.faults.corrupt_checksums > 0 {
                self.faults.corrupt_checksums -= 1;
                self.outgoing.corrupt_checksum();
            }
            self.acknowledge(self.timing.status_copy_cycles)
        } else {
            self.incoming = Incoming::default();
            self.acknowledge(0)
        }
    }

    /// The words as its handler copies them: a byte at a time, while the main loop stores the low
    /// byte of a word after the high one.
    fn sent_words(&mut self) -> [u16; 6] {
        let torn = |(new, old): (u16, u16)| new & 0xFF00 | old & 0xFF;
        let pairs = [0, 1, 2, 3, 4, 5].map(|i| (self.readings[i], self.readings_before[i]));
        let words = pairs.map(torn);
        if self.faults.torn_words == 0 || words == self.readings {
            return self.readings;
        }
        self.faults.torn_words -= 1;
        words
    }

    /// A byte to the co-processor.
    pub fn write(&mut self, now: Cycles, byte: u8) -> TwiReply {
        let extra_cycles = match self.incoming.push(byte) {
            Received::Part => 0,
            Received::Handshake => {
                self.handshake = true;
                0
            }
            Received::Command(command) if !self.faults.refuses_frames => {
                self.accept(now, command);
                self.timing.good_frame_cycles
            }
            Received::Command(_) | Received::BadFrame => self.timing.bad_frame_cycles,
        };
        self.acknowledge(extra_cycles)
    }

    /// The next byte from the co-processor, and for how long it holds SCL before it. The first one
    /// was ready when the address had been handled.
    pub fn read(&mut self) -> (u8, Cycles) {
        let stretch_cycles = if self.outgoing.is_whole() {
            0
        } else {
            self.stretch_cycles(0)
        };
        (self.outgoing.next_byte(), stretch_cycles)
    }

    /// How long it holds SCL for what takes this long beside the handler.
    pub const fn stretch_cycles(&self, extra_cycles: Cycles) -> Cycles {
        if self.faults.holds_bus {
            HELD
        } else {
            self.timing.stretch_cycles + extra_cycles
        }
    }

    const fn acknowledge(&self, extra_cycles: Cycles) -> TwiReply {
        TwiReply {
            acknowledged: true,
            stretch_cycles: self.stretch_cycles(extra_cycles),
        }
    }

    pub const fn next_event(&self) -> Cycles {
        self.next_at
    }

    /// Works out again when something is due.
    fn plan(&mut self) {
        let stage_at = self
            .stage
            .map(|stage| self.main_loop.tick_at + STORED[stage].0);
        let tick_or_stage = stage_at.unwrap_or(self.main_loop.next_tick_at);
        self.next_at = if self.powered {
            tick_or_stage.min(self.update_at)
        } else {
            NEVER
        };
    }

    /// Serves what is due at `now`: commands, then results, then the state machine.
    pub fn advance(&mut self, now: Cycles, measurable: Measurable, log: &mut EventLog) {
        if !self.powered {
            return;
        }
        if self.update_at <= now {
            self.update_at = NEVER;
            self.apply(now, self.command, log);
        }
        match self.stage {
            Some(stage) if self.main_loop.tick_at + STORED[stage].0 <= now => {
                self.store(now, stage, measurable, log);
            }
            None if self.main_loop.next_tick_at <= now => self.begin_tick(now, measurable, log),
            _ => {}
        }
        self.plan();
    }

    fn begin_tick(&mut self, now: Cycles, measurable: Measurable, log: &mut EventLog) {
        let tick = self.power.begin_tick(measurable.battery_too_low);
        self.main_loop.begin_tick(tick == Tick::Sample);
        match tick {
            Tick::Wait => {}
            Tick::MeasureBattery => self.publish(BATTERY, measurable),
            Tick::Sample => {
                self.stage = Some(0);
                self.readings_before = self.readings;
            }
            Tick::CutSupply(reason) => self.turn_off(now, reason, log),
        }
    }

    /// A frequency that the timers do not serve leaves the last one.
    fn accept(&mut self, now: Cycles, mut command: Command) {
        if !(1..=32).contains(&command.frequency_khz) {
            command.frequency_khz = self.command.frequency_khz;
        }
        self.command = command;
        self.heard = true;
        self.update_at = self.main_loop.update_after(now);
        self.plan();
    }

    fn apply(&mut self, now: Cycles, command: Command, log: &mut EventLog) {
        for motor in MotorPort::ALL {
            let new = command.motors[motor.index()];
            if new.duty.unsigned_abs() > 100 {
                log.fault(
                    now,
                    BoardFault::DutyBeyondRange {
                        motor,
                        duty: new.duty,
                    },
                );
            }
            if new != self.motor_command(motor) {
                let MotorCommand { duty, brake } = new;
                log.add(now, BoardEventKind::MotorCommand { motor, duty, brake });
            }
        }
        self.in_force = command;
        self.drives = drives(&command);
    }

    fn publish(&mut self, word: usize, measurable: Measurable) {
        self.readings[word] = measurable.words[word];
    }

    /// A port gets its supply back, or another one, after its second conversion.
    fn store(&mut self, now: Cycles, stage: usize, measurable: Measurable, log: &mut EventLog) {
        let word = STORED[stage].1;
        self.publish(word, measurable);
        if let Some(supply) = self.sensor_supplies.get_mut(word) {
            *supply = self.command.sensor_supply(word);
        }
        self.stage = (stage + 1 < STORED.len()).then_some(stage + 1);
        if self.stage.is_none() {
            self.end_sampling(now, log);
        }
    }

    fn end_sampling(&mut self, now: Cycles, log: &mut EventLog) {
        let request = self.command.request;
        if request == PowerRequest::BootMonitor {
            self.command.request = PowerRequest::StayOn;
        }
        let heard = std::mem::take(&mut self.heard);
        if self.power.end_sampling(heard, self.handshake, request) {
            log.add(now, BoardEventKind::Click);
        }
    }
}

fn drives(command: &Command) -> [MotorDrive; 3] {
    command
        .motors
        .map(|motor| pwm::drive(motor, command.frequency_khz))
}
