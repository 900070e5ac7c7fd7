// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Everything given about a program: its image, the memory map with the cost of each access,
//! annotations and the conventions of its kernel. Knows no control flow.

pub mod annotations;
pub mod facts;
pub mod image;
pub mod kernel;
pub mod memory_map;
