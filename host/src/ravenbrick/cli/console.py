# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Progress on the terminal: numbered steps with their durations; silent for `--json`."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

__all__ = ["Reporter", "Step"]


class Step:
    """One step of a command; `note` is what to say when it is done."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.note = ""
        self.seconds = 0.0
        self.share = 0.0
        self._bar: tuple[Progress, TaskID] | None = None

    def attach(self, progress: Progress) -> None:
        """Show the step's share on a progress bar."""
        self._bar = (progress, progress.add_task(self.name, total=1.0))

    def progress(self, share: float) -> None:
        """Say that a share (0 to 1) is done."""
        self.share = share
        if self._bar is not None:
            bar, task = self._bar
            bar.update(task, completed=share)


class Reporter:
    """Shows steps as they happen; `steps` keeps them with their durations."""

    def __init__(self, quiet: bool, total: int = 0) -> None:
        self._console = Console(quiet=quiet, highlight=False)
        self._total = total
        self.steps: list[Step] = []

    @contextmanager
    def step(self, name: str) -> Iterator[Step]:
        """Time a step, with a bar on a terminal and one line when it is done."""
        current = Step(name)
        self.steps.append(current)
        begin = time.monotonic()
        try:
            if self._console.is_terminal and not self._console.quiet:
                columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(24))
                bar = Progress(*columns, TimeElapsedColumn(), console=self._console, transient=True)
                with bar:
                    current.attach(bar)
                    yield current
            else:
                yield current
        except BaseException:
            self._line(current, time.monotonic() - begin, "failed", "red")
            raise
        current.seconds = time.monotonic() - begin
        self._line(current, current.seconds, current.note, "green")

    def _line(self, step: Step, seconds: float, note: str, style: str) -> None:
        number = len(self.steps)
        head = f"[{number}/{self._total}]" if self._total else "-"
        text = Text(f"{head} {step.name:<34} ", style="")
        text.append(f"{seconds:6.2f} s", style="dim")
        text.append(f"  {note}", style=style if note == "failed" else "")
        self._console.print(text, soft_wrap=True)

    def print(self, text: str = "") -> None:
        """A line of text."""
        self._console.print(Text(text), soft_wrap=True)

    def table(
        self, head: Sequence[str], rows: Sequence[Sequence[str]], left: Sequence[str] = ()
    ) -> None:
        """A plain table; columns titled in `left` to the left, besides the first."""
        table = Table(box=None, pad_edge=False, header_style="bold")
        for index, title in enumerate(head):
            table.add_column(
                title, justify="left" if index == 0 or title in left else "right", overflow="fold"
            )
        for row in rows:
            table.add_row(*(Text(cell) for cell in row))
        self._console.print(table)

    def durations(self) -> list[dict[str, object]]:
        """Names and seconds of the steps, for `--json`."""
        return [{"name": step.name, "seconds": round(step.seconds, 3)} for step in self.steps]
