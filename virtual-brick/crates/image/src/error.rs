// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Why an image was refused, as sentences for the reader.

use std::fmt;

/// An image that cannot be used, or a name that it does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// The file ends before its headers or contents do.
    Truncated {
        /// Bytes in the file.
        length: usize,
        /// What is missing.
        missing: &'static str,
    },
    /// The file does not start with the ELF magic number.
    NotElf,
    /// The file is ELF for another machine or of another kind.
    WrongMachine {
        /// What was found.
        found: String,
    },
    /// The headers contradict each other.
    Malformed {
        /// What the reader met.
        detail: String,
    },
    /// The debug information contradicts itself.
    DebugInformation {
        /// What the reader met.
        detail: String,
    },
    /// No segment has contents to load.
    Empty,
    /// The entry lies in no segment.
    EntryOutside {
        /// The entry address.
        entry: u32,
    },
    /// The image has no such symbol.
    UnknownSymbol {
        /// Name asked for.
        name: String,
        /// Symbols whose names contain it.
        similar: Vec<String>,
    },
    /// The type of an object is needed and not known.
    UnknownType {
        /// Name asked for.
        path: String,
        /// Its size in bytes, 0 when unknown.
        size: u32,
    },
    /// A component was asked of an object that has none of this name.
    UnknownComponent {
        /// Name asked for.
        path: String,
        /// What is known about it.
        detail: String,
    },
}

impl ImageError {
    /// The headers contradict each other.
    pub(crate) fn malformed(error: impl fmt::Display) -> Self {
        Self::Malformed {
            detail: error.to_string(),
        }
    }

    pub(crate) fn debug_information(error: gimli::Error) -> Self {
        Self::DebugInformation {
            detail: error.to_string(),
        }
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { length, missing } => write!(
                f,
                "the image is truncated: {length} bytes, {missing} missing; build it again"
            ),
            Self::NotElf => {
                write!(
                    f,
                    "the image is not an ELF file (no magic number 7F 45 4C 46 at its start)"
                )
            }
            Self::WrongMachine { found } => write!(
                f,
                "the image is not an executable for 32-bit little-endian ARM: it is {found}"
            ),
            Self::Malformed { detail } => write!(f, "the image is not a valid ELF file: {detail}"),
            Self::DebugInformation { detail } => {
                write!(f, "the debug information of the image is broken: {detail}")
            }
            Self::Empty => write!(f, "the image has no segment with contents to load"),
            Self::EntryOutside { entry } => write!(
                f,
                "the entry {entry:#010X} lies in no loaded segment; give the linker the entry \
                 symbol"
            ),
            Self::UnknownSymbol { name, similar } if similar.is_empty() => {
                write!(f, "the image has no symbol `{name}`")
            }
            Self::UnknownSymbol { name, similar } => {
                write!(
                    f,
                    "the image has no symbol `{name}`; similar: {}",
                    similar.join(", ")
                )
            }
            Self::UnknownType { path, size } => write!(
                f,
                "the type of `{path}` ({size} bytes) is not known as a scalar; give its kind (i32, \
                 f32, ...) or build with debug information"
            ),
            Self::UnknownComponent { path, detail } => {
                write!(f, "the image has no object `{path}`: {detail}")
            }
        }
    }
}

impl std::error::Error for ImageError {}
