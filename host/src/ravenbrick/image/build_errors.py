# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The first error of a build as a sentence, the further ones as its detail."""

from __future__ import annotations

import re
from pathlib import Path

from ravenbrick.errors import BuildError, ImageFileError, shown_path
from ravenbrick.project.workspace import BuildKind

__all__ = [
    "build_failure",
    "disk_full",
    "errors_in",
    "is_disk_full",
    "overflow_in",
    "with_stable_names",
]

# Compilers and project files: "file:line:column: [error:] sentence", never a warning or a remark.
_AT = re.compile(
    r"^(?P<place>\S.*?:\d+(?::\d+)?): "
    r"(?P<kind>(?:fatal |internal compiler )?[Ee]rror: )?(?P<text>.+)$"
)
_REMARK = re.compile(r"(warning|note|info|\(style\)|in function)\b|undefined reference")
_UNDEFINED = re.compile(
    r"^(?:\S*/ld: )?(?P<place>.*?)(?::\(\S+\))?: undefined reference to `(?P<name>.+)'$"
)
_DOUBLED = re.compile(r"multiple definition of `(.+?)';")
_NO_BODY = re.compile(r"^cannot generate code for file (\S+) \(")
_CIRCULAR = re.compile(r"^info: +((?:unit|change|remove) .+)$")
_PLAIN = re.compile(r"^(?:gnatbind: |gprbuild: )?(?:fatal )?error[:,] (.+)$")
_OVERFLOW = re.compile(r"region `(\w+)' overflowed by (\d+) bytes?")
_NO_SPACE = re.compile(r"No space left on device|Disk quota exceeded")
_ASSEMBLY = re.compile(r"\S*\bcc\w{6}\.s(?=:)")
_HEAP = "ravenbrick_heap_size"
DETAIL_LINES = 5


def _shown_place(place: str, project: Path) -> str:
    name, _, rest = place.partition(":")
    file = Path(name) if Path(name).is_absolute() else project / name
    return f"{shown_path(file)}:{rest}" if file.exists() else place


def _undefined(found: re.Match[str], project: Path) -> str:
    if found["name"] == _HEAP:
        return (
            "the program needs a heap, for 'new' or for a function that returns a limited object, "
            "and has none: use variables, name NXT.Malloc for a heap of no bytes, or give a size "
            "in bytes, such as HEAP=4096 before the command"
        )
    place, name = _shown_place(found["place"], project), found["name"]
    return f"{place}: undefined reference to '{name}'; no source and no library defines it"


def with_stable_names(output: str) -> str:
    """The output without the names that the compiler draws for files between it and assembler."""
    return _ASSEMBLY.sub("(assembler)", output)


def errors_in(output: str, project: Path) -> list[str]:
    """The errors in the output of gprbuild and its tools, each a line; places as a user types them.

    Lines of one message at one place are joined.
    """
    found: dict[str, str] = {}
    for line in with_stable_names(output).splitlines():
        if undefined := _UNDEFINED.match(line):
            found.setdefault(undefined["name"], _undefined(undefined, project))
        elif doubled := _DOUBLED.search(line):
            name = doubled[1]
            found.setdefault(name, f"'{name}' is defined twice; choose another name")
        elif (at := _AT.match(line)) and not _REMARK.match(at["text"]):
            if at["kind"] or re.search(r"\.c?gpr:\d+:\d+$", at["place"]):
                place = _shown_place(at["place"], project)
                before = found.get(place)
                found[place] = f"{before}; {at['text']}" if before else f"{place}: {at['text']}"
        elif body := _NO_BODY.match(line):
            spec = Path(body[1])
            text = f"{spec.name}: this package needs a body, and there is no {spec.stem}.adb"
            found.setdefault(line, text)
        elif plain := _PLAIN.match(line):
            found.setdefault(line, plain[1])
        elif found and (circular := _CIRCULAR.match(line)):
            found.setdefault(line, circular[1])
    return list(found.values())


def is_disk_full(output: str) -> bool:
    """Whether one of the tools says so."""
    return _NO_SPACE.search(output) is not None


def disk_full(folder: Path) -> BuildError:
    """The error for a disk that is full while this folder is written."""
    return BuildError(
        f"{shown_path(folder)}: the disk is full; free some space there and in the folder for "
        "temporary files, and build again"
    )


def overflow_in(output: str, kind: BuildKind) -> str:
    """By how much an image is too large for its memory; "" where it is not."""
    overflow = _OVERFLOW.search(output)
    if not overflow:
        return ""
    memory = "flash" if kind != "ram" and overflow[1] == "CODE" else "RAM"
    return (
        f"the {kind} image is {overflow[2]} bytes too large for the {memory}; "
        "shorten stacks or code"
    )


def build_failure(
    project: Path, kind: BuildKind, output: str, log: Path
) -> BuildError | ImageFileError:
    """The error for a build of a project that failed with this output, which is in the log too."""
    whole = f"whole output: {shown_path(log)}"
    if overflow := overflow_in(output, kind):
        advice = ", or build a flash image with '--image flash'" if kind == "ram" else ""
        return ImageFileError(f"{project.name}: {overflow}{advice}", detail=whole)
    errors = errors_in(output, project)
    if not errors:
        lines = [line for line in output.splitlines() if line.strip()]
        return BuildError(
            f"{project.name} could not be built, for no reason that the tools name",
            detail="\n".join([*lines[-DETAIL_LINES:], whole]),
        )
    more = [f"and {len(errors) - 1 - DETAIL_LINES} further errors"]
    further = errors[1:] if len(errors) <= 1 + DETAIL_LINES else errors[1 : 1 + DETAIL_LINES] + more
    error = BuildError(errors[0], detail="\n".join([*further, whole]))
    error.data = {"errors": errors}
    return error
