# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's LCD as one sees it: 100 x 64 dark dots on grey-green glass, in its frame."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from ravenbrick.trace.recording import Picture

__all__ = ["lcd_figure"]

GLASS, DOT, UNLIT, FRAME = "#b7c3a4", "#1d2417", "#b1bd9d", "#d9d9d6"
SCALE = 8
MARGIN = 6


def _raster(picture: Picture) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """RGB image with a thin gap between dots, shape (64 * SCALE, 100 * SCALE, 3)."""
    image = np.empty((64 * SCALE, 100 * SCALE, 3))
    image[:] = to_rgb(GLASS)
    dark = np.kron(picture.pixels, np.ones((SCALE, SCALE), dtype=bool))
    rows, columns = np.indices(dark.shape)
    dot = (rows % SCALE > 0) & (columns % SCALE > 0)
    image[dot & dark] = to_rgb(DOT)
    image[dot & ~dark] = to_rgb(UNLIT)
    return image


def lcd_figure(picture: Picture) -> Figure:
    """The LCD, 5 inches wide."""
    figure = Figure(figsize=(5.0, 3.35))
    axis = figure.add_axes((0, 0, 1, 1))
    axis.set_axis_off()
    axis.add_patch(
        FancyBboxPatch(
            (-MARGIN, -MARGIN),
            100 + 2 * MARGIN,
            64 + 2 * MARGIN,
            boxstyle="round,pad=0,rounding_size=4",
            facecolor=FRAME,
            edgecolor="#9b9b97",
            linewidth=1.5,
        )
    )
    axis.add_patch(
        FancyBboxPatch(
            (-2, -2),
            104,
            68,
            boxstyle="round,pad=0,rounding_size=1",
            facecolor=GLASS,
            edgecolor="#6f6f6a",
            linewidth=1,
        )
    )
    axis.imshow(_raster(picture), extent=(0, 100, 64, 0), interpolation="antialiased", zorder=3)
    axis.set_xlim(-MARGIN - 1, 100 + MARGIN + 1)
    axis.set_ylim(64 + MARGIN + 1, -MARGIN - 1)
    return figure
