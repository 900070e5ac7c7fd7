# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An ARM7TDMI as a debugger sees it: EmbeddedICE, and instructions fed through scan chain 1.

It executes what debuggers feed (loads and stores of registers, status registers, branches), not
programs: while it is not halted nothing happens. Source: ARM DDI 0029E, chapters 8 and 9.
"""

from __future__ import annotations

MASK = 0xFFFF_FFFF
DEBUG_CONTROL, DEBUG_STATUS, COMMS_CONTROL = 0, 1, 4
WATCHPOINT_CONTROL = (12, 20)
ENABLE = 1 << 8
DBGACK, DBGRQ, SYSCOMP = 1 << 0, 1 << 1, 1 << 3
VERSION_1 = 1 << 28
SUPERVISOR, MASKED = 0x13, 0xC0
NOP = 0xE1A0_0000
# After a debug request the program counter is three instructions on (section 8.8), and a store
# multiple that is fed reads it another three on.
PC_AHEAD = 24


def _reversed(value: int) -> int:
    """The data bits of scan chain 1, which leave from bit 31 on."""
    return int(f"{value:032b}"[::-1], 2)


class DebugCore:
    """Registers, pipeline and memory (words by address; absent ones read 0)."""

    def __init__(self, program_counter: int = 0x0020_2000) -> None:
        self.registers = [0x1000_0000 + number for number in range(15)] + [program_counter]
        self.status = MASKED | SUPERVISOR
        self.saved_status = SUPERVISOR
        self.memory: dict[int, int] = {}
        self.halted = False
        self._ice = {COMMS_CONTROL: VERSION_1}
        self._ice_read = 0
        self._bus = 0
        self._scanned, self._marked = NOP, False
        self._pipeline = [NOP, NOP]
        self._data: list[int] = []
        self._loads = False
        self._at_system_speed = False
        self.resumed_at: int | None = None

    def capture(self, chain: int) -> int:
        """See `tap.Core`."""
        if chain == 1:
            return _reversed(self._bus) << 1
        return self._ice_read

    def update(self, chain: int, value: int) -> None:
        """See `tap.Core`."""
        if chain == 1:
            self._scanned, self._marked = _reversed(value >> 1), bool(value & 1)
            return
        data, address, write = value & MASK, value >> 32 & 0x1F, value >> 37
        if not write:
            self._ice_read = self._read_ice(address)
            return
        self._ice[address] = data
        watched = any(self._ice.get(place, 0) & ENABLE for place in WATCHPOINT_CONTROL)
        requested = self._ice.get(DEBUG_CONTROL, 0) & DBGRQ
        if not self.halted and (watched or requested):
            self.halted = True
            self.registers[15] += PC_AHEAD

    def _read_ice(self, address: int) -> int:
        if address == DEBUG_STATUS:
            return (DBGACK if self.halted else 0) | SYSCOMP
        return self._ice.get(address, 0)

    def clock(self, chain: int) -> None:
        """See `tap.Core`."""
        if chain != 1 or not self.halted:
            return
        if self._data:
            register = self._data.pop(0)
            if self._loads:
                self.registers[register] = self._scanned
            elif self._data:
                self._bus = self.registers[self._data[0]]
            return
        self._at_system_speed = self._at_system_speed or self._marked
        executed = self._pipeline.pop(0)
        self._pipeline.append(self._scanned)
        self._execute(executed)

    def _execute(self, word: int) -> None:
        listed = [number for number in range(16) if word >> number & 1]
        if word & 0x0E00_0000 == 0x0800_0000:
            self._data, self._loads = listed, bool(word & 1 << 20)
        elif word & 0x0C00_0000 == 0x0400_0000:
            self._data, self._loads = [word >> 12 & 0xF], bool(word & 1 << 20)
        elif word & 0x0FBF_0FFF == 0x010F_0000:
            saved = word & 1 << 22
            self.registers[word >> 12 & 0xF] = self.saved_status if saved else self.status
        elif word & 0x0DB0_F000 == 0x0120_F000:
            self._set_status(word)
        if self._data and not self._loads:
            self._bus = self.registers[self._data[0]]

    def _set_status(self, word: int) -> None:
        """MSR of an immediate or a register, with its field mask."""
        if word & 1 << 25:
            turn = 2 * (word >> 8 & 0xF)
            value = ((word & 0xFF) >> turn | (word & 0xFF) << (32 - turn)) & MASK
        else:
            value = self.registers[word & 0xF]
        fields = sum(0xFF << 8 * place for place in range(4) if word >> (16 + place) & 1)
        if word & 1 << 22:
            self.saved_status = self.saved_status & ~fields | value & fields
        else:
            self.status = self.status & ~fields | value & fields

    def restart(self) -> None:
        """See `tap.Core`: the last instruction at system speed, or on with the program."""
        if not self._at_system_speed:
            return
        self._at_system_speed = False
        word = self._pipeline[-1]
        if word & 0x0E00_0000 == 0x0A00_0000:
            self.halted, self.resumed_at = False, self.registers[15]
            return
        base = word >> 16 & 0xF
        address = self.registers[base]
        if word & 0x0E00_0000 == 0x0800_0000:
            for number in (n for n in range(16) if word >> n & 1):
                if word & 1 << 20:
                    self.registers[number] = self.memory.get(address, 0)
                else:
                    self.memory[address] = self.registers[number]
                address += 4
            if word & 1 << 21:
                self.registers[base] = address
        self._pipeline = [NOP, NOP]
