// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Types of objects and source lines from debug information that the cross compiler writes. Needs
//! `arm-none-eabi-gcc`, which the set-up of the project installs.
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use image::{Image, ScalarKind};

const SOURCE: &str = "
typedef float real32_T;
typedef struct { real32_T correctedvoltage; struct { short count; } inner; } Outputs;
typedef enum { idle, driving } mode_t;
Outputs functional_Y;
volatile const unsigned char flag = 1;
static int hidden = 2;
mode_t mode;
double wide;
int *pointer;
int tasks__limit;
int discarded(int a) { return a + 1; }
void _start(void) { pointer = &hidden; mode = driving; wide = 1.5; tasks__limit = 3; for (;;) ; }
";

/// Both tests read the one image; the compiler runs once.
fn image() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(compile)
}

fn compile() -> Image {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // Another run of these tests may be under way.
    let own = |suffix| folder.join(format!("types-{}.{suffix}", std::process::id()));
    let (source, elf) = (own("c"), own("elf"));
    std::fs::write(&source, SOURCE).unwrap();
    let status = Command::new("arm-none-eabi-gcc")
        .args([
            "-mcpu=arm7tdmi",
            "-g",
            "-O1",
            "-nostdlib",
            "-fno-common",
            "-ffunction-sections",
            "-Wl,--gc-sections",
            "-Wl,--undefined=functional_Y,--undefined=flag",
            "-Wl,-Ttext=0x202000",
        ])
        .arg(&source)
        .arg("-o")
        .arg(&elf)
        .status()
        .expect("arm-none-eabi-gcc starts; run the project's set-up");
    assert!(status.success());
    let content = std::fs::read(&elf).unwrap();
    for file in [&source, &elf] {
        std::fs::remove_file(file).unwrap();
    }
    Image::parse(&content).unwrap()
}

#[test]
fn types_of_global_objects_come_from_the_debug_information() {
    let image = image();
    for (path, kind) in [
        ("functional_Y.correctedvoltage", ScalarKind::F32),
        ("functional_Y.inner.count", ScalarKind::I16),
        ("flag", ScalarKind::U8),
        ("hidden", ScalarKind::I32),
        ("mode", ScalarKind::U8),
        ("wide", ScalarKind::F64),
        ("pointer", ScalarKind::U32),
        ("Tasks.Limit", ScalarKind::I32),
    ] {
        let variable = image.variable(path).unwrap();
        assert_eq!(variable.kind, Some(kind), "{path}");
        assert_eq!(variable.size, kind.size(), "{path}");
    }
    let outputs = image.symbols().get("functional_Y").unwrap().address;
    assert_eq!(
        image.variable("functional_Y.inner.count").unwrap().address,
        outputs + 4
    );
    assert_eq!(image.variable("functional_Y").unwrap().kind, None);
}

#[test]
fn a_missing_component_is_named() {
    let message = image()
        .variable("functional_Y.speed")
        .unwrap_err()
        .to_string();
    assert!(message.contains("no component `speed`"), "{message}");
}

#[test]
fn lines_are_those_of_the_code_and_not_of_a_function_that_the_linker_discarded() {
    let image = image();
    assert_eq!(image.symbols().get("discarded"), None);
    let lines = image.lines();
    // Its rows begin at address 0, where the processor takes its exceptions.
    assert_eq!([0, 4, 0x18].map(|address| lines.at(address)), [None; 3]);
    let at = lines.at(image.entry()).unwrap();
    assert!(at.file.ends_with(".c"), "{at:?}");
    assert_eq!(
        SOURCE.lines().nth(at.line as usize - 1).unwrap().get(..12),
        Some("void _start(")
    );
}
