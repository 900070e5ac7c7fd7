# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Text on the LCD of any firmware, read with the font that its image contains.

Firmware for the NXT draws letters from a table: the characters from ' ' to '~', five to eight
columns each, the lowest bit on top. Such a table is found in the image by what every font has in
common, so nobody has to say where it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

__all__ = ["ImageFont", "find_font"]

LETTERS = [chr(code) for code in range(ord(" "), ord("~") + 1)]
WIDTHS = (5, 6, 7, 8)
NARROWEST_CELL = 6
DISTINCT_LETTERS = 90
LCD_WIDTH, LCD_HEIGHT, LETTER_HEIGHT = 100, 64, 8
UNKNOWN = "?"


def _looks_like_a_font(image: bytes, at: int, width: int) -> bool:
    """Blank space, no other blank letter, level strokes, a thin bar and a small dot."""

    def shape(code: int) -> bytes:
        begin = at + width * (code - ord(" "))
        return image[begin : begin + width]

    def inked(letter: str) -> bytes:
        return shape(ord(letter)).replace(b"\0", b"")

    if any(shape(ord(" "))) or not 1 <= len(inked("!")) <= 3:
        return False
    strokes = [inked(letter) for letter in "-_="]
    shapes = {shape(ord(letter)) for letter in LETTERS}
    return (
        all(len(stroke) >= 2 and len(set(stroke)) == 1 for stroke in strokes)
        and all(1 <= len(inked(letter)) <= 2 for letter in ".|")
        and all(inked(letter) for letter in LETTERS[1:])
        and len(shapes) >= DISTINCT_LETTERS
    )


@dataclass(frozen=True)
class ImageFont:
    """Letters by their columns; `width` columns each, in cells of at least six."""

    letters: dict[bytes, str]
    width: int

    def lines(self, pixels: bytes) -> tuple[str, ...]:
        """The lines of text in a picture of 64 rows of 100 pixels, from the top.

        Text may begin at any pixel and be dark or light; what is no letter reads '?' within a
        line. A line has at least two letters, or stands on a multiple of eight rows.
        """
        picture = np.frombuffer(pixels, np.uint8).reshape(LCD_HEIGHT, LCD_WIDTH).astype(bool)
        found: dict[int, str] = {}
        for _, row, text in sorted(self._candidates(picture), key=lambda one: (-one[0], one[1])):
            if all(abs(row - other) >= LETTER_HEIGHT for other in found):
                found[row] = text
        return tuple(found[row] for row in sorted(found))

    def _candidates(self, picture: np.ndarray) -> Iterator[tuple[int, int, str]]:
        """Number of letters, first row and text of each way to read a band of eight rows."""
        for row in range(LCD_HEIGHT - LETTER_HEIGHT + 1):
            band = picture[row : row + LETTER_HEIGHT]
            for ink in (band, ~band):
                columns = np.packbits(ink, axis=0, bitorder="little")[0].tobytes()
                if not any(columns):
                    continue
                for first in range(max(self.width, NARROWEST_CELL)):
                    text = self._text(columns, first)
                    count = sum(letter not in (" ", UNKNOWN) for letter in text)
                    strange = text.count(UNKNOWN)
                    if count > strange and count >= (1 if row % LETTER_HEIGHT == 0 else 2):
                        yield count - strange, row, text.strip()

    def _text(self, columns: bytes, first: int) -> str:
        step = max(self.width, NARROWEST_CELL)
        cells = [columns[at : at + step] for at in range(first, LCD_WIDTH - self.width + 1, step)]
        return "".join(
            UNKNOWN if any(cell[self.width :]) else self.letters.get(cell[: self.width], UNKNOWN)
            for cell in cells
        )


def find_font(image: bytes) -> ImageFont | None:
    """The first font in an image; None when there is none of this kind."""
    for width in WIDTHS:
        size, at = width * len(LETTERS), image.find(bytes(width))
        while at >= 0 and at + size <= len(image):
            if _looks_like_a_font(image, at, width):
                shapes = (image[begin : begin + width] for begin in range(at, at + size, width))
                return ImageFont(dict(zip(shapes, LETTERS, strict=True)), width)
            at = image.find(bytes(width), at + 1)
    return None
