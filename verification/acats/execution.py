# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs an image on the virtual brick until its report is complete."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path

import virtual_brick

__all__ = ["Verdict", "execute"]

BENCH = json.dumps(
    {
        "seed": 1,
        "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
        "body": {"kind": "bench"},
    }
)
FIRST_SLICE_CYCLES = 2_000_000
LIMIT_CYCLES = 10_000_000_000
"""About 208 s of the brick."""
PROCESSOR_EXCEPTIONS = r"undefined instruction|software interrupt|prefetch abort|data abort"
WORDS = {1: "passed", 2: "failed", 3: "inapplicable", 4: "tentative"}


@dataclass(frozen=True)
class Verdict:
    """How a run ended.

    `passed`, `failed`, `inapplicable`, `tentative` as reported; `raised`: an exception reached the
    last-chance handler; `stopped`: by the brick; `late`: at the limit; `silent`: without a report.
    """

    word: str
    text: str
    cycles: int
    removed_handlers: int = 0
    """Of the program's sources: the compiler found that they can never be entered."""


def _text_at(brick: virtual_brick.VirtualBrick, address: int) -> str:
    return brick.read_memory(address, 64).split(b"\0")[0].decode("latin-1")


def _overflowed(brick: virtual_brick.VirtualBrick) -> str | None:
    for thread in brick.threads():
        if thread.stack_size and thread.stack_used >= thread.stack_size:
            return f"stack of {thread.name or 'a task'} full: {thread.stack_size} bytes"
    return None


def _log(brick: virtual_brick.VirtualBrick) -> str:
    length = brick.read_int("acats_log_length", "u32")
    return brick.read_memory(brick.symbol("acats_log")[0], length).decode("latin-1")


def execute(elf: Path) -> Verdict:
    """Run to the verdict, to a failure of the program, or to the limit."""
    brick = virtual_brick.VirtualBrick(BENCH, elf.read_bytes())
    failure, _ = brick.symbol("ravenbrick_failure")
    try:
        brick.symbol("acats_verdict")
    except virtual_brick.ImageError:
        return Verdict("silent", "the program makes no report", 0)
    until = FIRST_SLICE_CYCLES
    while True:
        stop = brick.run_until(until)
        verdict = brick.read_int("acats_verdict", "u32")
        if verdict:
            word = WORDS.get(verdict, "stopped")
            text = _log(brick) if verdict in WORDS else "the program overwrote its verdict"
            break
        if address := int.from_bytes(brick.read_memory(failure, 4), "little"):
            line = int.from_bytes(brick.read_memory(failure + 4, 4), "little")
            text = f"{_text_at(brick, address)}:{line}"
            word = "stopped" if re.match(PROCESSOR_EXCEPTIONS, text) else "raised"
            break
        if stop.reason != "reached":
            word, text = "stopped", stop.message
            break
        if until >= LIMIT_CYCLES:
            word, text = "late", _log(brick)
            break
        until = min(2 * until, LIMIT_CYCLES)
    if full := _overflowed(brick):
        word, text = "stopped", full
    return Verdict(word, text, brick.cycles)
