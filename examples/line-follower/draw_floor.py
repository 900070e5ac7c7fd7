# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Draws floor.png: a black line of 30 mm on white paper, straights and half circles.

The sensor, 70 mm before the axle, starts over the left edge of the line.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np

PIXEL = 0.005  # m
CORNER = (-0.6, -0.25)  # lower left, m
SIZE = (1.8, 1.1)  # m
WIDTH = 0.03  # of the line, m
STRAIGHT = (-0.1, 0.7)  # x of both ends of the straights, m
RADIUS = 0.3  # of the half circles, m
WHITE, BLACK = 0.9, 0.08
SUPERSAMPLES = 4


def distance_to_line(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """From each point to the middle of the line, m; the lower straight is y = -WIDTH / 2."""
    middle = RADIUS - WIDTH / 2
    along = np.clip(x, *STRAIGHT)
    return np.abs(np.hypot(x - along, y - middle) - RADIUS)


def main() -> None:
    """Draw with grey edges where a pixel lies half on the line."""
    fine = PIXEL / SUPERSAMPLES
    columns, rows = (round(size / fine) for size in SIZE)
    x = CORNER[0] + fine * (np.arange(columns) + 0.5)
    y = CORNER[1] + fine * (np.arange(rows) + 0.5)
    line = distance_to_line(x[None, :], y[:, None]) < WIDTH / 2
    share = line.reshape(rows // SUPERSAMPLES, SUPERSAMPLES, columns // SUPERSAMPLES, SUPERSAMPLES)
    picture = WHITE + (BLACK - WHITE) * share.mean(axis=(1, 3))
    file = Path(__file__).resolve().parent / "floor.png"
    matplotlib.image.imsave(file, picture[::-1], cmap="gray", vmin=0.0, vmax=1.0)


if __name__ == "__main__":
    main()
