// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Plan and verdicts in JSON.

use serde::Serialize;
use serde_json::json;

use crate::measures::{Criterion, Measures, Plan};
use crate::run::Run;
use crate::sentence::{Expectation, Expected};
use crate::verdict::{judge, judge_criterion, CriterionVerdict, Verdict};

#[derive(Serialize)]
struct Answer<'a> {
    measures: &'a Measures,
    criteria: Vec<Judgement<CriterionVerdict>>,
    expectations: Vec<Judgement<Verdict>>,
}

/// A verdict, or why there is none.
#[derive(Serialize)]
#[serde(untagged)]
enum Judgement<V> {
    Verdict(V),
    Problem {
        #[serde(skip_serializing_if = "Option::is_none")]
        measure: Option<String>,
        #[serde(skip_serializing_if = "Option::is_none")]
        expectation: Option<String>,
        problem: String,
    },
}

impl Plan {
    /// Read a plan.
    ///
    /// # Errors
    /// The text is no plan; the sentence names the place.
    pub fn from_json(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }
}

impl Measures {
    /// These measures in JSON, and a verdict on each criterion and sentence of a plan in its order.
    ///
    /// # Errors
    /// Those of the writer of JSON.
    pub fn answer(&self, run: &Run<'_>, plan: &Plan) -> Result<String, String> {
        let criterion = |criterion: &Criterion| {
            let judged = judge_criterion(criterion, self);
            judged.map_or_else(
                |problem| Judgement::Problem {
                    measure: Some(criterion.measure.clone()),
                    expectation: None,
                    problem,
                },
                Judgement::Verdict,
            )
        };
        let expectation = |text: &String| {
            let parsed = Expectation::parse(text);
            let judged = parsed.and_then(|expectation| judge(&expectation, run, self));
            judged.map_or_else(
                |problem| Judgement::Problem {
                    measure: None,
                    expectation: Some(text.clone()),
                    problem,
                },
                Judgement::Verdict,
            )
        };
        let answer = Answer {
            measures: self,
            criteria: plan.criteria.iter().map(criterion).collect(),
            expectations: plan.expectations.iter().map(expectation).collect(),
        };
        serde_json::to_string(&answer).map_err(|error| error.to_string())
    }
}

impl Expectation {
    /// What a program must know of a sentence before a run, in JSON: its `text`, the `pin` and the
    /// last instant that it names, whether it judges faults or deadlines, and of which `task`.
    #[must_use]
    pub fn about(&self) -> String {
        let (task, judges_tasks) = match &self.expected {
            Expected::Deadlines { task } => (task.as_deref(), true),
            Expected::Response { task, .. } => (Some(task.as_str()), true),
            _ => (None, false),
        };
        json!({
            "text": self.text,
            "pin": self.pin(),
            "last_named": self.window.last_named().min(f64::MAX),
            "judges_faults": matches!(self.expected, Expected::Fault { .. }),
            "judges_tasks": judges_tasks,
            "task": task,
        })
        .to_string()
    }
}
