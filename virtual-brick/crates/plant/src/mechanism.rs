// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One step of motors and body.

use crate::balancer::Pendulum;
use crate::body::Vehicle;
use crate::drive::{MotorDrive, StepCurrent};
use crate::motor::Motor;
use crate::motor_parameters::MotorPort;
use crate::solver::{
    solve, Constraint, Coupling, Direction, ImpulseResponse, MassMatrix, Vector, MOTORS, PITCH,
};

/// Angular velocity in rad/s below which a shaft held by friction is at rest.
const AT_REST: f64 = 1e-6;
/// Most constraints: frictions of three motors and two of the body, rolling and castor; where there
/// is more than gear trains, two stops of each motor besides, and the floor on both sides.
pub(crate) const GEAR_CONSTRAINTS: usize = MOTORS + 2;
pub(crate) const CONSTRAINTS: usize = GEAR_CONSTRAINTS + 2 * MOTORS;

/// Three motor ports and a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mechanism {
    pub motors: [Option<Motor>; MOTORS],
    pub body: Body,
}

/// What the motors turn, with its state.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Body {
    Bench,
    Vehicle(Vehicle),
    Pendulum(Pendulum),
}

/// Responses of the mechanism's masses to impulses; worked out again only for another matrix, which
/// slow modulation and braking do not make.
#[derive(Clone, Debug)]
pub(crate) struct ImpulseResponses<const N: usize> {
    /// Masses of a body that does not pitch: they stay.
    masses: Option<MassMatrix<N>>,
    matrix: MassMatrix<N>,
    inverse: MassMatrix<N>,
    gears: [ImpulseResponse<N>; MOTORS],
    rolling: Option<ImpulseResponse<N>>,
}

/// What one step has found out before the impulses.
struct Step<'a, const N: usize> {
    dt: f64,
    responses: &'a ImpulseResponses<N>,
    laws: &'a [StepCurrent; MOTORS],
    before: Vector<N>,
    free: Vector<N>,
}

impl<const N: usize> ImpulseResponses<N> {
    pub fn new(mechanism: &Mechanism) -> Self {
        let masses = mechanism.masses();
        let pitches = matches!(mechanism.body, Body::Pendulum(_));
        Self::to(masses, mechanism, (!pitches).then_some(masses))
    }

    fn to(matrix: MassMatrix<N>, of: &Mechanism, masses: Option<MassMatrix<N>>) -> Self {
        let inverse = matrix.inverse();
        let rolling = match &of.body {
            Body::Vehicle(vehicle) => {
                Some(ImpulseResponse::new(&inverse, vehicle.rolling_direction()))
            }
            _ => None,
        };
        Self {
            masses,
            matrix,
            inverse,
            gears: [0, 1, 2].map(|k| ImpulseResponse::new(&inverse, [(k, 1.0), (k, 0.0)])),
            rolling,
        }
    }
}

impl<const N: usize> Step<'_, N> {
    fn answer(&self, direction: Direction) -> ImpulseResponse<N> {
        ImpulseResponse::new(&self.responses.inverse, direction)
    }
}

impl Mechanism {
    /// Gear trains are all that moves by itself.
    pub fn is_gears_only(&self) -> bool {
        let plays = self.motors.iter().flatten().any(Motor::has_backlash);
        !plays && !matches!(self.body, Body::Pendulum(_))
    }

