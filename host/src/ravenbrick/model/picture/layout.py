# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Coordinates of a layered drawing: boxes on straight lines, orthogonal lines in the gaps."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import pairwise

from ravenbrick.model.picture.layers import Box, Layers, Line, Place, layered

__all__ = ["Layout", "laid_out"]

_BETWEEN = 26.0  # boxes of a layer
_PASSING = 14.0  # a line above a box, or beside another line
_UNDER_NAME = 24.0  # a line below a box
_TRACK = 12.0
_GAP = 26.0  # between layers without vertical lines
_PASSES = 16
_STRAIGHTENING = 4
_SLACK = 4.0  # what neighbours may come closer if a line becomes straight
_SAME = 0.5

Point = tuple[float, float]


@dataclass
class Layout:
    """Left upper corners of boxes, polylines of lines, points at which lines part, and the size."""

    corners: dict[str, Point]
    ways: dict[Line, list[Point]]
    joints: list[Point]
    width: float
    height: float


@dataclass(eq=False)
class _Net:
    """What one output leads through a gap between layers: heights at both sides."""

    left: set[float] = field(default_factory=set)
    right: set[float] = field(default_factory=set)
    track: int = -1
    x: float = 0.0

    @property
    def span(self) -> tuple[float, float]:
        ends = self.left | self.right
        return min(ends), max(ends)

    @property
    def is_straight(self) -> bool:
        low, high = self.span
        return high - low < _SAME


def laid_out(boxes: list[Box], lines: list[Line]) -> Layout:
    """A layout of boxes and lines; the same input gives the same picture."""
    layers = layered(boxes, lines)
    _set_heights(layers)
    nets = _nets(layers)
    widths = [
        max((max(p.box.width, p.box.room) for p in row if p.box), default=0.0)
        for row in layers.rows
    ]
    return _drawn(layers, nets, widths)


def _set_heights(layers: Layers) -> None:
    """Middles of all places: near those that they are joined with, without overlap."""
    for row in layers.rows:
        y = 0.0
        for place in row:
            place.y = y + place.height / 2
            y += place.height + _BETWEEN
    for number in range(_PASSES):
        rows = layers.rows if number % 2 == 0 else layers.rows[::-1]
        for row in rows:
            wanted = [_wanted(place, number) for place in row]
            for place, y in zip(row, _apart(row, wanted), strict=True):
                place.y = y
    for _ in range(_STRAIGHTENING):
        for row in layers.rows:
            _straighten(row)
    top = min((p.y - p.height / 2 for row in layers.rows for p in row), default=0.0)
    for row in layers.rows:
        for place in row:
            place.y -= top


def _straighten(row: list[Place]) -> None:
    """Move each place within its room to where most of its lines are straight."""
    for number, place in enumerate(row):
        low, high = -math.inf, math.inf
        if number:
            low = row[number - 1].y + _distance(row[number - 1], place) - _SLACK
        if number + 1 < len(row):
            high = row[number + 1].y - _distance(place, row[number + 1]) + _SLACK
        levels = [end.y + its - own for end, own, its in place.before + place.after]
        allowed = [level for level in levels if low <= level <= high]

        def straight(y: float, levels: list[float] = levels) -> int:
            return sum(abs(level - y) < _SAME for level in levels)

        best = max(allowed, key=straight, default=place.y)
        if straight(best) > straight(place.y):
            place.y = best


def _distance(above: Place, below: Place) -> float:
    """Between the middles of neighbours."""
    room = _BETWEEN if above.box and below.box else _UNDER_NAME if above.box else _PASSING
    return (above.height + below.height) / 2 + room


def _wanted(place: Place, number: int) -> float:
    """Where most of its lines would be straight."""
    ends = place.before if number % 2 == 0 else place.after
    if number >= _PASSES - 4 or not ends:
        ends = place.before + place.after
    if not ends:
        return place.y
    found = sorted(end.y + its - own for end, own, its in ends)
    middle = len(found) // 2
    if len(found) % 2:
        return found[middle]
    return found[middle - 1] if number % 4 < 2 else found[middle]


