# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Implicit path enumeration (Li and Malik 1995): the longest path of a function as an integer
program, solved by HiGHS, where facts bind executions of places that are far from each other.

The graph comes from the crate `wcet`; without facts, the result equals its longest path.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ravenbrick.timing.bounds import ExecutionTimeError

__all__ = ["FlowFact", "flow_point", "longest_path"]

Edge = tuple[int, int | None, int]


@dataclass(frozen=True)
class FlowFact:
    """In one call of `symbol`, these source lines together are executed at most so often.

    A line is `file:number`; its executions are those of its first block.
    """

    symbol: str
    lines: tuple[str, ...]
    at_most: int
    reason: str


@dataclass(frozen=True)
class _Row:
    """Sum of coefficient * executions of an edge, at most or exactly a number."""

    terms: tuple[tuple[int, int], ...]
    most: int
    exact: bool = False


def _edges(graph: dict[str, Any]) -> list[Edge]:
    """Edges that can be taken: from, to (None: return), cycles."""
    blocks = graph["blocks"]
    return [
        (index, edge["to"], edge["cycles"])
        for index, block in enumerate(blocks)
        for edge in block["edges"]
        if edge["cycles"] is not None
    ]


def _flow_rows(graph: dict[str, Any], edges: Sequence[Edge]) -> list[_Row]:
    """Each block is left as often as it is entered; the first is entered once from outside."""
    rows = []
    for block in range(len(graph["blocks"])):
        out = [(n, 1) for n, (source, _, _) in enumerate(edges) if source == block]
        into = [(n, -1) for n, (_, to, _) in enumerate(edges) if to == block]
        rows.append(_Row((*out, *into), int(block == 0), exact=True))
    rows.append(_Row(tuple((n, 1) for n, e in enumerate(edges) if e[1] is None), 1, exact=True))
    return rows


def _loop_row(loop: dict[str, Any], edges: Sequence[Edge]) -> _Row:
    """Executions of a header, at most so many for each entry; none where no bound is needed."""
    inside, bound = set(loop["blocks"]), loop["header_executions"] or 0
    terms = []
    for number, (source, to, _) in enumerate(edges):
        if to == loop["header"]:
            entry = source not in inside
            terms.append((number, 1 - bound if entry else 1))
    return _Row(tuple(terms), bound - 1 if loop["header"] == 0 else 0)


def _repeats_row(graph: dict[str, Any], loop: dict[str, Any], edges: Sequence[Edge]) -> _Row:
    """Back edges of a header, in all so many for each entry of the loop around."""
    most, around = loop["repeats"]
    outside = next(each for each in graph["loops"] if each["header"] == around)
    inner, outer = set(loop["blocks"]), set(outside["blocks"])
    terms = [(n, 1) for n, e in enumerate(edges) if e[1] == loop["header"] and e[0] in inner]
    terms += [(n, -most) for n, e in enumerate(edges) if e[1] == around and e[0] not in outer]
    return _Row(tuple(terms), most if around == 0 else 0)


def _first_blocks(graph: dict[str, Any], fact: FlowFact) -> list[int]:
    """The first block of each line; raises `ExecutionTimeError` where there is none."""
    first = []
    for line in fact.lines:
        holds = [
            index
            for index, block in enumerate(graph["blocks"])
            if any(found == line or found.endswith(f"/{line}") for found in block["lines"])
        ]
        if not holds:
            raise ExecutionTimeError(
                f"[[flow]] of {fact.symbol}: no block has the line {line}; name file and line of "
                "a statement in this function"
            )
        first.append(min(holds, key=lambda index: int(graph["blocks"][index]["address"])))
    return first


def flow_point(graph: dict[str, Any], fact: FlowFact) -> dict[str, Any]:
    """Where a run counts the fact, as the virtual brick takes it."""
    address = [int(block["address"]) for block in graph["blocks"]]
    places = [address[block] for block in _first_blocks(graph, fact)]
    at_most = fact.at_most
    return {"kind": "together", "entry": address[0], "addresses": places, "at_most": at_most}


def _fact_row(graph: dict[str, Any], edges: Sequence[Edge], fact: FlowFact) -> _Row:
    terms, most = [], fact.at_most
    for first in _first_blocks(graph, fact):
        terms += [(number, 1) for number, edge in enumerate(edges) if edge[1] == first]
        most -= int(first == 0)
    return _Row(tuple(terms), most)


def longest_path(graph: dict[str, Any], facts: Sequence[FlowFact] = ()) -> int:
    """Cycles of the longest path. Raises `ExecutionTimeError` when the facts leave none."""
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import lil_matrix

    edges = _edges(graph)
    rows = [
        *_flow_rows(graph, edges),
        *(_loop_row(loop, edges) for loop in graph["loops"]),
        *(_repeats_row(graph, loop, edges) for loop in graph["loops"] if loop["repeats"]),
        *(_fact_row(graph, edges, fact) for fact in facts),
    ]
    matrix = lil_matrix((len(rows), len(edges)))
    for index, row in enumerate(rows):
        for number, coefficient in row.terms:
            matrix[index, number] += coefficient
    most = np.array([row.most for row in rows], float)
    least = np.where([row.exact for row in rows], most, -np.inf)
    solved = milp(
        -np.array([cycles for _, _, cycles in edges], float),
        constraints=LinearConstraint(matrix.tocsr(), least, most),
        bounds=Bounds(0, np.inf),
        integrality=np.ones(len(edges)),
    )
    if not solved.success:
        raise ExecutionTimeError(f"no longest path under these facts: {solved.message}")
    counts = np.rint(solved.x).astype(np.int64)
    return int(sum(int(n) * cycles for n, (_, _, cycles) in zip(counts, edges, strict=True)))
