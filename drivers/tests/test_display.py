# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Display, NXT.LCD, NXT.SPI and NXT.Fonts on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

from drivers.tests.observe import FONT, Brick

LETTER_F = ["#####", "#....", "#....", "####.", "#....", "#....", "#....", "....."]


def test_the_font_has_every_printable_letter_once() -> None:
    """Each of the 95 printable characters has a shape of its own."""
    assert sorted(FONT.values()) == [chr(code) for code in range(32, 127)]


def test_text_and_numbers_appear_where_they_were_put(brick: Callable[..., Brick]) -> None:
    """Text, decimal and hexadecimal numbers, wrapping and positions reach the display."""
    device = brick("display_text")
    device.run(150)
    assert device.text() == [
        "Hello, brick!",
        "-2147483648   42",
        "00C0FFEE",
        "sixteen columns",
        "and on",
        "",
        "          -92233",
        "{|}~ !\"#$%&'()*+",
    ]


def test_the_picture_is_upright(brick: Callable[..., Brick]) -> None:
    """The letter F in 00C0FFEE is seen as drawn, not mirrored, with its top at the top."""
    device = brick("display_text")
    device.run(150)
    picture = device.picture()
    left = 2 + 6 * "00C0FFEE".index("F")
    assert [line[left : left + 5] for line in picture[16:24]] == LETTER_F


def test_lines_beyond_the_last_scroll(brick: Callable[..., Brick]) -> None:
    """After ten lines the last eight are on the screen."""
    device = brick("display_scroll")
    device.run(250)
    assert device.text() == [f"line {number}" for number in range(3, 11)]
