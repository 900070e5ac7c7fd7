// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Python module `virtual_brick`; its types and meanings are written down in `virtual_brick.pyi`.

mod brick;
mod debugging;
mod errors;
mod outside;
mod timing;
mod values;

use pyo3::prelude::*;

/// Cycle-accurate virtual LEGO MINDSTORMS NXT brick.
#[pymodule]
mod virtual_brick {
    #[pymodule_export]
    use crate::brick::{Snapshot, VirtualBrick};
    #[pymodule_export]
    use crate::errors::{AddressError, ConfigurationError, ImageError, InputError};
    #[pymodule_export]
    use crate::timing::bound_execution_times;
    #[pymodule_export]
    use crate::values::{Stop, Thread};
}
