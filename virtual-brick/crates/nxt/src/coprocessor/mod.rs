// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The ATmega48 co-processor: slave 1 of the two-wire bus, motor bridges, analogue inputs, power.

mod frame;
mod pwm;

use at91sam7s::board::Cycles;
use plant::{MotorDrive, MotorPort};

use frame::{Command, Incoming, Outgoing, PowerRequest, Received};
pub use frame::{MotorCommand, SensorSupply};

use crate::event::{BoardEventKind, BoardFault, EventLog, PowerOffReason};
use crate::time::{microseconds, milliseconds, NEVER};

/// Address on the two-wire bus.
pub const ADDRESS: u8 = 1;
/// How long the interrupt handler of the two-wire interface holds SCL after a byte, unless
/// configured otherwise: about 32 cycles of its 8 MHz clock (chosen).
pub const STRETCH_CYCLES: Cycles = microseconds(4);
/// How long it holds SCL when it hangs: until the master gives up.
const HELD: Cycles = 1 << 48;

/// Time from the chip's supply to the first sampling.
const START_UP: Cycles = milliseconds(150);
/// Sampling period: 93 periods of a 31,250 Hz timer, as a fraction in master clock cycles.
const TICK_NUMERATOR: Cycles = 93 * 336_384_000;
const TICK_DENOMINATOR: Cycles = 31_250 * 7;
/// When the results of ports 1 to 4, buttons and battery are stored, after the tick began. The
/// conversions alone take 78 us a port and 104 us each of the others; the rest is chosen so that
/// the whole takes the 0.6 to 0.7 ms of the real loop.
const STORED: [Cycles; 6] = [
    microseconds(98),
    microseconds(196),
    microseconds(294),
    microseconds(392),
    microseconds(516),
    microseconds(640),
];
/// One pass of the main loop outside sampling, after which a command takes effect (chosen).
const LOOP_PASS: Cycles = microseconds(20);
/// Ticks without handshake until the brick switches off: about 298 s.
const TICKS_WITHOUT_HANDSHAKE: u64 = 100_000;
const POWER_DOWN_DELAY: Cycles = milliseconds(10);
const LOW_BATTERY_DELAY: Cycles = milliseconds(1000);
const BOOT_MONITOR_DELAY: Cycles = milliseconds(100);
const SILENCE: Cycles = milliseconds(2000);
const CLICK_PERIOD: Cycles = milliseconds(500);

/// What the co-processor can measure now.
#[derive(Clone, Copy, Debug)]
pub struct Measurable {
    /// Counts of the sensor ports.
    pub ports: [u16; 4],
    /// The button word.
    pub buttons: u16,
    /// The battery word.
    pub battery: u16,
    /// The battery does not suffice to start.
    pub battery_too_low: bool,
}

/// The co-processor.
#[derive(Clone, Debug)]
pub struct Coprocessor {
    /// When sampling begins.
    on_at: Cycles,
    started: bool,
    tick: u64,
    /// When the sampling of this tick begins.
    tick_at: Cycles,
    /// Index into [`STORED`] of the next result of this tick.
    stage: usize,
    readings: [u16; 6],
    incoming: Incoming,
    outgoing: Outgoing,
    handshake: bool,
    in_force: Command,
    /// States of the bridges by that command.
    drives: [MotorDrive; 3],
    /// A command accepted but not yet in force, and when it will be.
    accepted: Option<(Cycles, Command)>,
    last_frame_at: Cycles,
    next_click_at: Cycles,
    power_off: Option<(Cycles, PowerOffReason)>,
    powered: bool,
    /// When something of this is due next.
    next_at: Cycles,
    /// Status frames that will have a wrong checksum.
    corrupt_checksums: u16,
    holds_bus: bool,
    stretch_cycles: Cycles,
}

