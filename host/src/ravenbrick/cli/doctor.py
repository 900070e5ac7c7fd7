# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick doctor`: check of the tools and modules that the other commands need."""

from __future__ import annotations

import importlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from ravenbrick import __version__
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import ConnectionFailedError, ToolMissingError
from ravenbrick.grading.isolation import IsolationError, find_isolation
from ravenbrick.hardware.upload import LOADERS, brick_to_load
from ravenbrick.hardware.usb_bricks import find_bricks
from ravenbrick.image import build
from ravenbrick.image.build import Tool, find_tool
from ravenbrick.installation import PACKAGE, advice_for_packages, advice_for_python, in_checkout
from ravenbrick.project.workspace import tree
from ravenbrick.sources import brick_digest

__all__ = ["Check", "doctor_command"]

GNAT = "arm-linux-gnueabi-gcc-12"
LINKER = "arm-none-eabi-gcc"
C_LIBRARY = "libnewlib-arm-none-eabi"
GDB = Tool("gdb-multiarch", "debugs a program of the brick", "gdb-multiarch")
MODULE = "virtual_brick"
TIMEOUT_S = 60
ADA = "package Probe is\n   Answer : Integer := 42;\nend Probe;\n"
C = "float probe (float x) { return __builtin_sinf (x); }\n"
PROJECT = 'project Probe is for Languages use ("Ada", "C"); for Source_Files use (); end Probe;\n'
ELF_MACHINE, ARM = slice(18, 20), b"\x28\x00"


@dataclass(frozen=True)
class Check:
    """One thing that was looked for; `found` is its version or place, or why it does not do.

    `package` is the Debian package that brings it.
    """

    name: str
    ok: bool
    found: str
    package: str = ""


class _UnfitError(Exception):
    """A tool that is there does not work."""


