// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The assembled brick: made from a configuration and an image and observed from outside.

use std::fmt;
use std::sync::Arc;

use arm7tdmi::{psr, Blocks, Cpu};
use image::{Image, ImageError, ScalarKind};
use trace::Trace;

use crate::assembly::{self, Machine};
use crate::configuration::{Configuration, ConfigurationError};
use crate::dead_ends::DeadEndDetector;
use crate::endless_loops::EndlessLoops;
use crate::engine::Engine;
use crate::inputs::{Input, InputError, InputSchedule};
use crate::memory::{ChipMemory, MemoryError};
use crate::placement::{Placement, PlacementError};
use crate::probes::Probe;
use crate::stop::Stop;
use crate::threads::{Layout, Thread, ThreadObserver};

// State of what these files add to the brick: they extend `VirtualBrick`, so each knows the other.
use crate::boot_monitor::MonitorState;
use crate::call_trace::CallTrace;
use crate::flow_counts::FlowCounts;
use crate::job_profile::JobProfile;
use crate::recorder::Recorder;
use crate::semihosting::Console;
use crate::stacks::StackChecker;

/// A brick with a program, its surroundings and the record of its run.
///
/// A run is a function of the configuration, the image and the inputs: how it is cut into calls
/// of [`VirtualBrick::run_until`] makes no difference.
#[derive(Clone, Debug)]
pub struct VirtualBrick {
    configuration: Arc<Configuration>,
    pub(crate) cpu: Cpu,
    pub(crate) chip: Machine,
    pub(crate) image: Arc<Image>,
    pub(crate) placement: Placement,
    pub(crate) recorder: Recorder,
    pub(crate) inputs: InputSchedule,
    pub(crate) dead_ends: DeadEndDetector,
    pub(crate) endless_loops: EndlessLoops,
    pub(crate) stacks: StackChecker,
    pub(crate) call_trace: CallTrace,
    pub(crate) flow_counts: FlowCounts,
    pub(crate) job_profile: JobProfile,
    pub(crate) ended: Option<Stop>,
    pub(crate) engine: Engine,
    pub(crate) blocks: Blocks<Machine>,
    pub(crate) monitor: Option<MonitorState>,
    /// What the program says to its debugger; none while it has none.
    pub(crate) console: Option<Console>,
    threads_unobserved: Option<String>,
}

/// A brick that could not be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BrickError {
    /// Its configuration was refused.
    Configuration(ConfigurationError),
    /// Its image was refused.
    Image(ImageError),
    /// Its image does not fit the memory.
    Placement(PlacementError),
}

