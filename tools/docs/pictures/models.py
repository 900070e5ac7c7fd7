# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagrams of Simulink models as they are laid out: `python -m tools.docs.pictures.models`.

Draws the models of examples/paper as SVG below docs/pictures; blocks of other types are refused.
"""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import dataclass
from html import escape
from pathlib import Path

__all__ = ["drawing", "main"]

ROOT = Path(__file__).resolve().parents[3]
MODELS = ROOT / "examples" / "paper" / "models"
PICTURES = ROOT / "docs" / "pictures"
MARGIN, NAME_HEIGHT = 30, 16
Point = tuple[float, float]


def _text(x: float, y: float, words: str, size: int = 11) -> str:
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}">{escape(words)}</text>'


@dataclass(frozen=True)
class Block:
    """A block with its rectangle (left, top, right, bottom in pixels) and parameters."""

    kind: str
    name: str
    box: tuple[float, ...]
    values: dict[str, str]

    @property
    def middle(self) -> Point:
        """Centre of the rectangle."""
        left, top, right, bottom = self.box
        return (left + right) / 2, (top + bottom) / 2

    @property
    def mirrored(self) -> bool:
        """Whether the inputs are on the right."""
        return self.values.get("BlockMirror") == "on"

    def output(self) -> Point:
        """Where lines begin."""
        return self.box[0 if self.mirrored else 2], self.middle[1]

    def input(self, number: int) -> Point:
        """Where a line to an input ends; the second of a round sum is below."""
        left, top, right, bottom = self.box
        if self.kind == "Sum" and number == 2:
            return self.middle[0], bottom
        count = int(self.values.get("NumInputPorts", "1"))
        height = top + (bottom - top) * (2 * number - 1) / (2 * count)
        return right if self.mirrored else left, height

    def shape(self) -> str:
        """The block's outline with what stands in it, and its name below."""
        left, top, right, bottom = self.box
        x, y = self.middle
        outline = f'<rect x="{left:g}" y="{top:g}" width="{right - left:g}" '
        outline += f'height="{bottom - top:g}"{ROUND if "port" in self.kind else ""}/>'
        if self.kind == "Sum":
            signs = _text(left + 6, y + 4, "+", 10) + _text(x, bottom - 2, "\N{MINUS SIGN}", 10)
            return f'<circle cx="{x:g}" cy="{y:g}" r="{(right - left) / 2:g}"/>' + signs
        if self.kind == "Gain":
            back, tip = (right, left) if self.mirrored else (left, right)
            outline = f'<path d="M {back:g} {top:g} L {tip:g} {y:g} L {back:g} {bottom:g} Z"/>'
            x += 6 if self.mirrored else -6
        return outline + self._content(x, y) + _text(self.middle[0], bottom + 13, self.name, 10)

    def _content(self, x: float, y: float) -> str:
        match self.kind:
            case "Step":
                left, top, right, bottom = (self.box[n] + (5, 6, -5, -6)[n] for n in range(4))
                corners = f"M {left:g} {bottom:g} H {x:g} V {top:g} H {right:g}"
                return f'<path d="{corners}" fill="none"/>'
            case "TransferFcn":
                above, below = (re.findall(r"[\d.]+", self.values[n]) for n in FRACTION)
                bar = f'<path d="M {x - 38:g} {y:g} H {x + 38:g}"/>'
                polynomial = f"{below[0]} s + {below[1]}"
                return _text(x, y - 4, above[0]) + bar + _text(x, y + 13, polynomial)
            case "Gain":
                return _text(x, y + 4, self.values["Gain"], 9)
            case "Reference" if self.values.get("SourceType") == "PID 1dof":
                discrete = self.values["TimeDomain"] == "Discrete-time"
                return _text(x, y + 4, f"{self.values['Controller']}({'z' if discrete else 's'})")
            case "Inport" | "Outport":
                return _text(x, y + 4, self.values["Port"])
            case "Scope":
                return ""
        raise SystemExit(f"no shape is known for blocks of type {self.kind}; add it to {__file__}")


ROUND = ' rx="7"'
FRACTION = ("Numerator", "Denominator")


def _numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?[\d.]+", text)]


def _values(element: ElementTree.Element) -> dict[str, str]:
    return {item.attrib["Name"]: item.text or "" for item in element.findall("P")}


def _wire(blocks: dict[str, Block], start: Point, values: dict[str, str]) -> str:
    """A line to a block's input: relative moves, then one corner if it needs one."""
    points = [start]
    moves = _numbers(values.get("Points", ""))
    for dx, dy in zip(moves[::2], moves[1::2], strict=True):
        points.append((points[-1][0] + dx, points[-1][1] + dy))
    number, _, port = values["Dst"].partition("#in:")
    block = blocks[number]
    end = block.input(int(port))
    from_below = block.kind == "Sum" and end[1] == block.box[3]
    points.append((end[0], points[-1][1]) if from_below else (points[-1][0], end[1]))
    path = " L ".join(f"{x:g} {y:g}" for x, y in [*points, end])
    return f'<path d="M {path}" fill="none" marker-end="url(#arrow)"/>'


def drawing(model: Path) -> str:
    """The model's diagram as SVG."""
    with zipfile.ZipFile(model) as archive:
        system = ElementTree.fromstring(archive.read("simulink/blockdiagram.xml")).find(".//System")
    assert system is not None
    blocks = {}
    for element in system.findall("Block"):
        values, own = _values(element), element.attrib
        box = tuple(_numbers(values["Position"]))
        blocks[own["SID"]] = Block(own["BlockType"], own["Name"], box, values)
    wires = []
    for element in system.findall("Line"):
        values = _values(element)
        start = blocks[values["Src"].partition("#")[0]].output()
        ends = [_values(branch) for branch in element.findall("Branch")] or [values]
        wires += [_wire(blocks, start, end) for end in ends]
    width = max(block.box[2] for block in blocks.values()) + MARGIN
    height = max(block.box[3] for block in blocks.values()) + NAME_HEIGHT + MARGIN
    shapes = [block.shape() for block in blocks.values()]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" '
        f'width="{1.5 * width:g}" font-family="sans-serif" text-anchor="middle">\n'
        "<style>rect, circle, path { fill: #fff; stroke: #222; stroke-width: 1.2 } "
        'path[fill="none"] { fill: none } marker path { fill: #222 }</style>\n'
        '<marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M 0 0 L 8 4 L 0 8 Z"/></marker>\n'
        f'<rect width="{width:g}" height="{height:g}" style="stroke: none"/>\n'
        + "\n".join([*wires, *shapes])
        + "\n</svg>\n"
    )


def main() -> int:
    """Write the pictures."""
    for model in sorted(MODELS.glob("*.slx")):
        target = PICTURES / f"paper-{model.stem}.svg"
        target.write_text(drawing(model), encoding="utf-8")
        print(target.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
