// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A program that failed, in words: what its run-time recorded, and what the processor still holds.

use arm7tdmi::{psr, Mode};
use nxt::Button;

use crate::backtrace::{self, Call};
use crate::brick::VirtualBrick;
use crate::memory::ChipMemory;
use crate::stop::{Stop, StopReason};
use crate::threads::Memory;

const RECORD: &str = "ravenbrick_failure";
const TIMING_EVENTS: &str = "ravenbrick__delays__events__ring_with_events";
const TEXT_MAX: u32 = 80;
/// The text of a stack check that failed.
const CHECKED: &str = "Storage_Error: stack overflow";
const PROGRAM_COUNTER: usize = 15;
const LINK: usize = 14;
/// Of the record: 1 when the failure was reported on the display.
const REPORTED: u32 = 16;

/// What the run-time wrote before it halted.
struct Record {
    /// Name of a source file, or a message.
    text: String,
    /// Line of that file, 0, or the address of an instruction that the processor refused.
    line: u32,
    /// Control block of the thread, or what stands for a handler.
    current: u32,
}

impl Record {
    fn refused_instruction(&self) -> bool {
        let texts = [
            "undefined instruction",
            "software interrupt",
            "prefetch abort",
            "data abort",
        ];
        texts.contains(&self.text.as_str())
    }
}

/// What executes.
enum Context {
    Task(String),
    Handler(String),
}

impl VirtualBrick {
    /// The stop with what a person needs to know first: the stack that overflowed, or the
    /// exception, the task and the place.
    pub(crate) fn explained(&self, stop: Stop) -> Stop {
        let record = match stop.reason {
            StopReason::Fault | StopReason::Halted => self.failure_record(),
            StopReason::PowerOff if self.reported_failure() => {
                return self.switched_off_after_failure(stop)
            }
            _ => return stop,
        };
        let failed = match &record {
            Some(record) => self.failure(record),
            None => self.located(&stop.message),
        };
        let checked = record.as_ref().filter(|record| record.text == CHECKED);
        let checked = checked
            .and_then(|record| self.checked_overflow(record.current, &self.calls_of(record)));
        let overflow = self.stack_overflows().into_iter().next();
        let message = match overflow {
            Some(overflow) => format!("{overflow}; the program ended with: {failed}"),
            None => checked.unwrap_or(failed),
        };
        Stop { message, ..stop }
    }

    /// The program failed, which the end of the supply does not mend.
    fn switched_off_after_failure(&self, stop: Stop) -> Stop {
        let reason = StopReason::Halted;
        let failed = self.explained(Stop {
            reason,
            ..stop.clone()
        });
        let message = format!("{}; afterwards {}", failed.message, stop.message);
        Stop { message, ..failed }
    }

    /// Whether the program has failed and waits for the power button, which nobody presses now
    /// or later.
    pub(crate) fn failed_and_left_alone(&self) -> bool {
        self.reported_failure()
            && !self.chip.board().button_held(Button::Orange)
            && !self
                .inputs
                .waits(&format!("button.{}", Button::Orange.name()))
    }

    fn reported_failure(&self) -> bool {
        let masked = self.cpu.cpsr() & psr::I != 0;
        let record = || self.image.symbols().get(RECORD);
        let reported = |address| ChipMemory(&self.chip).word(address + REPORTED) == Some(1);
        masked && record().is_some_and(|record| record.size > REPORTED && reported(record.address))
    }

    /// Source, line and column (0: unknown) at which the program failed: a path, or only its name
    /// when a handler failed.
    #[must_use]
    pub fn raised_at(&self) -> Option<(String, u32, u32)> {
        let record = self.failure_record()?;
        let told = !record.refused_instruction() && record.line != 0;
        backtrace::innermost(&self.calls_of(&record))
            .cloned()
            .or_else(|| told.then(|| (record.text.clone(), record.line, 0)))
    }

    fn failure_record(&self) -> Option<Record> {
        let memory = ChipMemory(&self.chip);
        let address = self.image.symbols().get(RECORD)?.address;
        let text = memory.word(address)?;
        (text != 0).then_some(())?;
        let mut letters = Vec::new();
        for at in text..text.checked_add(TEXT_MAX)? {
            let mut letter = [0];
            if !memory.read(at, &mut letter) || letter[0] == 0 {
                break;
            }
            letters.extend(letter);
        }
        Some(Record {
            text: String::from_utf8_lossy(&letters).into_owned(),
            line: memory.word(address + 4)?,
            current: memory.word(address + 8)?,
        })
    }

