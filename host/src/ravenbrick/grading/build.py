# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The image of a submission, compiled and linked in the sandbox from objects of the reference.

What decides is what the compiler recorded, not what the sources look like: the linker options in
the ALI files, and the symbols of the objects.
"""

from __future__ import annotations

import functools
import hashlib
import io
import re
import sys
import tarfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import UsageError
from ravenbrick.grading.isolation import Bounds, Isolation
from ravenbrick.grading.rubric import Rubric
from ravenbrick.grading.sandbox import Outcome, run_isolated
from ravenbrick.grading.submission import DESIGN, SubmissionError, accepted_source
from ravenbrick.image.build import gprbuild_switches
from ravenbrick.image.build_errors import errors_in, overflow_in, with_stable_names
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.run_time import run_time_library
from ravenbrick.project.robot import ROBOT_FILE
from ravenbrick.project.workspace import PACKAGE, tree

__all__ = ["ELF", "build_image", "design_files", "prepare_base", "python_parts"]

ELF = "image.elf"
# Sources that differ from the reference project's get an instant that none of those has, so that
# gprbuild, which compares instants, compiles just them and what depends on them.
CHANGED_S = 1_000_000_000
REFUSED = "not linked:"
SAID = 400
LINES = 8
LINE_MAX = 1_000
FILE_MAX = 16 << 20
# What of the drivers a build reads, and of our project files.
DRIVERS = ("drivers.gpr", "src", "generated", "configuration")
TOOLS = ("application.gpr", "run_time.gpr", "ravenbrick.cgpr")
BUILD = r"""
set -eu
base=$1 parts=$2 results=$3; shift 3
mkdir build && tar -x
[ -z "$base" ] || tar -x -C build -f "$base" $parts
export PATH="$PWD/linker:$PATH" GPR_PROJECT_PATH_FILE="$PWD/projects.txt"
export RAVENBRICK_BUILD="$PWD/build"
cd project
gprbuild -q "$@" >&2
exec tar -c -C ../build $results
"""
# gprbuild finds this first, and calls it in the folder of the objects. Nothing of the submission
# has run before it, so what the compiler left can be trusted.
LINKER = "linker/arm-none-eabi-gcc"
CHECKED_LINK = rf"""#!/bin/sh
refused() {{ echo "{REFUSED} $1" >&2; exit 1; }}
found=$(grep -m 1 '^L ' *.ali) && refused "$found"
found=$(ls *.o | grep -v '^b__' | xargs arm-none-eabi-nm -A --defined-only |
    grep -m 1 -E ' (ravenbrick_|(system|ada|interfaces|gnat)__)') && refused "$found"
