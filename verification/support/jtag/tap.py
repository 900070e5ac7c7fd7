# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The test access port of IEEE 1149.1, and the ARM7TDMI's registers behind it.

Source: ARM7TDMI data sheet (ARM DDI 0029E), chapters 8 (debug interface) and 9 (EmbeddedICE).
"""

from __future__ import annotations

from typing import Protocol

IDENTITY = 0x3F0F0F0F
INSTRUCTION_BITS = 4
CAPTURED_INSTRUCTION = 0b0001
SCAN_N, RESTART, INTEST, IDCODE, BYPASS = 0x2, 0x4, 0xC, 0xE, 0xF
CHAIN_BITS = {1: 33, 2: 38}

# State -> states after TMS 0 and 1
NEXT = {
    "reset": ("idle", "reset"),
    "idle": ("idle", "select-dr"),
    "select-dr": ("capture-dr", "select-ir"),
    "capture-dr": ("shift-dr", "exit1-dr"),
    "shift-dr": ("shift-dr", "exit1-dr"),
    "exit1-dr": ("pause-dr", "update-dr"),
    "pause-dr": ("pause-dr", "exit2-dr"),
    "exit2-dr": ("shift-dr", "update-dr"),
    "update-dr": ("idle", "select-dr"),
    "select-ir": ("capture-ir", "reset"),
    "capture-ir": ("shift-ir", "exit1-ir"),
    "shift-ir": ("shift-ir", "exit1-ir"),
    "exit1-ir": ("pause-ir", "update-ir"),
    "pause-ir": ("pause-ir", "exit2-ir"),
    "exit2-ir": ("shift-ir", "update-ir"),
    "update-ir": ("idle", "select-dr"),
}


class Core(Protocol):
    """What is behind the scan chains."""

    def capture(self, chain: int) -> int:
        """The chain's bits, the first to leave lowest."""

    def update(self, chain: int, value: int) -> None:
        """New bits in the chain."""

    def clock(self, chain: int) -> None:
        """A debug clock, while chain 1 is selected for INTEST."""

    def restart(self) -> None:
        """The instruction RESTART is in force."""


class Tap:
    """The state machine; `tdo` is the line's level."""

    def __init__(self, core: Core) -> None:
        self._core = core
        self._state = "reset"
        self._instruction = IDCODE
        self._chain = 0
        self._shift = 0
        self._bits = 1
        self._clock = 0
        self.tdo = 0

    def lines(self, tck: int, tms: int, tdi: int) -> None:
        """New levels: a rising clock moves the machine, a falling one TDO."""
        if tck and not self._clock:
            self._rise(tms, tdi)
        elif self._clock and not tck:
            self.tdo = self._shift & 1
        self._clock = tck

    def _rise(self, tms: int, tdi: int) -> None:
        if self._state in ("shift-dr", "shift-ir"):
            self._shift = self._shift >> 1 | tdi << (self._bits - 1)
        self._state = NEXT[self._state][tms]
        match self._state:
            case "reset":
                self._instruction = IDCODE
            case "capture-ir":
                self._load(CAPTURED_INSTRUCTION, INSTRUCTION_BITS)
            case "update-ir":
                self._instruction = self._shift
            case "capture-dr":
                self._capture()
            case "update-dr":
                self._update()
            case "idle" if self._instruction == RESTART:
                self._core.restart()
            case "idle" if self._instruction == INTEST:
                self._core.clock(self._chain)

    def _load(self, value: int, bits: int) -> None:
        self._shift, self._bits = value, bits

    def _capture(self) -> None:
        if self._instruction == IDCODE:
            self._load(IDENTITY, 32)
        elif self._instruction == SCAN_N:
            self._load(0b1000, 4)
        elif self._instruction == INTEST and self._chain in CHAIN_BITS:
            self._load(self._core.capture(self._chain), CHAIN_BITS[self._chain])
        else:
            self._load(0, 1)

    def _update(self) -> None:
        if self._instruction == SCAN_N:
            self._chain = self._shift
        elif self._instruction == INTEST and self._chain in CHAIN_BITS:
            self._core.update(self._chain, self._shift)