def _apart(row: list[Place], wanted: list[float]) -> list[float]:
    """Nearest to the wanted heights in the given order: pools of adjacent violators."""
    offsets, total = [], 0.0
    for place, before in zip(row, [None, *row], strict=False):
        if before is not None:
            total += _distance(before, place)
        offsets.append(total)
    pools: list[list[float]] = []  # sum, weight, count
    for place, want, offset in zip(row, wanted, offsets, strict=True):
        weight = 1.0 if place.box else 0.6
        pools.append([(want - offset) * weight, weight, 1])
        while len(pools) > 1 and pools[-2][0] / pools[-2][1] > pools[-1][0] / pools[-1][1]:
            last = pools.pop()
            pools[-1] = [one + two for one, two in zip(pools[-1], last, strict=True)]
    levels = [pool[0] / pool[1] for pool in pools for _ in range(int(pool[2]))]
    return [level + offset for level, offset in zip(levels, offsets, strict=True)]


def _nets(layers: Layers) -> dict[tuple[int, str, int, bool], _Net]:
    """Heights at which each output enters and leaves gap g, between layers g - 1 and g."""
    found: dict[tuple[int, str, int, bool], _Net] = defaultdict(_Net)
    for line, chain in layers.chains.items():
        for gap, sides in _crossed(layers, line, chain):
            net = found[gap, line.source, line.output, line in layers.backwards]
            for y, is_left in sides:
                (net.left if is_left else net.right).add(y)
    for gap in {key[0] for key in found}:
        _assign_tracks([net for key, net in sorted(found.items()) if key[0] == gap])
    return found


def _crossed(
    layers: Layers, line: Line, chain: list[Place]
) -> list[tuple[int, list[tuple[float, bool]]]]:
    """The gaps of a line from source to target, each with both ends: height, and if on the left."""
    source, target = chain[0], chain[-1]
    assert source.box and target.box
    heights = [source.y + source.box.outputs[line.output], *(p.y for p in chain[1:-1]),
               target.y + target.box.inputs[line.port]]  # fmt: skip
    pairs = list(pairwise(heights))
    if line not in layers.backwards:
        return [(source.rank + 1 + n, [(one, True), (two, False)])
                for n, (one, two) in enumerate(pairs)]  # fmt: skip
    found = [(source.rank + 1, [(pairs[0][0], True), (pairs[0][1], True)])]
    for number, (one, two) in enumerate(pairs[1:-1]):
        found.append((source.rank - number, [(one, False), (two, True)]))
    return [*found, (target.rank, [(pairs[-1][0], False), (pairs[-1][1], False)])]


def _assign_tracks(nets: list[_Net]) -> None:
    """Vertical lines of a gap side by side; horizontal parts of two nets do not meet."""
    bent = [net for net in nets if not net.is_straight]
    first: dict[int, set[int]] = {id(net): set() for net in bent}
    for one in bent:
        for two in bent:
            if one is not two and _meet(one.right, two.left):
                first[id(one)].add(id(two))  # `one` leaves to the right where `two` arrives
    placed: set[int] = set()
    tracks: list[list[_Net]] = []
    waiting = sorted(bent, key=lambda net: (-_rising(net), net.span))
    while waiting:
        free = [net for net in waiting if first[id(net)] <= placed]
        net = (free or waiting)[0]
        waiting.remove(net)
        placed.add(id(net))
        low = 1 + max((one.track for one in bent if id(one) in first[id(net)]), default=-1)
        while low < len(tracks) and any(_overlap(net.span, one.span) for one in tracks[low]):
            low += 1
        if low == len(tracks):
            tracks.append([])
        net.track = low
        tracks[low].append(net)


def _rising(net: _Net) -> float:
    """Below 0 where a line goes down from left to right."""
    if not net.left or not net.right:
        return 0.0
    return min(net.left) - min(net.right)


