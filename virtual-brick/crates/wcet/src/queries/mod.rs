// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Questions that callers ask, and the form of the answers.

pub mod between_waits;
pub mod flow_points;
pub mod known_memory;
pub mod observed_path;
pub mod path_problem;
pub mod path_report;
pub mod report;
pub mod request;
pub mod task_job;
pub mod unmatched_facts;
