// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Accesses that the model cannot carry out: the first fault ends a run.

use std::fmt;

use crate::clock::Cycles;

/// Why an access cannot be carried out faithfully.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The boot ROM, whose content is its maker's and no part of the virtual brick.
    BootRom,
    /// The peripheral is modelled, this offset is not (or does not exist).
    RegisterNotModelled {
        /// Name of the peripheral in the datasheet.
        peripheral: &'static str,
        /// Register offset from its base address.
        offset: u32,
    },
    /// The register is modelled, what the written value asks for is not.
    FeatureNotModelled {
        /// Name of the peripheral in the datasheet.
        peripheral: &'static str,
        /// What was asked for.
        feature: &'static str,
    },
    /// An operation was started on a peripheral whose clock is off.
    ClockDisabled {
        /// Name of the peripheral in the datasheet.
        peripheral: &'static str,
        /// Its bit in `PMC_PCER`.
        identifier: u8,
    },
    /// No peripheral answers at this address.
    NoPeripheral,
    /// Flash was written with a width other than 32 bits.
    FlashWriteWidth,
    /// A peripheral data controller pointer left the memories.
    TransferAddress {
        /// Name of the peripheral in the datasheet.
        peripheral: &'static str,
    },
}

/// The first thing that the model could not do, with the access that asked for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// When the access took effect.
    pub at_cycles: Cycles,
    /// What is wrong.
    pub kind: FaultKind,
    /// Address of the access.
    pub address: u32,
    /// True for a write.
    pub write: bool,
    /// Value written; 0 for a read.
    pub value: u32,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            FaultKind::BootRom => f.write_str(
                "the boot ROM's content is Atmel's and no part of the virtual brick; a program \
                 comes here only by a wrong pointer",
            )?,
            FaultKind::RegisterNotModelled { peripheral, offset } => {
                write!(
                    f,
                    "{peripheral} has no modelled register at offset {offset:#05x}"
                )?;
            }
            FaultKind::FeatureNotModelled {
                peripheral,
                feature,
            } => {
                write!(f, "{peripheral}: {feature} is not modelled")?;
            }
            FaultKind::ClockDisabled {
                peripheral,
                identifier,
            } => write!(
                f,
                "{peripheral} was started while its clock is off: set bit {identifier} of PMC_PCER"
            )?,
            FaultKind::NoPeripheral => f.write_str("no peripheral answers at this address")?,
            FaultKind::FlashWriteWidth => f.write_str("flash takes 32-bit writes only")?,
            FaultKind::TransferAddress { peripheral } => write!(
                f,
                "{peripheral}: the data controller's pointer is outside SRAM and flash"
            )?,
        }
        if self.write {
            write!(f, "; write of {:#010x} to", self.value)?;
        } else {
            f.write_str("; read of")?;
        }
        write!(f, " {:#010x} at cycle {}", self.address, self.at_cycles)
    }
}

impl std::error::Error for Fault {}

/// Result of a register access inside a peripheral.
pub(crate) type Access<T = ()> = Result<T, FaultKind>;

/// The register at `offset` is not modelled or does not exist.
pub(crate) fn no_register<T>(peripheral: &'static str, offset: u32) -> Access<T> {
    Err(FaultKind::RegisterNotModelled { peripheral, offset })
}

/// The written value asks for a feature that is not modelled.
pub(crate) fn not_modelled<T>(peripheral: &'static str, feature: &'static str) -> Access<T> {
    Err(FaultKind::FeatureNotModelled {
        peripheral,
        feature,
    })
}

/// The peripheral was started without its clock.
pub(crate) fn clock_disabled<T>(peripheral: &'static str, identifier: u8) -> Access<T> {
    Err(FaultKind::ClockDisabled {
        peripheral,
        identifier,
    })
}

/// A transfer of the data controller that cannot be carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TransferFault {
    /// Why.
    pub(crate) kind: FaultKind,
    /// Pointer of the data controller.
    pub(crate) pointer: u32,
    /// The value of a transfer to memory.
    pub(crate) written: Option<u32>,
}
