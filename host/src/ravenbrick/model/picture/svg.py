# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram as SVG: each level of its subsystems a drawing, one below the other."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from ravenbrick.model.diagram import Diagram
from ravenbrick.model.picture.graph import Graph, Node, graph_of
from ravenbrick.model.picture.layers import Box, Line
from ravenbrick.model.picture.layout import Layout, laid_out

__all__ = ["diagram_svg"]

_LETTER, _SMALL = 6.6, 5.6  # mean width of a letter, px
_PORT_STEP = 20.0
_MARGIN = 24.0
_TITLE = 26.0
_NAME = 13.0
# Colours that a colour-blind reader tells apart: P. Tol, 2021; slower rates come later.
_RATES = ("#222222", "#4477aa", "#228833", "#aa3377", "#ccbb44", "#66ccee")
_CONTINUOUS = "#cc5500"
_STYLE = """
.diagram text { font-family: 'DejaVu Sans', Verdana, sans-serif; font-size: 11px; fill: #222; }
.diagram .name { font-size: 10px; fill: #555; } .diagram .port { font-size: 9px; fill: #555; }
.diagram .title { font-size: 13px; font-weight: bold; }
.diagram .block > :first-child { fill: #fff; stroke-width: 1.3; }
.diagram .system > :first-child { fill: #f3f6fa; }
.diagram .line { fill: none; stroke-width: 1.2; } .diagram .line:hover { stroke-width: 3; }
.diagram .block:hover > :first-child, .diagram .chosen > :first-child { fill: #fff3c4; }
""".strip()


def diagram_svg(diagram: Diagram, values: Mapping[str, str] | None = None) -> str:
    """The diagram and its subsystems as one SVG document; the same diagram gives the same text.

    Lines and blocks tell their parameters, rates and units when the mouse rests on them, and what
    `values` has for a block's path, such as its range in a simulation.
    """
    graph = graph_of(diagram)
    diagram.flat()  # refuses open ports and units that do not fit
    rates = sorted({node.rate for level in graph.levels() for node in level.nodes.values()
                    if node.rate})  # fmt: skip
    painter = _Painter(rates, values or {}, diagram.units)
    y, width = _MARGIN, 0.0
    for level in graph.levels():
        w, h = painter.level(level, y)
        width, y = max(width, w), y + h
    legend_width, y = painter.legend(y)
    width = max(width, legend_width) + 2 * _MARGIN
    head = ('<svg xmlns="http://www.w3.org/2000/svg" class="diagram" '
            f'width="{width:.0f}" height="{y:.0f}" viewBox="0 0 {width:.0f} {y:.0f}" role="img" '
            f'aria-label="Block diagram {escape(diagram.name)}">')  # fmt: skip
    background = '<rect width="100%" height="100%" fill="#fff"/>'
    return "\n".join([head, f"<style>{_STYLE}</style>", background, *painter.parts, "</svg>", ""])


class _Painter:
    """Texts of SVG, level by level."""

    def __init__(
        self, rates: list[float], values: Mapping[str, str], units: Mapping[str, str]
    ) -> None:
        self._rates, self._values, self._units = rates, values, units
        self.parts: list[str] = []

    def level(self, graph: Graph, top: float) -> tuple[float, float]:
        """One drawing from `top` on; gives its width and height."""
        boxes = [_box(node) for node in graph.nodes.values()]
        layout = laid_out(boxes, graph.lines)
        title = f"{graph.path.rstrip('/')}" or graph.name
        self.parts.append(f'<text class="title" x="{_MARGIN}" y="{top + 4}">{escape(title)}</text>')
        self.parts.append(f'<g transform="translate({_MARGIN} {top + _TITLE})">')
        for line, way in layout.ways.items():
            self._line(graph, line, way)
        for x, y in layout.joints:
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4" fill="#222"/>')
        for box in boxes:
            self._block(graph.nodes[box.key], box, layout)
        self.parts.append("</g>")
        return layout.width, layout.height + _TITLE + _NAME + _MARGIN

    def legend(self, top: float) -> tuple[float, float]:
        """Rates by colour; gives width and the lower end."""
        x = _MARGIN
        for rate in [*self._rates, None]:
            text = "continuous" if rate is None else f"{rate * 1000:g} ms"
            if rate is None and not any(_CONTINUOUS in part for part in self.parts):
                continue
            colour = self._colour(rate)
            self.parts.append(
                f'<rect x="{x:.1f}" y="{top - 9:.1f}" width="12" height="9" fill="{colour}"/>'
                f'<text x="{x + 17:.1f}" y="{top:.1f}">{text}</text>'
            )
            x += 30 + _LETTER * len(text)
        return x - _MARGIN, top + _MARGIN

    def _colour(self, rate: float | None) -> str:
        if rate is None:
            return _CONTINUOUS
        if not rate:
            return _RATES[0]
        return _RATES[self._rates.index(rate) % len(_RATES)]

    def _line(self, graph: Graph, line: Line, way: list[tuple[float, float]]) -> None:
        source, target = graph.nodes[line.source], graph.nodes[line.target]
        port = source.outputs[line.output] or ""
        said = f"{source.name}{f'.{port}' if port else ''} to {target.name}"
        path = source.blocks[0] if len(source.blocks) == 1 else ""
        unit = self._units.get(f"{path}:{line.output}", "")
        tips = [said, unit and f"unit {unit}", self._values.get(path, "")]
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in way)
        x, y = way[-1]
        colour = self._colour(source.rate)
        self.parts.append(
            f'<g class="line" stroke="{colour}"><polyline points="{points}"/>'
            f'<path d="M{x - 6:.1f},{y - 3:.1f} L{x:.1f},{y:.1f} L{x - 6:.1f},{y + 3:.1f} Z" '
            f'fill="{colour}" stroke="none"/>{_tip(tips)}</g>'
        )

    def _block(self, node: Node, box: Box, layout: Layout) -> None:
        x, y = layout.corners[node.key]
        kind = "block system" if node.inner is not None else "block"
        names = " ".join(node.blocks)
        self.parts.append(
            f'<g class="{kind}" data-blocks="{escape(names)}" transform="translate({x:.1f} '
            f'{y:.1f})" stroke="{self._colour(node.rate)}">{_outline(node, box)}'
        )
        self.parts.append(f'<g stroke="none">{_inside(node, box)}')
        if node.form != "port":
            self.parts.append(
                f'<text class="name" x="{box.width / 2:.1f}" y="{box.height + 11:.1f}" '
                f'text-anchor="middle">{escape(node.name)}</text>'
            )
        tips = [*node.details, *(self._values.get(path, "") for path in node.blocks[:1])]
        self.parts.append(f"</g>{_tip(tips)}</g>")


