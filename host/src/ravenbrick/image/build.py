# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Build a project's image: controller, run-time library, compiler, binder and linker."""

from __future__ import annotations

import errno
import math
import os
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import BuildError, ProjectFileError, ToolMissingError, UsageError
from ravenbrick.image.build_errors import build_failure, disk_full, is_disk_full
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.design_script import DESIGN_SCRIPT, design_is_due, run_design
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.locks import locked
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.image.memory import MemoryReport, memory_report
from ravenbrick.image.object_folders import (
    COMPILED_WITH,
    archive_of,
    keep_objects,
    same_objects,
)
from ravenbrick.image.run_time import (
    COMPILER,
    run_time_library,
    run_time_sources,
    tool_identity,
)
from ravenbrick.image.tool_lines import tool_line
from ravenbrick.installation import advice_for_packages
from ravenbrick.project.robot import Robot
from ravenbrick.project.workspace import BuildKind, Workspace, tree
from ravenbrick.subprocesses import attended

__all__ = [
    "BUSY",
    "TOOLS",
    "Built",
    "Tool",
    "build_image",
    "choices_of",
    "clean_project",
    "current_image",
    "find_tool",
    "gprbuild_switches",
    "manifest_file",
]

PROJECT_FILE = "robot.gpr"
BUSY = "in this project"
LINKER = "arm-none-eabi-gcc"
# Choices that no object depends on.
LINKED_ONLY = ("name", "HEAP", "SUPERVISION")
_READ = re.compile(r'^(?:\s*adding source dir= |Parsing )"(.*)"$', re.MULTILINE)


@dataclass(frozen=True)
class Tool:
    """A program that building needs, and what it is for."""

    program: str
    purpose: str
    package: str


TOOLS = (
    Tool("make", "builds the run-time library", "make"),
    Tool("gprbuild", "finds what to compile, bind and link", "gprbuild"),
    Tool(COMPILER, "compiles Ada and C for the ARM7TDMI", "gnat-12-arm-linux-gnueabi"),
    Tool(LINKER, "links, with the ARMv4T support library", "gcc-arm-none-eabi"),
)


@dataclass(frozen=True)
class Built:
    """A checked image and its memory report; `changed` says whether anything was built for it."""

    image: ElfImage
    memory: MemoryReport
    memory_file: Path
    changed: bool = True


def find_tool(tool: Tool) -> str | None:
    """Path of the program, None when it is not installed."""
    return shutil.which(tool.program)


def require_tools() -> None:
    """Raise `ToolMissingError` naming each tool that is missing."""
    missing = [tool for tool in TOOLS if find_tool(tool) is None]
    if missing:
        names = ", ".join(f"'{tool.program}' ({tool.purpose})" for tool in missing)
        raise ToolMissingError(
            f"the toolchain is incomplete: {names} not found; "
            f"{advice_for_packages(tool.package for tool in missing)}"
        )


def manifest_file(elf: Path) -> Path:
    """The record of what an image was made from."""
    return elf.with_name("build-manifest.json")


def choices_of(workspace: Workspace, robot: Robot, settings: Settings) -> dict[str, Any]:
    """The choices that an image depends on besides the contents of files."""
    tools = " ".join(tool_identity(name) for name in (COMPILER, LINKER, "gprbuild"))
    where = {"project folder": str(workspace.project), "Ravenbrick tree": str(tree())}
    return {"name": robot.name, **where, **settings.record(), "compiler": tools}


def current_image(workspace: Workspace, robot: Robot, kind: BuildKind) -> ElfImage | None:
    """The image, if it is there and was made from the sources as they are now; otherwise None."""
    elf = workspace.image(kind, robot.name)
    manifest = BuildManifest.read(manifest_file(elf))
    if manifest is None or str(elf) not in manifest.files:
        return None
    settings = Settings.of(robot, debug=kind == "debug")
    if manifest.change(choices_of(workspace, robot, settings), manifest_file(elf)) is not None:
        return None
    return None if design_is_due(workspace, settings) else read_image(elf)


def gprbuild_switches(settings: Settings, run_time: Path, values: dict[str, str]) -> list[str]:
    """The command for gprbuild and gprclean in a project's folder, without their own name."""
    tools = tree() / "tools"
    values = {**settings.values(), **values, "RUN_TIME": str(run_time)}
    command = [f"--config={tools / 'ravenbrick.cgpr'}", "-P", PROJECT_FILE]
    command += [f"-X{name}={value}" for name, value in values.items()]
    return [*command, f"--implicit-with={tools / 'run_time.gpr'}"]


