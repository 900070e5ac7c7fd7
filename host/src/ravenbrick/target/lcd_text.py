# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The text on the LCD, read with the letters that the image itself draws."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["FONT_SIZE", "FONT_SYMBOL", "lcd_text"]

# Drivers, package NXT.Fonts: letters from ' ' to '~', five columns each, the lowest bit on top, in
# cells of 6 x 8 pixels from column 2 on.
FONT_SYMBOL = "nxt__fonts__shapes"
LETTERS = [chr(code) for code in range(ord(" "), ord("~") + 1)]
WIDTH, CELL_WIDTH, CELL_HEIGHT, MARGIN, COLUMNS = 5, 6, 8, 2, 16
FONT_SIZE = WIDTH * len(LETTERS)
UNKNOWN = "?"


@lru_cache(maxsize=8)
def _letters(font: bytes) -> dict[bytes, str]:
    return {font[WIDTH * i : WIDTH * (i + 1)]: letter for i, letter in enumerate(LETTERS)}


def lcd_text(pixels: NDArray[np.bool_], font: bytes) -> tuple[str, ...]:
    """Eight lines without trailing blanks; a cell that holds no letter reads '?'."""
    letters = _letters(font)
    lines = []
    for top in range(0, pixels.shape[0], CELL_HEIGHT):
        band = pixels[top : top + CELL_HEIGHT]
        columns = np.packbits(band, axis=0, bitorder="little")[0]
        lefts = range(MARGIN, MARGIN + CELL_WIDTH * COLUMNS, CELL_WIDTH)
        cells = [columns[left : left + WIDTH].tobytes() for left in lefts]
        lines.append("".join(letters.get(cell, UNKNOWN) for cell in cells).rstrip())
    return tuple(lines)