    /// The run-time leaves the registers of the failing thread as they were.
    fn calls_of(&self, record: &Record) -> Vec<Call> {
        if !matches!(self.context(record.current), Some(Context::Task(_))) {
            return if record.refused_instruction() {
                let mut alone = [0; 16];
                alone[PROGRAM_COUNTER] = record.line;
                self.calls_from(alone)
            } else {
                Vec::new()
            };
        }
        let mut registers = [0; 16];
        for (number, register) in (0..).zip(&mut registers[..PROGRAM_COUNTER]) {
            *register = self.cpu.banked_register(Mode::System, number);
        }
        registers[PROGRAM_COUNTER] = if record.refused_instruction() {
            record.line
        } else {
            backtrace::before_return(registers[LINK])
        };
        self.calls_from(registers)
    }

    /// The chain of calls that leads to these registers.
    pub(crate) fn calls_from(&self, registers: [u32; 16]) -> Vec<Call> {
        let memory = ChipMemory(&self.chip);
        backtrace::chain(&self.image, registers, |address| memory.word(address))
    }

    fn context(&self, current: u32) -> Option<Context> {
        if let Some(name) = self.recorder.thread_name(current) {
            return Some(Context::Task(name));
        }
        // In front of what stands for a handler are its object and its code.
        let code = ChipMemory(&self.chip).word(current.wrapping_sub(4))?;
        let (symbol, distance) = self.image.symbols().nearest_code(code & !1)?;
        (distance == 0).then(|| Context::Handler(symbol.to_owned()))
    }

    fn in_whom(&self, current: u32, calls: &[Call]) -> String {
        match self.context(current) {
            Some(Context::Task(name)) if name == "environment" => {
                format!(" in {}", backtrace::environment(calls))
            }
            Some(Context::Task(name)) => format!(" in task {name}"),
            Some(Context::Handler(symbol)) if symbol == TIMING_EVENTS => {
                " in the handler of a timing event".to_owned()
            }
            Some(Context::Handler(symbol)) => format!(" in the interrupt handler {symbol}"),
            None => String::new(),
        }
    }

    fn failure(&self, record: &Record) -> String {
        let calls = self.calls_of(record);
        let whom = self.in_whom(record.current, &calls);
        let place = backtrace::place(&calls);
        if record.refused_instruction() {
            let place = place.unwrap_or_else(|| crate::dead_ends::place(&self.image, record.line));
            return format!("{} at {place}{whom}", self.refusal(record));
        }
        let own = (record.line != 0).then(|| format!("{}:{}", record.text, record.line));
        let place = place.or_else(|| own.clone());
        // Without a message, the compiler gives the place for one.
        let bare = own.is_some() || record.text.is_empty() || place.as_ref() == Some(&record.text);
        let place = place.map_or_else(String::new, |place| format!(" at {place}"));
        let asserted = calls
            .iter()
            .any(|call| call.symbol == "system__assertions__raise_assert_failure");
        let name = if asserted {
            "Assertion_Error"
        } else {
            "unhandled exception"
        };
        match record.text.split_once(": ") {
            _ if bare => format!("{name}{place}{whom}"),
            Some((name, why)) if name.ends_with("_Error") => {
                format!("{name} ({why}){place}{whom}")
            }
            _ => format!("{name} (\"{}\"){place}{whom}", record.text),
        }
    }

    fn refusal(&self, record: &Record) -> String {
        let (address, misaligned) = self.chip.aborted_access();
        match record.text.as_str() {
            "data abort" if misaligned => {
                format!("misaligned access to address {address:#010X} (data abort)")
            }
            "data abort" => {
                format!("access to address {address:#010X}, where there is no memory (data abort)")
            }
            "prefetch abort" => {
                format!(
                    "jump to {:#010X}, where there is no memory (prefetch abort)",
                    record.line
                )
            }
            text => text.to_owned(),
        }
    }

    /// What the brick itself refused, with the line and the task.
    fn located(&self, message: &str) -> String {
        if self.cpu.mode() != Some(Mode::System) {
            return message.to_owned();
        }
        let mut registers = self.cpu.registers();
        registers[PROGRAM_COUNTER] = backtrace::before_return(registers[PROGRAM_COUNTER]);
        let calls = self.calls_from(registers);
        let running = self.running_thread().unwrap_or(0);
        match backtrace::place(&calls) {
            Some(place) => format!("{message}, at {place}{}", self.in_whom(running, &calls)),
            None => message.to_owned(),
        }
    }
}
