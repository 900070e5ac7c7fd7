// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The boot monitor's commands, carried out on the chip (AT91SAM7S datasheet, 6175M, chapter 22).
//!
//! The processor stands while the monitor waits for a command; `G` calls a routine, which runs on
//! the processor and comes back to the monitor, or takes the USB over and never does.

use arm7tdmi::{psr, Bus, Cpu, Cycle, Mode, Width};
use at91sam7s::ResetCause;

use crate::brick::VirtualBrick;
use crate::stop::Stop;

/// Return address of a routine, in the RAM that the monitor reserves.
const RETURN: u32 = 0x0020_0100;
/// Branch to itself.
const BRANCH_TO_SELF: [u8; 4] = [0xFE, 0xFF, 0xFF, 0xEA];
/// The monitor's stack ends where the user's RAM begins.
const STACK: u32 = 0x0020_2000;
const VERSION: &[u8] = b"v1.4 Nov 10 2004 14:49:33\n\r";
/// Longest command: letter, two numbers, comma, end.
const COMMAND_BYTES_MAX: usize = 32;
/// Flash that recovery overwrites: the first two lock regions.
const OVERWRITTEN_BYTES: usize = 2 * 64 * 256;
const FLASH: u32 = 0x0010_0000;
const SRAM: u32 = 0x0020_0000;
const SRAM_BYTES: usize = 0x1_0000;

/// State of the monitor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum MonitorState {
    /// It collects a command.
    #[default]
    WaitsForCommand,
    /// It writes a file to memory: next address, bytes that are still to come.
    ReceivesFile(u32, u32),
    /// A routine runs.
    RunsRoutine,
}

impl VirtualBrick {
    /// Bring a brick into its boot monitor, as its own firmware does on request and the reset
    /// button does: a power cycle, after which the start of the flash is overwritten and RAM is
    /// lost. The seconds that this takes are left out. A run that had ended goes on.
    pub fn enter_boot_monitor(&mut self) {
        self.chip.reset(ResetCause::PowerUp);
        let _ = self.chip.take_reset();
        // Both ranges lie wholly in memory.
        let _ = self.chip.load(FLASH, &vec![0xFF; OVERWRITTEN_BYTES]);
        let _ = self.chip.load(SRAM, &vec![0; SRAM_BYTES]);
        let _ = self.chip.load(RETURN, &BRANCH_TO_SELF);
        self.chip.enter_as_boot_monitor();
        let now = self.chip.now();
        self.chip.board_mut().enter_boot_monitor(now);
        self.cpu = Cpu::new();
        self.blocks = self.blocks.new_like();
        self.ended = None;
        self.monitor = Some(MonitorState::WaitsForCommand);
    }

    /// The boot monitor is there: it waits for commands, or a routine that it called runs.
    #[must_use]
    pub fn in_boot_monitor(&self) -> bool {
        self.monitor.is_some()
    }

    /// Let time pass in the monitor or in the routine that it called.
    pub(crate) fn run_monitor(&mut self, limit_cycles: u64) -> Result<(), Stop> {
        let due = self.inputs.next_cycles();
        let end = limit_cycles
            .min(due)
            .min(self.recorder.next_sample_cycles());
        while self.chip.now() < end && self.monitor.is_some() {
            if self.monitor == Some(MonitorState::RunsRoutine) && !self.chip.processor_stopped() {
                let before = self.cpu.next_instruction_address();
                self.cpu.step(&mut self.chip);
                self.after_step(before)?;
                if self.cpu.next_instruction_address() == RETURN {
                    self.monitor = Some(MonitorState::WaitsForCommand);
                }
            } else {
                self.chip.skip_to_next_event(end);
                self.after_step(RETURN)?;
                if self.monitor != Some(MonitorState::RunsRoutine) {
                    self.serve_host();
                }
            }
            if self.chip.board().boot_monitor().is_none() {
                self.monitor = None;
                self.blocks = self.blocks.new_like();
            }
        }
        Ok(())
    }