impl Coprocessor {
    /// The chip's supply comes on at cycle 0; sampling begins after the start-up time and
    /// `phase` cycles.
    pub fn new(phase: Cycles) -> Self {
        let in_force = Command::at_reset();
        Self {
            on_at: START_UP + phase,
            started: false,
            tick: 0,
            tick_at: START_UP + phase,
            stage: 0,
            readings: [0; 6],
            incoming: Incoming::default(),
            outgoing: Outgoing::default(),
            handshake: false,
            in_force,
            drives: drives(&in_force),
            accepted: None,
            last_frame_at: 0,
            next_click_at: NEVER,
            power_off: None,
            powered: true,
            next_at: START_UP + phase + STORED[0],
            corrupt_checksums: 0,
            holds_bus: false,
            stretch_cycles: STRETCH_CYCLES,
        }
    }

    /// Fault: the next `count` status frames have a wrong checksum.
    pub fn corrupt_checksums(&mut self, count: u16) {
        self.corrupt_checksums = count;
    }

    /// Fault: it holds SCL after each byte, for good.
    pub fn hold_bus(&mut self, held: bool) {
        self.holds_bus = held;
    }

    pub const fn holds_bus(&self) -> bool {
        self.holds_bus
    }

    /// How long it holds SCL after a byte from now on.
    pub fn set_stretch(&mut self, cycles: Cycles) {
        self.stretch_cycles = cycles;
    }

    /// How long it holds SCL after a byte.
    pub const fn stretch_cycles(&self) -> Cycles {
        if self.holds_bus {
            HELD
        } else {
            self.stretch_cycles
        }
    }

    /// The co-processor has been sampling for a while already when the run begins: its tick is
    /// `phase` cycles away.
    pub fn skip_start_up(&mut self, now: Cycles, phase: Cycles, measurable: Measurable) {
        self.on_at = now + phase;
        self.begin_tick(0);
        self.started = true;
        self.readings = readings(measurable);
        self.plan();
    }

