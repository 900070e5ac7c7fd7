// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM7TDMI core: registers, decoding, execution, cycle counts. Knows only a bus.

pub mod bus;