    /// Execute the host's commands, up to the call of a routine.
    fn serve_host(&mut self) {
        let device = self.chip.board().boot_monitor();
        if device.is_none_or(|device| device.waiting() == 0) {
            return;
        }
        while self.monitor != Some(MonitorState::RunsRoutine) {
            match self.monitor {
                Some(MonitorState::ReceivesFile(address, remaining)) if remaining > 0 => {
                    let Some(byte) = self.next_byte() else {
                        return;
                    };
                    self.store(address, Width::Byte, u32::from(byte));
                    let next = MonitorState::ReceivesFile(address.wrapping_add(1), remaining - 1);
                    self.monitor = Some(next);
                }
                _ => {
                    self.monitor = Some(MonitorState::WaitsForCommand);
                    let Some(command) = self.take_command() else {
                        return;
                    };
                    self.execute(&command);
                }
            }
        }
    }

    fn next_byte(&mut self) -> Option<u8> {
        let device = self.chip.board_mut().boot_monitor_mut()?;
        device.received_mut().pop_front()
    }

    /// The bytes before the next `#`; what is longer than any command is dropped.
    fn take_command(&mut self) -> Option<Vec<u8>> {
        let device = self.chip.board_mut().boot_monitor_mut()?;
        let received = device.received_mut();
        let Some(end) = received.iter().position(|byte| *byte == b'#') else {
            if received.len() > COMMAND_BYTES_MAX {
                received.clear();
            }
            return None;
        };
        let mut command: Vec<u8> = received.drain(..=end).collect();
        command.pop();
        Some(command)
    }

    fn execute(&mut self, command: &[u8]) {
        let text = String::from_utf8_lossy(command);
        let mut letters = text.chars();
        let letter = letters.next().unwrap_or('\n');
        let mut numbers = letters.as_str().split(',').map(|number| {
            let digits = number.trim_start_matches("0x");
            u32::from_str_radix(digits, 16).unwrap_or(0)
        });
        let first = numbers.next().unwrap_or(0);
        let second = numbers.next().unwrap_or(0);
        match letter {
            'W' => self.store(first, Width::Word, second),
            'H' => self.store(first, Width::Halfword, second),
            'O' => self.store(first, Width::Byte, second),
            'w' => self.send_memory(first, Width::Word, 4),
            'h' => self.send_memory(first, Width::Halfword, 2),
            'o' => self.send_memory(first, Width::Byte, 1),
            'S' => self.monitor = Some(MonitorState::ReceivesFile(first, second)),
            'R' => {
                for offset in 0..second.min(SRAM_BYTES as u32 * 4) {
                    self.send_memory(first.wrapping_add(offset), Width::Byte, 1);
                }
            }
            'G' => self.call(first),
            'V' => self.reply(VERSION),
            'N' | 'T' => self.reply(b"\n\r"),
            _ => {}
        }
    }

    fn reply(&mut self, bytes: &[u8]) {
        if let Some(device) = self.chip.board_mut().boot_monitor_mut() {
            device.reply(bytes);
        }
    }

    /// A write of the monitor; one that aborts has no effect.
    fn store(&mut self, address: u32, width: Width, value: u32) {
        let _ = self.chip.write(address, width, value, Cycle::Nonsequential);
    }

    /// A read of the monitor, for the host; one that aborts gives zeros.
    fn send_memory(&mut self, address: u32, width: Width, bytes: usize) {
        let value = self.chip.read(address, width, Cycle::Nonsequential);
        let value = value.unwrap_or(0).to_le_bytes();
        self.reply(&value[..bytes]);
    }

    fn call(&mut self, address: u32) {
        let mut cpu = Cpu::new();
        cpu.set_cpsr(Mode::Supervisor.bits() | psr::I | psr::F);
        cpu.set_register(13, STACK);
        cpu.set_register(14, RETURN);
        if address & 1 != 0 {
            cpu.set_cpsr(cpu.cpsr() | psr::T);
        }
        cpu.set_pc(address & !1);
        self.cpu = cpu;
        self.monitor = Some(MonitorState::RunsRoutine);
    }
}
