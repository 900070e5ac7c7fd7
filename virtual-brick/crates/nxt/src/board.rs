// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The board as the chip sees it: pins, buses, analogue inputs, time.
//!
//! Events at the same cycle are served in this order: encoder edges (motor A first), step of the
//! plant, co-processor, sensors, Bluetooth, USB, report of the display. An input acts at once on
//! what the co-processor samples, and on the plant from its next step.

mod advance;

use at91sam7s::board::{
    Board, Character, ChipEvent, Cycles, PinLevels, PinOutputs, SerialPort, SoundBits, TwiReply,
    UsbAnswer, UsbSignal,
};
use plant::{MotorDrive, ParameterError, RobotParameters};

use advance::Slow;

use crate::battery::{Battery, BROWN_OUT_VOLTAGE, LOST_VOLTAGE};
use crate::bench::{Bench, BusEvent, ModuleTurn, TwiScript, TwiTurn};
use crate::bluetooth::{Bluetooth, ChipLines};
use crate::boot_monitor::BootMonitor;
use crate::buttons::Buttons;
use crate::configuration::BoardConfiguration;
use crate::coprocessor::{Coprocessor, Measurable, ADDRESS};
use crate::display::Display;
use crate::event::{BoardEvent, BoardEventKind, BoardFault, EventLog};
use crate::inputs::{self, InputDescription, InputError, Target};
use crate::measured::Measured;
use crate::physics::Physics;
use crate::ports::{Ports, PORT_LINES};
use crate::rs485::Rs485Line;
use crate::sound::{Recording, SAMPLE_CYCLES};
use crate::time::{microseconds, milliseconds, NEVER};
use crate::usb::{UsbHost, CABLE_COUNT};

const DISPLAY_SELECT: u32 = 1 << 10;
const DISPLAY_DATA: u32 = 1 << 12;
const DISPLAY_FRAME_BITS: u8 = 8;
/// Lines that the brick pulls up: two-wire bus (PA3, PA4) and the digital lines of the ports.
const PULLED_UP: u32 = 1 << 3 | BUS_CLOCK | PORT_LINES;
const BUS_CLOCK: u32 = 1 << 4;
/// Analogue channels of the ports' second digital lines: (channel, pin).
const ANALOGUE_PINS: [(u8, u32); 4] = [(1, 18), (2, 19), (3, 20), (7, 2)];
const ANALOGUE_FULL_SCALE: u16 = 1023;
/// Analogue channel on which the Bluetooth module tells its mode.
const MODULE_MODE_CHANNEL: u8 = 6;
/// Analogue channel that senses the 5 V of the USB cable.
const CABLE_CHANNEL: u8 = 4;
/// Pull-up of the USB, on while the pin is low.
const USB_PULL_UP: u32 = 1 << 16;
const MODULE_RESET: u32 = 1 << 11;
const MODULE_RXD: u32 = 1 << 21;
const MODULE_RTS: u32 = 1 << 24;
const MODULE_CTS: u32 = 1 << 25;
const MODULE_STREAM_WANTED: u32 = 1 << 27;
/// Direction of port 4's RS485 transceiver: high while the brick drives the line.
const RS485_DRIVES: u32 = 1 << 7;
/// The picture is looked at when nothing was sent for this long ...
const DISPLAY_PAUSE: Cycles = milliseconds(2);
/// ... or that long after the first byte.
const DISPLAY_PERIOD: Cycles = milliseconds(20);
/// Sampling period of the co-processor, within which its phase lies.
const TICK: u64 = microseconds(2_976);

