// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Semihosting: services that a program asks of its debugger by a software interrupt (Arm,
//! "Semihosting for AArch32 and AArch64", release 3.0; `abi-aa/semihosting`).
//!
//! Only what a run can repeat is there: a console that takes text, and virtual time. There is no
//! input, no file besides the one that tells the features, and no command of the host.

use arm7tdmi::{psr, Cpu, Exception, Step};

use crate::assembly::Machine;
use crate::brick::VirtualBrick;
use crate::stop::{Stop, StopReason};
use crate::CLOCK_HZ;

/// Operation code of SWI in ARM state, with its condition masked out, and in Thumb state.
const ARM_CALL: u32 = 0x0F12_3456;
const ARM_CONDITION: u32 = 0xF000_0000;
const THUMB_CALL: u32 = 0xDFAB;
const FAILED: u32 = u32::MAX;
/// Text that is kept; of more, the end.
const TEXT_BYTES_MAX: usize = 1 << 18;
/// Longest text of one call.
const STRING_BYTES_MAX: u32 = 1 << 16;
const FILES_MAX: usize = 16;

/// Handles of the console's streams; those of opened feature files follow.
const INPUT: u32 = 1;
const OUTPUT: u32 = 2;
const ERRORS: u32 = 3;
const FIRST_FILE: u32 = 4;
/// Section "Semihosting extensions": magic bytes; SYS_EXIT_EXTENDED and separate error output.
const FEATURES: [u8; 5] = *b"SHFB\x03";
const APPLICATION_EXIT: u32 = 0x2_0026;
/// Where a stack can begin: the end of the RAM.
const RAM_END: u32 = 0x0021_0000;

/// Output of the program to its debugger.
#[derive(Clone, Debug, Default)]
pub(crate) struct Console {
    text: Vec<u8>,
    /// Bytes written so far, those that are no longer kept included.
    bytes_written: u64,
    /// Read positions of opened feature files.
    files: Vec<Option<usize>>,
}

impl Console {
    fn write(&mut self, bytes: &[u8]) {
        self.text.extend_from_slice(bytes);
        self.bytes_written += bytes.len() as u64;
        if self.text.len() > 2 * TEXT_BYTES_MAX {
            self.text.drain(..self.text.len() - TEXT_BYTES_MAX);
        }
    }

    fn open_features(&mut self) -> u32 {
        let free = self.files.iter().position(Option::is_none);
        let index = match free {
            Some(index) => index,
            None if self.files.len() < FILES_MAX => {
                self.files.push(None);
                self.files.len() - 1
            }
            None => return FAILED,
        };
        self.files[index] = Some(0);
        FIRST_FILE + index as u32
    }

    fn file(&mut self, handle: u32) -> Option<&mut Option<usize>> {
        let index = handle.checked_sub(FIRST_FILE)? as usize;
        self.files.get_mut(index).filter(|file| file.is_some())
    }

    fn is_open(&mut self, handle: u32) -> bool {
        (INPUT..FIRST_FILE).contains(&handle) || self.file(handle).is_some()
    }

    fn close(&mut self, handle: u32) -> u32 {
        if let Some(file) = self.file(handle) {
            *file = None;
            return 0;
        }
        if self.is_open(handle) {
            0
        } else {
            FAILED
        }
    }

    /// The next bytes of a file; none at its end and from the console.
    fn read(&mut self, handle: u32, length: usize) -> &'static [u8] {
        let Some(Some(position)) = self.file(handle) else {
            return &[];
        };
        let rest = &FEATURES[(*position).min(FEATURES.len())..];
        let taken = &rest[..rest.len().min(length)];
        *position += taken.len();
        taken
    }

    fn seek(&mut self, handle: u32, position: u32) -> u32 {
        match self.file(handle) {
            Some(file) if position as usize <= FEATURES.len() => {
                *file = Some(position as usize);
                0
            }
            _ => FAILED,
        }
    }
}

/// What a call comes to.
enum Answer {
    /// The value for r0.
    Value(u32),
    /// The program ended: reason and code.
    Exit(u32, u32),
}