def _answer(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        arguments, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    if done.returncode != 0:
        lines = [line for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        raise _UnfitError(lines[-1] if lines else f"ends with {done.returncode}")
    return done.stdout.strip()


def _gnat(folder: Path) -> str:
    (folder / "probe.ads").write_text(ADA)
    _answer(folder, GNAT, "-c", "-mcpu=arm7tdmi", "probe.ads")
    version = _answer(folder, GNAT, "-dumpfullversion")
    target = _answer(folder, GNAT, "-dumpmachine")
    machine = (folder / "probe.o").read_bytes()[ELF_MACHINE]
    if machine != ARM or not version.startswith("12."):
        raise _UnfitError(f"is GNAT {version} for {target}; it must be GNAT 12 for ARM")
    return f"GNAT {version} for {target}"


def _gprbuild(folder: Path) -> str:
    (folder / "probe.gpr").write_text(PROJECT)
    configuration = tree() / "tools" / "ravenbrick.cgpr"
    _answer(folder, "gprbuild", "-q", f"--config={configuration}", "-P", "probe.gpr")
    return _version(folder, "gprbuild")


def _version(folder: Path, program: str) -> str:
    return _answer(folder, program, "--version").split("\n")[0]


def _linker(folder: Path) -> str:
    return f"GCC {_answer(folder, LINKER, '-dumpfullversion')}"


def _c_library(folder: Path) -> str:
    (folder / "probe.c").write_text(C)
    _answer(folder, LINKER, "-mcpu=arm7tdmi", "-nostartfiles", "probe.c", "-lm", "-o", "probe.elf")
    return "links"


PROBES: dict[str, Callable[[Path], str]] = {
    GNAT: _gnat,
    "gprbuild": _gprbuild,
    LINKER: _linker,
}


def _checked(name: str, package: str, probe: Callable[[Path], str]) -> Check:
    """Try something in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return Check(name, True, probe(Path(folder)))
        except _UnfitError as error:
            return Check(name, False, f"does not work: {error}", package)
        except (OSError, subprocess.TimeoutExpired) as error:
            return Check(name, False, f"does not start ({type(error).__name__})", package)


def _tool(tool: Tool) -> Check:
    if find_tool(tool) is None:
        return Check(tool.program, False, f"missing ({tool.purpose})", tool.package)
    probe = PROBES.get(tool.program, lambda folder: _version(folder, tool.program))
    return _checked(tool.program, tool.package, probe)


def _tools() -> list[Check]:
    checks = [_tool(tool) for tool in (*build.TOOLS, GDB)]
    library = "C library of the brick"
    if shutil.which(LINKER) is None:
        return [*checks, Check(library, False, f"not tried without {LINKER}", C_LIBRARY)]
    return [*checks, _checked(library, C_LIBRARY, _c_library)]


def _module() -> Check:
    """The compiled virtual brick: does it load, and was it built from this version's sources?"""
    name = f"Python module {MODULE}"
    try:
        module = importlib.import_module(MODULE)
    except ImportError as error:
        return Check(name, False, f"does not load: {error}")
    if getattr(module, "__version__", "") != __version__ or (
        in_checkout() and module.SOURCES != brick_digest(tree())
    ):
        return Check(name, False, "was not built from the sources of this version")
    return Check(name, True, f"{__version__}, {'with' if module.JIT else 'without'} JIT code")


def _requirement(requirement: str) -> Check:
    """A Python package that this version needs; pip has compared the versions."""
    name = re.split(r"[^\w.-]", requirement, maxsplit=1)[0]
    try:
        return Check(f"Python package {name}", True, metadata.version(name))
    except metadata.PackageNotFoundError:
        return Check(f"Python package {name}", False, f"missing ({requirement})")


def _requirements() -> list[str]:
    """The packages that this version names; a checkout has no description of itself."""
    manifest = PACKAGE.parents[1] / "pyproject.toml"
    if manifest.is_file():
        requirements: list[str] = tomllib.loads(manifest.read_text())["project"]["dependencies"]
        return requirements
    return [
        requirement
        for requirement in metadata.requires("ravenbrick") or ()
        if "extra ==" not in requirement
    ]


def _checks() -> list[Check]:
    python = Check("Python", sys.version_info >= (3, 11), sys.version.split()[0])
    return [python, *_tools(), *map(_requirement, _requirements()), _module()]


def _grading() -> Check:
    """Whether submissions can be isolated; only `grade` needs it, and can be told to go without."""
    try:
        return Check("isolation of submissions", True, find_isolation().name)
    except IsolationError as error:
        return Check("isolation of submissions", False, error.sentence)


def _connection() -> list[Check]:
    """What a real brick needs; nothing of it is needed for the virtual one."""
    loaders = [_loader(tool) for tool in LOADERS.values()]
    bricks = find_bricks()
    on_bus = [Check(f"brick {b.node}", b.usable, b.mode.words) for b in bricks]
    try:
        brick_to_load(bricks)
        ready = Check("upload", all(loader.ok for loader in loaders), "possible")
    except ConnectionFailedError as error:
        ready = Check("upload", False, error.sentence)
    return [*loaders, *on_bus, ready]


def _loader(tool: Tool) -> Check:
    place = find_tool(tool)
    advice = f"missing ({tool.purpose}); Debian package {tool.package}"
    return Check(tool.program, place is not None, place or advice)


def _refuse(failed: list[Check]) -> None:
    """Say in one sentence what is missing and what to do; nothing when nothing is."""
    if not failed:
        return
    packages = [check.package for check in failed if check.package]
    advice = [advice_for_packages(packages)] if packages else []
    if any(check.name.startswith("Python") for check in failed):
        advice.append(advice_for_python())
    raise ToolMissingError(
        f"missing: {', '.join(check.name for check in failed)}; {', and '.join(advice)}",
        detail="\n".join(f"{check.name}: {check.found}" for check in failed),
    )


@command("ravenbrick doctor")
def doctor_command(json_output: JsonOption = False) -> dict[str, Any]:
    reporter = Reporter(json_output)
    checks = _checks()
    reporter.table(
        ("component", "state", "found"),
        [[check.name, "ok" if check.ok else "MISSING", check.found] for check in checks],
        left=("state", "found"),
    )
    grading, connection = _grading(), _connection()
    for title, optional in (("grading", [grading]), ("a real brick", connection)):
        reporter.print(f"\nFor {title}:")
        reporter.table(
            ("component", "state", "found"),
            [[check.name, "ok" if check.ok else "no", check.found] for check in optional],
            left=("state", "found"),
        )
    _refuse([check for check in checks if not check.ok])
    return {
        "checks": [asdict(check) for check in checks],
        "grading": asdict(grading),
        "connection": [asdict(check) for check in connection],
    }
