// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The parts joined: the only place that knows chip, board and plant together.

use at91sam7s::board::ChipEvent;
use at91sam7s::{Chip, ChipConfiguration};
use image::Image;
use nxt::{BoardEvent, BoardEventKind, BoardFault, NxtBoard, PowerOffReason};
use trace::{Event, EventKind};

use crate::configuration::{Configuration, ConfigurationError};
use crate::inputs::{Input, InputError};
use crate::placement::{self, Placement, PlacementError};

/// The chip on its board.
pub(crate) type Machine = Chip<NxtBoard>;

/// What an event of the board means to the recorder.
pub(crate) enum Observed {
    /// To be recorded.
    Event(Event),
    /// To be recorded; the supply is off, with a sentence why.
    PowerOff {
        event: Event,
        sentence: &'static str,
    },
    /// The clock of the run-time begins.
    ClockStarted { at_cycles: u64 },
    /// The program asked for what the board does not model: the run ends.
    Fault { at_cycles: u64, fault: BoardFault },
}

/// A machine at power-on.
pub(crate) fn machine(configuration: &Configuration) -> Result<Machine, ConfigurationError> {
    let mut board = NxtBoard::new(
        &configuration.board,
        &configuration.robot,
        configuration.seed,
    )?;
    board.set_coprocessor_timing(configuration.timing.coprocessor);
    let chip = ChipConfiguration {
        timing: configuration.timing.chip,
        errata: configuration.errata,
        ..ChipConfiguration::default()
    };
    Ok(Chip::new(board, chip))
}

/// Put the image into memory and bring the machine to the state in which it is started.
pub(crate) fn load(chip: &mut Machine, image: &Image) -> Result<Placement, PlacementError> {
    let placement = placement::of(image)?;
    for segment in image.segments().iter().filter(|s| !s.bytes.is_empty()) {
        chip.load(segment.address, &segment.bytes)
            .map_err(PlacementError::NoMemory)?;
    }
    if placement == Placement::Ram {
        chip.enter_as_boot_monitor();
        let now = chip.now();
        chip.board_mut().skip_coprocessor_start_up(now);
    }
    Ok(placement)
}

/// Events of the board since the last call.
#[inline]
pub(crate) fn take_events(chip: &mut Machine, taken: &mut Vec<BoardEvent>) {
    chip.board_reports().take_events(taken);
}

/// Meaning of an event of the board.
#[inline]
pub(crate) fn observed(event: &BoardEvent) -> Observed {
    let at_cycles = event.at_cycles;
    let (kind, subject, value) = match event.kind {
        BoardEventKind::Chip(ChipEvent::IntervalTimerStarted) => {
            return Observed::ClockStarted { at_cycles };
        }
        BoardEventKind::Fault(fault) => return Observed::Fault { at_cycles, fault },
        BoardEventKind::Chip(ChipEvent::InterruptEntered { source }) => {
            (EventKind::InterruptEntered, u32::from(source), 0)
        }
        BoardEventKind::Chip(ChipEvent::InterruptLeft) => (EventKind::InterruptLeft, 0, 0),
        BoardEventKind::Chip(ChipEvent::ProcessorStopped) => (EventKind::ProcessorStopped, 0, 0),
        BoardEventKind::Chip(ChipEvent::ProcessorResumed) => (EventKind::ProcessorResumed, 0, 0),
        BoardEventKind::DisplayChanged(digest) => (
            EventKind::DisplayChanged,
            0,
            (digest & (u64::MAX >> 1)) as i64,
        ),
        BoardEventKind::MotorCommand { motor, duty, brake } => {
            let value = i64::from(duty as u8) | i64::from(brake) << 8;
            (EventKind::MotorCommand, motor.index() as u32, value)
        }
        BoardEventKind::Click => (EventKind::CoprocessorClick, 0, 0),
        BoardEventKind::PowerOff(reason) => {
            let (value, sentence) = power_off(reason);
            let event = Event {
                at_cycles,
                kind: EventKind::PowerOff,
                subject: 0,
                value,
            };
            return Observed::PowerOff { event, sentence };
        }
    };
    Observed::Event(Event {
        at_cycles,
        kind,
        subject,
        value,
    })
}

/// Number of the reason in the trace, and a sentence.
const fn power_off(reason: PowerOffReason) -> (i64, &'static str) {
    match reason {
        PowerOffReason::Requested => (0, "the program switched the brick off"),
        PowerOffReason::NoHandshake => (
            1,
            "the co-processor switched off: the handshake did not come within 298 s",
        ),
        PowerOffReason::BatteryLow => (
            2,
            "the co-processor switched off: the rechargeable pack is below 6.5 V",
        ),
        PowerOffReason::BootMonitor => (
            3,
            "the program asked for the boot monitor, which follows a power cycle",
        ),
        PowerOffReason::SupplyLost => (4, "the battery's voltage fell below 2 V"),
    }
}

/// The name and value were checked when the input was scheduled.
pub(crate) fn apply_input(chip: &mut Machine, input: &Input) -> Result<(), InputError> {
    if let Some((address, bytes)) = &input.written {
        return chip
            .load(*address, bytes)
            .map_err(|error| InputError::Variable {
                name: input.name.clone(),
                problem: error.to_string(),
            });
    }
    let now = chip.now();
    let set = chip.board_mut().set_input(now, &input.name, input.value);
    set.map_err(InputError::Refused)?;
    chip.follow_supply();
    Ok(())
}
