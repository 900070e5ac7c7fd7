// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Access for debuggers: what the bus shows, and changes from outside.

use arm7tdmi::{Bus, Cpu, Cycle, Width};
use at91sam7s::LoggedPins;

use crate::brick::VirtualBrick;
use crate::memory::{ChipMemory, MemoryError};

impl VirtualBrick {
    /// Bytes as a read of the processor would find them now, peripherals and the memory that
    /// appears at address 0 included. The brick is not changed: the reads are made on a copy,
    /// word by word, so a later word of a peripheral is read a few cycles later.
    ///
    /// # Errors
    /// Some of it is neither memory nor a modelled register.
    pub fn read_bus(&self, address: u32, length: usize) -> Result<Vec<u8>, MemoryError> {
        if let Ok(bytes) = self.chip.peek(address, length) {
            return Ok(bytes);
        }
        let refused = MemoryError { address, length };
        let mut copy = self.chip.clone();
        let mut bytes = Vec::new();
        let mut word_read: Option<(u32, u32)> = None;
        for offset in 0..length {
            let offset = u32::try_from(offset).map_err(|_| refused)?;
            let at = address.checked_add(offset).ok_or(refused)?;
            let word_address = at & !3;
            let word = match word_read {
                Some((known, word)) if known == word_address => word,
                _ => copy
                    .read(word_address, Width::Word, Cycle::Nonsequential)
                    .map_err(|_| refused)?,
            };
            if copy.fault() != self.chip.fault() {
                return Err(refused);
            }
            word_read = Some((word_address, word));
            bytes.push((word >> ((at & 3) * 8)) as u8);
        }
        Ok(bytes)
    }

    /// Change SRAM or flash from outside; the program is not told.
    ///
    /// # Errors
    /// Some of it is no memory; nothing is changed.
    pub fn write_memory(&mut self, address: u32, bytes: &[u8]) -> Result<(), MemoryError> {
        self.chip.load(address, bytes)
    }

    /// Transfers that the peripheral data controller has stored in memory so far.
    #[must_use]
    pub fn memory_transfers(&self) -> u64 {
        self.chip.transfers_stored()
    }

    /// The processor, to change its registers from outside.
    pub fn processor_mut(&mut self) -> &mut Cpu {
        &mut self.cpu
    }

    /// Source files and lines of the calls that lead to the next instruction, innermost first;
    /// calls without a source line are left out.
    #[must_use]
    pub fn call_places(&self) -> Vec<(String, u32)> {
        let mut registers = [0; 16];
        for (index, register) in (0..15).zip(&mut registers) {
            *register = self.cpu.register(index);
        }
        registers[15] = self.cpu.next_instruction_address();
        let calls = self.calls_from(registers).into_iter();
        let lines = calls.filter_map(|call| call.line);
        lines.map(|(file, line, _)| (file, line)).collect()
    }

    /// Address of the running thread's control block, 0 while none runs; none when threads
    /// cannot be observed.
    #[must_use]
    pub fn running_thread(&self) -> Option<u32> {
        self.recorder.running_thread(&ChipMemory(&self.chip))
    }

    /// Every physical quantity that is sampled as a signal, at the present: name and value.
    #[must_use]
    pub fn quantities(&self) -> Vec<(String, f64)> {
        self.chip.board().signals(self.chip.now())
    }

    /// Levels of the chip's pins PA0 to PA31, one bit each.
    #[must_use]
    pub fn pins(&self) -> u32 {
        self.chip.pins()
    }

    /// Log the levels of the pins whose bits are set, beside the trace, which stays the same.
    pub fn log_pins(&mut self, chosen: u32) {
        self.chip.log_pins(chosen);
    }

    /// Levels of all pins at each change of a logged one, from those when the log began.
    #[must_use]
    pub fn logged_pins(&self) -> &[LoggedPins] {
        self.chip.logged_pins()
    }

    /// Log the transfers of the peripheral data controller from now on.
    pub fn log_transfers(&mut self) {
        self.chip.log_transfers();
    }

    /// The logged transfers: when, in cycles, and of which peripheral.
    #[must_use]
    pub fn logged_transfers(&self) -> &[(u64, &'static str)] {
        self.chip.logged_transfers()
    }

    /// What can be set from outside on this brick.
    #[must_use]
    pub fn inputs(&self) -> &[nxt::InputDescription] {
        self.chip.board().inputs()
    }

    /// The run ended: why. None while it can go on.
    #[must_use]
    pub fn ended(&self) -> Option<&crate::Stop> {
        self.ended.as_ref()
    }
}
