# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of diagrams: no line meets another one's, and everything is where it belongs."""

from __future__ import annotations

from itertools import combinations, pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.model import (
    NXT_MOTOR,
    DataType,
    Diagram,
    Gain,
    Inport,
    IntegrationMethod,
    Integrator,
    Outport,
    UnitDelay,
    vehicle_plant,
)
from ravenbrick.model.picture.graph import graph_of
from ravenbrick.model.picture.layers import Box, Line, layered
from ravenbrick.model.picture.layout import Layout, laid_out
from ravenbrick.model.picture.svg import diagram_svg

SVG = "{http://www.w3.org/2000/svg}"
PI = pi_diagram(DiscretePi(0.3, 0.03, 0.004, IntegrationMethod.FORWARD_EULER), 9.0, 0.037)


def random_graph(seed: int, count: int) -> tuple[list[Box], list[Line]]:
    """Boxes with one to three inputs each, fed by any box, in a loop or not."""
    generator = np.random.default_rng(seed)
    boxes = []
    lines = []
    for number in range(count):
        ports = int(generator.integers(1, 4)) if number else 0
        heights = [20.0 * (port - (ports - 1) / 2) for port in range(ports)]
        boxes.append(Box(f"b{number}", 50.0, 30.0 + 20.0 * ports, heights, [0.0], 40.0))
        for port in range(ports):
            near = int(generator.integers(max(number - 8, 0), min(number + 3, count)))
            lines.append(Line(f"b{near}", 0, f"b{number}", port))
    return boxes, lines


def segments(layout: Layout) -> list[tuple[str, tuple[float, float], tuple[float, float]]]:
    """Straight pieces with the output that they belong to."""
    return [(line.source, *piece) for line, way in layout.ways.items() for piece in pairwise(way)]


def overlap(one: tuple[float, float], two: tuple[float, float]) -> float:
    """The common length of two intervals."""
    return min(max(one), max(two)) - max(min(one), min(two))


@pytest.mark.parametrize("seed", range(12))
def test_boxes_and_lines_of_different_outputs_do_not_lie_on_each_other(seed: int) -> None:
    """Random graphs of 6 to 50 boxes: lines are orthogonal, cross at points, and pass no box."""
    boxes, lines = random_graph(seed, 6 + 4 * seed)
    layout = laid_out(boxes, lines)
    sizes = {box.key: (box.width, box.height) for box in boxes}
    areas = {
        key: ((x, x + sizes[key][0]), (y, y + sizes[key][1]))
        for key, (x, y) in layout.corners.items()
    }
    for (_, one), (_, two) in combinations(areas.items(), 2):
        assert not (overlap(one[0], two[0]) > 0 and overlap(one[1], two[1]) > 0)
    assert min(begin for area in areas.values() for begin, _ in area) >= 0
    pieces = segments(layout)
    for _, begin, end in pieces:
        assert begin[0] == pytest.approx(end[0]) or begin[1] == pytest.approx(end[1], abs=0.6)
        for area in areas.values():
            inside = overlap((begin[0], end[0]), area[0]), overlap((begin[1], end[1]), area[1])
            assert not (min(inside) >= 0 and max(inside) > 0.6)
    shared = 0
    for (source, a, b), (other, c, d) in combinations(pieces, 2):
        for along, across in ((0, 1), (1, 0)):
            flat = a[across] == b[across] and c[across] == d[across]
            if source != other and flat and abs(a[across] - c[across]) < 1.0:
                shared += overlap((a[along], b[along]), (c[along], d[along])) > 1.0
    assert shared <= len(lines) // 25


def graph_without_crossings(seed: int) -> tuple[list[Box], list[Line]]:
    """Four layers of six boxes; when each layer is in order no lines cross, but they are not."""
    generator = np.random.default_rng(seed)
    boxes, lines = [], []
    for rank in range(4):
        fed_by = np.sort(generator.integers(6, size=12))
        for number in range(6):
            ports = [-10.0, 10.0] if rank else []
            boxes.append(Box(f"{rank}.{number}", 50.0, 60.0, ports, [0.0], 40.0))
            lines += [
                Line(f"{rank - 1}.{fed_by[2 * number + port]}", 0, f"{rank}.{number}", port)
                for port in range(len(ports))
            ]
    return [boxes[place] for place in generator.permutation(len(boxes))], lines


def crossings(lines: list[Line], order: list[str]) -> int:
    """Pairs of lines between two layers that cross when these have this order."""
    places = {key: number for number, key in enumerate(order)}
    ends = [(one.target[0], places[one.source], places[one.target], one.port) for one in lines]
    return sum(
        one[0] == two[0] and (one[1] - two[1]) * (one[2] - two[2] or one[3] - two[3]) < 0
        for one, two in combinations(ends, 2)
    )


def test_sweeps_remove_most_crossings_that_need_not_be() -> None:
    """Of random graphs that can be drawn without any: a tenth of those in the given order stay."""
    before = after = 0
    for seed in range(30):
        boxes, lines = graph_without_crossings(seed)
        layers = layered(boxes, lines)
        assert not crossings(lines, sorted(box.key for box in boxes))
        before += crossings(lines, [box.key for box in boxes])
        order = [place.box.key for row in layers.rows for place in row if place.box]
        after += crossings(lines, order)
    assert after < before / 8, (before, after)


