// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The reference engine: one instruction after the other, each bus cycle in its order.

mod arm;
mod block_transfer;
mod exceptions;
mod fetch;
mod multiply;
mod status;
mod step;
mod thumb;
mod thumb_transfer;
mod transfer;
