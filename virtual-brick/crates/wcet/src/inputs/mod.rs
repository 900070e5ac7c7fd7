// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Everything given about a program: its ELF image, its source lines, the memory map with the
//! cost of each access, and annotations. Knows no control flow.

pub mod annotations;
pub mod image;
pub mod kernel;
pub mod lines;
pub mod memory_map;