PATH=${{PATH#*:}} exec arm-none-eabi-gcc "$@"
"""
DESIGN_SCRIPT = r"""
set -eu
python=$1; shift
tar -x
cd project
"$python" design.py >&2
mkdir -p generated
exec tar -c generated
"""


@dataclass(frozen=True)
class _Project:
    """Files of a project by their names, with the instants that gprbuild compares."""

    files: Mapping[str, tuple[bytes, float]]

    def archive(self, others: Mapping[str, bytes]) -> bytes:
        """An archive with the files below project/, and others beside it."""
        stream = io.BytesIO()
        with tarfile.open(fileobj=stream, mode="w") as archive:
            for name, (content, instant) in self.files.items():
                _add(archive, f"project/{name}", content, instant)
            for name, content in others.items():
                _add(archive, name, content, 0, 0o755)
        return stream.getvalue()


def _add(
    archive: tarfile.TarFile, name: str, content: bytes, instant: float, mode: int = 0o644
) -> None:
    member = tarfile.TarInfo(name)
    member.mode = mode
    member.size, member.mtime = len(content), int(instant)
    archive.addfile(member, io.BytesIO(content))


def _reference(rubric: Rubric) -> dict[str, tuple[bytes, float]]:
    """What a build reads of the reference project: no scenarios, no tests, no notes."""
    names = [name for name in ("robot.gpr", "robot.toml") if (rubric.project / name).is_file()]
    files = [rubric.project / name for name in names]
    for folder in rubric.folders:
        files += sorted(p for p in (rubric.project / folder).glob("*") if p.is_file())
    return {
        file.relative_to(rubric.project).as_posix(): (file.read_bytes(), file.stat().st_mtime)
        for file in files
    }


def _laid_out(rubric: Rubric, sources: Mapping[str, bytes]) -> tuple[_Project, bool]:
    """The reference project with the submission's sources; whether all its own are still there."""
    files = _reference(rubric)
    own = [name for name in files if "/" in name]
    gone = [n for n in own if n.rpartition("/")[2] not in rubric.keep and n not in sources]
    for name in gone:
        del files[name]
    for name, text in sources.items():
        if name.rpartition("/")[2] in rubric.keep or "/" not in name:
            continue
        if name not in files or files[name][0] != text:
            files[name] = (text, CHANGED_S)
    return _Project(files), not gone


def _build_parts(settings: Settings, library: Path) -> list[Path]:
    root = tree()
    parts = [root / "tools" / name for name in TOOLS] + [root / "drivers" / n for n in DRIVERS]
    parts += [path.resolve() for path in (library, settings.configuration) if path is not None]
    return [path for path in parts if path.exists()]


@functools.cache
def _library(settings: Settings) -> Path:
    """The run-time library, looked at once by each worker."""
    return run_time_library(settings)


def _gprbuild(
    isolation: Isolation, rubric: Rubric, project: _Project, base: Path | None, parts: str,
    results: str,
) -> Outcome:  # fmt: skip
    """Build in the sandbox; what the environment asks for is not for graders."""
    settings = Settings.of(rubric.robot, {})
    library = _library(settings)
    values = {"IMAGE": "ram", "PROJECT": "project", "ROBOT": rubric.robot.name}
    switches = gprbuild_switches(settings, library, values | {"GENERATED": "generated"})
    folders = f"{tree() / 'tools'}\n{tree() / 'drivers'}\n"
    others = {"projects.txt": folders.encode(), LINKER: CHECKED_LINK.encode()}
    words = [str(base or ""), parts, results, *switches]
    words += ["-cargs:Ada", "-gnatef"]
    limits = rubric.limits
    return run_isolated(
        isolation,
        ["sh", "-c", BUILD, "build", *words],
        Bounds(limits.build_seconds, limits.memory_mb, limits.file_mb),
        content=project.archive(others),
        readable=[*_build_parts(settings, library), *([base] if base else [])],
        variables={"LC_ALL": "C.UTF-8", "RAVENBRICK_RTS": str(library)},
    )


def prepare_base(isolation: Isolation, rubric: Rubric, cache: Path) -> Path:
    """Objects of the reference project and its drivers, built once; raises `UsageError`."""
    base = cache / "base" / f"{rubric.digest[:24]}.tar"
    if base.is_file():
        return base.resolve()
    project = _Project(_reference(rubric))
    outcome = _gprbuild(isolation, rubric, project, None, "", "drivers project/objects")
    if outcome.code != 0:
        said = outcome.output.strip()[-SAID:]
        raise UsageError(f"the reference project {rubric.project} does not build: {said}")
    atomic_write(base, outcome.result)
    return base.resolve()


def _files_of(result: bytes) -> dict[str, bytes]:
    """Regular files of an archive that may be anybody's; raises `SubmissionError`."""
    found: dict[str, bytes] = {}
    try:
        with tarfile.open(fileobj=io.BytesIO(result), mode="r:") as archive:
            for member in archive:
                if member.isreg() and member.size <= FILE_MAX:
                    stream = archive.extractfile(member)
                    found[member.name] = stream.read() if stream else b""
    except (tarfile.TarError, ValueError, OSError) as error:
        raise SubmissionError(f"the build left no readable result ({error})") from None
    return found


def python_parts() -> list[Path]:
    """What Python needs to run this package, but for the tree."""
    parts = {Path(sys.prefix), Path(sys.base_prefix), PACKAGE, tree() / "catalogue"}
    parts.add(tree() / "tools" / "ravenbrick.cgpr")
    # A .pth file may have named folders that are none of this Python.
    parts |= {_folder_with("numpy"), _folder_with("virtual_brick")}
    return [path for path in parts if path.exists()]


def _folder_with(module: str) -> Path:
    found = find_spec(module)
    assert found is not None and found.origin is not None
    return Path((found.submodule_search_locations or [found.origin])[0]).resolve().parent


def design_files(
    isolation: Isolation, rubric: Rubric, files: Mapping[str, bytes]
) -> dict[str, bytes]:
    """The sources with what the submission's design.py generates; raises `SubmissionError`."""
    if DESIGN not in files:
        return dict(files)
    project, _complete = _laid_out(rubric, files)
    own = {ROBOT_FILE: (rubric.robot_text, 0.0)} if rubric.robot_text is not None else {}
    whole = _Project({**project.files, **own, DESIGN: (files[DESIGN], 0)})
    limits = rubric.limits
    outcome = run_isolated(
        isolation,
        ["sh", "-c", DESIGN_SCRIPT, "design", sys.executable],
        Bounds(limits.design_seconds, limits.memory_mb, limits.file_mb),
        content=whole.archive({}),
        readable=python_parts(),
        hidden=[tree()],
        variables={"PYTHONDONTWRITEBYTECODE": "1"},
    )
    _refuse_excess(outcome, f"{DESIGN} took more than {limits.design_seconds} s of processor time")
    if outcome.code != 0:
        raise SubmissionError(f"{DESIGN} failed: {outcome.output.strip()[-SAID:]}")
    made = {
        n: t for n, t in _files_of(outcome.result).items() if accepted_source(n, ("generated",))
    }
    return {**files, **made}


def _refuse_excess(outcome: Outcome, late: str) -> None:
    if outcome.full:
        raise SubmissionError("No space: it wrote more into files than it may")
    if outcome.flooded:
        raise SubmissionError("its messages never end, so it was stopped")
    if outcome.timed_out:
        raise SubmissionError(late)


def build_image(
    isolation: Isolation, rubric: Rubric, sources: Mapping[str, bytes], cache: Path
) -> Path:
    """The image's file in the cache; raises `SubmissionError`."""
    content = "".join(
        f"{name} {hashlib.sha256(text).hexdigest()}\n" for name, text in sorted(sources.items())
    )
    key = hashlib.sha256(f"{rubric.digest}\n{content}".encode("utf-8", "replace")).hexdigest()
    kept = cache / "images" / key / ELF
    failure = kept.with_name("failure.txt")
    if kept.is_file():
        return kept
    if failure.is_file():
        raise SubmissionError(failure.read_text("utf-8"))
    base = prepare_base(isolation, rubric, cache)
    project, complete = _laid_out(rubric, sources)
    elf = f"project/ram/{rubric.robot.name}.elf"
    parts = "drivers project/objects" if complete else "drivers"
    outcome = _gprbuild(isolation, rubric, project, base, parts, elf)
    try:
        _refuse_excess(
            outcome, f"the build took more than {rubric.limits.build_seconds} s of processor time"
        )
        if outcome.code != 0:
            raise SubmissionError(_why(outcome))
        files = _files_of(outcome.result)
        if elf not in files:
            raise SubmissionError("the build left no image")
    except SubmissionError as error:
        atomic_write(failure, str(error).encode("utf-8", "replace"))
        raise
    atomic_write(kept, files[elf])
    return kept


def _why(outcome: Outcome) -> str:
    # What looks for names takes time by the square of a line.
    lines = (line[:LINE_MAX] for line in outcome.output.splitlines())
    said = with_stable_names(re.sub(r"\S*/project/", "", "\n".join(lines))).strip()
    said = said.replace(f"{tree()}/", "")
    refused = [line for line in said.splitlines() if line.startswith(REFUSED)]
    if not refused:
        errors = "\n".join(errors_in(said, Path("/nowhere"))[:LINES])
        return overflow_in(said, "ram") or errors or said[-SAID:]
    unit, mark, option = refused[-1].removeprefix(REFUSED).strip().partition(":L ")
    if mark:
        return f"{Path(unit).stem}: the linker option {option} is not allowed in a submission"
    return f"defines {unit.split()[-1]}, a name of the run-time; choose another name"