/// Everything that is soldered or plugged around the chip.
#[derive(Clone, Debug)]
pub struct NxtBoard {
    coprocessor: Coprocessor,
    display: Display,
    refresh: Refresh,
    buttons: Buttons,
    battery: Battery,
    bluetooth: Bluetooth,
    usb: UsbHost,
    boot_monitor: Option<BootMonitor>,
    ports: Ports,
    rs485: Rs485Line,
    bench: Bench,
    physics: Physics,
    measured: Measured,
    inputs: Vec<InputDescription>,
    outputs: PinOutputs,
    addressed: bool,
    /// When the co-processor's readings were asked for first.
    first_readings_cycles: Option<Cycles>,
    phase: Cycles,
    sound: Recording,
    log: EventLog,
    /// What [`Self::slow_parts`] tells, as long as nobody has reached for these parts since.
    slow_next: Option<Slow>,
    /// One of them was advanced since the chip took what they brought.
    slow_advanced: bool,
}

/// When the picture is to be looked at.
#[derive(Clone, Copy, Debug)]
struct Refresh {
    first_at: Option<Cycles>,
    due_at: Cycles,
    digest: u64,
}

impl NxtBoard {
    /// The chip's supply comes on at cycle 0. The seed gives what no program can know: where the
    /// slotted wheels of the encoders stand and when the co-processor's tick comes.
    ///
    /// # Errors
    /// The first parameter that is not accepted.
    pub fn new(
        configuration: &BoardConfiguration,
        robot: &RobotParameters,
        seed: u64,
    ) -> Result<Self, ParameterError> {
        configuration.check()?;
        let mut random = Random(seed);
        let phases = [0; 3].map(|_| random.next(4 << 20) as f64 / f64::from(1 << 20));
        let phase = random.next(TICK);
        let ports = Ports::new(&configuration.sensors);
        let display = Display::new();
        let digest = display.picture().digest();
        Ok(Self {
            coprocessor: Coprocessor::new(phase),
            display,
            refresh: Refresh {
                first_at: None,
                due_at: NEVER,
                digest,
            },
            buttons: Buttons::default(),
            battery: Battery::new(configuration.battery.clone()),
            bluetooth: Bluetooth::new(&configuration.bluetooth),
            usb: UsbHost::default(),
            boot_monitor: None,
            physics: Physics::new(robot, phases)?,
            measured: Measured::new(&configuration.sensors, robot),
            inputs: inputs::inputs(ports.sensors(), robot),
            ports,
            rs485: Rs485Line::default(),
            bench: Bench::default(),
            outputs: PinOutputs::default(),
            addressed: false,
            first_readings_cycles: None,
            phase,
            sound: Recording::default(),
            log: EventLog::default(),
            slow_next: None,
            slow_advanced: false,
        })
    }

    /// The brick has been on for a while when the run begins, as when the boot monitor has loaded
    /// a program: the co-processor samples already.
    pub fn skip_coprocessor_start_up(&mut self, now: Cycles) {
        let measurable = self.measurable();
        self.coprocessor.skip_start_up(now, self.phase, measurable);
        self.bluetooth.skip_start_up(now);
        self.slow_next = None;
    }

    /// When the co-processor's readings were asked for first.
    #[must_use]
    pub const fn first_readings_cycles(&self) -> Option<Cycles> {
        self.first_readings_cycles
    }

    /// The Bluetooth module.
    #[must_use]
    pub const fn bluetooth(&self) -> &Bluetooth {
        &self.bluetooth
    }

    /// The Bluetooth module, to bring devices into its range and to speak with it.
    pub fn bluetooth_mut(&mut self) -> &mut Bluetooth {
        self.slow_next = None;
        &mut self.bluetooth
    }

    /// The USB host at the end of the cable.
    #[must_use]
    pub const fn usb(&self) -> &UsbHost {
        &self.usb
    }

    /// The USB host, to give it work.
    pub fn usb_mut(&mut self) -> &mut UsbHost {
        self.slow_next = None;
        &mut self.usb
    }

    /// The boot monitor's end of the USB, while it has it.
    #[must_use]
    pub const fn boot_monitor(&self) -> Option<&BootMonitor> {
        self.boot_monitor.as_ref()
    }

