// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Velocities at the end of a step under friction and stops.
//!
//! Each friction and each stop is one impulse with bounds; projected Gauss-Seidel iteration
//! finds them together (time stepping after Moreau). Impacts are plastic.

/// Gear trains A to C, what lies behind their play, the pitch of a body that balances.
pub(crate) const COORDINATES: usize = 7;

/// Coordinate of the pitch.
pub(crate) const PITCH: usize = 6;

/// One number per coordinate.
pub(crate) type Vector = [f64; COORDINATES];

const ITERATIONS: usize = 60;
/// Impulse in N m s below which the iteration has converged (a gear train's momentum at one
/// degree per second is about 1e-5).
const SMALL_IMPULSE: f64 = 1e-14;

/// What couples the coordinates of a symmetric matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Coupling {
    None,
    /// Two coordinates and the element that they share.
    Pair(usize, usize, f64),
    /// Three coordinates; elements shared by first and second, first and third, second and third.
    Triple {
        indices: [usize; 3],
        off_diagonal: [f64; 3],
    },
}

/// Symmetric mass matrix or its inverse: diagonal but for what is coupled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MassMatrix {
    pub diagonal: Vector,
    pub coupling: Coupling,
}

impl MassMatrix {
    pub fn multiply(&self, vector: &Vector) -> Vector {
        let mut product = [0.0; COORDINATES];
        for (index, value) in product.iter_mut().enumerate() {
            *value = self.diagonal[index] * vector[index];
        }
        self.add_coupled(vector, &mut product);
        product
    }

    #[inline(always)]
    fn add_coupled(&self, vector: &Vector, product: &mut Vector) {
        let mut couple = |first: usize, second: usize, element: f64| {
            product[first] += element * vector[second];
            product[second] += element * vector[first];
        };
        match self.coupling {
            Coupling::None => {}
            Coupling::Pair(first, second, element) => couple(first, second, element),
            Coupling::Triple {
                indices: [first, second, third],
                off_diagonal,
            } => {
                couple(first, second, off_diagonal[0]);
                couple(first, third, off_diagonal[1]);
                couple(second, third, off_diagonal[2]);
            }
        }
    }

    /// Product with the vector that has these elements and no others.
    fn along(&self, elements: [(usize, f64); 2]) -> Vector {
        let mut vector = [0.0; COORDINATES];
        for (index, factor) in elements {
            vector[index] += factor;
        }
        let mut product = [0.0; COORDINATES];
        for (index, _) in elements {
            product[index] = self.diagonal[index] * vector[index];
        }
        self.add_coupled(&vector, &mut product);
        product
    }

    pub fn inverse(&self) -> Self {
        let mut inverse = Self {
            diagonal: self.diagonal.map(|mass| 1.0 / mass),
            coupling: Coupling::None,
        };
        match self.coupling {
            Coupling::None => {}
            Coupling::Pair(first, second, coupling) => {
                let (one, two) = (self.diagonal[first], self.diagonal[second]);
                let determinant = one * two - coupling * coupling;
                inverse.diagonal[first] = two / determinant;
                inverse.diagonal[second] = one / determinant;
                inverse.coupling = Coupling::Pair(first, second, -coupling / determinant);
            }
            Coupling::Triple {
                indices,
                off_diagonal,
            } => {
                let (diagonal, off_diagonal) =
                    inverse_of_three(indices.map(|index| self.diagonal[index]), off_diagonal);
                for (index, element) in indices.into_iter().zip(diagonal) {
                    inverse.diagonal[index] = element;
                }
                inverse.coupling = Coupling::Triple {
                    indices,
                    off_diagonal,
                };
            }
        }
        inverse
    }
}

/// Inverse of a symmetric matrix of three rows by its cofactors; elements as in
/// [`Coupling::Triple`].
fn inverse_of_three(diagonal: [f64; 3], off_diagonal: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let ([a, d, f], [b, c, e]) = (diagonal, off_diagonal);
    let first = [d * f - e * e, c * e - b * f, b * e - c * d];
    let determinant = a * first[0] + b * first[1] + c * first[2];
    let share = |cofactor: f64| cofactor / determinant;
    (
        [share(first[0]), share(a * f - c * c), share(a * d - b * b)],
        [share(first[1]), share(first[2]), share(b * c - a * e)],
    )
}

/// Impulse along `direction` that brings the velocity there to `target`, within bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint {
    direction: [(usize, f64); 2],
    target: f64,
    lowest: f64,
    highest: f64,
    impulse: f64,
    response: Vector,
    stiffness: f64,
}

impl Constraint {
    /// `inverse` is that of the mass matrix.
    #[inline(always)]
    pub fn new(
        inverse: &MassMatrix,
        direction: [(usize, f64); 2],
        target: f64,
        bounds: (f64, f64),
    ) -> Self {
        let response = inverse.along(direction);
        let [(one, k), (other, l)] = direction;
        let mobility = k * response[one] + l * response[other];
        let (lowest, highest) = bounds;
        let stiffness = 1.0 / mobility;
        Self {
            direction,
            target,
            lowest,
            highest,
            impulse: 0.0,
            response,
            stiffness,
        }
    }

    /// Friction of at most `bound` (N m s) along `direction`.
    #[inline(always)]
    pub fn friction(inverse: &MassMatrix, direction: [(usize, f64); 2], bound: f64) -> Self {
        Self::new(inverse, direction, 0.0, (-bound, bound))
    }

    /// The impulse is strictly inside its bounds: what it holds stays.
    pub fn holds(&self) -> bool {
        self.impulse > self.lowest && self.impulse < self.highest
    }

    fn relax(&mut self, velocity: &mut Vector) -> f64 {
        let along: f64 = self
            .direction
            .iter()
            .map(|&(index, k)| k * velocity[index])
            .sum();
        let wanted = self.impulse + (self.target - along) * self.stiffness;
        let bounded = if wanted >= self.lowest {
            wanted
        } else {
            self.lowest
        };
        let impulse = if bounded < self.highest {
            bounded
        } else {
            self.highest
        };
        let change = impulse - self.impulse;
        self.impulse = impulse;
        for (value, response) in velocity.iter_mut().zip(self.response) {
            *value += response * change;
        }
        libm::fabs(change)
    }
}

/// Changes `velocity` until every constraint is met.
pub(crate) fn solve(velocity: &mut Vector, constraints: &mut [Option<Constraint>]) {
    for _ in 0..ITERATIONS {
        let mut largest = 0.0;
        for constraint in constraints.iter_mut().flatten() {
            let change = constraint.relax(velocity);
            if change > largest {
                largest = change;
            }
        }
        if largest < SMALL_IMPULSE {
            return;
        }
    }
}
