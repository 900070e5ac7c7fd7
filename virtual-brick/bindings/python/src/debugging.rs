// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The debugger's server for Python.

use std::cell::RefCell;
use std::net::IpAddr;

use debugger::{DebugTarget, Server};
use pyo3::prelude::*;
use virtual_brick_facade::VirtualBrick;

/// What the caller wants.
pub(crate) struct Service {
    pub address: IpAddr,
    pub port: u16,
    pub on_listening: Option<Py<PyAny>>,
    pub should_stop: Option<Py<PyAny>>,
    pub once: bool,
}

impl Service {
    /// Serve until the end; the brick as it is then.
    pub(crate) fn serve(self, py: Python<'_>, brick: VirtualBrick) -> PyResult<VirtualBrick> {
        let server = Server::listen(self.address, self.port)?;
        if let Some(told) = &self.on_listening {
            told.call1(py, (server.address().port(),))?;
        }
        py.detach(|| {
            let failure = RefCell::new(None);
            let stop = || match Python::attach(|py| self.stop_wanted(py)) {
                Ok(wanted) => wanted,
                Err(error) => {
                    failure.replace(Some(error));
                    true
                }
            };
            let mut target = DebugTarget::new(brick);
            if self.once {
                server.serve_one(&mut target, &stop)?;
            } else {
                server.serve(&mut target, &stop)?;
            }
            failure
                .into_inner()
                .map_or_else(|| Ok(target.into_brick()), Err)
        })
    }

    fn stop_wanted(&self, py: Python<'_>) -> PyResult<bool> {
        py.check_signals()?;
        match &self.should_stop {
            Some(asked) => asked.call0(py)?.is_truthy(py),
            None => Ok(false),
        }
    }
}
