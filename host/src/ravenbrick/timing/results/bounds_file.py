# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of response times from the file that `ravenbrick analyse` writes."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError, UsageError
from ravenbrick.image.elf import ElfImage
from ravenbrick.json_values import json_values

__all__ = ["own_bounds", "own_worst_paths", "read_bounds"]

ADVICE = "let 'ravenbrick analyse PROJECT' write it again"


def read_bounds(path: Path, image: ElfImage) -> dict[str, int]:
    """Longest response time in cycles by task; tasks without a bound are left out.

    Raises `UsageError` when there is no such file or it bounds another image, `ProjectFileError`
    when it is none of `ravenbrick analyse`.
    """
    if not path.is_file():
        raise UsageError(f"{path}: there is no such file; {ADVICE}")
    try:
        content = json_values(path.read_text(encoding="utf-8"))
        digest = content["image_sha256"]
        bounds = {
            str(task["name"]): int(task["response_bound_cycles"])
            for task in content["tasks"]
            if task["response_bound_cycles"] is not None
        }
    except json.JSONDecodeError as error:
        raise ProjectFileError(path, error.lineno, "", f"no JSON: {error.msg}") from None
    except UnicodeDecodeError:
        raise ProjectFileError(path, 1, "", f"not UTF-8 text; {ADVICE}") from None
    except KeyError as error:
        raise ProjectFileError(path, 1, str(error.args[0]), f"is missing; {ADVICE}") from None
    except (TypeError, ValueError, OverflowError) as error:
        raise ProjectFileError(path, 1, "tasks", f"{error}; {ADVICE}") from None
    if digest != image.digest:
        raise UsageError(f"{path}: bounds another image than {image.path}; {ADVICE}")
    return bounds


def own_bounds(path: Path, image: ElfImage) -> dict[str, int]:
    """As `read_bounds`, of a file that need not be there or be of this image: then no bounds."""
    try:
        return read_bounds(path, image)
    except UsageError:
        return {}


def own_worst_paths(path: Path, image: ElfImage) -> dict[str, list[dict[str, Any]]]:
    """Lines of each task's worst path, the most expensive first: their place, how often they are
    executed, their cycles, and the cycles that a job of the run needed for them.

    Empty where there is no file of `ravenbrick analyse` for this image.
    """
    if not own_bounds(path, image):
        return {}
    paths = json.loads(path.read_text(encoding="utf-8")).get("worst_paths", {})
    return {task: _lines(executed) for task, executed in paths.items()}


def _lines(executed: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Sums over all calls that execute a line."""
    sums: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
    for part in executed:
        line = sums[part["place"]]
        for index, field in enumerate(("worst_times", "worst_cycles", "run_cycles")):
            line[index] += part[field]
    names = ("place", "times", "cycles", "run_cycles")
    found = [dict(zip(names, (place, *sum_), strict=True)) for place, sum_ in sums.items()]
    return sorted(found, key=lambda line: (-line["cycles"], line["place"]))
