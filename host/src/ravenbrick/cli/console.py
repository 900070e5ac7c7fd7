# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Progress on the terminal: numbered steps with their durations; silent for `--json`."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

__all__ = ["Reporter", "Step"]

BAR_WIDTH = 24
BOLD, DIM, RED = "1", "2", "31"
# Return to the first column and clear the line.
CLEAR = "\r\x1b[K"


class Step:
    """One step of a command; `note` is what to say when it is done."""

    def __init__(self, name: str, draw: Callable[[str], None] | None = None) -> None:
        self.name = name
        self.note = ""
        self.seconds = 0.0
        self.share = 0.0
        self._draw = draw
        if draw is not None:
            draw(name)

    def progress(self, share: float) -> None:
        """Say that a share (0 to 1) is done."""
        changed = int(100 * share) != int(100 * self.share)
        self.share = share
        if self._draw is not None and changed:
            full = int(BAR_WIDTH * share)
            self._draw(f"{self.name} {'━' * full}{'╌' * (BAR_WIDTH - full)} {share:4.0%}")


class Reporter:
    """Shows steps as they happen; `steps` keeps them with their durations."""

    def __init__(self, quiet: bool, total: int = 0) -> None:
        self._quiet = quiet
        self._terminal = not quiet and sys.stdout.isatty()
        self._total = total
        self.steps: list[Step] = []

    @contextmanager
    def step(self, name: str) -> Iterator[Step]:
        """Time a step, with a bar on a terminal and one line when it is done."""
        current = Step(name, self._draw if self._terminal else None)
        self.steps.append(current)
        begin = time.monotonic()
        try:
            yield current
        except BaseException:
            self._line(current, time.monotonic() - begin, self._styled("failed", RED))
            raise
        current.seconds = time.monotonic() - begin
        self._line(current, current.seconds, current.note)

    def _draw(self, text: str) -> None:
        """Text of the step in progress, which the next line replaces."""
        sys.stdout.write(CLEAR + text)
        sys.stdout.flush()

    def _styled(self, text: str, style: str) -> str:
        if not self._terminal or os.environ.get("NO_COLOR"):
            return text
        return f"\x1b[{style}m{text}\x1b[0m"

    def _line(self, step: Step, seconds: float, note: str) -> None:
        head = f"[{len(self.steps)}/{self._total}]" if self._total else "-"
        if self._terminal:
            self._draw("")
        self.print(f"{head} {step.name:<34} {self._styled(f'{seconds:6.2f} s', DIM)}  {note}")

    def print(self, text: str = "") -> None:
        """A line of text."""
        if not self._quiet:
            print(text, flush=True)

    def tell(self, text: str) -> None:
        """A line needed while the command runs: with `--json` it goes to standard error."""
        if self._quiet:
            print(text, file=sys.stderr, flush=True)
        self.print(text)

    def table(
        self, head: Sequence[str], rows: Sequence[Sequence[str]], left: Sequence[str] = ()
    ) -> None:
        """A plain table; columns titled in `left` to the left, besides the first."""
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        aligned = ["<" if not i or title in left else ">" for i, title in enumerate(head)]
        for number, row in enumerate((head, *rows)):
            cells = zip(row, aligned, widths, strict=True)
            line = "  ".join(f"{cell:{side}{width}}" for cell, side, width in cells).rstrip()
            self.print(line if number else self._styled(line, BOLD))

    def durations(self) -> list[dict[str, object]]:
        """Names and seconds of the steps, for `--json`."""
        return [{"name": step.name, "seconds": round(step.seconds, 3)} for step in self.steps]
