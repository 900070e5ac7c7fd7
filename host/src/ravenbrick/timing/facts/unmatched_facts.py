# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Facts that match nothing in the image: a misspelt name, a file or a line without code."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError
from ravenbrick.image.elf import ElfImage
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml
from ravenbrick.timing.bounds import answer_of
from ravenbrick.timing.facts.facts import Facts, annotations_of, has_unit, place_of

__all__ = ["check_annotation_file", "check_facts"]

REMEDY = "; correct it, or remove the fact"
# Tables of places by the name that the execution-time analysis has for them.
PLACES = {"loop": "loop", "call": "call", "never": "never", "outside": "avoided"}
PLACES |= {"recursion": "recursion"}
NAMING_ONE = ("suspension", "flow")


def _unmatched(elf: bytes, name: str, files: dict[str, str]) -> list[dict[str, Any]]:
    """Facts of annotation files, by their names, that match nothing in the image called `name`."""
    annotations = [{"name": file, "text": text, "own": True} for file, text in files.items()]
    return list(answer_of(elf, {"annotations": annotations}, name)["unmatched"])


def _files(document: LocatedToml) -> tuple[dict[str, str], dict[str, KeyPath]]:
    """Annotations of the document and of its modes, and where each of them begins there."""
    values = document.values
    stated = {name: rows for name, rows in values.items() if name in PLACES}
    tables = {PLACES[name]: [place_of(row) for row in rows] for name, rows in stated.items()}
    files: dict[str, str] = {"": annotations_of(tables)}
    places: dict[str, KeyPath] = {"": ()}
    for index, mode in enumerate(values.get("mode", [])):
        name = f"mode {index}"
        tables = {key: mode[key] for key in ("never", "loop") if key in mode}
        files[name], places[name] = annotations_of(tables), ("mode", index)
    return files, places


def check_facts(facts: Facts, image: ElfImage) -> None:
    """Raise `ProjectFileError` for the first fact of the project's own file that matches nothing:
    functions, source lines, library units and handlers that the image does not have."""
    document = facts.document
    if document is None:
        return
    files, places = _files(document)
    own_names = {known: own for own, known in PLACES.items()}
    for found in _unmatched(image.content, str(image.path), files):
        place = (*places[found["file"]], own_names[found["table"]], found["index"], found["field"])
        raise document.error(place, found["reason"] + REMEDY)
    _check_names(document, image)
    _check_turns(facts, document)


def _check_turns(facts: Facts, document: LocatedToml) -> None:
    """Jobs in turn, of which nothing follows for a task without kinds or a common release."""
    kinds = {kind.task.lower() for kind in facts.kinds}
    for index, row in enumerate(document.values.get("jobs_in_turn", [])):
        task = row["task"]
        if task.lower() not in kinds:
            problem = f"no [[job_kind]] is of '{task}', so the turns of its jobs have no effect"
        elif facts.in_turn(task) is None:
            problem = f"'{task}' has no [[common_release]], so its first job is not known"
        else:
            continue
        raise document.error(("jobs_in_turn", index, "task"), problem + REMEDY)


def _functions(document: LocatedToml) -> Iterator[tuple[KeyPath, str]]:
    """Functions that such tables name, with where."""

    def rows(table: str) -> Iterator[tuple[int, Any]]:
        yield from enumerate(document.values.get(table, []))

    for table in NAMING_ONE:
        for index, row in rows(table):
            if "symbol" in row:
                yield (table, index, "symbol"), row["symbol"]
    for index, row in rows("job_kind"):
        for place, name in enumerate(row.get("never", [])):
            yield ("job_kind", index, "never", place), name
    for index, row in rows("jobs_in_turn"):
        for turn, names in enumerate(row["never"]):
            for place, name in enumerate(names):
                yield ("jobs_in_turn", index, "never", turn, place), name


def _check_names(document: LocatedToml, image: ElfImage) -> None:
    """Names in tables that are no annotations of code."""
    for place, name in _functions(document):
        if name not in image.symbols:
            raise document.error(place, f"the image has no function '{name}'{REMEDY}")
    for table in ("interrupt", "transfer"):
        for index, row in enumerate(document.values.get(table, [])):
            if "unit" in row and not has_unit(image, row["unit"]):
                problem = f"the image has no library unit '{row['unit']}'{REMEDY}"
                raise document.error((table, index, "unit"), problem)


def check_annotation_file(path: Path, text: str, elf: bytes, name: str) -> None:
    """Raise `ProjectFileError` for the first fact of an annotation file that matches nothing in the
    image, which is called `name`; otherwise as `answer_of`."""
    for found in _unmatched(elf, name, {str(path): text}):
        line = _line(text, found["table"], found["index"])
        field = f"{found['table']}[{found['index']}].{found['field']}"
        raise ProjectFileError(path, line, field, found["reason"] + REMEDY)


def _line(text: str, table: str, index: int) -> int:
    """Line of the head of a table, the first for one that is written otherwise."""
    heads = [n for n, line in enumerate(text.splitlines(), 1) if line.strip() == f"[[{table}]]"]
    return heads[index] if index < len(heads) else 1
