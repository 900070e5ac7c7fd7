// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Tasks as threads, on a program that writes the run-time's words by hand.

use crate::gdb::talk;
use crate::support::arm::{Program, ALWAYS};
use crate::support::{image, vehicle};
use debugger::DebugTarget;
use virtual_brick::VirtualBrick;

const RUNNING: u32 = 0x0020_8000;
const FIRST: u32 = 0x0020_8004;
const CONTROL: u32 = 0x0020_8100;
const DISPLAY: u32 = 0x0020_8200;
const STACK: u32 = 0x0020_8800;
const LAYOUT: u32 = 0x0020_A000;
const RESUME: u32 = 0x0020_A100;
const SWITCHED: u32 = 0x0020_A180;
const INTERRUPT_TOP: u32 = 0x0020_9000;
/// Offsets of the run-time's control block.
const OFFSETS: [u32; 9] = [36, 28, 32, 20, 0, 24, 40, 48, 52];
const STACK_POINTER: u32 = 8;
const PRIORITY: u32 = 20;
const STATE: u32 = 24;
const NEXT: u32 = 36;
const CYCLES: u64 = 2_000;

/// `control` runs in System mode, `display` is ready with its stack pointer at `STACK`.
fn program() -> Program {
    let mut program = Program::new();
    for (address, value) in [
        (CONTROL + NEXT, DISPLAY),
        (CONTROL + PRIORITY, 5),
        (DISPLAY + STACK_POINTER, STACK),
        (FIRST, CONTROL),
        (CONTROL + STATE, 1),
        (DISPLAY + STATE, 1),
        (RUNNING, CONTROL),
    ] {
        program.poke(address, value);
    }
    program.status(0xDF);
    program
}

fn target(mut program: Program) -> DebugTarget {
    let here = program.here();
    program.add(0, 1).branch(ALWAYS, here);
    let mut layout = vec![1, 64];
    layout.extend(OFFSETS);
    let elf = image(&program)
        .words(LAYOUT, &layout)
        .words(RESUME, &[0xE1A0_000D, 0xE28D_D01C, 0xE8BD_4FF0])
        .words(SWITCHED, &[0xE121_F01F])
        .object("ravenbrick_switched", SWITCHED, 4)
        .object("tasks__control", CONTROL, 64)
        .object("tasks__display", DISPLAY, 64)
        .object("ravenbrick_running_thread", RUNNING, 4)
        .object("ravenbrick_first_thread", FIRST, 4)
        .object("ravenbrick_thread_layout", LAYOUT, 44)
        .object("ravenbrick_interrupt_stack_top", INTERRUPT_TOP, 0);
    let brick = VirtualBrick::new(&vehicle(), &elf.build()).unwrap();
    let mut target = DebugTarget::new(brick);
    target.run_to(CYCLES);
    target
}

fn set_words(target: &mut DebugTarget, address: u32, words: &[u32]) {
    let hex: String = words
        .iter()
        .flat_map(|word| word.to_le_bytes())
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let packet = format!("M{address:x},{:x}:{hex}", 4 * words.len());
    assert_eq!(talk(target, &[&packet]), ["OK"]);
}

/// r0 to pc and cpsr of a thread.
fn registers(target: &mut DebugTarget, thread: u32) -> Vec<Option<u32>> {
    let reply = talk(target, &[&format!("Hg{thread}"), "g"]).remove(1);
    (0..17)
        .map(|at| u32::from_str_radix(&reply[8 * at..8 * at + 8], 16).ok())
        .map(|value| value.map(u32::swap_bytes))
        .collect()
}

#[test]
fn tasks_are_threads_with_name_state_and_priority() {
    let mut target = target(program());
    let replies = talk(
        &mut target,
        &["qfThreadInfo", "qThreadExtraInfo,2", "qThreadExtraInfo,3"],
    );
    assert_eq!(replies[0], "m02,03");
    let texts: Vec<String> = replies[1..]
        .iter()
        .map(|hex| {
            (0..hex.len() / 2)
                .map(|at| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).unwrap() as char)
                .collect()
        })
        .collect();
    assert_eq!(
        texts,
        ["control: running, priority 5", "display: ready, priority 0"]
    );
    assert!(target.monitor("threads").contains("display: ready"));
}

#[test]
fn a_preempted_task_shows_all_registers_it_will_go_on_with() {
    let mut target = target(program());
    let mut frame = vec![RESUME, 0x6000_001F];
    frame.extend([10, 11, 12, 13, 22, 0x0020_2004]);
    frame.extend([14, 15, 16, 17, 18, 19, 20, 21, 0x0020_2010]);
    set_words(&mut target, STACK, &frame);
    let shown: Vec<u32> = registers(&mut target, 3)
        .into_iter()
        .map(Option::unwrap)
        .collect();
    let sp = STACK + 4 * frame.len() as u32;
    let mut expected: Vec<u32> = (10..23).collect();
    expected.extend([sp, 0x0020_2010, 0x0020_2004, 0x6000_001F]);
    assert_eq!(shown, expected);
}

