# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Plots of matplotlib in the look of the charts."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, Any

from ravenbrick.report.chart import COLOURS, task_colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "COLOURS",
    "data_uri",
    "legend",
    "new_figure",
    "png_bytes",
    "task_colour",
]

DPI = 150


def new_figure(width: float = 8.0, height: float = 4.0, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure (inches) with plain axes, one below the other."""
    from matplotlib.figure import Figure  # slow to load

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, 1, sharex=rows > 1, squeeze=False)[:, 0]
    for axis in axes:
        axis.grid(True, color=COLOURS["grid"], linewidth=0.7)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
        axis.tick_params(labelsize=9)
    return figure, list(axes)


def data_uri(content: bytes, media_type: str) -> str:
    """Content for an `src` attribute."""
    return f"data:{media_type};base64,{base64.b64encode(content).decode('ascii')}"


def png_bytes(figure: Figure) -> bytes:
    """The figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()


def legend(axis: Axes, place: Any, columns: int = 1) -> None:
    """A plain legend."""
    axis.legend(frameon=False, fontsize=8.5, loc=place, ncols=columns)
