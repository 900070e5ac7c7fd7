// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! AT91SAM7S256: memory map and on-chip peripherals. Knows the board only as pins and lines.

pub mod board;
