// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Plans and verdicts in JSON, as the page and the host exchange them.

#![allow(clippy::unwrap_used)]

use measures::{measure, Clock, Expectation, Input, Plan, Run, Stop, Thread};
use serde_json::{json, Value};
use trace::{Event, EventKind, Limits, Signal, Trace};

const HERTZ: Clock = Clock {
    numerator: 1_000_000,
    denominator: 1,
};

/// Releases, starts and completions of task 0 and 1 in microseconds.
const EVENTS: [(u64, EventKind, u32, i64); 7] = [
    (10, EventKind::Release, 1, 10),
    (12, EventKind::ThreadRunning, 1, 0),
    (20, EventKind::Completion, 1, 10),
    (20, EventKind::ThreadRunning, 0, 0),
    (111, EventKind::Release, 1, 110),
    (117, EventKind::ThreadRunning, 1, 0),
    (130, EventKind::Completion, 1, 110),
];

/// The answer of a made run of two motors that step to 3 and -5 counts per sample.
fn answer(plan: &Value) -> Result<Value, String> {
    let mut trace = Trace::new(Limits::default());
    for (at_cycles, kind, subject, value) in EVENTS {
        let event = Event {
            at_cycles,
            kind,
            subject,
            value,
        };
        trace.record(event).unwrap();
    }
    for (at, motor) in [(1_000, 1), (1_000, 2)] {
        let event = Event {
            at_cycles: at,
            kind: EventKind::MotorCommand,
            subject: motor,
            value: 50,
        };
        trace.record(event).unwrap();
    }
    let at_cycles: Vec<u64> = (0..400).map(|row| row * 1_000).collect();
    let ramp = |slope: f64| (0..400).map(move |row| slope * f64::from(row)).collect();
    let (forward, backward): (Vec<f64>, Vec<f64>) = (ramp(3.0), ramp(-5.0));
    let signal = |name, values| Signal {
        name,
        at_cycles: &at_cycles,
        values,
    };
    let thread = |name: &str, base_priority| Thread {
        name: name.to_owned(),
        base_priority,
    };
    let run = Run {
        clock: HERTZ,
        stop: Stop {
            reason: "reached".to_owned(),
            at_cycles: 400_000,
            message: String::new(),
        },
        events: trace.events(),
        signals: vec![
            signal("motor.B.encoder", &forward),
            signal("motor.B.angular_velocity", &forward),
            signal("motor.C.encoder", &backward),
            signal("motor.C.angular_velocity", &backward),
        ],
        threads: &[thread("worker", 1), thread("urgent", 5)],
        screens: &[],
        inputs: &[Input {
            at_cycles: 0,
            name: "touch.1".to_owned(),
            value: 1.0,
        }],
    };
    let plan = Plan::from_json(&plan.to_string())?;
    let answer = measure(&run, &plan)?.answer(&run, &plan)?;
    Ok(serde_json::from_str(&answer).unwrap())
}

#[test]
fn of_several_motors_the_one_farthest_from_zero_counts() {
    let answer = answer(&json!({
        "step": {"from_ms": 0, "until_ms": 399, "motors": ["B", "C"]},
        "criteria": [{"measure": "final_value", "maximum": -80}, {"measure": "distance"}],
    }))
    .unwrap();
    let degrees_per_second = |index: usize| {
        let motor = ["B", "C"][index];
        let speed = answer["measures"]["steps"][motor]["final_value"]
            .as_f64()
            .unwrap();
        speed.to_degrees().round()
    };
    assert_eq!(
        (degrees_per_second(0), degrees_per_second(1)),
        (3000.0, -5000.0)
    );
    assert_eq!(answer["criteria"][0]["met"], true);
    assert_eq!(answer["criteria"][0]["label"], "final_value at most -80");
    assert_eq!(answer["criteria"][0]["shown"], "-87.27");
    let problem = answer["criteria"][1]["problem"].as_str().unwrap();
    assert!(problem.starts_with("'distance' was never reached in the run"));
}

#[test]
fn deadlines_and_response_times_are_judged_by_the_task_set() {
    let answer = answer(&json!({
        "tasks": [{"name": "Urgent", "release": "cyclic", "deadline_us": 15}],
        "expectations": [
            "deadlines met", "response time  of urgent at most 21 us", "deadlines met for nobody",
            "deadlines met at 3 s", "motor.B.encoder at least 50 at 20 ms",
        ],
    }))
    .unwrap();
    let verdicts = answer["expectations"].as_array().unwrap();
    assert_eq!(
        verdicts[0]["sentence"],
        "expected deadlines met, found 1 missed"
    );
    assert_eq!(
        (&verdicts[1]["met"], &verdicts[1]["value"]),
        (&json!(true), &json!(2e-5))
    );
    assert_eq!(
        verdicts[1]["expectation"],
        "response time of urgent at most 21 us"
    );
    assert_eq!(
        verdicts[2]["problem"],
        "there is no task 'nobody'; the image has: urgent, worker"
    );
    assert_eq!(
        verdicts[3]["problem"],
        "'deadlines met' is of the whole run; leave the time out"
    );
    assert_eq!(verdicts[4]["at"], 0.02);
    assert_eq!(
        answer["measures"]["tasks"][0]["response_time_cycles_mean"],
        15.0
    );
}

#[test]
fn bounds_are_exact_to_the_last_bit() {
    let bound: f64 = 0.300_000_000_000_000_04;
    let plan = format!(r#"{{"criteria": [{{"measure": "distance", "minimum": {bound:?}}}]}}"#);
    let plan = Plan::from_json(&plan).unwrap();
    assert_eq!(
        plan.criteria[0].minimum.map(f64::to_bits),
        Some(bound.to_bits())
    );
    assert_eq!(plan.criteria[0].maximum, None);
    let endless = r#"{"criteria": [{"measure": "distance", "maximum": "inf"}]}"#;
    let endless = Plan::from_json(endless).unwrap();
    assert_eq!(endless.criteria[0].maximum, Some(f64::INFINITY));
}

#[test]
fn a_plan_with_an_unknown_field_or_signal_is_refused_by_name() {
    let refused = answer(&json!({"task": []})).unwrap_err();
    assert!(refused.contains("unknown field `task`"), "{refused}");
    let refused = answer(&json!({
        "setpoints": [{"port": "B", "symbol": "wanted", "factor": 0.1}],
        "step": {"from_ms": 0, "until_ms": 300, "motors": ["B"]},
    }));
    let refused = refused.unwrap_err();
    assert!(refused.starts_with("the signal 'probe.wanted' was not recorded; recorded are: motor"));
}

#[test]
fn a_sentence_says_before_the_run_what_it_is_about() {
    let about = |text: &str| -> Value {
        serde_json::from_str(&Expectation::parse(text).unwrap().about()).unwrap()
    };
    assert_eq!(about("pin 31 ever high after 2 s")["pin"], 31);
    assert_eq!(about("pin 31 ever high after 2 s")["last_named"], 2.0);
    assert_eq!(about("deadlines met for x")["task"], "x");
    assert_eq!(about(r#"a fault saying "x  y""#)["judges_faults"], true);
    assert_eq!(about(r#"lcd  shows "x  y""#)["text"], r#"lcd shows "x  y""#);
    for wrong in [
        "pin 32 high",
        "pin 05 high",
        "body.x at least 2 ",
        "lcd shows \"\"",
        "x at least 1e",
    ] {
        let parsed = Expectation::parse(wrong).map(|found| found.text);
        assert!(parsed.is_err() || wrong.ends_with(' '), "{wrong}");
    }
}
