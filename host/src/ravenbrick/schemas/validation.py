# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Check a located TOML file against a schema; the error names file, line and field."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any

from ravenbrick.errors import ProjectFileError
from ravenbrick.schemas import schema
from ravenbrick.schemas.check import meets
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml

if TYPE_CHECKING:
    import jsonschema

__all__ = ["validate"]

Complaint = tuple[KeyPath, str]
_TYPES = {
    "object": "a table",
    "array": "a list",
    "string": "a text in quotes",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
}
_UNKNOWN = "unknown field"
# Nobody reads more, and a hostile file may have hundreds of thousands.
_COMPLAINTS_MAX = 100
_PORTS = "the brick has the motor ports A, B, C and the sensor ports 1, 2, 3, 4"


def _shown(value: Any) -> str:
    return f"'{value}'" if isinstance(value, str) else repr(value)


def _choices(values: list[Any]) -> str:
    return ", ".join(_shown(value) for value in values)


def _missing(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    for name in error.validator_value:
        if name not in error.instance:
            yield (*path, name), "is missing; add it"


def _unknown(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    known = sorted(error.schema.get("properties", {}))
    for name in sorted(set(error.instance) - set(known)):
        close = difflib.get_close_matches(name, known, 1)
        advice = f"did you mean '{close[0]}'?" if close else f"known here: {', '.join(known)}"
        yield (*path, name), f"{_UNKNOWN}; {advice}"


def _wrong_name(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    name, known = error.instance, error.validator_value
    if set(known) <= {*"ABC1234"}:
        yield (*path, name), f"unknown port '{name}'; {_PORTS}"
    else:
        yield (*path, name), f"unknown name; expected one of {_choices(known)}"


def _wrong_choice(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    if list(error.absolute_schema_path)[-2:-1] == ["propertyNames"]:
        yield from _wrong_name(error, path)
        return
    expected = _choices(error.validator_value)
    yield path, f"is {_shown(error.instance)}; expected one of {expected}"


def _at(text: str) -> Callable[[jsonschema.ValidationError, KeyPath], Iterator[Complaint]]:
    def complain(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
        bound, value = _shown(error.validator_value), _shown(error.instance)
        yield path, text.format(bound=bound, value=value)

    return complain


def _wrong_type(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    expected = _TYPES.get(error.validator_value, str(error.validator_value))
    yield path, f"is {_shown(error.instance)}; expected {expected}"


def _depends(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    for name, needed in sorted(error.validator_value.items()):
        for other in needed:
            if name in error.instance and other not in error.instance:
                yield (*path, other), f"is missing; '{name}' needs it"


def _no_bound(error: jsonschema.ValidationError, path: KeyPath) -> Iterator[Complaint]:
    names = [_shown(name) for branch in error.validator_value for name in branch["required"]]
    yield path, f"has no bound; give {', '.join(names)} or both"


_TRANSLATORS: dict[str, Callable[[jsonschema.ValidationError, KeyPath], Iterator[Complaint]]] = {
    "required": _missing,
    "additionalProperties": _unknown,
    "enum": _wrong_choice,
    "type": _wrong_type,
    "dependentRequired": _depends,
    "const": _at("is {value}; expected {bound}"),
    "minimum": _at("is {value}; expected at least {bound}"),
    "maximum": _at("is {value}; expected at most {bound}"),
    "exclusiveMinimum": _at("is {value}; expected more than {bound}"),
    "pattern": _at("is {value}; expected a name of small letters, digits, '-' and '_'"),
    "minItems": _at("is empty; expected at least {bound} item"),
    "maxItems": _at("has too many items; expected at most {bound}"),
    "minLength": _at("is empty; write a text"),
    "maxLength": _at("is {value}; expected at most {bound} letters"),
    "minProperties": _at("is empty; expected at least {bound} entry"),
    "maxProperties": _at("has several entries; expected one"),
    "anyOf": _no_bound,
}


def _complaints(document: LocatedToml, name: str) -> Iterator[Complaint]:
    if meets(document.values, schema(name)):
        return
    import jsonschema  # slow to load, and only a wrong file needs it

    validator = jsonschema.Draft202012Validator(schema(name))
    for error in validator.iter_errors(document.values):
        path: KeyPath = tuple(error.absolute_path)
        translate = _TRANSLATORS.get(error.validator)
        yield from translate(error, path) if translate else iter([(path, error.message)])


def validate(document: LocatedToml, name: str) -> None:
    """Raise `ProjectFileError` for the first wrong field; `detail` has others."""
    complaints = dict.fromkeys(islice(_complaints(document, name), _COMPLAINTS_MAX))
    found = [document.error(path, text) for path, text in complaints]
    # A mistyped name comes before the missing field that it leaves behind.
    found.sort(key=lambda error: (_UNKNOWN not in error.sentence, error.line, error.field))
    if found:
        first: ProjectFileError = found[0]
        first.detail = "\n".join(error.sentence for error in found[1:])
        raise first
