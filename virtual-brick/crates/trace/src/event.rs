// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Events: what happened, to whom, when.

use crate::error::TraceError;

/// Subject of [`EventKind::ThreadRunning`] when no thread runs.
pub const IDLE: u32 = u32::MAX;

/// Length of one packed event.
pub const PACKED_EVENT_LENGTH: usize = 24;

/// What happened. The numbers are part of the packed format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum EventKind {
    /// The kernel selected a thread: subject is its index, or [`IDLE`].
    ThreadRunning = 1,
    /// A thread's state changed: value is the new state.
    ThreadState = 2,
    /// A job was released: value is its nominal release in cycles.
    Release = 3,
    /// A job ended: value is its nominal release in cycles.
    Completion = 4,
    /// The core took an interrupt: subject is its source.
    InterruptEntered = 5,
    /// The interrupt handler ended.
    InterruptLeft = 6,
    /// The picture changed: value is a digest of the picture, low 63 bits.
    DisplayChanged = 7,
    /// A motor command took effect: subject is the motor, value is the duty in percent as a
    /// signed byte, plus 256 when the winding is shorted in the off phase.
    MotorCommand = 8,
    /// An input was applied: subject is the index of its name, value the bits of the number.
    Input = 9,
    /// The processor clock stopped until the next interrupt.
    ProcessorStopped = 10,
    /// The processor clock runs again.
    ProcessorResumed = 11,
    /// The supply was switched off: value is 0 at the program's request, 1 without handshake,
    /// 2 with an empty battery, 3 for the boot monitor.
    PowerOff = 12,
    /// The co-processor toggled the amplifier because it heard nothing for 2 s.
    CoprocessorClick = 13,
}

impl EventKind {
    /// Every kind, in the order of the numbers.
    pub const ALL: [Self; 13] = [
        Self::ThreadRunning,
        Self::ThreadState,
        Self::Release,
        Self::Completion,
        Self::InterruptEntered,
        Self::InterruptLeft,
        Self::DisplayChanged,
        Self::MotorCommand,
        Self::Input,
        Self::ProcessorStopped,
        Self::ProcessorResumed,
        Self::PowerOff,
        Self::CoprocessorClick,
    ];

    /// The number in the packed format.
    #[must_use]
    pub const fn number(self) -> u32 {
        self as u32
    }

    /// The name used outside: lower case, words joined by underscores.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ThreadRunning => "thread_running",
            Self::ThreadState => "thread_state",
            Self::Release => "release",
            Self::Completion => "completion",
            Self::InterruptEntered => "interrupt_entered",
            Self::InterruptLeft => "interrupt_left",
            Self::DisplayChanged => "display_changed",
            Self::MotorCommand => "motor_command",
            Self::Input => "input",
            Self::ProcessorStopped => "processor_stopped",
            Self::ProcessorResumed => "processor_resumed",
            Self::PowerOff => "power_off",
            Self::CoprocessorClick => "coprocessor_click",
        }
    }
}

/// One event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// When, in cycles of the master clock.
    pub at_cycles: u64,
    /// What.
    pub kind: EventKind,
    /// To whom; meaning by kind.
    pub subject: u32,
    /// How much; meaning by kind.
    pub value: i64,
}

impl Event {
    /// The packed form: u64 cycles, u32 kind, u32 subject, i64 value, little endian.
    #[inline]
    #[must_use]
    pub fn packed(&self) -> [u8; PACKED_EVENT_LENGTH] {
        let mut bytes = [0; PACKED_EVENT_LENGTH];
        bytes[0..8].copy_from_slice(&self.at_cycles.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.kind.number().to_le_bytes());
        bytes[12..16].copy_from_slice(&self.subject.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.value.to_le_bytes());
        bytes
    }

    /// What was packed; none where the kind has no such number.
    #[inline]
    fn unpacked(bytes: &[u8; PACKED_EVENT_LENGTH]) -> Option<Self> {
        let kind = u32::from_le_bytes(part(bytes, 8)).checked_sub(1)?;
        Some(Self {
            at_cycles: at_cycles(bytes),
            kind: *EventKind::ALL.get(kind as usize)?,
            subject: u32::from_le_bytes(part(bytes, 12)),
            value: i64::from_le_bytes(part(bytes, 16)),
        })
    }
}

#[inline]
fn at_cycles(packed: &[u8; PACKED_EVENT_LENGTH]) -> u64 {
    u64::from_le_bytes(part(packed, 0))
}

/// `N` bytes from `first` on: one load, where the place is known.
#[inline]
fn part<const N: usize>(packed: &[u8], first: usize) -> [u8; N] {
    let behind = packed.get(first..).unwrap_or_default();
    behind.first_chunk().copied().unwrap_or([0; N])
}

/// Events in the order of time; equal instants keep the order of recording.
///
/// They are kept packed, as digest and readers take them: there are tens of thousands per second.
#[derive(Clone, Debug, Default)]
pub struct Events {
    all: Vec<[u8; PACKED_EVENT_LENGTH]>,
}

impl Events {
    #[inline]
    pub(crate) fn push(&mut self, event: Event, limit: usize) -> Result<(), TraceError> {
        if self.all.len() >= limit {
            return Err(TraceError::TooManyEvents { limit });
        }
        let previous_cycles = self.all.last().map_or(0, at_cycles);
        if event.at_cycles < previous_cycles {
            return Err(TraceError::OutOfOrder {
                previous_cycles,
                at_cycles: event.at_cycles,
            });
        }
        self.all.push(event.packed());
        Ok(())
    }

    /// Forget all but the first `length` events.
    pub(crate) fn truncate(&mut self, length: usize) {
        self.all.truncate(length);
    }

    /// Number of events.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// No event was recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The events of a packed record; bytes after the last whole one are left out.
    #[must_use]
    pub fn from_packed(packed: &[u8]) -> Self {
        Self {
            all: packed
                .chunks_exact(PACKED_EVENT_LENGTH)
                .map(|bytes| part(bytes, 0))
                .collect(),
        }
    }

    /// The events from the first to the last.
    pub fn iter(&self) -> impl Iterator<Item = Event> + '_ {
        self.iter_from(0)
    }

    /// The events from position `first` on.
    pub fn iter_from(&self, first: usize) -> impl Iterator<Item = Event> + '_ {
        self.all[first.min(self.len())..]
            .iter()
            .filter_map(Event::unpacked)
    }

    /// All events packed one after the other, [`PACKED_EVENT_LENGTH`] bytes each.
    #[must_use]
    pub fn packed(&self) -> &[u8] {
        self.packed_from(0)
    }

    /// The events from position `first` on, packed.
    #[must_use]
    pub fn packed_from(&self, first: usize) -> &[u8] {
        self.all[first.min(self.len())..].as_flattened()
    }
}