    /// The boot monitor's end of the USB, to take commands and to answer them.
    pub fn boot_monitor_mut(&mut self) -> Option<&mut BootMonitor> {
        self.boot_monitor.as_mut()
    }

    /// The far end of port 4's RS485 line.
    pub fn rs485_mut(&mut self) -> &mut Rs485Line {
        self.slow_next = None;
        &mut self.rs485
    }

    /// Records from now on what passes on the chip's buses.
    pub fn record_buses(&mut self) {
        self.bench.record();
    }

    /// What passed on the buses since the last call, each with its cycle.
    pub fn take_bus_log(&mut self) -> Vec<(Cycles, BusEvent)> {
        self.bench.take_log()
    }

    /// A script answers on the two-wire bus in place of the co-processor.
    pub fn script_twi(&mut self, turns: Vec<TwiTurn>) {
        self.bench.twi = Some(TwiScript::new(turns));
    }

    /// The counts that the chip's converter gets from a channel, the last one for good; none of
    /// them lets the board give them again.
    pub fn script_converter(&mut self, channel: u8, counts: &[u16]) {
        self.bench.script_converter(channel, counts);
    }

    /// A script speaks in place of the Bluetooth module.
    pub fn script_module(&mut self, now: Cycles, turns: Vec<ModuleTurn>) {
        self.slow_next = None;
        self.bench.script_module(now, turns);
    }

    /// The chip comes back from a power cycle in its boot monitor, which takes the USB until a
    /// program switches the pull-up off.
    pub fn enter_boot_monitor(&mut self, now: Cycles) {
        self.coprocessor.restart(now, self.phase);
        self.switch_supplies(now);
        self.boot_monitor = Some(BootMonitor::default());
        self.slow_next = None;
        self.usb.set_pull_up(true);
    }

    /// The display.
    #[must_use]
    pub const fn display(&self) -> &Display {
        &self.display
    }

    /// The co-processor's command for a motor that is in force.
    #[must_use]
    pub const fn motor_command(&self, motor: plant::MotorPort) -> crate::MotorCommand {
        self.coprocessor.motor_command(motor)
    }

    /// 9 V supply of sensor port 1 to 4 that is in force; nothing for another number.
    #[must_use]
    pub fn sensor_supply(&self, port: usize) -> Option<crate::SensorSupply> {
        (1..=4)
            .contains(&port)
            .then(|| self.coprocessor.sensor_supply(port - 1))
    }

    /// Sound played from one cycle to another as signed 16-bit samples of
    /// [`crate::SOUND_SAMPLE_CYCLES`] cycles.
    #[must_use]
    pub fn sound(&self, from: Cycles, to: Cycles) -> Vec<i16> {
        self.sound.samples(from / SAMPLE_CYCLES, to / SAMPLE_CYCLES)
    }

    /// Some event happened since the last call of [`Self::take_events`].
    #[must_use]
    #[inline]
    pub fn has_events(&self) -> bool {
        !self.log.is_empty()
    }

    /// Events since the last call, in the order in which they happened, in place of what `taken`
    /// holds.
    #[inline]
    pub fn take_events(&mut self, taken: &mut Vec<BoardEvent>) {
        self.log.take(taken);
    }

    /// The inputs that this configuration has.
    #[must_use]
    pub fn inputs(&self) -> &[InputDescription] {
        &self.inputs
    }

    /// Tells whether [`Self::set_input`] would take this.
    ///
    /// # Errors
    /// The name is not one of [`Self::inputs`] or the value is out of its range.
    pub fn check_input(&self, name: &str, value: f64) -> Result<(), InputError> {
        inputs::find(&self.inputs, name, value).map(|_| ())
    }

