// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The core against single-step vectors of an independent core.

#![allow(clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;
use support::{archive, single_step::Class};

const ARCHIVE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../../verification/processor/arm7tdmi-single-step.tar.xz"
);

fn failures(records_per_class: usize) -> (usize, Vec<String>) {
    let members = archive::read(Path::new(ARCHIVE)).expect("the archive is readable");
    let mut case_count = 0;
    let mut failures = Vec::new();
    for member in members {
        let class = Class::parse(&member.name, &member.content).expect("the class is readable");
        for record in class.records.iter().take(records_per_class) {
            case_count += 1;
            failures.extend(class.run(record).err());
        }
    }
    (case_count, failures)
}

fn assert_all_pass(records_per_class: usize, expected_cases: usize) {
    let (case_count, failures) = failures(records_per_class);
    assert_eq!(case_count, expected_cases);
    assert!(
        failures.is_empty(),
        "{} of {case_count} differ, the first: {}",
        failures.len(),
        failures[0]
    );
}

#[test]
fn the_first_40_vectors_of_each_class_agree_in_state_writes_and_cycles() {
    assert_all_pass(40, 37 * 40);
}

#[test]
#[ignore = "all 14,800 vectors; run in release builds"]
fn all_vectors_agree_in_state_writes_and_cycles() {
    assert_all_pass(usize::MAX, 37 * 400);
}
