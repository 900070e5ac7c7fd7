# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Display, NXT.LCD, NXT.SPI and NXT.Fonts on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

from verification.support.bricks.observe import FONT, Brick

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


def test_pixels_lines_and_bitmaps_are_drawn(brick: Callable[..., Brick]) -> None:
    """Lines in all directions, rectangles across rows, bitmaps cut at the edges, three inks."""
    device = brick("display_drawing")
    device.run(150)
    picture = device.picture()
    assert [line[:10] for line in picture[:6]] == [
        "##........",
        "..##......",
        "....##....",
        "......##..",
        "........##",
        "..........",
    ]
    assert all(picture[y][10:20].index("#") == 9 - y for y in range(10))
    assert all(picture[y][25] == "#" for y in range(10))
    assert [line[30:40] for line in picture[2:14]] == [
        "..........",
        "##########",
        *["#........#"] * 8,
        "##########",
        "..........",
    ]
    block = [line[42:50] for line in picture[1:19]]
    assert block == [
        "........",
        *["########"] * 3,
        *["##...###"] * 6,
        *["########"] * 7,
        "........",
    ]
    assert [line[60:63] for line in picture[4:14]] == [
        "...",
        "###",
        *["#.."] * 6,
        "#.#",
        "...",
    ]
    assert [line[97:] for line in picture[59:]] == ["...", ".##", ".##", ".##", ".##"]
    assert [line[70:80].count("#") for line in picture[:10]] == [10] * 5 + [0] + [10] * 4
    assert [line[84:91] for line in picture[2:6]] == [".......", ".#..##.", "....##.", "......."]
    assert picture[63][0] == "#"


def test_letters_have_descenders(brick: Callable[..., Brick]) -> None:
    """Of g, j, p, q and y something is below the line, and they read as themselves."""
    device = brick("display_drawing")
    device.run(150)
    assert all("#" in device.picture()[63][2 + 6 * n : 7 + 6 * n] for n in range(5))
    assert device.text()[7][:5] == "gjpqy"


def test_several_tasks_write_without_disturbing_each_other(brick: Callable[..., Brick]) -> None:
    """Each row shows what its task wrote, and no update waits for the display's 4 ms."""
    device = brick("display_tasks")
    device.run(400)
    rows = device.text()
    assert rows[1] == "uppeupper row"
    assert (rows[3], rows[6]) == ("main", "  lower row")
    assert device.integer("rounds_of_upper") > 250
    assert device.integer("longest_update_us") < 600
