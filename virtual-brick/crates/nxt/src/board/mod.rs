// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Everything around the chip, in the order of time.
//!
//! Events at the same cycle are served in this order: encoder edges (motor A first), step of the
//! plant, co-processor, sensors, Bluetooth, USB, report of the display. An input acts at once on
//! what the co-processor samples, and on the plant from its next step.

mod devices;
mod interface;
mod refresh;

use at91sam7s::board::{Cycles, PinOutputs};
use plant::{MotorDrive, ParameterError, RobotParameters};

use devices::{Devices, TimedDevices};
use refresh::Refresh;

use crate::battery::{Battery, LOST_VOLTAGE};
use crate::bluetooth::Bluetooth;
use crate::boot_monitor::BootMonitor;
use crate::bus_log::{BusEvent, BusLog};
use crate::buttons::{Button, Buttons};
use crate::configuration::BoardConfiguration;
use crate::coprocessor::{Coprocessor, CoprocessorTiming, Measurable};
use crate::display::Display;
use crate::event::{BoardEvent, EventLog};
use crate::inputs::{self, InputDescription, InputError, Target};
use crate::mounted_sensors::MountedSensors;
use crate::physics::Physics;
use crate::ports::Ports;
use crate::rs485::Rs485Line;
use crate::scripts::{ConverterScript, ModuleScript, ModuleTurn, TwiScript, TwiTurn};
use crate::sound::{Recording, SAMPLE_CYCLES};
use crate::time::microseconds;
use crate::usb::UsbHost;

/// Sampling period of the co-processor, within which its phase lies.
const TICK: u64 = microseconds(2_976);

