# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The quick verdict on a project file beside that of jsonschema."""

from __future__ import annotations

import copy
import random
import tomllib
from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest
from verification.support.projects import VEHICLE

from ravenbrick.schemas import schema
from ravenbrick.schemas.check import meets

ROOT = VEHICLE.parents[1]
FILES = {
    "robot": sorted(ROOT.glob("examples/*/robot.toml")),
    "scenario": sorted(ROOT.glob("examples/*/scenarios/*.toml")),
    "rubric": sorted(ROOT.glob("docs/lessons/rubrics/l[ae]*-*.toml")),
    "timing": sorted(ROOT.glob("examples/*/timing.toml")),
}
FAULTS: list[Any] = [True, -1, 0, 2.5, 3.0, 10**9, "", "a", "Not A Name", [], [1], {}, {"a": 1}]


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every table or list inside, with each of its keys."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, inner in items:
        yield value, key
        if isinstance(inner, (dict, list)):
            yield from places(inner)


@pytest.mark.parametrize("name", FILES)
def test_the_quick_verdict_is_that_of_jsonschema(name: str) -> None:
    """On our own files, and on those with a field changed, added, renamed or taken away."""
    own = jsonschema.Draft202012Validator(schema(name))
    documents = [tomllib.loads(file.read_text("utf-8")) for file in FILES[name]]
    assert documents and all(meets(document, schema(name)) for document in documents)
    draw = random.Random(name)
    wrong = 0
    for _ in range(250):
        document = copy.deepcopy(draw.choice(documents))
        table, key = draw.choice(list(places(document)))
        change = draw.randrange(4)
        if change == 0:
            table[key] = copy.deepcopy(draw.choice(FAULTS))
        elif change == 1:
            del table[key]
        elif isinstance(table, dict):
            table[draw.choice([f"{key}s", "kind", "minimum"])] = table.pop(key) if change < 3 else 1
        found = meets(document, schema(name))
        assert found == own.is_valid(document), document
        wrong += not found
    assert wrong > 50


def test_a_keyword_that_the_check_does_not_know_is_not_passed_over() -> None:
    with pytest.raises(KeyError, match="uniqueItems"):
        meets([1, 1], {"uniqueItems": True})
