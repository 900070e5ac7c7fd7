// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The plant in steps, its encoders at exact cycles between them.

use at91sam7s::board::Cycles;
use plant::{Motor, MotorDrive, MotorPort, ParameterError, Robot, RobotParameters};

use crate::encoder::{Edge, Encoder};
use crate::time::{seconds, NEVER, PLANT_STEP_CYCLES};

/// Pins of (tacho, direction) of the motors A to C.
const ENCODER_PINS: [(u32, u32); 3] = [(15, 1), (26, 9), (0, 8)];

/// The plant between two steps: `ahead` is its state at the end of the running step.
#[derive(Clone, Debug)]
pub struct Physics {
    behind: Robot,
    ahead: Robot,
    step_start: Cycles,
    encoders: [Option<Encoder>; 3],
    /// Edges of the running step, the next one last.
    edges: Vec<Edge>,
    /// Pins that the encoders drive, and their levels.
    pins: (u32, u32),
    /// Drives and supply of the last step if it changed nothing: with the same, no step will.
    resting: Option<([MotorDrive; 3], f64)>,
}

impl Physics {
    /// `phases` are those of the encoders' slotted wheels, 0 to 4.
    pub fn new(parameters: &RobotParameters, phases: [f64; 3]) -> Result<Self, ParameterError> {
        let robot = Robot::new(parameters)?;
        let encoders = MotorPort::ALL.map(|port| {
            robot
                .motor(port)
                .map(|_| Encoder::new(phases[port.index()]))
        });
        let behind = robot.clone();
        Ok(Self {
            pins: pins(&encoders),
            behind,
            ahead: robot,
            step_start: 0,
            encoders,
            edges: Vec::new(),
            resting: None,
        })
    }

    pub fn next_event(&self) -> Cycles {
        let edge = self.edges.last().map_or(NEVER, |edge| edge.at_cycles);
        edge.min(self.step_start + PLANT_STEP_CYCLES)
    }

    /// Serves what is due at `now`: edges first, then the step, which takes the drives and the
    /// supply at its beginning for all of its length. True when a step was made.
    pub fn advance(&mut self, now: Cycles, drives: &[MotorDrive; 3], supply: f64) -> bool {
        while self.edges.last().is_some_and(|edge| edge.at_cycles <= now) {
            self.serve_edge();
        }
        if now < self.step_start + PLANT_STEP_CYCLES {
            return false;
        }
        self.step_start += PLANT_STEP_CYCLES;
        if self.resting == Some((*drives, supply)) {
            return true;
        }
        self.behind.take_state(&self.ahead);
        self.ahead.step(seconds(PLANT_STEP_CYCLES), drives, supply);
        let rests = self.ahead.same_state(&self.behind);
        self.resting = rests.then_some((*drives, supply));
        self.find_edges();
        true
    }

    fn serve_edge(&mut self) {
        let Some(edge) = self.edges.pop() else {
            return;
        };
        if let Some(encoder) = &mut self.encoders[edge.motor] {
            encoder.apply(edge);
        }
        self.pins = pins(&self.encoders);
    }

    fn find_edges(&mut self) {
        let span = (self.step_start, PLANT_STEP_CYCLES);
        for port in MotorPort::ALL {
            let index = port.index();
            let states = (self.behind.motor(port), self.ahead.motor(port));
            if let (Some(encoder), (Some(from), Some(to))) = (&self.encoders[index], states) {
                encoder.edges(index, from.angle(), to.angle(), span, &mut self.edges);
            }
        }
        self.edges
            .sort_by_key(|edge| std::cmp::Reverse((edge.at_cycles, edge.motor)));
    }

    /// Pins that the encoders drive, and their levels.
    pub const fn pins(&self) -> (u32, u32) {
        self.pins
    }

    pub fn encoder(&self, port: MotorPort) -> Option<&Encoder> {
        self.encoders[port.index()].as_ref()
    }

    /// The motor in `port` as the next step will take it.
    pub fn motor_mut(&mut self, port: MotorPort) -> Option<&mut Motor> {
        self.resting = None;
        self.ahead.motor_mut(port)
    }

    /// The robot as the next step will take it.
    pub fn robot_mut(&mut self) -> &mut Robot {
        self.resting = None;
        &mut self.ahead
    }

    /// The plant at the beginning and at the end of the running step, and how much of the step
    /// has gone by at `now`.
    pub fn around(&self, now: Cycles) -> (&Robot, &Robot, f64) {
        let gone = now.saturating_sub(self.step_start).min(PLANT_STEP_CYCLES);
        (
            &self.behind,
            &self.ahead,
            gone as f64 / PLANT_STEP_CYCLES as f64,
        )
    }
}

fn pins(encoders: &[Option<Encoder>; 3]) -> (u32, u32) {
    let (mut driven, mut level) = (0, 0);
    for (encoder, (tacho, direction)) in encoders.iter().zip(ENCODER_PINS) {
        if let Some(encoder) = encoder {
            driven |= 1 << tacho | 1 << direction;
            level |= u32::from(encoder.tacho()) << tacho;
            level |= u32::from(encoder.direction()) << direction;
        }
    }
    (driven, level)
}