    /// The chip's supply comes back after a power cycle; faults from outside stay.
    pub fn restart(&mut self, now: Cycles, phase: Cycles) {
        *self = Self {
            on_at: now + START_UP + phase,
            tick_at: now + START_UP + phase,
            last_frame_at: now,
            corrupt_checksums: self.corrupt_checksums,
            holds_bus: self.holds_bus,
            stretch_cycles: self.stretch_cycles,
            ..Self::new(phase)
        };
        self.plan();
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

    /// 9 V supply of sensor port `index`, 0 to 3.
    pub const fn sensor_supply(&self, index: usize) -> SensorSupply {
        self.in_force.sensor_supply(index)
    }

    /// 9 V supplies of the sensor ports.
    pub fn sensor_supplies(&self) -> [SensorSupply; 4] {
        [0, 1, 2, 3].map(|index| self.sensor_supply(index))
    }

    /// States of the bridges.
    pub const fn drives(&self) -> &[MotorDrive; 3] {
        &self.drives
    }

    /// The chip addresses the co-processor. A read takes the frame to be sent now.
    pub fn start(&mut self, read: bool) {
        if read {
            self.outgoing = Outgoing::new(self.readings);
            if self.corrupt_checksums > 0 {
                self.corrupt_checksums -= 1;
                self.outgoing.corrupt_checksum();
            }
        } else {
            self.incoming = Incoming::default();
        }
    }

    /// A byte to the co-processor.
    pub fn write(&mut self, now: Cycles, byte: u8) {
        match self.incoming.push(byte) {
            None => {}
            Some(Received::Handshake) => self.handshake = true,
            Some(Received::Command(command, request)) => {
                self.accept(now, command);
                match request {
                    PowerRequest::StayOn => {}
                    PowerRequest::PowerDown => {
                        self.switch_off(now + POWER_DOWN_DELAY, PowerOffReason::Requested);
                    }
                    PowerRequest::BootMonitor => {
                        self.switch_off(now + BOOT_MONITOR_DELAY, PowerOffReason::BootMonitor);
                    }
                }
            }
        }
        self.plan();
    }

    /// The next byte from the co-processor.
    pub fn read(&mut self) -> u8 {
        self.outgoing.next_byte()
    }

    pub const fn next_event(&self) -> Cycles {
        self.next_at
    }

    /// Works out again when something is due.
    fn plan(&mut self) {
        let command = self.accepted.map_or(NEVER, |(at, _)| at);
        let off = self.power_off.map_or(NEVER, |(at, _)| at);
        let first = self
            .stage_at()
            .min(command)
            .min(off)
            .min(self.next_click_at);
        self.next_at = if self.powered { first } else { NEVER };
    }

    /// Serves what is due at `now`: commands, then results, then clicks, then the supply.
    pub fn advance(&mut self, now: Cycles, measurable: Measurable, log: &mut EventLog) {
        if !self.powered {
            return;
        }
        if let Some((_, command)) = self.accepted.filter(|&(at, _)| at <= now) {
            self.accepted = None;
            self.apply(now, command, log);
        }
        if self.stage_at() <= now {
            self.store(now, measurable);
        }
        if self.next_click_at <= now {
            self.next_click_at += CLICK_PERIOD;
            log.add(now, BoardEventKind::Click);
        }
        if let Some((_, reason)) = self.power_off.filter(|&(at, _)| at <= now) {
            self.turn_off(now, reason, log);
        }
        self.plan();
    }

    /// A frequency that the timers do not serve leaves the last one.
    fn accept(&mut self, now: Cycles, mut command: Command) {
        self.last_frame_at = now;
        self.next_click_at = NEVER;
        if !(1..=32).contains(&command.frequency_khz) {
            let last = self.accepted.map_or(self.in_force, |(_, command)| command);
            command.frequency_khz = last.frequency_khz;
        }
        self.accepted = Some((self.effective_at(now), command));
    }

    /// Commands wait for the start and for the end of the sampling that runs.
    fn effective_at(&self, now: Cycles) -> Cycles {
        if !self.started && now < self.on_at {
            return self.on_at + STORED[5];
        }
        if self.tick_at <= now {
            self.tick_at + STORED[5]
        } else {
            now + LOOP_PASS
        }
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

    fn switch_off(&mut self, at: Cycles, reason: PowerOffReason) {
        if self.power_off.is_none() {
            self.power_off = Some((at, reason));
        }
    }

    fn begin_tick(&mut self, tick: u64) {
        self.tick = tick;
        self.tick_at = self.on_at + tick * TICK_NUMERATOR / TICK_DENOMINATOR;
    }

    fn stage_at(&self) -> Cycles {
        self.tick_at + STORED[self.stage]
    }

    fn store(&mut self, now: Cycles, measurable: Measurable) {
        self.readings[self.stage] = readings(measurable)[self.stage];
        self.stage += 1;
        if self.stage < STORED.len() {
            return;
        }
        self.stage = 0;
        self.begin_tick(self.tick + 1);
        self.check_start(now, measurable);
        self.check_silence(now);
    }

    fn check_start(&mut self, now: Cycles, measurable: Measurable) {
        if !self.started && measurable.battery_too_low {
            self.switch_off(now + LOW_BATTERY_DELAY, PowerOffReason::BatteryLow);
        }
        self.started = true;
        if self.tick == TICKS_WITHOUT_HANDSHAKE && !self.handshake {
            self.switch_off(now + POWER_DOWN_DELAY, PowerOffReason::NoHandshake);
        }
    }

    fn check_silence(&mut self, now: Cycles) {
        if self.next_click_at == NEVER && now >= self.last_frame_at + SILENCE {
            self.next_click_at = now + CLICK_PERIOD;
        }
    }
}

fn drives(command: &Command) -> [MotorDrive; 3] {
    command
        .motors
        .map(|motor| pwm::drive(motor, command.frequency_khz))
}

const fn readings(measurable: Measurable) -> [u16; 6] {
    let [one, two, three, four] = measurable.ports;
    [
        one,
        two,
        three,
        four,
        measurable.buttons,
        measurable.battery,
    ]
}