/// A call under way.
struct Call<'a> {
    chip: &'a mut Machine,
    console: &'a mut Console,
    parameter: u32,
}

impl Call<'_> {
    fn answer(mut self, operation: u32) -> Option<Answer> {
        let value = match operation {
            0x01 => self.open()?,
            0x02 => {
                let handle = self.field(0)?;
                self.console.close(handle)
            }
            0x03 => {
                let letter = self.bytes(self.parameter, 1)?;
                self.console.write(&letter);
                0
            }
            0x04 => {
                let text = self.string(self.parameter)?;
                self.console.write(&text);
                0
            }
            0x05 => self.write()?,
            0x06 => self.read()?,
            0x08 => u32::from(self.field(0)? as i32 == -1),
            0x09 => self.is_terminal()?,
            0x0A => {
                let (handle, position) = (self.field(0)?, self.field(1)?);
                self.console.seek(handle, position)
            }
            0x0C => {
                let handle = self.field(0)?;
                self.console
                    .file(handle)
                    .map_or(FAILED, |_| FEATURES.len() as u32)
            }
            0x10 => {
                (u128::from(self.chip.now()) * 100 * u128::from(CLOCK_HZ.1)
                    / u128::from(CLOCK_HZ.0)) as u32
            }
            0x11 => (self.chip.now() * CLOCK_HZ.1 / CLOCK_HZ.0) as u32,
            0x13 => 0,
            0x15 => self.command_line()?,
            0x16 => self.heap_information()?,
            0x18 => return Some(Answer::Exit(self.parameter, 0)),
            0x20 => return Some(Answer::Exit(self.field(0)?, self.field(1)?)),
            0x30 => {
                let ticks = self.chip.now().to_le_bytes();
                self.chip.load(self.parameter, &ticks).ok()?;
                0
            }
            0x31 => (CLOCK_HZ.0 / CLOCK_HZ.1) as u32,
            _ => FAILED,
        };
        Some(Answer::Value(value))
    }

    fn bytes(&self, address: u32, length: u32) -> Option<Vec<u8>> {
        self.chip.peek(address, length as usize).ok()
    }

    fn word(&self, address: u32) -> Option<u32> {
        let bytes = self.bytes(address, 4)?;
        bytes.try_into().ok().map(u32::from_le_bytes)
    }

    /// A field of the block to which the parameter points.
    fn field(&self, index: u32) -> Option<u32> {
        self.word(self.parameter.wrapping_add(4 * index))
    }

    /// Up to the byte 0, which is left out.
    fn string(&self, address: u32) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        for offset in 0..STRING_BYTES_MAX {
            match self.bytes(address.checked_add(offset)?, 1)?.first()? {
                0 => return Some(text),
                letter => text.push(*letter),
            }
        }
        Some(text)
    }

    /// The console is `:tt`: for reading, writing, and appending, which means errors.
    fn open(&mut self) -> Option<u32> {
        let (name, mode, length) = (self.field(0)?, self.field(1)?, self.field(2)?);
        let name = self.bytes(name, length.min(STRING_BYTES_MAX))?;
        Some(match (name.as_slice(), mode) {
            (b":tt", 0..=3) => INPUT,
            (b":tt", 4..=7) => OUTPUT,
            (b":tt", 8..=11) => ERRORS,
            (b":semihosting-features", 0 | 1) => self.console.open_features(),
            _ => FAILED,
        })
    }

    /// The number of bytes that were not written.
    fn write(&mut self) -> Option<u32> {
        let (handle, from, length) = (self.field(0)?, self.field(1)?, self.field(2)?);
        if !matches!(handle, OUTPUT | ERRORS) || length > STRING_BYTES_MAX {
            return Some(length);
        }
        let text = self.bytes(from, length)?;
        self.console.write(&text);
        Some(0)
    }

    /// The number of bytes that were not read.
    fn read(&mut self) -> Option<u32> {
        let (handle, to, length) = (self.field(0)?, self.field(1)?, self.field(2)?);
        let found = self.console.read(handle, length as usize);
        self.chip.load(to, found).ok()?;
        Some(length - found.len() as u32)
    }

    fn is_terminal(&mut self) -> Option<u32> {
        let handle = self.field(0)?;
        Some(match handle {
            INPUT..=ERRORS => 1,
            _ if self.console.is_open(handle) => 0,
            _ => FAILED,
        })
    }

    /// An empty one.
    fn command_line(&mut self) -> Option<u32> {
        let (buffer, size) = (self.field(0)?, self.field(1)?);
        if size == 0 {
            return None;
        }
        self.chip.load(buffer, &[0]).ok()?;
        let length = self.parameter.wrapping_add(4);
        self.chip.load(length, &0u32.to_le_bytes()).ok()?;
        Some(0)
    }

    /// A heap from wherever the program ends, a stack from the end of the RAM.
    fn heap_information(&mut self) -> Option<u32> {
        let block = self.field(0)?;
        let fields: [u32; 4] = [0, RAM_END, RAM_END, 0];
        let bytes: Vec<u8> = fields
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.chip.load(block, &bytes).ok()?;
        Some(0)
    }
}

