// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Typed exceptions of the module.

use std::fmt::Display;

use pyo3::exceptions::PyValueError;
use pyo3::{create_exception, PyErr, PyTypeInfo};

create_exception!(
    virtual_brick,
    ConfigurationError,
    PyValueError,
    "A refused configuration."
);
create_exception!(
    virtual_brick,
    ImageError,
    PyValueError,
    "A refused image, or an unknown symbol."
);
create_exception!(virtual_brick, InputError, PyValueError, "A refused input.");
create_exception!(
    virtual_brick,
    AddressError,
    PyValueError,
    "An address that is not memory."
);

/// The exception of type `E` with the sentence of a Rust error.
pub(crate) fn raise<E: PyTypeInfo>(error: impl Display) -> PyErr {
    PyErr::new::<E, _>(error.to_string())
}
