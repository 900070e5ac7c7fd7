# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import numpy as np
from verification.support.bricks import fake_brick

from ravenbrick.brick.lcd_text import lcd_text


def _pixels() -> np.ndarray:
    brick = fake_brick.VirtualBrick("{}", b"")
    return np.frombuffer(brick.lcd(), dtype=np.uint8).reshape(64, 100).astype(bool)


def test_text_is_read_with_the_letters_of_the_image() -> None:
    """Eight lines, blanks at the end removed."""
    assert lcd_text(_pixels(), fake_brick.FONT) == (fake_brick.LINE, *[""] * 7)


def test_a_cell_without_a_letter_is_a_question_mark() -> None:
    """A drawing between letters does not disturb them."""
    pixels = _pixels().copy()
    pixels[0:8, 2:7] = True
    assert lcd_text(pixels, fake_brick.FONT)[0] == "?" + fake_brick.LINE[1:]
