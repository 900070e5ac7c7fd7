# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether a value meets a schema, without saying where it does not.

This is all that a correct file needs; jsonschema, which finds the faults of the others, takes
longer to load than a command's own modules.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

__all__ = ["meets"]

Schema = dict[str, Any] | bool
_TYPES: dict[str, type | tuple[type, ...]] = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "number": (int, float),
    "integer": (int, float),
}
_NUMBER = (int, float)
# Keywords that compare, and the values that they apply to.
_COMPARISONS: dict[str, tuple[type | tuple[type, ...], Callable[[Any, Any], bool]]] = {
    "minimum": (_NUMBER, lambda value, bound: value >= bound),
    "maximum": (_NUMBER, lambda value, bound: value <= bound),
    "exclusiveMinimum": (_NUMBER, lambda value, bound: value > bound),
    "minLength": (str, lambda value, bound: len(value) >= bound),
    "maxLength": (str, lambda value, bound: len(value) <= bound),
    "pattern": (str, lambda value, pattern: re.search(pattern, value) is not None),
    "minItems": (list, lambda value, bound: len(value) >= bound),
    "maxItems": (list, lambda value, bound: len(value) <= bound),
    "minProperties": (dict, lambda value, bound: len(value) >= bound),
    "maxProperties": (dict, lambda value, bound: len(value) <= bound),
    "required": (dict, lambda value, names: all(name in value for name in names)),
    "dependentRequired": (
        dict,
        lambda value, needs: all(
            other in value for name in needs if name in value for other in needs[name]
        ),
    ),
}
# Keywords that say nothing about the value, or are read with another one.
_OTHERS = {"$schema", "$id", "$defs", "title", "description", "default", "then", "else"}


def meets(value: Any, schema: Schema, root: Schema | None = None) -> bool:
    """Whether a value of TOML or JSON meets a schema; references lead into `root`, the whole.

    Raises KeyError for a keyword that no schema of ours uses.
    """
    if isinstance(schema, bool):
        return schema
    whole = schema if root is None else root
    return all(keyword in _OTHERS or _holds(value, keyword, schema, whole) for keyword in schema)


def _holds(value: Any, keyword: str, schema: dict[str, Any], root: Schema) -> bool:
    argument = schema[keyword]

    def inner(part: Any, rule: Schema) -> bool:
        return meets(part, rule, root)

    match keyword:
        case "type":
            return _is(value, argument)
        case "const":
            return _same(value, argument)
        case "enum":
            return any(_same(value, choice) for choice in argument)
        case "allOf":
            return all(inner(value, rule) for rule in argument)
        case "anyOf":
            return any(inner(value, rule) for rule in argument)
        case "not":
            return not inner(value, argument)
        case "if":
            return inner(value, schema.get("then" if inner(value, argument) else "else", True))
        case "$ref":
            return inner(value, _referred(argument, root))
        case "items":
            return not isinstance(value, list) or all(inner(item, argument) for item in value)
        case "properties" | "patternProperties" | "additionalProperties" | "propertyNames":
            return not isinstance(value, dict) or all(
                inner(part, rule) for part, rule in _parts(value, keyword, schema)
            )
    applies, compare = _COMPARISONS[keyword]
    other_kind = not isinstance(value, applies) or isinstance(value, bool)
    return other_kind or compare(value, argument)


def _parts(
    value: dict[str, Any], keyword: str, schema: dict[str, Any]
) -> Iterator[tuple[Any, Schema]]:
    """Names or fields of a table, each with the rule that the keyword has for it."""
    argument = schema[keyword]
    known, patterns = schema.get("properties", {}), schema.get("patternProperties", {})
    for name, field in value.items():
        if keyword == "propertyNames":
            yield name, argument
        elif keyword == "properties" and name in known:
            yield field, known[name]
        elif keyword == "patternProperties":
            yield from ((field, rule) for p, rule in patterns.items() if re.search(p, name))
        elif keyword == "additionalProperties" and name not in known:
            if not any(re.search(pattern, name) for pattern in patterns):
                yield field, argument


def _referred(place: str, root: Any) -> Schema:
    for name in place.removeprefix("#/").split("/"):
        root = root[name]
    found: Schema = root
    return found


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool) and kind != "boolean":
        return False
    whole = kind != "integer" or not isinstance(value, float) or value.is_integer()
    return isinstance(value, _TYPES[kind]) and whole


def _same(value: Any, wanted: Any) -> bool:
    return bool(value == wanted) and isinstance(value, bool) == isinstance(wanted, bool)
