// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Commands of `monitor`: the brick's surroundings, its display, its record.

use std::fmt::Write;

use trace::{EventKind, NameSpace};
use virtual_brick::CLOCK_HZ;

use crate::arch::BANKED;
use crate::execution::Job;
use crate::loading;
use crate::peripherals;
use crate::screen;
use crate::target::DebugTarget;
use crate::tasks;
use crate::timeline::{Change, Refused};

/// Events that `trace` shows without a count.
const EVENTS_SHOWN: usize = 20;

const HELP: &str = "\
help                this text
time                current time in cycles and seconds, and extent of the record
why                 reason why the run cannot continue
inputs              inputs that can be set
set NAME VALUE      set an input now; the record after the current time is discarded
lcd                 the display
signals [PART]      last samples of the physical quantities whose names contain PART
plant               motors, vehicle and battery at the current cycle
peripherals [PART]  registers of the peripherals whose names contain PART, without side effects
trace [COUNT]       the last events of the record (default: 20)
threads             tasks with state, priority and stack
registers           registers of all modes
digest              digest of the record up to the current time
semihosting on|off  handle semihosting calls (on), or leave them to the program's handler (off)
steps task|processor  steps of the selected task (default), or of the processor
program FILE        restart with this ELF file; give GDB 'file FILE' first
reset               return to the beginning; give GDB 'maintenance flush register-cache' afterwards
";

/// The answer to a command line.
pub(crate) fn answer(target: &mut DebugTarget, line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words.as_slice() {
        [] | ["help"] => HELP.to_owned(),
        ["time"] => time(target),
        ["why"] => why(target),
        ["inputs"] => inputs(target),
        ["set", name, value] => set(target, name, value),
        ["lcd"] => screen::show(target.timeline.brick()),
        ["signals"] => signals(target, ""),
        ["signals", part] => signals(target, part),
        ["plant"] => plant(target),
        ["peripherals"] => peripherals::show(target.timeline.brick(), ""),
        ["peripherals", part] => peripherals::show(target.timeline.brick(), part),
        ["trace"] => trace(target, EVENTS_SHOWN),
        ["trace", count] => match count.parse() {
            Ok(count) => trace(target, count),
            Err(_) => format!("'{count}' is no number of events\n"),
        },
        ["threads"] => threads(target),
        ["registers"] => registers(target),
        ["digest"] => format!("{}\n", target.timeline.brick().trace().digest()),
        ["semihosting", "on"] => semihosting(target, true),
        ["semihosting", "off"] => semihosting(target, false),
        ["steps", "task"] => steps(target, true),
        ["steps", "processor"] => steps(target, false),
        ["program", _, ..] => program(target, line),
        ["reset"] => reset(target),
        _ => format!("no command '{line}'; 'monitor help' lists them\n"),
    }
}

/// The file's name may have spaces, and quotation marks around it.
fn program(target: &mut DebugTarget, line: &str) -> String {
    let name = line.trim().strip_prefix("program").unwrap_or_default();
    match loading::program(target, name.trim().trim_matches('"')) {
        Ok(()) => time(target),
        Err(why) => format!("{why}\n"),
    }
}

fn seconds(cycles: u64) -> f64 {
    cycles as f64 * CLOCK_HZ.1 as f64 / CLOCK_HZ.0 as f64
}

fn time(target: &DebugTarget) -> String {
    let (now, beginning) = (target.timeline.now(), target.timeline.beginning());
    format!(
        "cycle {now}, {:.6} s; the record begins at {:.6} s and has {} checkpoints\n",
        seconds(now),
        seconds(beginning),
        target.timeline.checkpoint_count()
    )
}

fn why(target: &DebugTarget) -> String {
    match target.timeline.brick().ended() {
        None => "the run can go on\n".to_owned(),
        Some(stop) => format!(
            "{} at cycle {}: {}\n",
            stop.reason, stop.at_cycles, stop.message
        ),
    }
}

fn inputs(target: &DebugTarget) -> String {
    let mut text = String::new();
    for input in target.timeline.brick().inputs() {
        let whole = if input.whole {
            "whole numbers"
        } else {
            "numbers"
        };
        let (low, high, unit) = (input.lowest, input.highest, input.unit);
        let _ = writeln!(
            text,
            "{:<22}{whole} from {low} to {high} {unit}",
            input.name
        );
    }
    text
}

fn set(target: &mut DebugTarget, name: &str, value: &str) -> String {
    let Ok(value) = value.parse::<f64>() else {
        return format!("'{value}' is no number\n");
    };
    let name = name.to_owned();
    let shown = format!("{name} = {value} from now on\n");
    match target.timeline.intervene(Change::Input { name, value }) {
        Ok(()) => shown,
        Err(Refused::Input(error)) => format!("{error}\n"),
        Err(Refused::Memory(error)) => format!("{error}\n"),
    }
}

