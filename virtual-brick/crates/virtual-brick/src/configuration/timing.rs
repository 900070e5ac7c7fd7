// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timing that no document fixes: a profile and single values in its place.

use at91sam7s::{CodeBufferLoss, TimingProfile};
use nxt::CoprocessorTiming;
use serde_json::{Map, Value};

use super::error::ConfigurationError;
use super::timing_parameters::{TimingParameter, TIMING_PARAMETERS};
use crate::engine::Engine;

/// The doubtful costs of core, chip and co-processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Of the core.
    pub core: arm7tdmi::TimingProfile,
    /// Of memory, interrupt path, data controller and two-wire interface.
    pub chip: TimingProfile,
    /// Of the co-processor's program.
    pub coprocessor: CoprocessorTiming,
}

impl Default for Timing {
    fn default() -> Self {
        Self::nominal()
    }
}

impl Timing {
    /// Expected values.
    #[must_use]
    pub const fn nominal() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::nominal(),
            chip: TimingProfile::nominal(),
            coprocessor: CoprocessorTiming::nominal(),
        }
    }

    /// Every doubtful value at its lowest.
    #[must_use]
    pub const fn optimistic() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::optimistic(),
            chip: TimingProfile::optimistic(),
            coprocessor: CoprocessorTiming::optimistic(),
        }
    }

    /// Every doubtful value at its highest.
    #[must_use]
    pub const fn pessimistic() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::nominal(),
            chip: TimingProfile::pessimistic(),
            coprocessor: CoprocessorTiming::pessimistic(),
        }
    }

    /// What can execute instructions under this timing: blocks know no cost that depends on what
    /// the bus did before a fetch.
    pub(super) fn engine(&self, wanted: Engine) -> Engine {
        if self.chip.code_buffer_loss == CodeBufferLoss::Branch {
            wanted
        } else {
            Engine::Reference
        }
    }

    /// The profile with the values that replace its own.
    pub(super) fn from_fields(fields: &Map<String, Value>) -> Result<Self, ConfigurationError> {
        let mut timing = match fields.get("profile").map(Value::as_str) {
            None | Some(Some("nominal")) => Self::nominal(),
            Some(Some("optimistic")) => Self::optimistic(),
            Some(Some("pessimistic")) => Self::pessimistic(),
            Some(_) => {
                let problem = "must be \"optimistic\", \"nominal\" or \"pessimistic\"";
                return Err(ConfigurationError::field("timing.profile", problem));
            }
        };
        for (name, value) in fields.iter().filter(|(name, _)| *name != "profile") {
            let path = format!("timing.{name}");
            let parameter = parameter(name).ok_or_else(|| unknown(&path))?;
            if !parameter.values.set(&mut timing, value) {
                let problem = format!("must be {}", parameter.values);
                return Err(ConfigurationError::field(&path, problem));
            }
        }
        Ok(timing)
    }
}

fn parameter(name: &str) -> Option<&'static TimingParameter> {
    TIMING_PARAMETERS.iter().find(|known| known.name == name)
}

fn unknown(path: &str) -> ConfigurationError {
    let names: Vec<_> = TIMING_PARAMETERS.iter().map(|known| known.name).collect();
    let problem = format!("unknown parameter, expected profile, {}", names.join(", "));
    ConfigurationError::field(path, problem)
}