    /// Presses, turns, loads or sets something at `now`, up to which the board is advanced.
    ///
    /// # Errors
    /// The name is not one of [`Self::inputs`] or the value is out of its range.
    pub fn set_input(&mut self, now: Cycles, name: &str, value: f64) -> Result<(), InputError> {
        let target = inputs::find(&self.inputs, name, value)?;
        self.advance(now);
        self.slow_next = None;
        match target {
            Target::Sensor(index, quantity) => self.ports.set_input(index, quantity, value),
            Target::Plugged(index) => self.ports.set_plugged(now, index, value != 0.0),
            Target::Short(index, line) => self.ports.set_short(now, index, line, value != 0.0),
            Target::WrongSums => self.coprocessor.spoil_sums(value as u16),
            Target::UsbCable => self.usb.set_plugged(now, value != 0.0),
            Target::BusStuck => self.coprocessor.hold_bus(value != 0.0),
            Target::Button(button) => self.buttons.set(button, value != 0.0),
            Target::BatteryVoltage => {
                self.battery.set_voltage(value);
                self.look_at_battery(now);
            }
            Target::HandAngle(port) => {
                if let Some(motor) = self.physics.motor_mut(port) {
                    motor.set_hand_angle(value);
                }
            }
            Target::Held => self.physics.robot_mut().set_held(value != 0.0),
            Target::Push => self.physics.robot_mut().set_push(value),
            Target::LoadTorque(port) => {
                if let Some(motor) = self.physics.motor_mut(port) {
                    motor.set_load_torque(value);
                }
            }
        }
        Ok(())
    }

    pub(crate) const fn physics(&self) -> &Physics {
        &self.physics
    }

    pub(crate) const fn measured(&self) -> &Measured {
        &self.measured
    }

    pub(crate) const fn drives(&self) -> &[MotorDrive; 3] {
        self.coprocessor.drives()
    }

    pub(crate) fn battery_voltage(&self) -> f64 {
        self.battery.voltage()
    }

    fn measurable(&self) -> Measurable {
        Measurable {
            ports: self.ports.raw(),
            buttons: self.buttons.word(),
            battery: self.battery.word(),
            battery_too_low: self.battery.refuses_start(),
        }
    }

    fn driven(&self, pin: u32, level: bool) -> bool {
        self.outputs.driven & pin != 0 && (self.outputs.level & pin != 0) == level
    }

    /// The display hears frames while PA10 is low, as an output or as the SPI's own select line.
    fn display_selected(&self, selected: u32) -> bool {
        selected & DISPLAY_SELECT != 0 || self.driven(DISPLAY_SELECT, false)
    }

    fn display_frame(&mut self, now: Cycles, byte: u8) {
        if self.driven(DISPLAY_DATA, true) {
            self.display.write_data(byte);
        } else if let Err(fault) = self.display.write_command(byte) {
            self.log.fault(now, fault);
        }
        self.slow_next = None;
        let first_at = *self.refresh.first_at.get_or_insert(now);
        self.refresh.due_at = (now + DISPLAY_PAUSE).min(first_at + DISPLAY_PERIOD);
    }

    fn report_picture(&mut self, now: Cycles) {
        let digest = self.display.picture().digest();
        if digest != self.refresh.digest {
            self.log.add(now, BoardEventKind::DisplayChanged(digest));
        }
        self.refresh = Refresh {
            first_at: None,
            due_at: NEVER,
            digest,
        };
    }
}

impl Board for NxtBoard {
    fn outputs_changed(&mut self, now: Cycles, outputs: PinOutputs) {
        self.outputs = outputs;
        self.slow_next = None;
        self.ports.outputs_changed(now, outputs);
        let high = |pin: u32| {
            let pulled = outputs.driven & pin == 0 && outputs.pull_up & pin != 0;
            pulled || outputs.driven & outputs.level & pin != 0
        };
        let lines = ChipLines {
            reset: !high(MODULE_RESET),
            stream_wanted: high(MODULE_STREAM_WANTED),
            ready: !high(MODULE_RTS),
        };
        self.bluetooth.lines_changed(now, lines);
        if self.driven(USB_PULL_UP, true) {
            self.boot_monitor = None;
        }
        let on = self.boot_monitor.is_some() || self.driven(USB_PULL_UP, false);
        self.usb.set_pull_up(on);
    }

