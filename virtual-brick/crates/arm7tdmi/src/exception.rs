// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Exceptions: vectors, modes and masks (DDI 0029E, section 3.9).

use crate::registers::{psr, Mode};

/// The exceptions of the architecture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exception {
    /// nRESET was driven low.
    Reset,
    /// An encoding without meaning, or a coprocessor instruction no coprocessor accepts.
    UndefinedInstruction,
    /// SWI.
    SoftwareInterrupt,
    /// An opcode whose fetch was aborted reached execution.
    PrefetchAbort,
    /// A load or store was aborted.
    DataAbort,
    /// nIRQ.
    Irq,
    /// nFIQ.
    Fiq,
}

impl Exception {
    /// Address of the exception's vector.
    pub const fn vector(self) -> u32 {
        match self {
            Self::Reset => 0x00,
            Self::UndefinedInstruction => 0x04,
            Self::SoftwareInterrupt => 0x08,
            Self::PrefetchAbort => 0x0C,
            Self::DataAbort => 0x10,
            Self::Irq => 0x18,
            Self::Fiq => 0x1C,
        }
    }

    /// Mode in which the exception is handled.
    pub const fn mode(self) -> Mode {
        match self {
            Self::Reset | Self::SoftwareInterrupt => Mode::Supervisor,
            Self::UndefinedInstruction => Mode::Undefined,
            Self::PrefetchAbort | Self::DataAbort => Mode::Abort,
            Self::Irq => Mode::Irq,
            Self::Fiq => Mode::Fiq,
        }
    }

    pub(crate) const fn masks(self) -> u32 {
        match self {
            Self::Reset | Self::Fiq => psr::I | psr::F,
            _ => psr::I,
        }
    }
}
