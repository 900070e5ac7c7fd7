// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timing as Python functions: bounds of execution times, the parameters that no document fixes.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use virtual_brick_facade::{Timing, TIMING_PARAMETERS};
use wcet::{AnnotationFile, Request};

use crate::chip_memory_map::memory_map;

/// Facts that hold in every program: compiler's library, failures, run-time.
const KNOWN: [(&str, &str); 3] = [
    (
        "libgcc.toml",
        include_str!("../../../crates/wcet/annotations/libgcc.toml"),
    ),
    (
        "failures.toml",
        include_str!("../../../crates/wcet/annotations/failures.toml"),
    ),
    (
        "runtime.toml",
        include_str!("../../../crates/wcet/annotations/runtime.toml"),
    ),
];

/// The map without regions.
const PLAIN: &str = "plain";

/// Facts that need the chip's regions.
const PLACEMENT: (&str, &str) = (
    "placement.toml",
    include_str!("../../../crates/wcet/annotations/placement.toml"),
);

/// Bounds of the functions and jobs of a request, from an ELF file.
#[pyfunction]
#[pyo3(signature = (elf, request, timing = "nominal", wait_states = 1))]
pub(crate) fn bound_execution_times(
    py: Python<'_>,
    elf: &[u8],
    request: &str,
    timing: &str,
    wait_states: u64,
) -> PyResult<String> {
    let wrong = |error: &dyn std::fmt::Display| PyValueError::new_err(error.to_string());
    let mut request: Request = serde_json::from_str(request).map_err(|e| wrong(&e))?;
    let placement = (timing != PLAIN).then_some(PLACEMENT);
    let known = KNOWN.into_iter().chain(placement);
    request
        .annotations
        .extend(known.map(|(name, text)| AnnotationFile {
            name: name.to_owned(),
            text: text.to_owned(),
            own: false,
        }));
    let map = memory_map(timing, wait_states).map_err(|e| wrong(&e))?;
    let elf = elf.to_vec();
    let response = py
        .detach(|| request.answer(&elf, &map))
        .map_err(|e| wrong(&e))?;
    serde_json::to_string(&response).map_err(|e| wrong(&e))
}

/// The parameters of `timing` in the configuration, as a JSON list.
#[pyfunction]
pub(crate) fn timing_parameters() -> String {
    let rows = TIMING_PARAMETERS.iter().map(|parameter| {
        let value = |timing: Timing| parameter.values.get(&timing);
        json!({
            "name": parameter.name,
            "meaning": parameter.meaning,
            "source": parameter.source,
            "values": parameter.values.to_string(),
            "optimistic": value(Timing::optimistic()),
            "nominal": value(Timing::nominal()),
            "pessimistic": value(Timing::pessimistic()),
        })
    });
    serde_json::Value::from_iter(rows).to_string()
}
