// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What keeps a program from being bounded, with the place where it happens.

use std::fmt;

/// A place in the program, as far as the image tells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Address of the instruction.
    pub address: u32,
    /// Function and offset in it.
    pub symbol: Option<(String, u32)>,
    /// Source file and line.
    pub line: Option<(String, u32)>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#010x}", self.address)?;
        if let Some((name, offset)) = &self.symbol {
            write!(f, " in {name}+{offset:#x}")?;
        }
        if let Some((file, line)) = &self.line {
            write!(f, " ({file}:{line})")?;
        }
        Ok(())
    }
}

/// A loop for which an annotation must state a bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingBound {
    /// The loop's first instruction.
    pub place: Place,
    /// Number of the loop among those of its function, by address.
    pub index: usize,
    /// Source lines of its blocks that are in no inner loop.
    pub lines: Vec<(String, u32)>,
    /// Functions that were active, the outermost first, the loop's own left out.
    pub callers: Vec<String>,
}

/// A loop bound of the user that some call certainly exceeds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contradiction {
    /// The fact, with the file in which it stands.
    pub fact: String,
    /// Most executions of the loop's first block for each entry, by the fact.
    pub allowed: u64,
    /// The loop's first instruction.
    pub place: Place,
    /// Functions that were active, the outermost first, the loop's own left out.
    pub callers: Vec<String>,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} contradicts the code: the loop at {}",
            self.fact, self.place
        )?;
        let mut callers = self.callers.iter().rev();
        callers.try_for_each(|caller| write!(f, ", called by {caller}"))?;
        write!(
            f,
            ", cannot be left within {} executions of its first block; correct the fact, or let \
             it hold for other calls only, with 'within'",
            self.allowed
        )
    }
}

/// Why there is no bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// An argument, the image or an annotation is wrong.
    Input(String),
    /// Functions call each other in a cycle.
    Recursion(Vec<Place>),
    /// The target of a branch or call is not known.
    UnresolvedBranch(Place),
    /// Control leaves the code of the image, or reaches data.
    NoCode(Place),
    /// A loop is entered at two places, so no bound per entry can be stated.
    Irreducible(Place),
    /// Loops without a bound.
    MissingBounds(Vec<MissingBound>),
    /// A fact of the user that the code contradicts.
    Contradiction(Box<Contradiction>),
    /// The function has no path to its end.
    NeverReturns(Place),
    /// A software interrupt, whose handler is not part of the program's graph.
    SoftwareInterrupt(Place),
    /// The function returns with another stack pointer than it was called with.
    StackNotRestored(Place),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(text) => f.write_str(text),
            Self::Recursion(cycle) => {
                f.write_str("recursion cannot be bounded:")?;
                cycle
                    .iter()
                    .try_for_each(|place| write!(f, "\n  called at {place}"))
            }
            Self::UnresolvedBranch(place) => write!(
                f,
                "{place}: the target of this branch is not known; give it as [[call]] with \
                 'targets' in the annotation file"
            ),
            Self::NoCode(place) => write!(f, "{place}: control reaches a place without code"),
            Self::Irreducible(place) => write!(
                f,
                "{place}: a loop is entered at several places, too many to follow each of them"
            ),
            Self::MissingBounds(loops) => {
                f.write_str(
                    "loops without a bound; give each as [[loop]] in the annotation file:",
                )?;
                loops.iter().try_for_each(|missing| {
                    write!(f, "\n  loop {} at {}", missing.index, missing.place)
                })
            }
            Self::Contradiction(found) => found.fmt(f),
            Self::NeverReturns(place) => write!(f, "{place}: the function never returns"),
            Self::SoftwareInterrupt(place) => {
                write!(f, "{place}: a software interrupt has no bound here")
            }
            Self::StackNotRestored(place) => write!(
                f,
                "{place}: returns with another stack pointer than the function was called with"
            ),
        }
    }
}

impl std::error::Error for Error {}
