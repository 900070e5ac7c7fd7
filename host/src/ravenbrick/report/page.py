# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""HTML pages from the templates of this folder; text of a project is always escaped."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any

from ravenbrick.report.chart import Drawing

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["Figure", "Figures", "Row", "counted", "milliseconds", "page", "percent"]

# Cells of a table; a pair is a text with a smaller one below it.
Row = tuple[str | int | tuple[str, str], ...]


@dataclass(frozen=True)
class Figure:
    """A chart with its caption."""

    drawing: Drawing
    caption: str


@dataclass
class Figures:
    """The figures of a page, by the names of their files."""

    named: dict[str, Figure] = field(default_factory=dict)

    def add(self, name: str, drawing: Drawing | None, caption: str) -> Figure | None:
        """A figure of the page; None for no drawing."""
        if drawing is None:
            return None
        self.named[name] = Figure(drawing, caption)
        return self.named[name]


def counted(number: int, noun: str) -> str:
    """The number with its noun in singular or plural."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def percent(share: float) -> str:
    """A share of one in percent."""
    return f"{100 * share:.2f} %"


def milliseconds(seconds: float | None) -> str:
    """A time in s as text, `never` for None."""
    return "never" if seconds is None else f"{1000 * seconds:.1f} ms"


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined  # slow to load

    made = Environment(
        loader=PackageLoader("ravenbrick.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals["counted"] = counted
    made.filters |= {"milliseconds": milliseconds, "percent": percent}
    return made


def page(template: str, **values: Any) -> str:
    """The page of a template; raises `jinja2.UndefinedError` for a value that is not given."""
    return _environment().get_template(template).render(values)
