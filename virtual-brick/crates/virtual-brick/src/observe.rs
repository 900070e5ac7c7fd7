// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! An observer of single steps, for debuggers: sees every step and access, changes nothing.

use arm7tdmi::{Abort, Bus, Cycle, Step, Width};

use crate::assembly::Machine;
use crate::brick::VirtualBrick;

/// A data access of the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Address as the core computed it.
    pub address: u32,
    /// Bytes: 1, 2 or 4.
    pub width_bytes: u32,
    /// The value of a write; none for a read.
    pub written: Option<u32>,
}

/// Looks at a run step by step and can end it between two steps.
pub trait StepObserver {
    /// Whether [`StepObserver::access`] is to be called.
    const SEES_ACCESSES: bool;
    /// Whether the other functions are to be called. Without, the fast engine can run.
    const SEES_STEPS: bool = true;

    /// A step is about to be made; true ends the run before it.
    fn before_step(&mut self, brick: &VirtualBrick) -> bool;

    /// The step makes a data access.
    fn access(&mut self, access: Access);

    /// The step was made; true ends the run.
    fn after_step(&mut self, brick: &VirtualBrick, step: Step) -> bool;
}

/// Nobody looks.
pub(crate) struct Unobserved;

impl StepObserver for Unobserved {
    const SEES_ACCESSES: bool = false;
    const SEES_STEPS: bool = false;

    #[inline(always)]
    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        false
    }

    #[inline(always)]
    fn access(&mut self, _access: Access) {}

    #[inline(always)]
    fn after_step(&mut self, _brick: &VirtualBrick, _step: Step) -> bool {
        false
    }
}

/// The chip's bus with an ear on its data accesses.
pub(crate) struct ObservedBus<'a, O> {
    pub chip: &'a mut Machine,
    pub observer: &'a mut O,
}

const fn bytes(width: Width) -> u32 {
    match width {
        Width::Byte => 1,
        Width::Halfword => 2,
        Width::Word => 4,
    }
}

impl<O: StepObserver> Bus for ObservedBus<'_, O> {
    fn fetch_word(&mut self, address: u32, cycle: Cycle) -> Result<u32, Abort> {
        self.chip.fetch_word(address, cycle)
    }

    fn fetch_halfword(&mut self, address: u32, cycle: Cycle) -> Result<u16, Abort> {
        self.chip.fetch_halfword(address, cycle)
    }

    fn read(&mut self, address: u32, width: Width, cycle: Cycle) -> Result<u32, Abort> {
        self.observer.access(Access {
            address,
            width_bytes: bytes(width),
            written: None,
        });
        self.chip.read(address, width, cycle)
    }

    fn write(&mut self, address: u32, width: Width, value: u32, cycle: Cycle) -> Result<(), Abort> {
        self.observer.access(Access {
            address,
            width_bytes: bytes(width),
            written: Some(value),
        });
        self.chip.write(address, width, value, cycle)
    }

    fn internal(&mut self, count: u32) {
        self.chip.internal(count);
    }

    fn irq(&self) -> bool {
        self.chip.irq()
    }

    fn fiq(&self) -> bool {
        self.chip.fiq()
    }
}
