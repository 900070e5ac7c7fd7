# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's display as a drawing."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["HEIGHT", "WIDTH", "lcd_svg"]

WIDTH, HEIGHT = 100, 64
_PIXEL = 2
_MARGIN = 4


def lcd_svg(lines: Sequence[str]) -> str:
    """SVG of lines in which `#` is a dark pixel: one path of the dark pixels, line by line."""
    strokes = []
    for y, line in enumerate(lines):
        x = 0
        while x < WIDTH:
            length = len(line[x:]) - len(line[x:].lstrip("#"))
            if length:
                strokes.append(f"M{x} {y}h{length}v1h-{length}z")
            x += length or 1
    width, height = WIDTH + 2 * _MARGIN, HEIGHT + 2 * _MARGIN
    size = f'width="{_PIXEL * width}" height="{_PIXEL * height}"'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} '
            f'viewBox="-{_MARGIN} -{_MARGIN} {width} {height}">',
            f'<rect x="-{_MARGIN}" y="-{_MARGIN}" width="{width}" height="{height}" rx="2" '
            'fill="#b9c6a5"/>',
            f'<path fill="#20261c" d="{"".join(strokes)}"/>',
            "</svg>",
            "",
        ]
    )