    fn pin_levels(&self) -> PinLevels {
        let (driven, level) = self.physics.pins();
        let held_back = if self.bluetooth.holds_back() {
            MODULE_CTS
        } else {
            0
        };
        PinLevels {
            driven: driven | PULLED_UP | MODULE_RXD | MODULE_CTS,
            level: (level | PULLED_UP | MODULE_RXD | held_back)
                & !self.ports.low()
                & !self.bus_low(),
        }
    }

    fn twi_start(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        let reply = match &mut self.bench.twi {
            Some(script) => script.start(),
            None => self.address_coprocessor(now, address, read),
        };
        let event = BusEvent::TwiStart {
            byte: address << 1 | u8::from(read),
            acknowledged: reply.acknowledged,
        };
        self.bench.note(now, event);
        reply
    }

    fn twi_write(&mut self, now: Cycles, byte: u8) -> TwiReply {
        let reply = match &mut self.bench.twi {
            Some(script) => script.written(),
            None => {
                if self.addressed {
                    self.coprocessor.write(now, byte);
                }
                self.reply()
            }
        };
        let acknowledged = reply.acknowledged;
        let event = BusEvent::TwiWritten { byte, acknowledged };
        self.bench.note(now, event);
        reply
    }

    fn twi_read(&mut self, now: Cycles) -> (u8, Cycles) {
        let (byte, stretch_cycles) = match &mut self.bench.twi {
            Some(script) => script.read(),
            None if self.addressed => (self.coprocessor.read(), self.coprocessor.stretch_cycles()),
            None => (0xFF, 0),
        };
        self.bench.note(now, BusEvent::TwiRead(byte));
        (byte, stretch_cycles)
    }

    fn twi_stop(&mut self, now: Cycles) {
        self.addressed = false;
        self.bench.note(now, BusEvent::TwiStop);
    }

    fn spi_frame(&mut self, now: Cycles, selected: u32, frame: u16, bits: u8) -> u16 {
        if self.display_selected(selected) {
            let data = self.driven(DISPLAY_DATA, true);
            self.bench.note(now, BusEvent::Display { data, frame });
            match u8::try_from(frame) {
                Ok(byte) if bits == DISPLAY_FRAME_BITS => self.display_frame(now, byte),
                _ => self.log.fault(now, BoardFault::DisplayFrame { bits }),
            }
        }
        0
    }

    fn analogue_input(&mut self, now: Cycles, channel: u8) -> u16 {
        let scripted = self.bench.count(channel);
        let count = scripted.unwrap_or_else(|| self.voltage_at(now, channel));
        self.bench.note(now, BusEvent::Converted { channel, count });
        count
    }

    fn flash_command(&mut self, now: Cycles, command: u8, page: u16) {
        self.bench.note(now, BusEvent::Flash { command, page });
    }

    fn supply_is_low(&self) -> bool {
        self.battery.voltage() < BROWN_OUT_VOLTAGE
    }

    fn next_event(&self) -> Cycles {
        self.next_time()
    }

    fn advance(&mut self, now: Cycles) {
        self.advance_to(now);
    }

    fn has_received(&mut self, now: Cycles) -> bool {
        self.may_bring(now)
    }

    fn powered(&self) -> bool {
        self.coprocessor.powered()
    }

    fn sound_bits(&mut self, now: Cycles, sound: SoundBits) {
        self.sound.add(now, sound);
    }

    fn serial_sent(&mut self, now: Cycles, port: SerialPort, character: Character) {
        self.slow_next = None;
        let event = BusEvent::Sent(port, character.data as u8);
        self.bench.note(now, event);
        match (port, self.bench.module()) {
            (SerialPort::Usart0, _) => self.rs485.sent(now, character),
            (SerialPort::Usart1, Some(script)) => script.hear(now),
            (SerialPort::Usart1, None) => {
                self.bluetooth.character(now, character, &mut self.log);
            }
            (SerialPort::DebugUnit, _) => {}
        }
    }

