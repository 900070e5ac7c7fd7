// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Peripherals that exchange data with the board, and the data controller that feeds them.

pub(crate) mod pdc;
pub(crate) mod ports;
pub(crate) mod spi;
pub(crate) mod ssc;
pub(crate) mod twi;
pub(crate) mod udp;
pub(crate) mod usart;
