// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Behaviour of the core seen from outside, over a memory that answers in one cycle.

mod program;

mod access;
mod arm_data;
mod arm_transfers;
mod bus_order;
mod cycles_on_silicon;
mod every_opcode;
mod exceptions;
mod interrupts;
mod thumb;