def _environment(run_time: Path, folder: Path) -> dict[str, str]:
    """The variables of gprbuild.

    `folder` gets a file with the folders of our project files, whose names may hold any character.
    """
    path_file = folder / "projects.txt"
    path_file.write_text(f"{tree() / 'tools'}\n{tree() / 'drivers'}\n", encoding="utf-8")
    environment = {k: v for k, v in os.environ.items() if k != "GPR_PROJECT_PATH"}
    environment |= {"GPR_PROJECT_PATH_FILE": str(path_file), "RAVENBRICK_RTS": str(run_time)}
    return environment | {"LC_ALL": "C.UTF-8"}


def _sources(
    call: list[str], project: Path, environment: dict[str, str]
) -> tuple[list[Path], list[Path]]:
    """Folders of sources and project files, as gprclean reads them; none where it cannot."""
    command = ["gprclean", "-n", "-vP1", *(o for o in call if not o.startswith("--implicit"))]
    done = subprocess.run(
        command, cwd=project, env=environment, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, encoding="utf-8", errors="surrogateescape", check=False,
    )  # fmt: skip
    found = [Path(name) for name in dict.fromkeys(_READ.findall(done.stdout))]
    return [p for p in found if p.is_dir()], [p for p in found if p.is_file()]


def _run(
    command: list[str], workspace: Workspace, environment: dict[str, str], log: Path, lock: int,
    show: Callable[[str], None] | None,
) -> tuple[int, str]:  # fmt: skip
    """Run gprbuild, its whole output in the log, each tool shown as it runs."""
    lines = []
    with (
        log.open("w", encoding="utf-8") as file,
        attended(subprocess.Popen(
            command, cwd=workspace.project, env=environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", errors="replace",
            pass_fds=(lock,),
        )) as process,
    ):  # fmt: skip
        assert process.stdout is not None
        for line in process.stdout:
            lines.append(line)
            file.write(line)
            shown = tool_line(line.rstrip("\n")) if show else None
            if show and shown:
                show(shown)
    return process.returncode, "".join(lines)


def _check_project(workspace: Workspace, settings: Settings) -> None:
    if not (workspace.project / PROJECT_FILE).is_file():
        raise ProjectFileError(
            workspace.project / PROJECT_FILE, 1, "", "is missing; a project needs it to be built"
        )
    for path in (workspace.project, workspace.products, tree(), settings.generated):
        if "\n" in str(path):
            raise UsageError(
                f"'{path}': the build tools do not accept a line break in a folder's name"
            )


@contextmanager
def _nothing_left_after_failure(elf: Path) -> Iterator[None]:
    for file in (manifest_file(elf), elf):
        file.unlink(missing_ok=True)
    try:
        yield
    except BaseException:
        elf.unlink(missing_ok=True)
        raise


def _date_back(folders: Iterable[Path], files: Iterable[str]) -> None:
    """Have gprbuild notice the next edit, which may come in the second of a compilation.

    It compares times in seconds: products are not newer than what was written last; while that
    second lasts, they are older, and the Ada units that were written in it are forgotten, as are
    the times of the objects in an archive.
    """
    written = max((os.stat(file).st_mtime for file in files if os.path.exists(file)), default=0.0)
    latest = math.floor(written)
    stamp = time.strftime("%Y%m%d%H%M%S", time.gmtime(latest)).encode()
    lasts = time.time() < latest + 1
    if lasts:
        latest -= 1
    for entry in (entry for folder in folders for entry in os.scandir(folder)):
        unit = entry.name.endswith(".ali") and lasts
        if entry.name.endswith(".deps") or (unit and stamp in Path(entry.path).read_bytes()):
            os.unlink(entry.path)
        elif entry.stat().st_mtime >= latest + 1:
            os.utime(entry.path, (latest, latest))


