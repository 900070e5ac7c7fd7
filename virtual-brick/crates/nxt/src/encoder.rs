// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The quadrature encoder in a motor.
//!
//! Both channels have 180 periods per turn of the output shaft. Forwards the pair
//! (tacho, direction) goes (0,0), (1,0), (1,1), (0,1).

use at91sam7s::board::Cycles;

/// Changes of the pair per turn.
const STATES_PER_TURN: f64 = 720.0;

/// An encoder: which of its states it is in.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoder {
    /// Angle of the slotted wheel at angle 0 of the shaft, in states.
    phase: f64,
    first: i64,
    state: i64,
}

/// A change of the pair at an exact time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    pub at_cycles: Cycles,
    pub motor: usize,
    state: i64,
}

impl Encoder {
    /// `phase` from 0 to 4 is where the slotted wheel stands at angle 0.
    pub fn new(phase: f64) -> Self {
        let state = libm::floor(phase) as i64;
        Self {
            phase,
            first: state,
            state,
        }
    }

    /// Level of the tacho line.
    pub const fn tacho(&self) -> bool {
        matches!(self.state.rem_euclid(4), 1 | 2)
    }

    /// Level of the direction line.
    pub const fn direction(&self) -> bool {
        matches!(self.state.rem_euclid(4), 2 | 3)
    }

    /// Edges of the tacho line since the start, forwards minus backwards: 360 per turn.
    pub const fn count(&self) -> i64 {
        tacho_edges(self.state) - tacho_edges(self.first)
    }

    pub fn apply(&mut self, edge: Edge) {
        self.state = edge.state;
    }

    /// Edges while the shaft turns from `from` to `to` rad evenly in `length` cycles after
    /// `start`.
    pub fn edges(
        &self,
        motor: usize,
        from: f64,
        to: f64,
        (start, length): (Cycles, Cycles),
        edges: &mut Vec<Edge>,
    ) {
        let to = self.position(to);
        let last = floor(to);
        let mut state = self.state;
        if state == last {
            return;
        }
        let from = self.position(from);
        while state != last {
            let (border, next) = if last > state {
                (state + 1, state + 1)
            } else {
                (state, state - 1)
            };
            let share = (border as f64 - from) / (to - from);
            let within = libm::ceil(share * length as f64);
            let within = libm::fmin(libm::fmax(within, 1.0), length as f64) as Cycles;
            edges.push(Edge {
                at_cycles: start + within,
                motor,
                state: next,
            });
            state = next;
        }
    }

    fn position(&self, angle: f64) -> f64 {
        angle * (STATES_PER_TURN / std::f64::consts::TAU) + self.phase
    }
}

/// Greatest whole number not above; the nearest there is where it is too large.
fn floor(position: f64) -> i64 {
    let whole = position as i64;
    if whole as f64 > position {
        whole.saturating_sub(1)
    } else {
        whole
    }
}

/// Edges of the tacho line up to a state, from state 0.
const fn tacho_edges(state: i64) -> i64 {
    (state + 1).div_euclid(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the program sees changes after the instant at which the step begins, never at it.
    #[test]
    fn a_border_just_where_a_step_begins_is_crossed_one_cycle_later() {
        let encoder = Encoder::new(0.0);
        let mut edges = Vec::new();
        encoder.edges(0, 0.0, -0.001, (1_000, 4_800), &mut edges);
        assert_eq!(edges.len(), 1);
        assert_eq!(edges[0].at_cycles, 1_001);
    }
}