def _meet(one: set[float], two: set[float]) -> bool:
    return any(abs(a - b) < _TRACK / 2 for a in one for b in two)


def _overlap(one: Point, two: Point) -> bool:
    return one[0] < two[1] + _TRACK / 2 and two[0] < one[1] + _TRACK / 2


def _drawn(
    layers: Layers, nets: dict[tuple[int, str, int, bool], _Net], widths: list[float]
) -> Layout:
    lefts, x = [], 0.0
    for gap in range(len(widths) + 1):
        own = [net for key, net in nets.items() if key[0] == gap]
        count = max((net.track + 1 for net in own), default=0)
        room = _GAP + _TRACK * max(count - 1, 0) if 0 < gap < len(widths) or count else 0.0
        for net in own:
            net.x = x + _GAP / 2 + _TRACK * max(net.track, 0)
        x += room
        lefts.append(x)
        x += widths[gap] if gap < len(widths) else 0.0
    corners = {}
    for key, place in layers.boxes.items():
        assert place.box
        left = lefts[place.rank] + (widths[place.rank] - place.box.width) / 2
        corners[key] = (left, place.y - place.box.height / 2)
    ways = {line: _way(layers, line, chain, nets, corners)
            for line, chain in layers.chains.items()}  # fmt: skip
    bottom = max((p.y + p.height / 2 for row in layers.rows for p in row), default=0.0)
    return Layout(corners, ways, _joints(ways), x, bottom)


def _way(
    layers: Layers, line: Line, chain: list[Place],
    nets: dict[tuple[int, str, int, bool], _Net], corners: dict[str, Point],
) -> list[Point]:  # fmt: skip
    source, target = layers.boxes[line.source].box, layers.boxes[line.target].box
    assert source and target
    back = line in layers.backwards
    points: list[Point] = []
    for gap, (one, two) in _crossed(layers, line, chain):
        net = nets[gap, line.source, line.output, back]
        points += [(net.x, one[0]), (net.x, two[0])]
    begin, end = corners[line.source], corners[line.target]
    first = (begin[0] + source.width, points[0][1])
    return _simplified([first, *points, (end[0], points[-1][1])])


def _simplified(points: list[Point]) -> list[Point]:
    """Without points that change nothing."""
    found: list[Point] = []
    for point in points:
        if found and abs(found[-1][0] - point[0]) < _SAME and abs(found[-1][1] - point[1]) < _SAME:
            continue
        if len(found) > 1 and any(
            abs(found[-1][axis] - point[axis]) < _SAME
            and abs(found[-2][axis] - point[axis]) < _SAME
            for axis in (0, 1)
        ):
            found.pop()
        found.append(point)
    return found


def _joints(ways: dict[Line, list[Point]]) -> list[Point]:
    """Corners at which a line leaves another one of the same output."""
    outputs: dict[tuple[str, int], list[list[Point]]] = defaultdict(list)
    for line, way in ways.items():
        outputs[line.source, line.output].append(way)
    found = set()
    for group in outputs.values():
        arms: dict[Point, set[Point]] = defaultdict(set)
        corners = {point for way in group for point in way[1:-1]}
        for way in group:
            for one, two in pairwise(way):
                for corner in corners:
                    for end in (one, two):
                        if end != corner and _on(corner, one, two):
                            arms[corner].add(_direction(corner, end))
        found |= {corner for corner, directions in arms.items() if len(directions) > 2}
    return sorted(found)


def _on(point: Point, one: Point, two: Point) -> bool:
    return all(
        min(one[axis], two[axis]) - _SAME <= point[axis] <= max(one[axis], two[axis]) + _SAME
        for axis in (0, 1)
    )


def _direction(start: Point, end: Point) -> Point:
    across, down = end[0] - start[0], end[1] - start[1]
    return ((across > _SAME) - (across < -_SAME), (down > _SAME) - (down < -_SAME))