def _tip(lines: list[str]) -> str:
    return f"<title>{escape(chr(10).join(line for line in lines if line))}</title>"


def _box(node: Node) -> Box:
    """The size of a node, and where its ports are."""
    ports = max(len(node.inputs), len(node.outputs), 1)
    height = max(30.0, _PORT_STEP * ports + (8 if ports > 1 else 0))
    labelled = any(node.inputs) + any(node.outputs)
    width = max(34.0, _LETTER * len(node.symbol) + 14 + 12 * labelled)
    if node.form == "port":
        width, height = _LETTER * len(node.name) + 20, 20.0
    elif node.form == "circle":
        height = width = 30.0
    elif node.form == "bar":
        named = max(map(len, (*node.inputs, *node.outputs)))
        width = 8.0 if named <= 2 else _SMALL * named + 14
    elif node.form == "triangle":
        width, height = _LETTER * len(node.symbol) + 30, 36.0
    elif node.form == "system":
        sides = [max(map(len, names), default=0) for names in (node.inputs, node.outputs)]
        width = max(70.0, _SMALL * sum(sides) + 34, _LETTER * len(node.name))
    inputs, outputs = (_spread(len(ends), height) for ends in (node.inputs, node.outputs))
    room = 0.0 if node.form == "port" else _SMALL * len(node.name)
    last = node.form == "port" and not node.outputs
    return Box(node.key, width, height, inputs, outputs, room, last)


def _spread(count: int, height: float) -> list[float]:
    """Heights of ports from the middle."""
    return [height * ((number + 0.5) / count - 0.5) for number in range(count)]


def _outline(node: Node, box: Box) -> str:
    w, h = f"{box.width:.1f}", f"{box.height:.1f}"
    middle = f"{box.height / 2:.1f}"
    match node.form:
        case "port":
            return f'<rect width="{w}" height="{h}" rx="{middle}"/>'
        case "circle":
            radius = f"{box.width / 2:.1f}"
            return f'<ellipse cx="{radius}" cy="{middle}" rx="{radius}" ry="{middle}"/>'
        case "triangle":
            return f'<path d="M0,0 L{w},{middle} L0,{h} Z"/>'
        case "bar" if box.width < 10:
            return f'<rect width="{w}" height="{h}" style="fill:#222"/>'
        case _:
            return f'<rect width="{w}" height="{h}" rx="2"/>'


def _inside(node: Node, box: Box) -> str:
    middle = box.height / 2
    parts = []
    text = node.name if node.form == "port" else node.symbol
    if text == "~limit":
        x, y = box.width / 2, middle
        parts.append(
            f'<path d="M{x - 12},{y + 8} h7 L{x + 5},{y - 8} h7" fill="none" stroke="#222"/>'
        )
    elif text:
        x = box.width * 0.38 if node.form == "triangle" else box.width / 2
        parts.append(_text(x, middle + 4, text, "middle", ""))
    signs = node.form == "circle"
    for side, names, heights in (("start", node.inputs, box.inputs),
                                 ("end", node.outputs, box.outputs)):  # fmt: skip
        for name, height in zip(names, heights, strict=True):
            if name and not (node.form == "bar" and box.width < 10):
                x = (4 if not signs else 5) if side == "start" else box.width - 4
                parts.append(_text(x, middle + height + 3.5, name, side, "port"))
    return "".join(parts)


def _text(x: float, y: float, text: str, anchor: str, kind: str) -> str:
    cut = f' class="{kind}"' if kind else ""
    return (f'<text{cut} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">'
            f"{escape(text.replace('-', chr(8722)) if kind else text)}</text>")  # fmt: skip
