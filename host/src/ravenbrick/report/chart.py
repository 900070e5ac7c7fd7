# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Charts as SVG: a drawing holds panels, a panel maps its own units to the drawing's pixels.

The report draws dozens of charts; text takes a hundredth of the time that a raster picture takes,
and stays sharp on paper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["COLOURS", "SERIES", "Anchor", "Drawing", "Panel", "task_colour", "ticks"]

Floats = NDArray[np.float64]
Anchor = Literal["start", "middle", "end"]
COLOURS = {
    "text": "#222222",
    "faint": "#5c6066",
    "grid": "#e3e3e3",
    "setpoint": "#555555",
    "design": "#9a6a00",
    "sampled": "#00695c",
    "raw": "#a9c2df",
    "interrupts": "#8a8a8a",
    "kernel": "#c9b458",
    "deadline": "#b3372f",
    "bound": "#9a6a00",
}
# One order for motors, runs and tasks, legible in grey print.
SERIES = ("#1f5fa8", "#b3372f", "#00695c", "#8e4585", "#9a6a00", "#4a6b2a", "#7a4b3a")
TASKS = ("#1f5fa8", "#00695c", "#8e4585", "#9a6a00", "#4a6b2a", "#7a4b3a")


def task_colour(index: int) -> str:
    """Colour of a task by its index."""
    return TASKS[index % len(TASKS)]


def ticks(low: float, high: float, wanted: int = 6) -> list[float]:
    """Round values from `low` to `high`, at most about `wanted`."""
    span = high - low
    if not span > 0:
        return [low]
    power = 10.0 ** math.floor(math.log10(span / wanted))
    step = next(power * s for s in (1, 2, 5, 10) if power * s >= span / wanted)
    first = math.ceil(low / step - 1e-9)
    return [n * step for n in range(first, math.floor(high / step + 1e-9) + 1)]


