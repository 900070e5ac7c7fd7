// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Velocities at the end of a step under friction and stops.
//!
//! Each friction and each stop is one impulse with bounds; projected Gauss-Seidel iteration
//! finds them together (time stepping after Moreau). Impacts are plastic.

/// Gear trains A to C.
pub(crate) const MOTORS: usize = 3;

/// Gear trains A to C, what lies behind their play, the pitch of a body that balances.
pub(crate) const COORDINATES: usize = 7;

/// Coordinate of the pitch.
pub(crate) const PITCH: usize = 6;

/// One number per coordinate: [`MOTORS`] where gear trains are all that moves by itself, else
/// [`COORDINATES`].
pub(crate) type Vector<const N: usize> = [f64; N];

/// Two coordinates and how much of an impulse acts on each.
pub(crate) type Direction = [(usize, f64); 2];

const ITERATIONS: usize = 60;
/// Impulse in N m s below which the iteration has converged (a gear train's momentum at one
/// degree per second is about 1e-5).
const SMALL_IMPULSE: f64 = 1e-14;

/// What couples the coordinates of a symmetric matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassMatrix<const N: usize> {
    pub diagonal: Vector<N>,
    pub coupling: Coupling,
}

impl<const N: usize> MassMatrix<N> {
    #[inline(always)]
    pub fn multiply(&self, vector: &Vector<N>) -> Vector<N> {
        let mut product = [0.0; N];
        for (index, value) in product.iter_mut().enumerate() {
            *value = self.diagonal[index] * vector[index];
        }
        self.add_coupled(vector, &mut product);
        product
    }

    #[inline(always)]
    fn add_coupled(&self, vector: &Vector<N>, product: &mut Vector<N>) {
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
    #[inline(always)]
    fn along(&self, elements: Direction) -> Vector<N> {
        let mut vector = [0.0; N];
        for (index, factor) in elements {
            vector[index] += factor;
        }
        let mut product = [0.0; N];
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

/// How the velocities answer to an impulse along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImpulseResponse<const N: usize> {
    direction: Direction,
    response: Vector<N>,
    stiffness: f64,
}

impl<const N: usize> ImpulseResponse<N> {
    /// `inverse` is that of the mass matrix.
    #[inline(always)]
    pub fn new(inverse: &MassMatrix<N>, direction: Direction) -> Self {
        let response = inverse.along(direction);
        let [(one, k), (other, l)] = direction;
        let mobility = k * response[one] + l * response[other];
        let stiffness = 1.0 / mobility;
        Self {
            direction,
            response,
            stiffness,
        }
    }
}

/// Impulse along a direction that brings the velocity there to `target`, within bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint<const N: usize> {
    answer: ImpulseResponse<N>,
    target: f64,
    lowest: f64,
    highest: f64,
    impulse: f64,
}

impl<const N: usize> Constraint<N> {
    #[inline(always)]
    pub fn new(answer: ImpulseResponse<N>, target: f64, (lowest, highest): (f64, f64)) -> Self {
        Self {
            answer,
            target,
            lowest,
            highest,
            impulse: 0.0,
        }
    }

    /// Friction of at most `bound` (N m s).
    #[inline(always)]
    pub fn friction(answer: ImpulseResponse<N>, bound: f64) -> Self {
        Self::new(answer, 0.0, (-bound, bound))
    }

    /// The impulse is strictly inside its bounds: what it holds stays.
    pub fn holds(&self) -> bool {
        self.impulse > self.lowest && self.impulse < self.highest
    }

    #[inline(always)]
    fn relax(&mut self, velocity: &mut Vector<N>) -> f64 {
        let [(one, k), (other, l)] = self.answer.direction;
        let along = k * velocity[one] + l * velocity[other];
        let wanted = self.impulse + (self.target - along) * self.answer.stiffness;
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
        // So it mostly is after the first round: the host guesses so, and need not wait for it.
        if change == 0.0 {
            return 0.0;
        }
        self.impulse = impulse;
        for (value, response) in velocity.iter_mut().zip(self.answer.response) {
            *value += response * change;
        }
        libm::fabs(change)
    }
}

/// Changes `velocity` until every constraint is met.
pub(crate) fn solve<const N: usize>(
    velocity: &mut Vector<N>,
    constraints: &mut [Option<Constraint<N>>],
) {
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