#[test]
fn a_waiting_task_shows_where_it_goes_on_and_leaves_out_what_is_not_known() {
    let mut target = target(program());
    set_words(&mut target, STACK, &[0x0020_2008]);
    let shown = registers(&mut target, 3);
    assert_eq!(shown[13..16], [Some(STACK + 4), None, Some(0x0020_2008)]);
    assert!(shown[..13].iter().all(Option::is_none));
    // An address that holds no code is no context.
    set_words(&mut target, STACK, &[0x0020_C000]);
    assert!(registers(&mut target, 3).iter().all(Option::is_none));
    let refused = talk(&mut target, &["Hg3", "P0=00000000"]);
    assert!(refused[1].starts_with('E'), "{refused:?}");
}

#[test]
fn a_task_that_waits_in_the_thumb_run_time_shows_what_its_switch_saved() {
    let mut target = target(program());
    let mut frame = vec![SWITCHED];
    frame.extend(4..12);
    frame.push(0x0020_200B);
    set_words(&mut target, STACK, &frame);
    let shown = registers(&mut target, 3);
    let expected: Vec<_> = (4..12).map(Some).collect();
    assert_eq!(shown[4..12], expected);
    let sp = STACK + 4 * frame.len() as u32;
    assert_eq!(
        shown[13..],
        [Some(sp), Some(0x0020_200B), Some(0x0020_200A), Some(0x3F)]
    );
    assert!(shown[..4].iter().all(Option::is_none));
}

#[test]
fn the_monitor_shows_record_peripherals_and_plant_as_they_are() {
    let mut target = target(program());
    let trace = target.monitor("trace 3");
    assert_eq!(trace.lines().count(), 3, "{trace}");
    assert!(target
        .monitor("trace")
        .contains("thread_running    control"));
    assert!(target.monitor("trace many").contains("no number of events"));
    let before = target.monitor("digest");
    let shown = target.monitor("peripherals pmc");
    assert!(shown.contains("PMC MCKR    FFFFFC30  "), "{shown}");
    assert!(target.monitor("peripherals TC").lines().count() >= 21);
    assert!(target.monitor("peripherals LPT").contains("there are TC0"));
    assert!(target.monitor("plant").contains("motor.B.angle"));
    assert_eq!(target.monitor("digest"), before);
}

#[test]
fn while_a_handler_runs_the_task_shows_what_the_interrupt_entry_saved() {
    // As the entry leaves it: two words and a frame on the stack of IRQ mode, Supervisor mode.
    let mut program = program();
    program
        .status(0xD2)
        .load(13, INTERRUPT_TOP - 32)
        .status(0xD3);
    let mut target = target(program);
    let frame = [0x8000_001F, CONTROL, 1, 2, 3, 4, 5, 0x0020_2020];
    set_words(&mut target, INTERRUPT_TOP - 32, &frame);
    let shown = registers(&mut target, 2);
    assert_eq!(shown[..4], [Some(1), Some(2), Some(3), Some(4)]);
    assert_eq!(
        (shown[12], shown[15], shown[16]),
        (Some(5), Some(0x0020_2020), Some(0x8000_001F))
    );
    assert_eq!(shown[4], None);
}

#[test]
fn a_step_of_a_task_goes_on_while_others_execute() {
    // control: add, hand over to display, which adds twice and hands back.
    let mut program = program();
    program.load(2, RUNNING).load(3, CONTROL).load(4, DISPLAY);
    let again = program.here();
    program
        .add(0, 1)
        .str(4, 2, 0)
        .add(5, 1)
        .add(5, 1)
        .str(3, 2, 0)
        .branch(ALWAYS, again);
    let mut target = target(program);
    let store = 0x0020_2000 + 4 * (again as u32 + 1);
    let breakpoint = format!("Z0,{store:x},4");
    let remove = format!("z0,{store:x},4");
    let replies = talk(
        &mut target,
        &[
            &breakpoint,
            "vCont;c",
            &remove,
            "vCont;s:2",
            "pf",
            "bs",
            "pf",
        ],
    );
    assert!(replies[1].contains("thread:02"), "{replies:?}");
    let pc = |reply: &str| u32::from_str_radix(reply, 16).unwrap().swap_bytes();
    assert_eq!(pc(&replies[4]), store + 16);
    assert_eq!(pc(&replies[6]), store);
    target.monitor("steps processor");
    let replies = talk(&mut target, &["vCont;s:2", "pf"]);
    assert_eq!(pc(&replies[1]), store + 4);
}
