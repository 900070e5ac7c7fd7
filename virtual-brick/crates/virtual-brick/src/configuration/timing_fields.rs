// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The fields of `timing`: a profile and single values in its place.

use serde_json::{Map, Value};

use super::error::ConfigurationError;
use super::timing::Timing;
use super::timing_parameters::{TimingParameter, TIMING_PARAMETERS};

impl Timing {
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
