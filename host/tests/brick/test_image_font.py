# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import numpy as np
import pytest
from verification.support.bricks.observe import FONT

from ravenbrick.brick.image_font import LETTERS, find_font


def font_table() -> bytes:
    """The drivers' font, as firmware would have it."""
    shapes = {letter: bytes(shape) for shape, letter in FONT.items()}
    return b"".join(shapes[letter] for letter in LETTERS)


def picture(text: str, row: int, column: int, light: bool = False) -> bytes:
    table = font_table()
    pixels = np.zeros((64, 100), bool)
    for index, letter in enumerate(text):
        begin = 5 * LETTERS.index(letter)
        for offset, bits in enumerate(table[begin : begin + 5]):
            for bit in range(8):
                pixels[row + bit, column + 6 * index + offset] = bits >> bit & 1
    if light:
        pixels[row : row + 8] = ~pixels[row : row + 8]
    return pixels.astype(np.uint8).tobytes()


@pytest.mark.parametrize("before", [b"", b"\0" * 37, bytes(range(256)) * 3])
def test_the_font_is_found_wherever_it_is(before: bytes) -> None:
    font = find_font(before + font_table() + b"\xff" * 100)
    assert font is not None
    assert font.width == 5
    assert font.lines(picture("Motor 12", 16, 2)) == ("Motor 12",)


@pytest.mark.parametrize(("row", "column", "light"), [(0, 0, False), (35, 11, False), (8, 3, True)])
def test_text_is_read_at_any_pixel_dark_or_light(row: int, column: int, light: bool) -> None:
    font = find_font(font_table())
    assert font is not None
    assert font.lines(picture("My Files", row, column, light)) == ("My Files",)


def test_an_image_without_letters_has_no_font() -> None:
    noise = np.random.default_rng(1).integers(0, 256, 20_000, np.uint8).tobytes()
    assert find_font(noise) is None
    assert find_font(bytes(5_000)) is None
