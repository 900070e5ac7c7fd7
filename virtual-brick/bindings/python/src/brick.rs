// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The brick as a Python class.

use std::collections::btree_map::{BTreeMap, Entry};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use trace::{EventKind, NameSpace};
use virtual_brick_facade::{BrickError, Configuration, Image, ProfileWindow, ScalarKind, CLOCK_HZ};

use crate::debugging::Service;
use crate::errors::{raise, AddressError, ConfigurationError, ImageError, InputError};
use crate::transports::{self, Completion, Message};
use crate::values::{packed, packed_arrivals, packed_steps, Stop, Thread};

/// Python's signals (Ctrl-C) are polled this often: a tenth of a virtual second.
const SIGNAL_CHECK_CYCLES: u64 = 4_805_486;

/// Default of what carries bytes.
const NOTHING: &[u8] = &[];

/// A brick with its program, surroundings and record, and where variables lie that were read.
#[pyclass(module = "virtual_brick")]
pub(crate) struct VirtualBrick(virtual_brick_facade::VirtualBrick, Places);

type Places = BTreeMap<(String, Option<String>), (u32, ScalarKind)>;

/// The whole state of a brick at an instant.
#[pyclass(module = "virtual_brick", frozen)]
pub(crate) struct Snapshot(virtual_brick_facade::Snapshot);

/// Function, argument, callers, place in the source, cycles of call and return.
type TracedCall = (String, u32, Vec<String>, Vec<u32>, (u64, u64));

#[pymethods]
impl VirtualBrick {
    #[new]
    fn new(configuration_json: &str, elf: &[u8]) -> PyResult<Self> {
        let configuration =
            Configuration::from_json(configuration_json).map_err(raise::<ConfigurationError>)?;
        virtual_brick_facade::VirtualBrick::new(&configuration, elf)
            .map(|brick| Self(brick, Places::new()))
            .map_err(refused)
    }

    #[staticmethod]
    fn from_binary(configuration_json: &str, content: &[u8], address: u32) -> PyResult<Self> {
        let image = Image::binary(content, address).map_err(raise::<ImageError>)?;
        let configuration =
            Configuration::from_json(configuration_json).map_err(raise::<ConfigurationError>)?;
        virtual_brick_facade::VirtualBrick::with_image(&configuration, image)
            .map(|brick| Self(brick, Places::new()))
            .map_err(refused)
    }

    #[getter]
    fn cycles(&self) -> u64 {
        self.0.cycles()
    }

    #[getter]
    fn clock_hz(&self) -> (u64, u64) {
        CLOCK_HZ
    }

    #[getter]
    fn program_counter(&self) -> u32 {
        self.0.processor().next_instruction_address()
    }

    #[getter]
    fn threads_unobserved(&self) -> Option<&str> {
        self.0.threads_unobserved()
    }

    fn schedule_input(&mut self, at_cycles: u64, name: &str, value: f64) -> PyResult<()> {
        self.0
            .schedule_input(at_cycles, name, value)
            .map_err(raise::<InputError>)
    }

    fn enter_boot_monitor(&mut self) {
        self.0.enter_boot_monitor();
    }

    #[getter]
    fn in_boot_monitor(&self) -> bool {
        self.0.in_boot_monitor()
    }

    fn bluetooth_device(&self) -> (String, String, bool) {
        let device = self.0.bluetooth_device();
        let discoverable = self.0.bluetooth_discoverable();
        (
            device.address.to_string(),
            device.name.to_string(),
            discoverable,
        )
    }

    #[getter]
    fn bluetooth_waiting(&self) -> usize {
        self.0.bluetooth_waiting()
    }

    #[pyo3(signature = (at_cycles, peer, kind, data=NOTHING, name="", pin=None))]
    fn bluetooth_send(
        &mut self,
        at_cycles: u64,
        peer: &str,
        kind: &str,
        data: &[u8],
        name: &str,
        pin: Option<&str>,
    ) -> PyResult<()> {
        let message = transports::message_from_python(at_cycles, peer, kind, data, name, pin)?;
        self.0.bluetooth_send(message).map_err(raise::<InputError>)
    }

