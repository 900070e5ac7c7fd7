// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Builders for tests: small ELF files, hand-assembled words.
#![allow(dead_code, clippy::unwrap_used)]

pub mod elf;
