// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Controllers of interrupts, clocks and resets.

pub(crate) mod aic;
pub(crate) mod pmc;
pub(crate) mod rstc;
