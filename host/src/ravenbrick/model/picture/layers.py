# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Layers of a drawing and the order in each: K. Sugiyama, S. Tagawa and M. Toda, 1981.

Lines that close a loop are turned, ranks are longest paths, a line over several layers gets a
place in each, and sweeps by barycentres reduce crossings.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from itertools import combinations, pairwise

__all__ = ["Box", "Layers", "Line", "Place", "layered"]

_SWEEPS = 12
_FEEDBACK_LAST = 1e6


@dataclass
class Box:
    """A block to be drawn: its size, and the heights of its ports below the middle.

    Its name under it takes `room`; `last` says that it belongs to the right edge.
    """

    key: str
    width: float
    height: float
    inputs: list[float]
    outputs: list[float]
    room: float
    last: bool = False


@dataclass(frozen=True)
class Line:
    """From an output of one box to an input of another."""

    source: str
    output: int
    target: str
    port: int


@dataclass(eq=False)
class Place:
    """A box in a layer, or where a line passes it; `y` is that of the middle.

    A line that leads back passes from right to left.
    """

    rank: int
    box: Box | None = None
    backwards: bool = False
    before: list[tuple[Place, float, float]] = field(default_factory=list)
    after: list[tuple[Place, float, float]] = field(default_factory=list)
    y: float = 0.0

    @property
    def height(self) -> float:
        """The room that it takes."""
        return self.box.height if self.box else 0.0


@dataclass
class Layers:
    """Places by layer in order, those of each box, and the chain of places of each line."""

    rows: list[list[Place]]
    boxes: dict[str, Place]
    chains: dict[Line, list[Place]]
    backwards: set[Line]


def layered(boxes: list[Box], lines: list[Line]) -> Layers:
    """Ranks and orders; the boxes' own order decides between equals."""
    backwards = _closing(boxes, lines)
    ranks = _ranks(boxes, lines, backwards)
    places = {box.key: Place(ranks[box.key], box) for box in boxes}
    rows: list[list[Place]] = [[] for _ in range(max(ranks.values(), default=0) + 1)]
    for place in places.values():
        rows[place.rank].append(place)
    chains = _chains(lines, places, rows, backwards)
    best = [list(row) for row in rows]
    fewest = _crossings(rows)
    for sweep in range(_SWEEPS):
        _sweep(rows, down=sweep % 2 == 0)
        count = _crossings(rows)
        if count < fewest:
            fewest, best = count, [list(row) for row in rows]
        if not fewest:
            break
    return Layers(best, places, chains, backwards)


def _closing(boxes: list[Box], lines: list[Line]) -> set[Line]:
    """Lines that lead back to a box on the way to them, by depth-first search from the sources."""
    following: dict[str, list[Line]] = defaultdict(list)
    entered = {line.target for line in lines if line.source != line.target}
    for line in lines:
        following[line.source].append(line)
    starts = [b.key for b in boxes if b.key not in entered] + [b.key for b in boxes]
    done: set[str] = set()
    found: set[Line] = set()
    for start in starts:
        if start in done:
            continue
        way, open_lines = [start], [iter(following[start])]
        on_way = {start}
        while way:
            next_line = next(open_lines[-1], None)
            if next_line is None:
                done.add(way[-1])
                on_way.discard(way.pop())
                open_lines.pop()
            elif next_line.target in on_way:
                found.add(next_line)
            elif next_line.target not in done:
                way.append(next_line.target)
                on_way.add(next_line.target)
                open_lines.append(iter(following[next_line.target]))
    return found


def _ranks(boxes: list[Box], lines: list[Line], backwards: set[Line]) -> dict[str, int]:
    """Longest path from the left; what only feeds others stands just before them."""
    before: dict[str, set[str]] = {box.key: set() for box in boxes}
    for line in lines:
        if line not in backwards and line.source != line.target:
            before[line.target].add(line.source)
    ranks: dict[str, int] = {}
    waiting = {key: set(needs) for key, needs in before.items()}
    while waiting:
        free = [key for key, needs in waiting.items() if not needs]
        for key in free:
            ranks[key] = max((ranks[one] + 1 for one in before[key]), default=0)
            del waiting[key]
        for needs in waiting.values():
            needs.difference_update(free)
    last = max(ranks.values(), default=0)
    after: dict[str, list[str]] = defaultdict(list)
    for target, needs in before.items():
        for source in needs:
            after[source].append(target)
    for box in boxes:
        if not before[box.key] and after[box.key]:
            ranks[box.key] = min(ranks[target] for target in after[box.key]) - 1
        if box.last and not after[box.key]:
            ranks[box.key] = last
    return ranks


def _chains(
    lines: list[Line], places: dict[str, Place], rows: list[list[Place]], backwards: set[Line]
) -> dict[Line, list[Place]]:
    """The places of each line from source to target; lines from one output share theirs."""
    shared: dict[tuple[str, int, int, bool], Place] = {}
    chains: dict[Line, list[Place]] = {}
    joined: set[tuple[int, int, float, float]] = set()

    def passing(line: Line, rank: int, back: bool) -> Place:
        key = (line.source, line.output, rank, back)
        if key not in shared:
            shared[key] = Place(rank, backwards=back)
            rows[rank].append(shared[key])
        return shared[key]

    for line in lines:
        source, target = places[line.source], places[line.target]
        back = line in backwards or source.rank >= target.rank
        if back:
            backwards.add(line)
            ranks = range(source.rank, target.rank - 1, -1)
        else:
            ranks = range(source.rank + 1, target.rank)
        chain = [source, *(passing(line, rank, back) for rank in ranks), target]
        chains[line] = chain
        assert source.box and target.box
        for one, two in pairwise(chain):
            from_y = source.box.outputs[line.output] if one is source else 0.0
            to_y = target.box.inputs[line.port] if two is target else 0.0
            key = (id(one), id(two), from_y, to_y)
            if key in joined or one.rank == two.rank:
                continue
            joined.add(key)
            left, right, a, b = (one, two, from_y, to_y) if one.rank < two.rank else (
                two, one, to_y, from_y)  # fmt: skip
            left.after.append((right, a, b))
            right.before.append((left, b, a))
    return chains


def _sweep(rows: list[list[Place]], *, down: bool) -> None:
    """Sort each layer by where its lines come from, on the left or on the right."""
    for row in rows if down else reversed(rows):
        position: dict[int, float] = {}
        for other in rows:
            for number, place in enumerate(other):
                position[id(place)] = float(number)
        keys = {}
        for number, place in enumerate(row):
            ends = place.before if down else place.after
            ends = ends or (place.after if down else place.before)
            weights = [position[id(end)] + _port_share(end, its) for end, _, its in ends]
            keys[id(place)] = sum(weights) / len(weights) if weights else float(number)
            if place.backwards:
                keys[id(place)] += _FEEDBACK_LAST
        row.sort(key=lambda place: keys[id(place)])


def _port_share(end: Place, offset: float) -> float:
    return 0.8 * offset / end.height if end.height else 0.0


def _crossings(rows: list[list[Place]]) -> int:
    """Pairs of lines that cross between neighbouring layers."""
    count = 0
    for row, following in pairwise(rows):
        position = {id(place): number for number, place in enumerate(following)}
        pairs = [
            ((number, own), (position[id(other)], its))
            for number, place in enumerate(row) for other, own, its in place.after
        ]  # fmt: skip
        for (left, right), (left_two, right_two) in combinations(pairs, 2):
            count += (left < left_two and right > right_two) or (
                left > left_two and right < right_two
            )
    return count
