# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One look for all plots: the same colour for the same thing, legible in grey print."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "COLOURS",
    "data_uri",
    "degrees_per_second",
    "legend",
    "new_figure",
    "png_bytes",
    "task_colour",
]

COLOURS = {
    "setpoint": "#555555",
    "design": "#9a6a00",
    "sampled": "#00695c",
    "left": "#1f5fa8",
    "right": "#b3372f",
    "with": "#1f5fa8",
    "without": "#b3372f",
    "interrupts": "#8a8a8a",
    "kernel": "#c9b458",
    "grid": "#e3e3e3",
    "faint": "#a9c2df",
}
TASK_COLOURS = ("#1f5fa8", "#00695c", "#8e4585", "#9a6a00", "#4a6b2a", "#7a4b3a")
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


def task_colour(index: int) -> str:
    """Colour of a task by its index."""
    return TASK_COLOURS[index % len(TASK_COLOURS)]


def degrees_per_second(speed: NDArray[np.float64]) -> NDArray[np.float64]:
    """rad/s -> degrees/s, the unit that NXT users know."""
    return cast("NDArray[np.float64]", np.degrees(speed))


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
