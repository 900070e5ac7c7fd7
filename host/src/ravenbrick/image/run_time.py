# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The run-time library of a build, built when it is missing or its sources have changed."""

from __future__ import annotations

import hashlib
import os
import shutil
from pathlib import Path
from typing import Any

from ravenbrick.errors import BuildError, UsageError, shown_path
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.locks import locked
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.project.workspace import run_time_folder, tree
from ravenbrick.subprocesses import run_child

__all__ = ["COMPILER", "run_time_home", "run_time_library", "run_time_sources", "tool_identity"]

COMPILER = "arm-linux-gnueabi-gcc-12"
FOLDERS = ("kernel", "kernel/plain", "kernel/timed", "language", "arm7tdmi", "at91sam7s", "jorvik")
STATES = ("arm7tdmi/arm", "arm7tdmi/thumb", "arm7tdmi/timed", "jorvik/fifo", "jorvik/priority")


def tool_identity(program: str) -> str:
    """Path, size and time of an installed program; another version has others."""
    path = shutil.which(program)
    if path is None:
        return "missing"
    found = os.stat(path)
    return f"{os.path.realpath(path)} {found.st_size} {found.st_mtime_ns}"


def run_time_sources(settings: Settings) -> tuple[list[Path], list[Path]]:
    """Folders and files that the library is built from; none for one that is taken as it is."""
    if settings.run_time is not None:
        return [], []
    root, folder = tree(), tree() / "runtime"
    files = [folder / "Makefile", folder / "taken-units.txt", root / "tools" / "toolchain.mk"]
    return [folder / name for name in (*FOLDERS, *STATES)], files


def _choices(settings: Settings) -> dict[str, Any]:
    return {"library": settings.library, "compiler": tool_identity(COMPILER)}


def _digest() -> str:
    """Digest of the run-time's sources and the compiler, for the cache."""
    root = tree() / "runtime"
    whole = hashlib.sha256(tool_identity(COMPILER).encode())
    for path in sorted(root.rglob("*")):
        if path.is_file() and path.relative_to(root).parts[0] != "tests":
            whole.update(f"{path.relative_to(root)}\n".encode())
            whole.update(path.read_bytes())
    return whole.hexdigest()[:16]


def run_time_home() -> Path:
    """Folder of the run-time libraries that this tree builds; raises `UsageError`."""
    return run_time_folder(_digest)


def run_time_library(settings: Settings) -> Path:
    """Folder of the library, current; raises `BuildError` and `UsageError`."""
    if settings.run_time is not None:
        if not (settings.run_time / "adalib" / "libgnat.a").is_file():
            raise UsageError(
                f"RAVENBRICK_RTS={settings.run_time}: there is no run-time library (no "
                "adalib/libgnat.a in it); name the folder of one, or unset it"
            )
        return settings.run_time
    folder = run_time_home()
    library, record = folder / settings.library, folder / f"{settings.library}.json"
    with locked(folder, "that builds the run-time library") as lock:
        manifest = BuildManifest.read(record)
        if manifest is None or manifest.change(_choices(settings), record) is not None:
            manifest = BuildManifest.now(_choices(settings), *run_time_sources(settings))
            _make(folder, settings, lock)
            manifest.add(library / "adalib" / "libgnat.a")
            manifest.write(record)
    return library


def _make(folder: Path, settings: Settings, lock: int) -> None:
    """Build the library by the run-time's Makefile, through a link whose name make can read."""
    sources, link = tree() / "runtime", folder / "sources"
    if not link.is_symlink() or Path(os.readlink(link)) != sources:
        link.unlink(missing_ok=True)
        link.symlink_to(sources, target_is_directory=True)
    command = ["make", "-C", str(folder), "-f", "sources/Makefile", f"-j{os.cpu_count() or 1}"]
    command += ["SOURCES=sources", "BUILD=.", f"PROFILE={settings.profile}"]
    command += [f"CODE={settings.runtime_code}", f"QUEUING={settings.queuing}"]
    command += [f"EXECUTION_TIME={'yes' if settings.execution_time else 'no'}", "library"]
    # What a make above this one says to those below is not for this one.
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS")}
    done = run_child(command, env=environment | {"LC_ALL": "C"}, pass_fds=(lock,))
    if done.returncode != 0:
        lines = done.stdout.strip().splitlines()
        wrong = [line for line in lines if "error" in line or "No space" in line] or ["make failed"]
        raise BuildError(
            f"the run-time library in {shown_path(folder)} could not be built: {wrong[0]}",
            detail="\n".join(lines[-10:]),
        )
