// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The core against single-step vectors of an independent core.

use crate::support::{archive, single_step::Class};
use std::path::Path;

const ARCHIVE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../../verification/processor/arm7tdmi-single-step.tar.xz"
);

#[test]
fn the_first_40_vectors_of_each_class_agree_in_state_writes_and_cycles() {
    let members = archive::read(Path::new(ARCHIVE)).expect("the archive is readable");
    let mut case_count = 0;
    for member in members {
        let class = Class::parse(&member.name, &member.content).expect("the class is readable");
        for record in class.records.iter().take(40) {
            case_count += 1;
            assert_eq!(class.run(record), Ok(()));
        }
    }
    assert_eq!(case_count, 37 * 40);
}