    /// Advances by `dt` s with the bridges in the given states at `supply` V.
    pub fn step<const N: usize, const C: usize>(
        &mut self,
        responses: &mut ImpulseResponses<N>,
        dt: f64,
        drives: &[MotorDrive; MOTORS],
        supply: f64,
    ) {
        let mut laws = [StepCurrent::default(); MOTORS];
        let mut before = [0.0; MOTORS];
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(motor) = motor {
                laws[k] = motor.step_current(&drives[k], supply, dt);
                before[k] = motor.angular_velocity();
            }
        }
        let velocity = self.new_velocities::<N, C>(responses, dt, &laws);
        let wheels = self.wheel_angles();
        for (k, motor) in self.motors.iter_mut().enumerate() {
            let Some(motor) = motor else {
                continue;
            };
            let winding = motor.winding(before[k], supply, dt);
            if !motor.follow_hand(dt) {
                let load = velocity.get(MOTORS + k).copied().unwrap_or_default();
                motor.finish_step(velocity[k], load, dt);
            }
            motor.finish_current(&drives[k], laws[k], winding);
        }
        let pitch_rate = velocity.get(PITCH).copied().unwrap_or_default();
        self.roll(wheels, pitch_rate, dt);
    }

    /// Inertias of gear trains and body; 1 where there is nothing or a hand decides.
    pub fn masses<const N: usize>(&self) -> MassMatrix<N> {
        let mut diagonal = [1.0; N];
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(motor) = motor.as_ref().filter(|motor| !motor.held_by_hand()) {
                let (before, behind) = motor.inertias();
                diagonal[k] = before;
                if motor.has_backlash() {
                    diagonal[MOTORS + k] = behind;
                }
            }
        }
        let mut masses = MassMatrix {
            diagonal,
            coupling: Coupling::None,
        };
        match &self.body {
            Body::Bench => {}
            Body::Vehicle(vehicle) => {
                let (own, coupling) = vehicle.wheel_inertia();
                masses.diagonal[vehicle.left] += own;
                masses.diagonal[vehicle.right] += own;
                masses.coupling = Coupling::Pair(vehicle.left, vehicle.right, coupling);
            }
            Body::Pendulum(pendulum) => pendulum.add_masses(&mut masses),
        }
        masses
    }

    /// Velocities of the coordinates; 0 where there is nothing or a hand decides.
    #[inline(always)]
    pub fn velocities<const N: usize>(&self) -> Vector<N> {
        let mut velocity = [0.0; N];
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(motor) = motor.as_ref().filter(|motor| !motor.held_by_hand()) {
                velocity[k] = motor.angular_velocity();
                if N > MOTORS && motor.has_backlash() {
                    velocity[MOTORS + k] = motor.load_velocity();
                }
            }
        }
        if let Body::Pendulum(pendulum) = &self.body {
            velocity[PITCH] = pendulum.pitch_rate;
        }
        velocity
    }

    /// Velocities at the end of a step. Its linear part: M (w1 - w0) = dt (Kt i - b (w0 + w1) / 2 -
    /// load).
    fn new_velocities<const N: usize, const C: usize>(
        &self,
        responses: &mut ImpulseResponses<N>,
        dt: f64,
        laws: &[StepCurrent; MOTORS],
    ) -> Vector<N> {
        let mut matrix = responses.masses.unwrap_or_else(|| self.masses());
        let before = self.velocities();
        let mut right = matrix.multiply(&before);
        for (k, (motor, law)) in self.motors.iter().zip(laws).enumerate() {
            let Some(motor) = motor.as_ref().filter(|motor| !motor.held_by_hand()) else {
                continue;
            };
            let parameters = motor.parameters();
            let torque = parameters.torque_constant;
            let viscous = parameters.viscous_friction / 2.0;
            matrix.diagonal[k] += dt * (viscous + torque * law.slope);
            right[k] += dt * (torque * law.offset - viscous * before[k]);
            let load = if N > MOTORS {
                load_coordinate(&self.motors, k)
            } else {
                k
            };
            right[load] -= dt * motor.load_torque();
        }
        if let Body::Pendulum(pendulum) = &self.body {
            pendulum.add_impulses(&before, dt, &mut right);
        }
        if matrix != responses.matrix {
            *responses = ImpulseResponses::to(matrix, self, responses.masses);
        }
        let free = responses.inverse.multiply(&right);
        self.constrained::<N, C>(&Step {
            dt,
            responses,
            laws,
            before,
            free,
        })
    }

    #[inline(always)]
    fn constrained<const N: usize, const C: usize>(&self, step: &Step<'_, N>) -> Vector<N> {
        let mut velocity = step.free;
        let mut constraints = [const { None }; C];
        let mut frictions = [None; MOTORS];
        let mut count = 0;
        let mut add = |constraint| {
            constraints[count] = Some(constraint);
            count += 1;
            count - 1
        };
        for (k, friction) in frictions.iter_mut().enumerate() {
            *friction = self.motor_friction(k, step).map(&mut add);
            for stop in self.stops(k, step).into_iter().flatten() {
                add(stop);
            }
        }
        self.add_floor_frictions(step, &mut add);
        for stop in self.pitch_stops(step).into_iter().flatten() {
            add(stop);
        }
        solve(&mut velocity, &mut constraints[..count]);
        for (k, friction) in frictions.into_iter().enumerate() {
            let constraint = friction.and_then(|index: usize| constraints[index].as_ref());
            let held = constraint.is_some_and(Constraint::holds);
            if held && libm::fabs(velocity[k]) < AT_REST {
                velocity[k] = 0.0;
            }
        }
        if matches!(&self.body, Body::Pendulum(pendulum) if pendulum.held) {
            velocity[PITCH] = 0.0;
        }
        velocity
    }

    #[inline(always)]
    fn motor_friction<const N: usize>(
        &self,
        k: usize,
        step: &Step<'_, N>,
    ) -> Option<Constraint<N>> {
        let motor = self.motors[k]
            .as_ref()
            .filter(|motor| !motor.held_by_hand())?;
        let parameters = motor.parameters();
        let before = step.before[k];
        let velocity = if libm::fabs(before) < AT_REST {
            0.0
        } else {
            before
        };
        let law = &step.laws[k];
        let driving = parameters.torque_constant * (law.offset - law.slope * before);
        let torque = libm::fmax(libm::fabs(driving), libm::fabs(motor.load_torque()));
        let bound = parameters.friction(velocity, torque);
        (bound > 0.0).then(|| Constraint::friction(step.responses.gears[k], bound * step.dt))
    }

    #[inline(always)]
    fn stops<const N: usize>(&self, k: usize, step: &Step<'_, N>) -> [Option<Constraint<N>>; 2] {
        let plays = |motor: &&Motor| N > MOTORS && motor.has_backlash();
        let Some(motor) = self.motors[k].as_ref().filter(plays) else {
            return [None, None];
        };
        let (lowest, highest) = motor.play_velocities(step.dt);
        let answer = step.answer([(k, 1.0), (MOTORS + k, -1.0)]);
        [
            Some(Constraint::new(answer, lowest, (0.0, f64::INFINITY))),
            Some(Constraint::new(answer, highest, (f64::NEG_INFINITY, 0.0))),
        ]
    }

    #[inline(always)]
    fn add_floor_frictions<const N: usize>(
        &self,
        step: &Step<'_, N>,
        mut add: impl FnMut(Constraint<N>) -> usize,
    ) {
        let (Body::Vehicle(vehicle), Some(rolling)) = (&self.body, step.responses.rolling) else {
            return;
        };
        let parameters = vehicle.parameters();
        let (roll, drag) = (parameters.rolling_resistance, parameters.castor_friction);
        if roll > 0.0 {
            add(Constraint::friction(rolling, roll * step.dt));
        }
        if drag > 0.0 {
            let castor = vehicle.castor_direction(&step.before, &step.free);
            add(Constraint::friction(step.answer(castor), drag * step.dt));
        }
    }

    /// The floor under a body that falls, or the hand that holds it.
    #[inline(always)]
    fn pitch_stops<const N: usize>(&self, step: &Step<'_, N>) -> [Option<Constraint<N>>; 2] {
        let Body::Pendulum(pendulum) = &self.body else {
            return [None, None];
        };
        let answer = step.answer([(PITCH, 1.0), (PITCH, 0.0)]);
        if pendulum.held {
            let bounds = (f64::NEG_INFINITY, f64::INFINITY);
            return [Some(Constraint::new(answer, 0.0, bounds)), None];
        }
        let (lowest, highest) = pendulum.pitch_rates(step.dt);
        [
            Some(Constraint::new(answer, lowest, (0.0, f64::INFINITY))),
            Some(Constraint::new(answer, highest, (f64::NEG_INFINITY, 0.0))),
        ]
    }

    /// Ports of the left and the right wheel, their radius and distance.
    pub fn wheels(&self) -> Option<(MotorPort, MotorPort, f64, f64)> {
        match &self.body {
            Body::Bench => None,
            Body::Vehicle(vehicle) => {
                let drive = vehicle.parameters();
                Some((drive.left, drive.right, drive.wheel_radius, drive.track))
            }
            Body::Pendulum(pendulum) => {
                let body = pendulum.parameters();
                Some((body.left, body.right, body.wheel_radius, body.track))
            }
        }
    }

    /// Angles of the left and the right wheel against the body.
    fn wheel_angles(&self) -> Option<(f64, f64)> {
        let (left, right, ..) = self.wheels()?;
        let angle = |port: MotorPort| Some(self.motors[port.index()].as_ref()?.load_angle());
        Some((angle(left)?, angle(right)?))
    }

    fn roll(&mut self, before: Option<(f64, f64)>, pitch_rate: f64, dt: f64) {
        let (Some(before), Some(after)) = (before, self.wheel_angles()) else {
            return;
        };
        let (left, right) = (after.0 - before.0, after.1 - before.1);
        match &mut self.body {
            Body::Bench => {}
            Body::Vehicle(vehicle) => vehicle.roll(left, right),
            Body::Pendulum(pendulum) => {
                let turn = pendulum.finish_step(pitch_rate, dt);
                let body = pendulum.parameters();
                let (radius, track) = (body.wheel_radius, body.track);
                pendulum.pose.roll(radius, track, left + turn, right + turn);
            }
        }
    }
}

/// Coordinate of what lies behind the play of motor `k`: its gear train's when it has none.
pub(crate) fn load_coordinate(motors: &[Option<Motor>; MOTORS], k: usize) -> usize {
    let behind = motors[k].as_ref().is_some_and(Motor::has_backlash);
    if behind {
        MOTORS + k
    } else {
        k
    }
}