def _build(
    workspace: Workspace, robot: Robot, kind: BuildKind, lock: int,
    show: Callable[[str], None] | None,
) -> Built:  # fmt: skip
    settings = Settings.of(robot, debug=kind == "debug")
    _check_project(workspace, settings)
    elf, folder = workspace.image(kind, robot.name), workspace.build(kind)
    folder.mkdir(parents=True, exist_ok=True)
    choices = choices_of(workspace, robot, settings)
    compiled = {name: value for name, value in choices.items() if name not in LINKED_ONLY}
    apart = ("project folder", "GENERATED", "DEBUG")
    shared = {name: value for name, value in compiled.items() if name not in apart}
    with _nothing_left_after_failure(elf), tempfile.TemporaryDirectory() as private:
        run_time = run_time_library(settings)
        # Unoptimised code may be too large for the RAM.
        place = "flash" if settings.debug else kind
        values = {"IMAGE": place, "PROJECT": workspace.project.name, "ROBOT": robot.name}
        values["RAVENBRICK_BUILD"] = str(workspace.products)
        call = gprbuild_switches(settings, run_time, values)
        environment = _environment(run_time, Path(private))
        folders, files = _sources(call, workspace.project, environment)
        if "GENERATED" in os.environ and folders and settings.generated not in folders:
            raise BuildError(
                f"{PROJECT_FILE}: does not take the controller of GENERATED="
                f"{os.environ['GENERATED']}; write Application.Generated in its Source_Dirs"
            )
        archive = archive_of(settings, files) if files else None
        kernel_folders, kernel_files = run_time_sources(settings)
        files += [run_time / "adalib" / "libgnat.a", workspace.project / DESIGN_SCRIPT]
        manifest = BuildManifest.now(choices, folders + kernel_folders, files + kernel_files)
        command = ["gprbuild", "-k", f"-j{os.cpu_count() or 1}", *call]
        command += ["-cargs", "-v", "-cargs:Ada", "-gnatef", "-bargs", "-v", "-largs", "-v"]
        log = folder / "build.log"
        own = folder.parent / "objects" / settings.own_objects
        drivers = workspace.products / "drivers" / settings.objects
        switches = {path: f[1] for path, f in manifest.files.items() if path.endswith(".gpr")}
        compiled |= switches
        shared |= {p: f for p, f in switches.items() if not p.endswith(f"/{PROJECT_FILE}")}
        with same_objects(own, compiled), same_objects(drivers, shared, archive):
            code, output = _run(command, workspace, environment, log, lock, show)
            if is_disk_full(output):
                raise disk_full(folder)
            _date_back((own, drivers), manifest.files)
        if manifest.change(choices) is not None:  # edited meanwhile: all is compiled again
            for objects in (own, drivers):
                (objects / COMPILED_WITH).unlink()
        if code != 0:
            raise build_failure(workspace.project, kind, output, log)
        image = read_image(elf)
        keep_objects(drivers, archive)
        memory = memory_report(image, robot)
        memory.write(folder / "memory.json")
        if folders:
            manifest.add(elf)
            manifest.write(manifest_file(elf))
    return Built(image, memory, folder / "memory.json")


def _unchanged(workspace: Workspace, robot: Robot, kind: BuildKind) -> Built | None:
    image = current_image(workspace, robot, kind)
    if image is None:
        return None
    memory_file = workspace.build(kind) / "memory.json"
    return Built(image, memory_report(image, robot), memory_file, changed=False)


def build_image(
    workspace: Workspace,
    robot: Robot,
    kind: BuildKind,
    show: Callable[[str], None] | None = None,
) -> Built:
    """Build, check and measure an image, unless it is there and nothing has changed.

    `show` gets a line for each tool as it runs. Raises `ToolMissingError`, `BuildError`,
    `DesignError`, `ImageFileError`, `ProjectFileError` or `UsageError`; then there is no image.
    """
    built = _unchanged(workspace, robot, kind)
    if built is not None:
        return built
    require_tools()
    with locked(workspace.products, BUSY) as lock:
        built = _unchanged(workspace, robot, kind)
        if built is not None:
            return built
        if design_is_due(workspace, Settings.of(robot)):
            if show:
                show(f"  python    {DESIGN_SCRIPT} -> generated/")
            run_design(workspace)
        try:
            return _build(workspace, robot, kind, lock, show)
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT):
                raise disk_full(workspace.products) from None
            raise


def clean_project(workspace: Workspace) -> list[Path]:
    """Remove what was built for a project, its own objects of the drivers too; the folders."""
    folders = [workspace.products / workspace.project.name]
    if workspace.root == workspace.project:
        folders.append(workspace.products / "drivers")
    with locked(workspace.products, BUSY):
        for folder in folders:
            shutil.rmtree(folder, ignore_errors=True)
    return folders
