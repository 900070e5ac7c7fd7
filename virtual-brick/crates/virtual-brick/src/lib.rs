// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Facade of the virtual brick: assembles the chip, the board and the plant, loads an image,
//! runs it, and records what happens.

mod access;
mod assembly;
mod backtrace;
mod boot_monitor;
mod brick;
mod buses;
mod call_trace;
mod checkpoint;
mod configuration;
mod dead_ends;
mod endless_loops;
mod engine;
mod failure;
mod flow_counts;
mod inputs;
mod job_profile;
mod memory;
mod observe;
mod placement;
mod probes;
mod recorder;
mod run;
mod semihosting;
mod stacks;
mod stop;
mod threads;
mod transports;

pub use arm7tdmi::Step as CpuStep;
pub use at91sam7s::LoggedPins;
pub use brick::{BrickError, Snapshot, VirtualBrick};
pub use call_trace::TracedCall;
pub use checkpoint::{Checkpoint, NotPassed};
pub use configuration::{
    Configuration, ConfigurationError, Timing, TimingParameter, TimingValues, TIMING_PARAMETERS,
};
pub use engine::Engine;
pub use flow_counts::{Arrival, FlowCount};
pub use image::{
    FlowPoint, Image, ImageError, Line, Lines, ScalarKind, Section, Segment, Symbol, Symbols,
    Variable,
};
pub use inputs::InputError;
pub use job_profile::{ProfileStep, ProfileWindow};
pub use memory::MemoryError;
pub use nxt::SOUND_SAMPLE_CYCLES;
pub use observe::{Access, StepObserver};
pub use placement::PlacementError;
pub use probes::Probe;
pub use stop::{Stop, StopReason};
pub use threads::Thread;
pub use transports::TransportError;

/// Frequency of the master clock in Hz as a fraction: numerator and denominator.
pub const CLOCK_HZ: (u64, u64) = (
    at91sam7s::MASTER_CLOCK_HZ_NUMERATOR,
    at91sam7s::MASTER_CLOCK_HZ_DENOMINATOR,
);
