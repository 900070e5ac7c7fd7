# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Longest paths of the examples' jobs and of all functions they reach, found in two ways: by the
crate's walk over nested loops, and as an integer program (implicit path enumeration) by HiGHS.

`python -m verification.timing.integer_program [NAME ...]` prints one JSON object.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import virtual_brick
from ravenbrick.errors import RavenbrickError
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.ipet import longest_path

from verification.timing.examples import EXAMPLES
from verification.timing.known_examples import known_example

__all__ = ["compared"]


def _answers(image: ElfImage, request: dict[str, Any]) -> dict[str, Any]:
    text = virtual_brick.bound_execution_times(image.content, json.dumps(request), "nominal", 1)
    answer: dict[str, Any] = json.loads(text)
    return answer


def compared(name: str) -> dict[str, Any]:
    """Graphs of an example in which both ways were gone, and those with different results."""
    known = known_example(name)
    request = {
        "annotations": [{"name": source, "text": text} for source, text in known.annotations],
        "jobs": [
            {"body": body, "waits": list(waits), "otherwise": list(otherwise)}
            for body, waits, otherwise in known.jobs
        ],
        "graphs": True,
    }
    found = _answers(known.image, request)["jobs"]
    reached = sorted({function for job in found for function in job["reached"]})
    functions = [function for function in reached if function in known.image.symbols]
    found += _answers(known.image, {**request, "jobs": [], "functions": functions})["functions"]
    different, count, blocks = [], 0, 0
    for answer in found:
        graph = answer["graph"]
        if graph is None:
            continue
        count, blocks = count + 1, blocks + len(graph["blocks"])
        solved = longest_path(graph)
        if solved != graph["path_cycles"]:
            different.append(f"{name}: {answer['symbol']}: {solved}, {graph['path_cycles']}")
    return {"graphs": count, "blocks": blocks, "different": different}


def main() -> int:
    """Print the comparison; 1 when the two ways disagree."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(EXAMPLES))
    every = []
    for name in parser.parse_args().names:
        try:
            every.append(compared(name))
        except RavenbrickError as error:
            every.append({"graphs": 1, "blocks": 0, "different": [f"{name}: {error.sentence}"]})
        print(f"{name}: {every[-1]['graphs']} graphs", file=sys.stderr, flush=True)
    result = {
        "graphs": sum(one["graphs"] for one in every),
        "blocks": sum(one["blocks"] for one in every),
        "different": [text for one in every for text in one["different"]],
    }
    print(json.dumps(result, indent=1))
    return 1 if result["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
