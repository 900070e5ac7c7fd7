// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The target as GDB's packets meet it, on a hand-made program that counts.

use crate::gdb::talk;
use crate::support::arm::{Program, ALWAYS};
use debugger::DebugTarget;
use virtual_brick::VirtualBrick;

const COUNTER: u32 = 0x0020_8000;
const ADD: u32 = 0x0020_2008;
const STORE: u32 = 0x0020_200C;

/// r1 = &counter; for ever: r0 += 1, counter = r0.
fn counting() -> VirtualBrick {
    let mut program = Program::new();
    program.load(1, COUNTER).status(0x13);
    let again = program.here();
    program.add(0, 1).str(0, 1, 0).branch(ALWAYS, again);
    crate::support::brick(&program)
}

fn target() -> DebugTarget {
    DebugTarget::new(counting())
}

fn little_endian(value: u32) -> String {
    value
        .to_le_bytes()
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect()
}

fn counter(target: &mut DebugTarget) -> u32 {
    let reply = talk(target, &[&format!("m{COUNTER:x},4")]).remove(0);
    u32::from_str_radix(&reply, 16).unwrap().swap_bytes()
}

#[test]
fn the_description_names_the_banks_of_all_modes_and_the_register_packet_has_them() {
    let replies = talk(
        &mut target(),
        &["qXfer:features:read:target.xml:0,fff", "g"],
    );
    assert!(
        replies[0].contains("org.gnu.gdb.arm.core"),
        "{}",
        replies[0]
    );
    assert!(replies[0].contains("spsr_irq"));
    assert_eq!(replies[1].len(), 8 * (17 + 22));
    assert_eq!(&replies[1][8 * 15..8 * 16], little_endian(0x0020_2000));
}