    fn serial_received(&mut self, now: Cycles, port: SerialPort) -> Option<Character> {
        let drives = self.driven(RS485_DRIVES, true);
        let character = match (port, self.bench.module()) {
            (SerialPort::Usart0, _) => self.rs485.take(now, drives),
            (SerialPort::Usart1, Some(script)) => script.take(now),
            (SerialPort::Usart1, None) => self.bluetooth.take_character(),
            (SerialPort::DebugUnit, _) => None,
        }?;
        self.slow_next = None;
        let event = BusEvent::Received(port, character.data as u8);
        self.bench.note(now, event);
        Some(character)
    }

    fn usb_signal(&mut self, now: Cycles) -> Option<UsbSignal> {
        let Some(monitor) = &mut self.boot_monitor else {
            let signal = self.usb.signal(now)?;
            self.slow_next = None;
            return Some(signal);
        };
        self.slow_next = None;
        while let Some(signal) = self.usb.signal(now) {
            if let Some(answer) = monitor.signal(signal) {
                self.usb.answer(now, answer);
            }
        }
        None
    }

    fn usb_answer(&mut self, now: Cycles, answer: UsbAnswer) {
        self.slow_next = None;
        self.usb.answer(now, answer);
    }

    fn wants_attention(&self) -> bool {
        self.log.ends()
    }

    fn observe(&mut self, now: Cycles, event: ChipEvent) {
        self.log.add(now, BoardEventKind::Chip(event));
    }
}

impl NxtBoard {
    /// A battery that is too low for everything ends the run.
    fn look_at_battery(&mut self, now: Cycles) {
        if self.battery.voltage() < LOST_VOLTAGE {
            self.coprocessor.lose_supply(now, &mut self.log);
            self.switch_supplies(now);
        }
    }

    fn address_coprocessor(&mut self, now: Cycles, address: u8, read: bool) -> TwiReply {
        self.addressed = address == ADDRESS && self.powered();
        if self.addressed {
            self.coprocessor.start(read);
            if read {
                self.first_readings_cycles.get_or_insert(now);
            }
        }
        self.reply()
    }

    /// Counts of the chip's converter on a channel.
    fn voltage_at(&self, now: Cycles, channel: u8) -> u16 {
        match channel {
            MODULE_MODE_CHANNEL if self.bluetooth.stream_mode() => return ANALOGUE_FULL_SCALE,
            CABLE_CHANNEL if self.usb.plugged() => return CABLE_COUNT,
            _ => {}
        }
        let line = ANALOGUE_PINS
            .into_iter()
            .position(|(number, _)| number == channel);
        line.map_or(0, |index| self.port_voltage(now, index))
    }

    const fn reply(&self) -> TwiReply {
        let stretch_cycles = if self.addressed {
            self.coprocessor.stretch_cycles()
        } else {
            0
        };
        TwiReply {
            acknowledged: self.addressed,
            stretch_cycles,
        }
    }

    /// Counts on the second digital line of a port: a sensor's voltage, or a level.
    fn port_voltage(&self, now: Cycles, index: usize) -> u16 {
        let level = if self.is_low(1 << ANALOGUE_PINS[index].1) {
            0
        } else {
            ANALOGUE_FULL_SCALE
        };
        self.ports.analogue(now, index).unwrap_or(level)
    }

    /// The pin is driven low from either side.
    fn is_low(&self, pin: u32) -> bool {
        self.driven(pin, false) || self.outputs.driven & pin == 0 && self.ports.low() & pin != 0
    }

    /// The clock of the two-wire bus while the co-processor holds it.
    const fn bus_low(&self) -> u32 {
        if self.coprocessor.holds_bus() {
            BUS_CLOCK
        } else {
            0
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    /// A number below `bound`.
    fn next(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ mixed >> 31) % bound
    }
}
