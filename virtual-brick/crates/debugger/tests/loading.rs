// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the program says to its debugger, and programs that come from GDB.

use crate::gdb::talk;
use crate::support::arm::{Program, ALWAYS};
use debugger::DebugTarget;

const TEXT: u32 = 0x0020_8000;
const CALL: u32 = 0xEF12_3456;
/// The instruction after the call.
const AFTER: u32 = 0x0020_200C;

/// r1 = text; for ever: say it.
fn talking() -> DebugTarget {
    let mut program = Program::new();
    program.load(1, TEXT);
    let again = program.here();
    program
        .load(0, 4)
        .raw(CALL)
        .delay(1000)
        .branch(ALWAYS, again);
    let mut brick = crate::support::brick(&program);
    brick.write_memory(TEXT, b"hi\n\0").unwrap();
    DebugTarget::new(brick)
}

fn said(replies: &[String]) -> usize {
    replies.iter().filter(|reply| *reply == "O68690a").count()
}

#[test]
fn console_output_comes_before_the_stop_and_again_after_running_backwards() {
    let mut target = talking();
    let to_call = format!("Z0,{AFTER:x},4");
    // At a breakpoint, a client steps before it goes on.
    let replies = talk(&mut target, &[&to_call, "vCont;c", "vCont;s:1", "vCont;c"]);
    assert_eq!(said(&replies), 2, "{replies:?}");
    assert_eq!(replies[1], "O68690a");
    assert!(replies[2].contains("swbreak:"), "{replies:?}");
    let replies = talk(&mut target, &[&to_call, "bc"]);
    assert_eq!(said(&replies), 0, "{replies:?}");
    let replies = talk(&mut target, &["vCont;s:1", &to_call, "vCont;c"]);
    assert_eq!(said(&replies), 1, "{replies:?}");
}

#[test]
fn a_step_over_a_call_is_one_step() {
    let mut target = talking();
    let replies = talk(&mut target, &["vCont;s:1", "vCont;s:1", "vCont;s:1", "pf"]);
    assert_eq!(said(&replies), 1, "{replies:?}");
    assert_eq!(replies.last().unwrap(), "0c202000");
}

#[test]
fn software_interrupts_can_be_left_to_the_program() {
    let mut target = talking();
    assert!(target.monitor("semihosting off").contains("own handler"));
    let replies = talk(&mut target, &["vCont;c"]);
    assert_eq!(said(&replies), 0, "{replies:?}");
    assert!(target.monitor("why").contains("software interrupt"));
}

#[test]
fn flash_is_erased_and_written_in_pages_and_nothing_else_is() {
    let mut target = talking();
    let replies = talk(
        &mut target,
        &[
            "vFlashErase:00100100,00000200",
            "vFlashWrite:100180:abcd",
            "vFlashDone",
            "m10017e,6",
            "vFlashErase:00200000,00000100",
            "vFlashWrite:13fffe:abcd1",
        ],
    );
    assert_eq!(replies[..3], ["OK", "OK", "OK"]);
    assert_eq!(replies[3], "ffff61626364");
    assert!(replies[4].starts_with('E'), "{replies:?}");
    assert!(replies[5].starts_with('E'), "{replies:?}");
}

#[test]
fn another_program_begins_with_the_inputs_that_were_to_come() {
    let mut program = Program::new();
    program.load(0, 0x1234).stop();
    let file = format!("other program {}.elf", std::process::id());
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(file);
    std::fs::write(&file, crate::support::image(&program).build()).unwrap();
    let mut free = crate::support::brick(&program);
    free.schedule_input(50_000, "touch.1", 1.0).unwrap();
    free.run_until(100_000);

    let mut brick = crate::support::brick(Program::new().stop());
    brick.schedule_input(50_000, "touch.1", 1.0).unwrap();
    let mut target = DebugTarget::new(brick);
    target.run_to(70_000);
    assert!(target
        .monitor(&format!("program {}", file.display()))
        .starts_with("cycle 0,"));
    target.run_to(70_000);
    let answer = target.monitor(&format!("program \"{}\"", file.display()));
    std::fs::remove_file(&file).unwrap();
    assert!(answer.starts_with("cycle 0,"), "{answer}");
    target.run_to(100_000);
    assert_eq!(target.into_brick().trace().digest(), free.trace().digest());
}

#[test]
fn a_file_that_is_no_program_is_named() {
    let mut target = talking();
    for path in ["/nowhere/at/all.elf", "/dev/zero", "/etc/hostname"] {
        let answer = target.monitor(&format!("program {path}"));
        assert!(answer.starts_with(path), "{answer}");
    }
    let replies = talk(&mut target, &["vCont;s:1"]);
    assert!(replies[0].starts_with("T05"), "{replies:?}");
}