def test_straight_lines_have_room_between_boxes() -> None:
    """A chain: each line is one piece from left to right, as long as the others."""
    boxes = [Box(f"b{n}", 50.0, 30.0, [0.0] if n else [], [0.0], 20.0) for n in range(4)]
    lines = [Line(f"b{n}", 0, f"b{n + 1}", 0) for n in range(3)]
    layout = laid_out(boxes, lines)
    lengths = []
    for begin, end in layout.ways.values():
        assert begin[1] == end[1]
        lengths.append(end[0] - begin[0])
    assert lengths[0] > 10.0 and lengths == [pytest.approx(lengths[0])] * 3
    assert layout.width == pytest.approx(4 * 50.0 + 3 * lengths[0])


def test_lines_end_at_the_ports() -> None:
    """Of the box and height that they name."""
    boxes, lines = random_graph(3, 20)
    layout = laid_out(boxes, lines)
    by_key = {box.key: box for box in boxes}
    for line, way in layout.ways.items():
        x, y = layout.corners[line.target]
        target = by_key[line.target]
        assert way[-1][0] == pytest.approx(x)
        assert way[-1][1] == pytest.approx(y + target.height / 2 + target.inputs[line.port])
        assert way[0][0] == pytest.approx(layout.corners[line.source][0] + 50.0)


def test_the_picture_names_blocks_ports_parameters_and_rates() -> None:
    """As SVG that a parser reads; the same each time."""
    text = diagram_svg(PI, {"Error": "0 to 3 V"})
    assert text == diagram_svg(PI, {"Error": "0 to 3 V"}) != diagram_svg(PI)
    tree = ElementTree.fromstring(text)
    words = {node.text for node in tree.iter(f"{SVG}text")}
    assert {"Input_Voltage", "Error", "Kp", "Tracking", "4 ms"} <= words
    tips = [node.text or "" for node in tree.iter(f"{SVG}title")]
    assert any("gain: Kp = 0.3 V/V" in tip for tip in tips)
    assert any("Error to Proportional\nunit V\n0 to 3 V" in tip for tip in tips)
    blocks = [
        node.get("data-blocks", "") for node in tree.iter(f"{SVG}g") if node.get("data-blocks")
    ]
    assert sorted(blocks) == sorted(block.name for block in PI.blocks)
    assert PI._repr_svg_() == diagram_svg(PI)


def test_the_symbol_of_a_gain_lies_within_its_triangle() -> None:
    """A long one too: the triangle is as high as a letter where it ends."""
    diagram = Diagram("scaled", 0.01)
    chain = (Inport("u"), Gain("Scale", gain=-1234567.0), Outport("y"))
    diagram.connect_chain(*(diagram.add(block) for block in chain))
    tree = ElementTree.fromstring(diagram_svg(diagram))
    group = next(g for g in tree.iter(f"{SVG}g") if g.get("data-blocks") == "Scale")
    shape = next(path.get("d", "") for path in group.iter(f"{SVG}path"))
    width, middle = (float(number) for number in shape.split()[1].strip("L").split(","))
    text = next(text for text in group.iter(f"{SVG}text") if text.get("class") is None)
    half = 6.6 * len(text.text or "") / 2
    begin, end = float(text.get("x", "")) - half, float(text.get("x", "")) + half
    assert half > 20 and begin >= 0 and 2 * middle * (1 - end / width) >= 9


def test_what_follows_from_a_continuous_state_is_continuous_up_to_a_memory() -> None:
    """A block without memory has the rate of what it reads."""
    diagram = Diagram("mixed", 0.01)
    real = DataType.REAL64
    chain = (
        Inport("u", data_type=real), Integrator("State"),
        Gain("Behind", gain=2.0, data_type=real), UnitDelay("Memory", data_type=real),
        Gain("Sampled", gain=2.0, data_type=real), Outport("y", data_type=real),
    )  # fmt: skip
    diagram.connect_chain(*(diagram.add(block) for block in chain))
    rates = {node.name: node.rate for node in graph_of(diagram).nodes.values()}
    assert rates == {
        "u": None, "State": None, "Behind": None, "Memory": 0.01, "Sampled": 0.01, "y": None,
    }  # fmt: skip


def test_each_subsystem_has_its_own_drawing() -> None:
    """With its ports' names, in the colour of continuous time."""
    plant = vehicle_plant("vehicle", NXT_MOTOR, wheel_radius=0.028, track=0.11, mass=0.6)
    tree = ElementTree.fromstring(diagram_svg(plant))
    titles = [t.text for t in tree.iter(f"{SVG}text") if t.get("class") == "title"]
    assert titles == ["vehicle", "Left", "Right"]
    words = [node.text for node in tree.iter(f"{SVG}text")]
    assert words.count("encoder_count") == 4
    assert "continuous" in words


def test_a_diagram_that_is_imported_is_drawn_by_its_paths() -> None:
    """Blocks with a common path stand in one subsystem, with ports where lines pass its border."""
    flat = Diagram("flat", 0.01)
    for block in PI.blocks:
        flat.add(block)
    for block in PI.blocks:
        for port in range(len(block.input_types)):
            flat.connect(PI.source(block, port), block, port)
    inside = ("Integral", "Increment", "Integral_Gain")
    flat.paths = {b.name: f"Loop/I/{b.name}" if b.name in inside else b.name for b in flat.blocks}
    tree = ElementTree.fromstring(diagram_svg(flat))
    titles = [t.text for t in tree.iter(f"{SVG}text") if t.get("class") == "title"]
    assert titles == ["flat", "Loop", "Loop/I"]