fn signals(target: &DebugTarget, part: &str) -> String {
    let mut text = String::new();
    let trace = target.timeline.brick().trace();
    for signal in trace.signals().iter().filter(|s| s.name.contains(part)) {
        if let (Some(cycles), Some(value)) = (signal.at_cycles.last(), signal.values.last()) {
            let at = seconds(*cycles);
            let _ = writeln!(text, "{:<28}{value:>14.6}  at {at:.6} s", signal.name);
        }
    }
    if text.is_empty() {
        text = format!("no sample of a signal whose name contains '{part}' so far\n");
    }
    text
}

fn plant(target: &DebugTarget) -> String {
    let mut text = String::new();
    for (name, value) in target.timeline.brick().quantities() {
        let _ = writeln!(text, "{name:<28}{value:>14.6}");
    }
    text
}

fn trace(target: &DebugTarget, count: usize) -> String {
    let trace = target.timeline.brick().trace();
    let events = trace.events();
    let name = |space: NameSpace, index: u32| {
        let names = trace.names().all(space);
        names.get(index as usize).map_or("none", String::as_str)
    };
    let mut text = String::new();
    for event in events.iter_from(events.len().saturating_sub(count)) {
        let subject = match event.kind {
            EventKind::ThreadRunning
            | EventKind::ThreadState
            | EventKind::Release
            | EventKind::Completion => name(NameSpace::Thread, event.subject).to_owned(),
            EventKind::MotorCommand => name(NameSpace::Motor, event.subject).to_owned(),
            EventKind::Input => name(NameSpace::Input, event.subject).to_owned(),
            EventKind::InterruptEntered => format!("source {}", event.subject),
            _ => String::new(),
        };
        let value = match event.kind {
            EventKind::Input => f64::from_bits(event.value as u64).to_string(),
            EventKind::DisplayChanged => format!("{:016x}", event.value),
            _ => event.value.to_string(),
        };
        let (at, kind) = (event.at_cycles, event.kind.name());
        let _ = writeln!(text, "{at:>14}  {kind:<18}{subject:<20}{value}");
    }
    if text.is_empty() {
        text = "no event so far\n".to_owned();
    }
    text
}

fn threads(target: &DebugTarget) -> String {
    let brick = target.timeline.brick();
    let mut text = String::new();
    if let Some(reason) = brick.threads_unobserved() {
        let _ = writeln!(text, "tasks cannot be observed: {reason}");
    }
    let tasks = brick.threads();
    for tid in tasks::list(brick) {
        let _ = write!(text, "{tid}  {}", tasks::describe(tid, brick));
        match tid.get().checked_sub(2).and_then(|index| tasks.get(index)) {
            Some(task) => {
                let _ = writeln!(
                    text,
                    ", stack {} of {} bytes",
                    task.stack_used, task.stack_size
                );
            }
            None => text.push('\n'),
        }
    }
    text
}

fn registers(target: &DebugTarget) -> String {
    let brick = target.timeline.brick();
    let cpu = brick.processor();
    let mut text = String::new();
    for (number, value) in cpu.registers().iter().enumerate() {
        let _ = writeln!(text, "{:<24}{value:#010X}", format!("r{number}"));
    }
    let _ = writeln!(text, "{:<24}{:#010X}", "cpsr", cpu.cpsr());
    let known = tasks::registers(target.stopped, brick);
    for (register, value) in BANKED.iter().zip(known.banked) {
        let name = match register {
            crate::arch::Banked::Register(mode, number) => format!("r{number} of {mode:?}"),
            crate::arch::Banked::Status(mode) => format!("spsr of {mode:?}"),
        };
        let _ = writeln!(text, "{name:<24}{:#010X}", value.unwrap_or(0));
    }
    text
}

fn semihosting(target: &mut DebugTarget, on: bool) -> String {
    match target.timeline.intervene(Change::Semihosting(on)) {
        Ok(()) if on => "the program's calls of its debugger are served\n".to_owned(),
        Ok(()) => "the program's calls of its debugger go to its own handler\n".to_owned(),
        Err(_) => "it stays as it was\n".to_owned(),
    }
}

fn steps(target: &mut DebugTarget, of_task: bool) -> String {
    target.steps_of_task = of_task;
    let of = if of_task {
        "the selected task"
    } else {
        "the processor"
    };
    format!("a step is one of {of}\n")
}

fn reset(target: &mut DebugTarget) -> String {
    target.timeline.reset();
    target.job = Job::Nothing;
    let brick = target.timeline.brick();
    target.stopped = tasks::Context::now(brick).tid(brick);
    time(target)
}
