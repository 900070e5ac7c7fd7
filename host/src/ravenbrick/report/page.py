# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables and figures of the report as HTML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

from ravenbrick.report.chart import Drawing

__all__ = ["Drawings", "Table", "counted", "table"]

Cells = Sequence[str]


@dataclass(frozen=True)
class Table:
    """Numbers to the right; the first `text_columns` to the left. `markup`: cells are HTML."""

    head: Cells
    rows: Sequence[Cells]
    text_columns: int = 1
    markup: bool = False

    def html(self) -> str:
        """In a box of its own that scrolls sideways."""
        cells = self._row(self.head, "th", False)
        body = "".join(self._row(row, "td", self.markup) for row in self.rows)
        return f'<div class="scroll"><table>{cells}{body}</table></div>'

    def _row(self, cells: Cells, tag: str, markup: bool) -> str:
        text = ""
        for place, cell in enumerate(cells):
            style = ' class="text"' if place < self.text_columns else ""
            text += f"<{tag}{style}>{cell if markup else escape(cell)}</{tag}>"
        return f"<tr>{text}</tr>"


def table(head: Cells, rows: Sequence[Cells]) -> str:
    """A plain table."""
    return Table(head, rows).html()


def counted(number: int, noun: str) -> str:
    """The number with its noun in singular or plural."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


@dataclass
class Drawings:
    """The drawings that a page shows, by the names of their files."""

    drawn: dict[str, Drawing] = field(default_factory=dict)

    def figure(self, name: str, drawing: Drawing | None, caption: str) -> str:
        """A drawing with its caption; nothing for no drawing."""
        if drawing is None:
            return ""
        self.drawn[name] = drawing
        return (
            f'<figure><div class="scroll">{drawing.svg()}</div>'
            f"<figcaption>{escape(caption)}</figcaption></figure>"
        )
