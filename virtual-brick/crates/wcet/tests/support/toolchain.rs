// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The C compiler for the target.

use std::path::{Path, PathBuf};
use std::process::Command;

const COMPILER: &str = "arm-none-eabi-gcc";

/// Every code and optimisation that programs are tested with.
pub const VARIANTS: [[&str; 2]; 8] = [
    ["-marm", "-O0"],
    ["-marm", "-O1"],
    ["-marm", "-O2"],
    ["-marm", "-Os"],
    ["-mthumb", "-O0"],
    ["-mthumb", "-O1"],
    ["-mthumb", "-O2"],
    ["-mthumb", "-Os"],
];

/// A file next to the tests.
pub fn program(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/programs")
        .join(name)
}

/// Compiles and links C files; `None`, with a message, when there is no compiler.
pub fn build(name: &str, sources: &[PathBuf], flags: &[&str]) -> Option<Vec<u8>> {
    let suffix: String = flags
        .concat()
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .collect();
    // Tests run side by side and build the same programs.
    let thread: String = format!("{:?}", std::thread::current().id());
    let thread = thread.replace(|c: char| !c.is_ascii_digit(), "");
    let file = format!("{name}-{suffix}-{}-{thread}.elf", std::process::id());
    let output = Path::new(env!("CARGO_TARGET_TMPDIR")).join(file);
    let result = Command::new(COMPILER)
        .args([
            "-mcpu=arm7tdmi",
            "-mthumb-interwork",
            "-g",
            "-nostdlib",
            "-ffreestanding",
        ])
        .args([
            "-Wl,-Ttext=0x202000",
            "-Wl,--no-warn-rwx-segments",
            "-Wl,-e0x202000",
        ])
        .args(flags)
        .args(sources)
        .args(["-lgcc", "-o"])
        .arg(&output)
        .output();
    match result {
        Ok(result) if result.status.success() => {
            let content = std::fs::read(&output).expect("the compiler wrote the file");
            let _ = std::fs::remove_file(&output);
            Some(content)
        }
        Ok(result) => panic!("{name}: {}", String::from_utf8_lossy(&result.stderr)),
        Err(_) => {
            eprintln!("skipped: {COMPILER} is not installed, so there is nothing to analyse");
            None
        }
    }
}

/// Calls `check` with a program, compiled for each state, and the flag of that state.
pub fn in_each_state(name: &str, optimisation: &str, check: impl Fn(&str, &[u8])) {
    for state in ["-marm", "-mthumb"] {
        let sources = [program(&format!("{name}.c"))];
        let Some(elf) = build(name, &sources, &[state, optimisation]) else {
            return;
        };
        check(state, &elf);
    }
}
