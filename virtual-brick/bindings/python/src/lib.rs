// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Python module `virtual_brick`; its types and meanings are written down in `virtual_brick.pyi`.

mod brick;
mod chip_memory_map;
mod debugging;
mod errors;
mod recorded_run;
mod timing;
mod transports;
mod values;

use pyo3::prelude::*;

/// Where the version of the whole project stands.
const VERSION_FILE: &str = include_str!("../../../../host/src/ravenbrick/__init__.py");

/// The project's version when this module was built; empty when the file has none.
fn version() -> &'static str {
    let assignment = VERSION_FILE.split("\n__version__ = \"").nth(1);
    assignment
        .and_then(|rest| rest.split('"').next())
        .unwrap_or_default()
}

/// Cycle-accurate virtual LEGO MINDSTORMS NXT brick.
#[pymodule]
mod virtual_brick {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::brick::{Snapshot, VirtualBrick};
    #[pymodule_export]
    use crate::errors::{AddressError, ConfigurationError, ImageError, InputError};
    #[pymodule_export]
    use crate::recorded_run::{expectation, fitted_speed, signal_unit, Measured, RecordedRun};
    #[pymodule_export]
    use crate::timing::{bound_execution_times, timing_parameters};
    #[pymodule_export]
    use crate::values::{Stop, Thread};

    #[pymodule_export]
    const SOURCES: &str = match option_env!("RAVENBRICK_SOURCES") {
        Some(digest) => digest,
        None => "",
    };
    #[pymodule_export]
    const SPEED_WINDOW: f64 = measures::WINDOW;
    #[pymodule_export]
    const SETTLING_BAND: f64 = measures::SETTLING_BAND;
    #[pymodule_export]
    const JIT: bool = cfg!(feature = "jit");

    #[pymodule_init]
    fn version_of_the_project(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", crate::version())
    }
}
