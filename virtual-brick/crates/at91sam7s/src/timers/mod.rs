// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Counters of the master clock and the slow clock. None knows who reads its outputs.

pub(crate) mod pit;
pub(crate) mod pwmc;
pub(crate) mod rtt;
pub(crate) mod tc;
pub(crate) mod wdt;