#[test]
fn the_memory_map_has_ram_and_flash() {
    let reply = talk(&mut target(), &["qXfer:memory-map:read::0,fff"]).remove(0);
    assert!(reply.contains(r#"type="ram" start="0x00200000" length="0x00010000""#));
    assert!(reply.contains(r#"type="flash" start="0x00100000""#));
}

#[test]
fn memory_is_read_and_written_and_what_is_none_is_refused() {
    let replies = talk(
        &mut target(),
        &[
            "M208000,4:11223344",
            "m208000,4",
            "m400000,4",
            "mffffffff,ff",
            "M400000,1:00",
        ],
    );
    assert_eq!(replies[..2], ["OK", "11223344"]);
    assert!(
        replies[2..].iter().all(|reply| reply.starts_with('E')),
        "{replies:?}"
    );
}

#[test]
fn a_peripheral_register_is_read_without_a_change_of_the_brick() {
    let mut target = target();
    let before = target.monitor("time");
    // PMC_SR: the boot monitor left the PLL locked and the master clock ready.
    let reply = talk(&mut target, &["mfffffc68,4"]).remove(0);
    assert_eq!(
        u32::from_str_radix(&reply, 16).unwrap().swap_bytes() & 0xC,
        0xC
    );
    assert_eq!(target.monitor("time"), before);
}

#[test]
fn registers_are_set_one_by_one() {
    let replies = talk(
        &mut target(),
        &["P3=efbeadde", "p3", "P21=04000000", "p21", "p99"],
    );
    assert_eq!(replies[..4], ["OK", "efbeadde", "OK", "04000000"]);
    assert!(replies[4].is_empty() || replies[4].starts_with('E'));
}

#[test]
fn a_breakpoint_stops_before_its_instruction() {
    let mut target = target();
    let replies = talk(&mut target, &["Z0,20200c,4", "vCont;c", "pf", "p0"]);
    assert!(replies[1].contains("swbreak:"), "{replies:?}");
    assert_eq!(replies[2], little_endian(STORE));
    assert_eq!(replies[3], little_endian(1));
    assert_eq!(counter(&mut target), 0);
}

#[test]
fn a_step_is_one_instruction_and_a_range_is_left_before_the_stop() {
    let replies = talk(
        &mut target(),
        &[
            "vCont;s:1",
            "vCont;s:1",
            "pf",
            "vCont;r202008,202010:1",
            "pf",
        ],
    );
    assert!(replies[0].starts_with("T05"), "{replies:?}");
    assert_eq!(replies[2], little_endian(ADD));
    assert_eq!(replies[4], little_endian(0x0020_2010));
}

#[test]
fn a_write_watchpoint_stops_before_the_write_and_only_when_the_value_changes() {
    let mut target = target();
    // The first store writes 1 over 1.
    let replies = talk(
        &mut target,
        &[
            "M208000,4:01000000",
            "Z2,208000,4",
            "vCont;c",
            "pf",
            "p0",
            "z2,208000,4",
            "vCont;s:1",
        ],
    );
    assert!(replies[2].contains("watch:"), "{replies:?}");
    assert_eq!(replies[3], little_endian(STORE));
    assert_eq!(replies[4], little_endian(2));
    assert_eq!(counter(&mut target), 2);
}

#[test]
fn read_and_access_watchpoints_tell_reads_from_writes() {
    let mut program = Program::new();
    program
        .load(1, COUNTER)
        .str(0, 1, 4)
        .ldr(2, 1, 0)
        .str(0, 1, 0)
        .stop();
    let mut target = DebugTarget::new(crate::support::brick(&program));
    let replies = talk(
        &mut target,
        &[
            "Z3,208000,4",
            "vCont;c",
            "pf",
            "z3,208000,4",
            "vCont;s:1",
            "Z4,208000,4",
            "vCont;c",
            "pf",
        ],
    );
    assert!(replies[1].contains("rwatch:"), "{replies:?}");
    assert_eq!(replies[2], little_endian(0x0020_2008));
    assert!(replies[6].contains("awatch:"), "{replies:?}");
    assert_eq!(replies[7], little_endian(0x0020_200C));
}

#[test]
fn steps_backwards_pass_through_the_states_of_the_steps_forwards() {
    let mut target = target();
    let forwards: Vec<String> = (0..60)
        .map(|_| talk(&mut target, &["g", "vCont;s:1"]).remove(0))
        .collect();
    for state in forwards.iter().rev() {
        let replies = talk(&mut target, &["bs", "g"]);
        assert_eq!(&replies[1], state);
    }
    let reply = talk(&mut target, &["bs"]).remove(0);
    assert!(reply.contains("replaylog:begin"), "{reply}");
}

#[test]
fn running_backwards_ends_at_the_last_write_of_a_value() {
    let mut target = target();
    // Far enough for several checkpoints.
    target.run_to(10_000_000);
    let value = counter(&mut target);
    let replies = talk(
        &mut target,
        &["Z2,208000,4", "bc", "z2,208000,4", "bs", "pf", "p0"],
    );
    assert!(replies[1].contains("watch:"), "{replies:?}");
    assert_eq!(replies[4], little_endian(STORE));
    assert_eq!(replies[5], little_endian(value));
    assert_eq!(counter(&mut target), value - 1);
}

#[test]
fn running_backwards_ends_at_a_breakpoint_of_long_ago_or_at_the_beginning() {
    let mut target = target();
    target.run_to(20_000_000);
    let replies = talk(
        &mut target,
        &["Z0,202004,4", "bc", "pf", "z0,202004,4", "bc", "pf"],
    );
    assert!(replies[1].contains("swbreak:"), "{replies:?}");
    assert_eq!(replies[2], little_endian(0x0020_2004));
    assert!(replies[4].contains("replaylog:begin"), "{replies:?}");
    assert_eq!(replies[5], little_endian(0x0020_2000));
}

#[test]
fn a_debugged_run_has_the_digest_of_a_free_run() {
    let mut free = counting();
    free.schedule_input(3_000_000, "touch.1", 1.0).unwrap();
    let brick = free.clone();
    free.run_until(8_000_000);
    let mut target = DebugTarget::new(brick);
    talk(
        &mut target,
        &[
            "Z0,202008,4",
            "vCont;c",
            "z0,202008,4",
            "Z2,208000,4",
            "vCont;c",
        ],
    );
    target.run_to(9_000_000);
    talk(&mut target, &["bs", "bs", "bc"]);
    target.run_to(8_000_000);
    assert_eq!(target.into_brick().trace().digest(), free.trace().digest());
}

#[test]
fn user_changes_are_repeated_after_running_backwards() {
    let mut target = target();
    target.run_to(5_000_000);
    talk(&mut target, &["P0=00000070"]);
    assert!(target.monitor("set touch.1 1").contains("from now on"));
    target.run_to(6_000_000);
    let (digest, value) = (target.monitor("digest"), counter(&mut target));
    assert!(value > 0x7000_0000, "{value:#x}");
    target.run_to(1_000_000);
    assert!(counter(&mut target) < 0x7000_0000);
    target.run_to(6_000_000);
    assert_eq!(
        (target.monitor("digest"), counter(&mut target)),
        (digest, value)
    );
    target.monitor("reset");
    target.run_to(6_000_000);
    assert!(counter(&mut target) < 0x7000_0000);
}

#[test]
fn a_change_in_the_past_begins_another_future() {
    let mut target = target();
    target.run_to(5_000_000);
    talk(&mut target, &["P0=00000070"]);
    target.run_to(2_000_000);
    talk(&mut target, &["P0=00000060"]);
    target.run_to(6_000_000);
    assert_eq!(counter(&mut target) >> 28, 6);
}

#[test]
fn checkpoints_stay_bounded_however_long_the_run() {
    let mut target = target();
    target.run_to(600_000_000);
    let text = target.monitor("time");
    let count: usize = text.split(' ').rev().nth(1).unwrap().parse().unwrap();
    assert!((100..=160).contains(&count), "{text}");
    let replies = talk(&mut target, &["bs", "bs"]);
    assert!(
        replies.iter().all(|reply| reply.starts_with("T05")),
        "{replies:?}"
    );
}

#[test]
fn a_run_that_ends_stops_with_a_signal_and_can_be_gone_back_in() {
    let mut program = Program::new();
    program.load(1, 0x0040_0000).ldr(0, 1, 0).stop();
    let mut target = DebugTarget::new(crate::support::brick(&program));
    let replies = talk(&mut target, &["vCont;c", "bs", "bs", "pf"]);
    assert!(replies[0].starts_with("T0"), "{replies:?}");
    assert!(!replies[0].starts_with("T05"), "{replies:?}");
    assert!(replies[1].starts_with("T05"), "{replies:?}");
}

#[test]
fn monitor_commands_answer_and_refuse_with_what_would_be_right() {
    let mut target = target();
    assert!(target.monitor("").contains("help"));
    assert!(target.monitor("nonsense").contains("monitor help"));
    assert!(target.monitor("set touch.1 x").contains("no number"));
    assert!(target.monitor("set touch.9 1").contains("touch.1"));
    assert!(target.monitor("inputs").contains("battery.voltage"));
    assert!(target.monitor("signals nothing").contains("no sample"));
    target.run_to(1_000_000);
    assert!(target.monitor("signals motor.B").contains("motor.B.angle"));
    assert_eq!(target.monitor("lcd").lines().count(), 32);
    assert!(target.monitor("threads").contains("cannot be observed"));
    assert!(target.monitor("registers").contains("spsr of Irq"));
    assert!(target.monitor("why").contains("can go on"));
}
