// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Measures the published points of real motors on the plant: `cargo run --release -p plant
//! --example published_points` prints them as one line of JSON.

#[path = "../tests/common/mod.rs"]
mod common;

use common::points::{sets, stall_percent_at_most, MISSED, POINTS};
use common::SET_A;
use serde_json::{json, Value};

fn main() {
    let sets = sets();
    let point = |point: &common::points::Point| {
        let measured: Vec<Value> = sets
            .iter()
            .map(|set| {
                let value = set.value(point);
                let passes = point.passes(value);
                json!({"set": set.name, "rich": set.rich, "value": value, "passes": passes})
            })
            .collect();
        json!({
            "condition": point.condition,
            "quantity": point.quantity,
            "published": point.published,
            "limits": point.limits().map(|(low, high)| [low, high]),
            "source": point.source,
            "measured": measured,
        })
    };
    let miss = |miss: &common::points::Miss| {
        json!({
            "set": miss.set,
            "condition": miss.condition,
            "quantity": miss.quantity,
            "reason": miss.reason,
        })
    };
    let points: Vec<Value> = POINTS.iter().map(point).collect();
    let missed: Vec<Value> = MISSED.iter().map(miss).collect();
    let allowed = stall_percent_at_most(SET_A);
    println!(
        "{}",
        json!({"points": points, "missed": missed, "stall_percent_at_most": allowed})
    );
}