    fn bluetooth_sent<'py>(&mut self, py: Python<'py>) -> Vec<Message<'py>> {
        let sent = self.0.bluetooth_sent().into_iter();
        sent.map(|message| transports::message_to_python(py, message))
            .collect()
    }

    #[getter]
    fn usb_attached(&self) -> bool {
        self.0.usb_attached()
    }

    #[pyo3(signature = (
        at_cycles, number, timeout_cycles, kind, endpoint=0, data=NOTHING, length=0
    ))]
    #[allow(clippy::too_many_arguments)]
    fn usb_transfer(
        &mut self,
        at_cycles: u64,
        number: u64,
        timeout_cycles: u64,
        kind: &str,
        endpoint: u8,
        data: &[u8],
        length: usize,
    ) -> PyResult<()> {
        let times = (at_cycles, number, timeout_cycles);
        let transfer = transports::transfer(times, kind, endpoint, data, length)?;
        self.0.usb_transfer(transfer).map_err(raise::<InputError>)
    }

    fn usb_completed<'py>(&mut self, py: Python<'py>) -> Vec<Completion<'py>> {
        let completed = self.0.usb_completed().into_iter();
        completed
            .map(|one| transports::completion_to_python(py, one))
            .collect()
    }

    #[pyo3(signature = (at_cycles, data, bit_cycles=transports::RS485_BIT_CYCLES))]
    fn rs485_send(&mut self, at_cycles: u64, data: &[u8], bit_cycles: u64) -> PyResult<()> {
        self.0
            .rs485_send(at_cycles, data, bit_cycles)
            .map_err(raise::<InputError>)
    }

    fn rs485_sent(&mut self) -> Vec<(u64, u8)> {
        self.0.rs485_sent()
    }

    fn record_buses(&mut self) {
        self.0.record_buses();
    }

    fn bus_log(&mut self) -> Vec<(u64, String)> {
        let log = self.0.take_bus_log().into_iter();
        log.map(|(at, event)| (at, event.to_string())).collect()
    }

    fn log_pins(&mut self, pins: Vec<u32>) -> PyResult<()> {
        if let Some(pin) = pins.iter().find(|&&pin| pin > 31) {
            let text = format!("pin {pin}: expected 0 to 31");
            return Err(raise::<AddressError>(text));
        }
        self.0
            .log_pins(pins.iter().fold(0, |mask, pin| mask | 1 << pin));
        Ok(())
    }

    fn logged_pins(&self) -> Vec<(u64, u32)> {
        let log = self.0.logged_pins().iter();
        log.map(|levels| (levels.at_cycles, levels.pins)).collect()
    }

    fn script_twi(&mut self, turns: Vec<(usize, Vec<u8>, u64)>) {
        self.0
            .script_twi(turns.into_iter().map(transports::twi_turn).collect());
    }

    fn script_converter(&mut self, channel: u8, counts: Vec<u16>) -> PyResult<()> {
        if channel > 7 || counts.iter().any(|&count| count > 1023) {
            return Err(raise::<InputError>(format!(
                "converter: channel {channel}, counts {counts:?}: expected a channel from 0 to 7 \
                 and counts from 0 to 1023"
            )));
        }
        self.0.script_converter(channel, &counts);
        Ok(())
    }

    fn script_module(&mut self, turns: Vec<(usize, u64, Vec<u8>)>) {
        self.0
            .script_module(turns.into_iter().map(transports::module_turn).collect());
    }

    fn run_until(&mut self, py: Python<'_>, cycles: u64) -> PyResult<Stop> {
        loop {
            let slice = self
                .0
                .cycles()
                .saturating_add(SIGNAL_CHECK_CYCLES)
                .min(cycles);
            let stop = py.detach(|| self.0.run_until(slice));
            if stop.reason != virtual_brick_facade::StopReason::Reached || slice == cycles {
                return Ok(stop.into());
            }
            py.check_signals()?;
        }
    }

    fn run_until_picture(
        &mut self,
        py: Python<'_>,
        instants: &Bound<'_, PyList>,
        first: usize,
        end: usize,
    ) -> PyResult<(Stop, usize)> {
        let version = self.0.lcd_version();
        let mut index = first;
        loop {
            let stop = self.run_until(py, instants.get_item(index)?.extract()?)?;
            if !stop.reached() || self.0.lcd_version() != version || index + 1 >= end {
                return Ok((stop, index));
            }
            index += 1;
        }
    }

    fn lcd<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.lcd())
    }

    #[getter]
    fn lcd_version(&self) -> u64 {
        self.0.lcd_version()
    }

    #[pyo3(signature = (from_cycles = 0))]
    fn sound<'py>(&self, py: Python<'py>, from_cycles: u64) -> Bound<'py, PyBytes> {
        let samples = self.0.sound(from_cycles);
        let bytes: Vec<u8> = samples.into_iter().flat_map(i16::to_le_bytes).collect();
        PyBytes::new(py, &bytes)
    }

    fn symbol(&self, name: &str) -> PyResult<(u32, u32)> {
        let symbol = self
            .0
            .image()
            .symbols()
            .find(name)
            .map_err(raise::<ImageError>)?;
        Ok((symbol.address, symbol.size))
    }

    fn nearest_code(&self, address: u32) -> Option<(String, u32)> {
        let (name, offset) = self.0.image().symbols().nearest_code(address)?;
        Some((name.to_owned(), offset))
    }

    fn read_memory<'py>(
        &self,
        py: Python<'py>,
        address: u32,
        length: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.0.read_memory(address, length);
        Ok(PyBytes::new(py, &bytes.map_err(raise::<AddressError>)?))
    }

    #[pyo3(signature = (name, kind=None))]
    fn read_float(&mut self, name: &str, kind: Option<&str>) -> PyResult<f64> {
        let (kind, bytes) = self.read(name, kind)?;
        Ok(kind.to_f64(&bytes))
    }

    #[pyo3(signature = (name, kind=None))]
    fn read_int(&mut self, name: &str, kind: Option<&str>) -> PyResult<i64> {
        let (kind, bytes) = self.read(name, kind)?;
        Ok(kind.to_i64(&bytes))
    }

    #[pyo3(signature = (symbol, kind=None))]
    fn add_probe(&mut self, symbol: &str, kind: Option<&str>) -> PyResult<()> {
        self.0
            .add_probe(symbol, scalar_kind(kind)?)
            .map_err(raise::<ImageError>)
    }

    fn threads(&self) -> Vec<Thread> {
        self.0.threads().into_iter().map(Thread::from).collect()
    }

    fn thread_names(&self) -> Vec<String> {
        self.0.trace().names().all(NameSpace::Thread).to_vec()
    }

    fn input_names(&self) -> Vec<String> {
        self.0.trace().names().all(NameSpace::Input).to_vec()
    }

    fn events<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.0.trace().events().packed())
    }

    fn take_events<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.0.take_events().packed())
    }

    #[staticmethod]
    fn event_kinds() -> BTreeMap<u32, &'static str> {
        EventKind::ALL
            .into_iter()
            .map(|kind| (kind.number(), kind.name()))
            .collect()
    }

    fn signals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let signals = PyDict::new(py);
        // Signals share one column of instants: as many samples were taken at the same ones.
        let mut instants = BTreeMap::new();
        for signal in self.0.trace().signals().iter() {
            let at_cycles = match instants.entry(signal.at_cycles.len()) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(packed(py, signal.at_cycles, u64::to_le_bytes)?),
            };
            let values = packed(py, signal.values, f64::to_le_bytes)?;
            signals.set_item(signal.name, (&*at_cycles, values))?;
        }
        Ok(signals)
    }

    fn raised_at(&self) -> Option<(String, u32, u32)> {
        self.0.raised_at()
    }

    fn trace_calls(&mut self, functions: Vec<String>) {
        self.0.trace_calls(&functions);
    }

    fn traced_calls(&self) -> Vec<TracedCall> {
        let calls = self.0.traced_calls().into_iter();
        calls
            .map(|call| {
                (
                    call.function,
                    call.argument,
                    call.callers,
                    call.addresses,
                    call.cycles,
                )
            })
            .collect()
    }

    fn call_place(&self, addresses: Vec<u32>) -> Option<String> {
        self.0.call_place(&addresses)
    }

    fn count_flow(&mut self, points_json: &str) -> PyResult<()> {
        let points = serde_json::from_str(points_json).map_err(raise::<PyValueError>)?;
        self.0.count_flow(points);
        Ok(())
    }

    fn flow_counts(&self) -> PyResult<String> {
        serde_json::to_string(self.0.flow_counts()).map_err(raise::<PyValueError>)
    }

    fn flow_arrivals<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyBytes>> {
        let counts = self.0.flow_counts().iter();
        let packed = counts.map(|count| packed_arrivals(py, &count.arrivals));
        packed.collect()
    }

    fn profile(&mut self, windows: Vec<(usize, u64, u64)>) {
        self.0.profile(windows.into_iter().map(ProfileWindow::from));
    }

    fn profiled<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyBytes>> {
        let windows = self.0.profiled().into_iter();
        windows.map(|steps| packed_steps(py, steps)).collect()
    }

    fn log_transfers(&mut self) {
        self.0.log_transfers();
    }

    fn logged_transfers<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<BTreeMap<&'static str, Bound<'py, PyBytes>>> {
        let mut instants: BTreeMap<&'static str, Vec<u64>> = BTreeMap::new();
        for (at_cycles, peripheral) in self.0.logged_transfers() {
            instants.entry(peripheral).or_default().push(*at_cycles);
        }
        let columns = instants.into_iter();
        columns
            .map(|(name, at)| Ok((name, packed(py, &at, u64::to_le_bytes)?)))
            .collect()
    }

    #[getter]
    fn link_up_cycles(&self) -> Option<u64> {
        self.0.link_up_cycles()
    }

    fn stack_overflows(&self) -> Vec<String> {
        self.0.stack_overflows()
    }

    fn quantities(&self) -> Vec<(String, f64)> {
        self.0.quantities()
    }

    fn trace_digest(&self) -> String {
        self.0.trace().digest().to_string()
    }

    #[pyo3(signature = (port=0, address="127.0.0.1", *, on_listening=None, should_stop=None,
                        once=false))]
    fn serve_debugger(
        &mut self,
        py: Python<'_>,
        port: u16,
        address: &str,
        on_listening: Option<Py<PyAny>>,
        should_stop: Option<Py<PyAny>>,
        once: bool,
    ) -> PyResult<()> {
        let wish = Service {
            address: address.parse().map_err(raise::<PyValueError>)?,
            port,
            on_listening,
            should_stop,
            once,
        };
        self.0 = wish.serve(py, self.0.clone())?;
        Ok(())
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot(self.0.snapshot())
    }

    fn restore(&mut self, snapshot: &Snapshot) {
        self.0.restore(&snapshot.0);
        // It may be of a brick with another program.
        self.1.clear();
    }
}

impl VirtualBrick {
    /// A variable's kind and bytes; what lies in no memory reads as zero.
    fn read(&mut self, name: &str, kind: Option<&str>) -> PyResult<(ScalarKind, Vec<u8>)> {
        let (address, kind) = match self.1.entry((name.to_owned(), kind.map(str::to_owned))) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let probe = self.0.read_scalar(name, scalar_kind(kind)?);
                let place = probe.map(|probe| (probe.address, probe.kind));
                *new.insert(place.map_err(raise::<ImageError>)?)
            }
        };
        let bytes = self.0.read_memory(address, kind.size() as usize);
        Ok((kind, bytes.unwrap_or_else(|_| vec![0; 8])))
    }
}

fn refused(error: BrickError) -> PyErr {
    match error {
        BrickError::Configuration(error) => raise::<ConfigurationError>(error),
        BrickError::Image(error) => raise::<ImageError>(error),
        BrickError::Placement(error) => raise::<ImageError>(error),
    }
}

fn scalar_kind(kind: Option<&str>) -> PyResult<Option<ScalarKind>> {
    kind.map(|kind| kind.parse().map_err(raise::<ImageError>))
        .transpose()
}