/// The instruction that led to the vector of software interrupts is a call of the debugger.
fn is_call(cpu: &Cpu, chip: &Machine) -> bool {
    let after = cpu.register(14);
    if cpu.spsr().is_some_and(|status| status & psr::T != 0) {
        let at = after.wrapping_sub(2);
        return chip.peek(at, 2) == Ok((THUMB_CALL as u16).to_le_bytes().to_vec());
    }
    let code = chip.peek_word(after.wrapping_sub(4));
    code.is_ok_and(|code| code & !ARM_CONDITION == ARM_CALL)
}

impl VirtualBrick {
    /// Do what a step asked the debugger for. The program goes on after its call, with the answer
    /// in r0; as on the chip under a debugger, r14 and SPSR of supervisor mode are changed.
    #[inline]
    pub(crate) fn semihost(&mut self, step: Step) -> Result<Step, Stop> {
        if step != Step::Exception(Exception::SoftwareInterrupt) {
            return Ok(step);
        }
        self.serve_call(step)
    }

    #[cold]
    fn serve_call(&mut self, step: Step) -> Result<Step, Stop> {
        let Some(console) = &mut self.console else {
            return Ok(step);
        };
        if !is_call(&self.cpu, &self.chip) {
            return Ok(step);
        }
        let call = Call {
            chip: &mut self.chip,
            console,
            parameter: self.cpu.register(1),
        };
        let value = match call.answer(self.cpu.register(0)) {
            Some(Answer::Value(value)) => value,
            Some(Answer::Exit(reason, code)) => return Err(self.exited(reason, code)),
            None => FAILED,
        };
        let after = self.cpu.register(14);
        if let Some(status) = self.cpu.spsr() {
            self.cpu.set_cpsr(status);
        }
        self.cpu.set_pc(after);
        self.cpu.set_register(0, value);
        Ok(Step::Instruction)
    }

    fn exited(&self, reason: u32, code: u32) -> Stop {
        let (reason, message) = if reason == APPLICATION_EXIT {
            let text = format!("the program ended itself with code {code} (semihosting)");
            (StopReason::Halted, text)
        } else {
            let text = format!("the program reported reason {reason:#X} to its debugger");
            (StopReason::Fault, text)
        };
        Stop {
            reason,
            at_cycles: self.chip.now(),
            message,
        }
    }

    /// Let the program speak to its debugger from now on, or not: then its software interrupts
    /// go to its own handler.
    pub fn set_semihosting(&mut self, on: bool) {
        if on != self.console.is_some() {
            self.console = on.then(Console::default);
        }
    }

    /// Bytes that the program has written to its debugger so far.
    #[must_use]
    pub fn console_bytes(&self) -> u64 {
        self.console
            .as_ref()
            .map_or(0, |console| console.bytes_written)
    }

    /// Output of the program to its debugger after the first `from` bytes, as far as it is kept.
    #[must_use]
    pub fn console_since(&self, from: u64) -> &[u8] {
        let Some(Console {
            text,
            bytes_written,
            ..
        }) = &self.console
        else {
            return &[];
        };
        let wanted = bytes_written.saturating_sub(from) as usize;
        &text[text.len() - wanted.min(text.len())..]
    }
}