impl fmt::Display for BrickError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Configuration(error) => error.fmt(f),
            Self::Image(error) => error.fmt(f),
            Self::Placement(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for BrickError {}

impl From<ConfigurationError> for BrickError {
    fn from(error: ConfigurationError) -> Self {
        Self::Configuration(error)
    }
}

impl From<ImageError> for BrickError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

impl From<PlacementError> for BrickError {
    fn from(error: PlacementError) -> Self {
        Self::Placement(error)
    }
}

/// The whole state of a brick at an instant, its trace included.
#[derive(Clone, Debug)]
pub struct Snapshot(Box<VirtualBrick>);

impl VirtualBrick {
    /// Assemble a brick and load a program.
    ///
    /// # Errors
    /// The configuration or the image cannot be used.
    pub fn new(configuration: &Configuration, elf: &[u8]) -> Result<Self, BrickError> {
        Self::with_image(configuration, Image::parse(elf)?)
    }

    /// Assemble a brick and load a program that was read already.
    ///
    /// # Errors
    /// The configuration cannot be used or the image does not fit the memory.
    pub fn with_image(configuration: &Configuration, image: Image) -> Result<Self, BrickError> {
        let mut chip = assembly::machine(configuration)?;
        let image = Arc::new(image);
        let placement = assembly::load(&mut chip, &image)?;
        let mut cpu = Cpu::with_profile(configuration.timing.core);
        if placement == Placement::Ram {
            start_at(&mut cpu, image.entry());
        }
        let layout = Layout::of(&image);
        let threads_unobserved = layout.as_ref().err().cloned();
        let observer = layout
            .ok()
            .map(|layout| ThreadObserver::new(layout, Some(Arc::clone(&image))));
        let mut recorder = Recorder::new(configuration, &chip, observer);
        recorder.watch_new_words(&mut chip);
        Ok(Self {
            configuration: Arc::new(configuration.clone()),
            cpu,
            chip,
            stacks: StackChecker::new(&image),
            image,
            placement,
            recorder,
            inputs: InputSchedule::default(),
            call_trace: CallTrace::default(),
            flow_counts: FlowCounts::default(),
            job_profile: JobProfile::default(),
            dead_ends: DeadEndDetector::default(),
            endless_loops: EndlessLoops::default(),
            ended: None,
            engine: configuration.engine,
            blocks: configuration.engine.blocks(
                configuration.jit_threshold_runs,
                configuration.jit_synchronous,
            ),
            monitor: None,
            console: None,
            threads_unobserved,
        })
    }

    /// The same brick at its start with another program: inputs that still wait stay, and the
    /// probes that the program has.
    ///
    /// # Errors
    /// The program cannot be used.
    pub fn with_program(&self, elf: &[u8]) -> Result<Self, BrickError> {
        let mut brick = Self::new(&self.configuration, elf)?;
        brick.inputs = self.inputs.clone();
        for probe in self.recorder.probes() {
            // What the program does not have is no longer recorded.
            let _ = brick.add_probe(&probe.path, Some(probe.kind));
        }
        Ok(brick)
    }

    /// The present, in cycles of the master clock since the start.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.chip.now()
    }

    /// The program.
    #[must_use]
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The record of the run.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        &self.recorder.trace
    }

    /// The events recorded so far, which are then forgotten with all samples. Checkpoints taken
    /// before cannot be restored any more.
    pub fn take_events(&mut self) -> trace::Events {
        self.recorder.trace.take_events()
    }

    /// The processor's registers and status.
    #[must_use]
    pub fn processor(&self) -> &Cpu {
        &self.cpu
    }

    /// Let an input change at an instant; unknown names are refused at once.
    ///
    /// # Errors
    /// The input is unknown, its instant has passed or its value is not allowed.
    pub fn schedule_input(
        &mut self,
        at_cycles: u64,
        name: &str,
        value: f64,
    ) -> Result<(), InputError> {
        let now_cycles = self.chip.now();
        if at_cycles < now_cycles {
            return Err(InputError::InPast {
                name: name.to_owned(),
                at_cycles,
                now_cycles,
            });
        }
        let input = Input::new(&self.image, name, value)?;
        match &input.written {
            Some((address, bytes)) => self.check_writable(name, *address, bytes.len())?,
            None => {
                let checked = self.chip.board().check_input(name, value);
                checked.map_err(InputError::Refused)?;
            }
        }
        self.inputs.add(at_cycles, input);
        Ok(())
    }

    fn check_writable(&self, name: &str, address: u32, size: usize) -> Result<(), InputError> {
        let refused = |error: MemoryError| InputError::Variable {
            name: name.to_owned(),
            problem: error.to_string(),
        };
        self.chip.peek(address, size).map(drop).map_err(refused)
    }

    /// Sample a global object into the signal `probe.<path>` from the next sample on.
    /// Without `kind` the debug information must tell the type.
    ///
    /// # Errors
    /// No such symbol or component, or its type is unknown.
    pub fn add_probe(&mut self, path: &str, kind: Option<ScalarKind>) -> Result<(), ImageError> {
        let probe = Probe::new(&self.image, path, kind)?;
        self.recorder.add_probe(probe);
        Ok(())
    }

    /// Read a scalar object now. Without `kind` the debug information must tell the type.
    ///
    /// # Errors
    /// No such symbol or component, its type is unknown, or it lies in no memory.
    pub fn read_scalar(&self, path: &str, kind: Option<ScalarKind>) -> Result<Probe, ImageError> {
        let mut probe = Probe::new(&self.image, path, kind)?;
        probe.sample(&ChipMemory(&self.chip));
        Ok(probe)
    }

    /// Bytes of memory as the program sees them, without side effects.
    ///
    /// # Errors
    /// Some of it is no memory.
    pub fn read_memory(&self, address: u32, length: usize) -> Result<Vec<u8>, MemoryError> {
        self.chip.peek(address, length)
    }

    /// The picture: 64 rows of 100 pixels from the top left, one byte 0 or 1 each.
    #[must_use]
    pub fn lcd(&self) -> Vec<u8> {
        self.chip.board().display().picture().to_bytes()
    }

    /// Grows when the program sends something to the display: while it stays, so does the picture.
    #[must_use]
    pub fn lcd_version(&self) -> u64 {
        self.chip.board().display().version()
    }

    /// Sound played so far from a cycle on: signed 16-bit samples of
    /// [`nxt::SOUND_SAMPLE_CYCLES`] cycles.
    #[must_use]
    pub fn sound(&self, from_cycles: u64) -> Vec<i16> {
        self.chip.board().sound(from_cycles, self.chip.now())
    }

    /// When the program first asked the co-processor for its readings; none before.
    #[must_use]
    pub fn link_up_cycles(&self) -> Option<u64> {
        self.chip.board().first_readings_cycles()
    }

    /// The threads of the program; empty when they cannot be observed.
    #[must_use]
    pub fn threads(&self) -> Vec<Thread> {
        self.recorder.threads(&ChipMemory(&self.chip))
    }

    /// Why the program's threads cannot be observed; none when they are.
    #[must_use]
    pub fn threads_unobserved(&self) -> Option<&str> {
        self.threads_unobserved.as_deref()
    }

    /// Bytes of JIT code that the fast engine has for the program by now. They are no part of the
    /// state and depend on the host.
    #[must_use]
    pub fn jit_code_bytes(&self) -> usize {
        self.blocks.jit_code_bytes()
    }

    /// The whole state now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(Box::new(self.clone()))
    }

    /// Go back to the state of a snapshot; the run goes on from there as it did then.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.clone_from(&snapshot.0);
    }
}

fn start_at(cpu: &mut Cpu, entry: u32) {
    if entry & 1 != 0 {
        cpu.set_cpsr(cpu.cpsr() | psr::T);
    }
    cpu.set_pc(entry & !1);
}