/// Everything that is soldered or plugged around the chip.
#[derive(Clone, Debug)]
pub struct NxtBoard {
    coprocessor: Coprocessor,
    buttons: Buttons,
    battery: Battery,
    devices: TimedDevices,
    boot_monitor: Option<BootMonitor>,
    physics: Physics,
    mounted_sensors: MountedSensors,
    bus_log: BusLog,
    twi_script: Option<TwiScript>,
    converter_script: ConverterScript,
    inputs: Vec<InputDescription>,
    outputs: PinOutputs,
    addressed: bool,
    /// When the co-processor's readings were asked for first.
    first_readings_cycles: Option<Cycles>,
    phase: Cycles,
    sound: Recording,
    log: EventLog,
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
        let inputs = inputs::inputs(ports.sensors(), robot);
        let battery = Battery::new(configuration.battery.clone());
        let timing = CoprocessorTiming::nominal();
        Ok(Self {
            coprocessor: Coprocessor::new(timing, 0, phase, battery.word()),
            buttons: Buttons::default(),
            battery,
            devices: TimedDevices::new(Devices {
                refresh: Refresh::new(Display::new()),
                ports,
                bluetooth: Bluetooth::new(&configuration.bluetooth),
                usb: UsbHost::default(),
                rs485: Rs485Line::default(),
                module_script: None,
            }),
            boot_monitor: None,
            physics: Physics::new(robot, phases)?,
            mounted_sensors: MountedSensors::new(&configuration.sensors, robot),
            inputs,
            bus_log: BusLog::default(),
            twi_script: None,
            converter_script: ConverterScript::default(),
            outputs: PinOutputs::default(),
            addressed: false,
            first_readings_cycles: None,
            phase,
            sound: Recording::default(),
            log: EventLog::default(),
        })
    }

    /// The brick has been on for a while when the run begins, as when the boot monitor has loaded
    /// a program: the co-processor samples already.
    pub fn skip_coprocessor_start_up(&mut self, now: Cycles) {
        let measurable = self.measurable();
        self.coprocessor.skip_start_up(now, self.phase, measurable);
        self.switch_supplies(now);
        self.devices.change().bluetooth.skip_start_up(now);
    }

    /// How long the co-processor's program takes from now on.
    pub fn set_coprocessor_timing(&mut self, timing: CoprocessorTiming) {
        self.coprocessor.set_timing(timing);
    }

    /// When the co-processor's readings were asked for first.
    #[must_use]
    pub const fn first_readings_cycles(&self) -> Option<Cycles> {
        self.first_readings_cycles
    }

    /// The Bluetooth module.
    #[must_use]
    pub const fn bluetooth(&self) -> &Bluetooth {
        &self.devices.get().bluetooth
    }

    /// The Bluetooth module, to bring devices into its range and to speak with it.
    pub fn bluetooth_mut(&mut self) -> &mut Bluetooth {
        &mut self.devices.change().bluetooth
    }

    /// The USB host at the end of the cable.
    #[must_use]
    pub const fn usb(&self) -> &UsbHost {
        &self.devices.get().usb
    }

    /// The USB host, to give it work.
    pub fn usb_mut(&mut self) -> &mut UsbHost {
        &mut self.devices.change().usb
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
        &mut self.devices.change().rs485
    }

    /// Records from now on what passes on the chip's buses.
    pub fn record_buses(&mut self) {
        self.bus_log.record();
    }

    /// What passed on the buses since the last call, each with its cycle.
    pub fn take_bus_log(&mut self) -> Vec<(Cycles, BusEvent)> {
        self.bus_log.take()
    }

    /// A script answers on the two-wire bus in place of the co-processor.
    pub fn script_twi(&mut self, turns: Vec<TwiTurn>) {
        self.twi_script = Some(TwiScript::new(turns));
    }

    /// The counts that the chip's converter gets from a channel, the last one for good; none of
    /// them lets the board give them again.
    pub fn script_converter(&mut self, channel: u8, counts: &[u16]) {
        self.converter_script.set(channel, counts);
    }

    /// A script speaks in place of the Bluetooth module.
    pub fn script_module(&mut self, now: Cycles, turns: Vec<ModuleTurn>) {
        self.devices.change().module_script = Some(ModuleScript::new(now, turns));
    }

    /// The chip comes back from a power cycle in its boot monitor, which takes the USB until a
    /// program switches the pull-up off.
    pub fn enter_boot_monitor(&mut self, now: Cycles) {
        let battery = self.battery.word();
        self.coprocessor.restart(now, self.phase, battery);
        self.switch_supplies(now);
        self.boot_monitor = Some(BootMonitor::default());
        self.devices.change().usb.set_pull_up(now, true);
    }

    /// The display.
    #[must_use]
    pub const fn display(&self) -> &Display {
        self.devices.get().refresh.display()
    }

    /// The co-processor's command for a motor that is in force.
    #[must_use]
    pub const fn motor_command(&self, motor: plant::MotorPort) -> crate::MotorCommand {
        self.coprocessor.motor_command(motor)
    }

    /// 9 V supply of sensor port 1 to 4 that is in force; nothing for another number.
    #[must_use]
    pub fn sensor_supply(&self, port: usize) -> Option<crate::SensorSupply> {
        let index = port.checked_sub(1)?;
        self.coprocessor.sensor_supplies().get(index).copied()
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

    /// From now on, more events than this want attention at once: there is no room for them.
    #[inline]
    pub fn set_event_room(&mut self, events: usize) {
        self.log.set_room(events);
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
        self.advance_to(now);
        let devices = self.devices.change();
        let on = value != 0.0;
        match target {
            Target::Sensor(index, quantity) => devices.ports.set_input(index, quantity, value),
            Target::Plugged(index) => devices.ports.set_plugged(now, index, on),
            Target::Short(index, line) => devices.ports.set_short(now, index, line, on),
            Target::CorruptChecksums => self.coprocessor.faults.corrupt_checksums = value as u16,
            Target::TornWords => self.coprocessor.faults.torn_words = value as u16,
            Target::FramesRefused => self.coprocessor.faults.refuses_frames = on,
            Target::UsbCable => devices.usb.set_plugged(now, on),
            Target::BusStuck => self.coprocessor.faults.holds_bus = on,
            Target::Button(button) => self.buttons.set(button, on),
            Target::BatteryVoltage => {
                self.battery.set_voltage(value);
                self.check_battery(now);
            }
            Target::HandAngle(port) => {
                if let Some(motor) = self.physics.motor_mut(port) {
                    motor.set_hand_angle(value);
                }
            }
            Target::Held => self.physics.robot_mut().set_held(on),
            Target::Push => self.physics.robot_mut().set_push(value),
            Target::LoadTorque(port) => {
                if let Some(motor) = self.physics.motor_mut(port) {
                    motor.set_load_torque(value);
                }
            }
        }
        Ok(())
    }

    /// Whether a button is down.
    pub const fn button_held(&self, button: Button) -> bool {
        self.buttons.is_down(button)
    }

    pub(crate) const fn physics(&self) -> &Physics {
        &self.physics
    }

    pub(crate) const fn mounted_sensors(&self) -> &MountedSensors {
        &self.mounted_sensors
    }

    pub(crate) const fn drives(&self) -> &[MotorDrive; 3] {
        self.coprocessor.drives()
    }

    pub(crate) fn battery_voltage(&self) -> f64 {
        self.battery.voltage()
    }

    fn measurable(&self) -> Measurable {
        let [one, two, three, four] = self.devices.get().ports.raw();
        let (buttons, battery) = (self.buttons.word(), self.battery.word());
        Measurable {
            words: [one, two, three, four, buttons, battery],
            battery_too_low: self.battery.refuses_start(),
        }
    }

    /// When anything is due next.
    fn next_time(&self) -> Cycles {
        let times = self.devices.times();
        let next = self.next_physics_or_coprocessor();
        next.min(times.changes_at).min(times.sends_at)
    }

    /// When plant or co-processor change by themselves next: they do so often and are asked each
    /// time.
    fn next_physics_or_coprocessor(&self) -> Cycles {
        self.physics.next_event().min(self.coprocessor.next_event())
    }

    /// Serves what is due.
    fn advance_to(&mut self, now: Cycles) {
        loop {
            let changes_at = self.devices.times().changes_at;
            let at = self.next_physics_or_coprocessor().min(changes_at);
            if at > now {
                return;
            }
            if self.physics.next_event() <= at {
                self.advance_physics(at);
            }
            if self.coprocessor.next_event() <= at {
                self.advance_coprocessor(at);
            }
            self.devices.advance(at, &mut self.log);
        }
    }

    fn advance_physics(&mut self, at: Cycles) {
        let drives = self.coprocessor.drives();
        if self.physics.advance(at, drives, self.battery.voltage()) {
            let (_, robot, _) = self.physics.around(at);
            self.battery.set_current(robot.supply_current());
            if !self.mounted_sensors.is_empty() {
                let ports = &mut self.devices.change().ports;
                self.mounted_sensors.update(robot, ports);
            }
            self.check_battery(at);
        }
    }

    fn advance_coprocessor(&mut self, at: Cycles) {
        let measurable = self.measurable();
        self.coprocessor.advance(at, measurable, &mut self.log);
        self.switch_supplies(at);
    }

    /// The ports get the supplies that are in force.
    fn switch_supplies(&mut self, at: Cycles) {
        let supplies = self.coprocessor.sensor_supplies();
        if supplies != self.devices.get().ports.supplies() {
            self.devices.change().ports.set_supplies(at, supplies);
        }
    }

    /// A battery that is too low for everything ends the run.
    fn check_battery(&mut self, now: Cycles) {
        if self.battery.voltage() < LOST_VOLTAGE {
            self.coprocessor.lose_supply(now, &mut self.log);
            self.switch_supplies(now);
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

#[cfg(test)]
mod tests {
    use super::Random;

    /// The first numbers of `splitmix64.c` (Vigna 2015) with the state 1234567.
    #[test]
    fn random_numbers_are_those_of_splitmix64() {
        let mut random = Random(1_234_567);
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(published.map(|_| random.next(u64::MAX)), published);
    }
}
