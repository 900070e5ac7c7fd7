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
    bands = pixels.reshape(-1, CELL_HEIGHT, pixels.shape[1])
    columns = np.packbits(bands, axis=1, bitorder="little")[:, 0]
    inked = columns[:, MARGIN : MARGIN + CELL_WIDTH * COLUMNS].reshape(-1, COLUMNS, CELL_WIDTH)
    data = inked[:, :, :WIDTH].tobytes()
    cells = [data[at : at + WIDTH] for at in range(0, len(data), WIDTH)]
    text = "".join([letters.get(cell, UNKNOWN) for cell in cells])
    return tuple(text[at : at + COLUMNS].rstrip() for at in range(0, len(text), COLUMNS))
