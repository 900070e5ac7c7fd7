# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's LCD as one sees it: 100 x 64 dark dots on grey-green glass, in its frame."""

from __future__ import annotations

import numpy as np

from ravenbrick.report.chart import Drawing
from ravenbrick.trace.recording import Picture

__all__ = ["lcd_drawing"]

GLASS, DOT, FRAME = "#b7c3a4", "#1d2417", "#d9d9d6"
SCALE, MARGIN = 4, 16


def lcd_drawing(picture: Picture) -> Drawing:
    """The LCD with a thin gap between the dots."""
    read = " / ".join(line for line in picture.text if line.strip())
    width, height = 100 * SCALE + 2 * MARGIN, 64 * SCALE + 2 * MARGIN
    drawing = Drawing(width, height, f"LCD: {read}" if read else "LCD")
    drawing.add(f'<rect width="{width}" height="{height}" rx="14" fill="{FRAME}"/>')
    inner = f'x="8" y="8" width="{width - 16}" height="{height - 16}"'
    drawing.add(f'<rect {inner} rx="5" fill="{GLASS}" stroke="#6f6f6a"/>')
    rows, columns = np.nonzero(picture.pixels)
    drawing.rectangles(
        [
            (MARGIN + SCALE * column, MARGIN + SCALE * row, SCALE - 0.4, SCALE - 0.4)
            for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
        ],
        DOT,
    )
    return drawing
