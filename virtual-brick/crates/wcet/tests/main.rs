// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The tests of the crate's interface, as one program: it is compiled and linked once.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod between_waits;
mod calls;
mod chip;
mod controller;
mod critical_sections;
mod flow_facts;
mod interworking;
mod loop_forms;
mod random_waits;
mod refusals;
mod requests;
mod soundness;
mod stacks;
mod support;
mod task_bodies;
mod worst_path;