def _number(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """First, least, greatest and last point of each pixel's column; looks the same."""
    column = np.floor(x)
    if x.size <= 4 * np.unique(column).size:
        return x, y
    begin = np.flatnonzero(np.diff(column, prepend=column[0] - 1))
    end = np.append(begin[1:], x.size) - 1
    low, high = np.minimum.reduceat(y, begin), np.maximum.reduceat(y, begin)
    up = y[begin] <= y[end]
    ys = np.stack([y[begin], np.where(up, low, high), np.where(up, high, low), y[end]], axis=1)
    ys, xs = ys.ravel(), np.stack([x[begin], x[begin], x[end], x[end]], axis=1).ravel()
    return xs, ys


def _corners(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Without points inside level pieces."""
    if y.size < 3:
        return x, y
    inside = (y[1:-1] == y[:-2]) & (y[1:-1] == y[2:])
    keep = np.concatenate(([True], ~inside, [True]))
    return x[keep], y[keep]


class Drawing:
    """An SVG picture of `width` by `height` pixels; y points down."""

    def __init__(self, width: float, height: float, description: str) -> None:
        self.width, self.height, self.description = width, height, description
        self._parts: list[str] = []

    def add(self, element: str) -> None:
        """Add an element of SVG as it is."""
        self._parts.append(element)

    def text(
        self,
        x: float,
        y: float,
        content: str,
        *,
        anchor: Anchor = "start",
        colour: str = COLOURS["text"],
        size: float = 12,
        bold: bool = False,
    ) -> None:
        """One line of text; `y` is its base line."""
        weight = ' font-weight="600"' if bold else ""
        self.add(
            f'<text x="{_number(x)}" y="{_number(y)}" text-anchor="{anchor}" fill="{colour}" '
            f'font-size="{size:g}"{weight}>{escape(content)}</text>'
        )

    def path(self, data: str, colour: str, width: float = 1.5, dash: str = "") -> None:
        """A line through path data."""
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(
            f'<path d="{data}" fill="none" stroke="{colour}" stroke-width="{width:g}" '
            f'stroke-linejoin="round"{dashes}/>'
        )

    def rectangles(self, boxes: Sequence[tuple[float, float, float, float]], colour: str) -> None:
        """Filled boxes of one colour: x, y, width, height."""
        if not boxes:
            return
        data = "".join(
            f"M{_number(x)} {_number(y)}h{_number(w)}v{_number(h)}h-{_number(w)}z"
            for x, y, w, h in boxes
        )
        self.add(f'<path d="{data}" fill="{colour}"/>')

    def svg(self) -> str:
        """The picture as an element of HTML, and as a file when written alone."""
        size = f"0 0 {self.width:g} {self.height:g}"
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{size}" width="{self.width:g}" '
            f'height="{self.height:g}" role="img" font-family="system-ui, \'Segoe UI\', Roboto, '
            f"'Liberation Sans', sans-serif\"><title>{escape(self.description)}</title>"
            + "".join(self._parts)
            + "</svg>"
        )


@dataclass
class Panel:
    """A part of a drawing with axes: `x` and `y` are their ranges, logarithmic x if asked for.

    `left`, `top`, `width` and `height` are pixels of the drawing.
    """

    drawing: Drawing
    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]
    log: bool = False

    @property
    def bottom(self) -> float:
        """The lower edge, in pixels."""
        return self.top + self.height

    def at_x(self, values: ArrayLike) -> Floats:
        """Pixels of values on the x axis."""
        low, high = self.x
        shown = np.asarray(values, np.float64)
        if self.log:
            low, high, shown = math.log(low), math.log(high), np.log(np.maximum(shown, 1e-12))
        return np.asarray(self.left + (shown - low) / (high - low) * self.width)

    def at_y(self, values: ArrayLike) -> Floats:
        """Pixels of values on the y axis."""
        low, high = self.y
        return np.asarray(self.bottom - (np.asarray(values) - low) / (high - low) * self.height)

    def x_axis(self, label: str = "", values: Sequence[float] | None = None) -> None:
        """Grid lines, and numbers below them when there is a label."""
        shown = ticks(*self.x, int(self.width / 90)) if values is None else values
        for value in shown:
            at = float(self.at_x(value))
            self.vertical(value, COLOURS["grid"])
            if label:
                text = f"{value:g}"
                self.drawing.text(
                    at, self.bottom + 16, text, anchor="middle", colour=COLOURS["faint"], size=11
                )
        if label:
            middle = self.left + self.width / 2
            self.drawing.text(
                middle, self.bottom + 33, label, anchor="middle", colour=COLOURS["faint"]
            )

    def y_axis(self, title: str = "") -> None:
        """Grid lines with their numbers; the title stands above the panel."""
        for value in ticks(*self.y, max(int(self.height / 28), 4)):
            at = float(self.at_y(value))
            self.drawing.path(
                f"M{_number(self.left)} {_number(at)}h{_number(self.width)}", COLOURS["grid"], 1
            )
            self.drawing.text(
                self.left - 7, at + 4, f"{value:g}", anchor="end", colour=COLOURS["faint"], size=11
            )
        if title:
            self.drawing.text(self.left, self.top - 7, title, bold=True)

    def vertical(self, value: float, colour: str, width: float = 1, dash: str = "") -> None:
        """A line over the whole height."""
        at = _number(float(self.at_x(value)))
        self.drawing.path(f"M{at} {_number(self.top)}v{_number(self.height)}", colour, width, dash)

    def horizontal(self, value: float, colour: str, width: float = 1, dash: str = "") -> None:
        """A line over the whole width."""
        at = _number(float(self.at_y(value)))
        self.drawing.path(f"M{_number(self.left)} {at}h{_number(self.width)}", colour, width, dash)

    def line(
        self,
        x: ArrayLike,
        y: ArrayLike,
        colour: str,
        width: float = 1.5,
        *,
        dash: str = "",
        held: bool = False,
        ordered: bool = True,
    ) -> None:
        """A curve; `held`: each value until the next. `ordered`: x only grows, points may go."""
        xs, ys = self.at_x(x), np.clip(self.at_y(y), self.top - 2, self.bottom + 2)
        if not xs.size:
            return
        if held and xs.size > 1:
            xs, ys = np.repeat(xs, 2)[1:], np.repeat(ys, 2)[:-1]
        xs, ys = xs.round(1), ys.round(1)
        if ordered:
            xs, ys = _corners(*_thinned(xs, ys))
        points = "L".join(f"{a:g} {b:g}" for a, b in zip(xs.tolist(), ys.tolist(), strict=True))
        self.drawing.path(f"M{points}", colour, width, dash)

    def legend(self, entries: Sequence[tuple[str, str, str]]) -> None:
        """Label, colour and dashes of each curve, to the right above the panel."""
        right = self.left + self.width
        for label, colour, dash in reversed(entries):
            self.drawing.text(right, self.top - 7, label, anchor="end", colour=COLOURS["faint"])
            right -= 6.4 * len(label) + 8
            at = f"M{_number(right - 22)} {_number(self.top - 11)}h22"
            self.drawing.path(at, colour, 2.4, dash)
            right -= 40
