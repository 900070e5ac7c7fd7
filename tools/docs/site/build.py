# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The running bricks of the site: `python -m tools.docs.site.build FOLDER [BRICK ...]`.

Builds and analyses the image of every directive `brick`, runs it once natively, and writes one
folder for each beside the page of `ravenbrick view`. Places with the same image share the folder.
It needs no page of the documentation, so it can be done while those are built.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.brick.session import session_of
from ravenbrick.cli.view import page_files, project_files
from ravenbrick.image.design_script import DESIGN_SCRIPT
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.packed_files import with_scripts
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.timing.results.bounds_file import own_bounds

from tools.docs.lessons import ROOT, run_text
from tools.docs.site.bricks import EXAMPLES, PAGE_FOLDER, SHOWN_FOLDER, Shown, shown_on
from tools.docs.site.devices import device_files
from tools.docs.site.offline import WORKER

__all__ = ["all_shown", "build_site"]

PAGES = ROOT / "docs"
PROJECTS = ROOT / "build" / "site"
COMMAND = Path(sys.executable).parent / "ravenbrick"
AT_ONCE = 2
BOUNDS = "timing.json"


def all_shown(pages: Path = PAGES) -> list[Shown]:
    """The bricks of all pages, each once; raises `ValueError` as `shown_on`."""
    files = sorted(pages.rglob("*.md"))
    return list({shown.name: shown for page in files for shown in shown_on(page)}.values())


def project_of(shown: Shown) -> Path:
    """The folder of the project; that of a sheet is made by its steps."""
    if not shown.steps:
        return EXAMPLES / shown.example
    folder = PROJECTS / shown.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run_text(shown.steps, shown.name, folder)
    return folder / shown.project


def _ravenbrick(*words: object) -> subprocess.CompletedProcess[str]:
    command = [str(COMMAND), *map(str, words), "--json"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def prepare(folder: Path) -> None:
    """Build a project, with the figures of its design, which a project just copied lacks, and
    bound its response times. A program may have none: its sheet says so."""
    workspace = Workspace.of(folder)
    has_figures = workspace.design_file.is_file() or not (folder / DESIGN_SCRIPT).is_file()
    for word in ("build",) if has_figures else ("design", "build"):
        done = _ravenbrick(word, folder)
        if done.returncode != 0:
            raise RuntimeError(f"{folder}: {word} failed:\n{done.stdout}{done.stderr}")
    image = read_image(workspace.image("ram", read_robot(folder).name))
    if not own_bounds(workspace.results / BOUNDS, image):
        _ravenbrick("analyse", folder, "--no-margins")


def _session(
    robot: Robot, scenario: Scenario, image: ElfImage, shown: Shown, bounds: dict[str, int]
) -> dict[str, Any]:
    """The scenario as a run, which the page compares with the native one at its end."""
    locally = {
        "template": shown.template,
        "folder": f"examples/{shown.example}",
        "changed": bool(shown.steps),
    }
    session = session_of(robot, scenario, bounds_cycles=bounds) | {"locally": locally}
    if scenario.peer is not None or scenario.monitor is not None:
        return session
    recording = VirtualTarget().run(robot, scenario, image)
    until_cycles = recording.clock.cycles_of_ms(scenario.duration_ms)
    end = {"until_ms": scenario.duration_ms, "until_cycles": until_cycles}
    return session | end | {"digest": recording.digest}


def _write(files: dict[str, bytes], folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in with_scripts(files).items():
        atomic_write(folder / name, content)


def _write_brick(shown: Shown, folder: Path, site: Path) -> None:
    robot = read_robot(folder)
    workspace = Workspace.of(folder)
    image = read_image(workspace.image("ram", robot.name))
    scenario = read_scenario(scenario_path(folder, shown.scenario), robot)
    bounds = own_bounds(workspace.results / BOUNDS, image)
    files = project_files(workspace, _session(robot, scenario, image, shown, bounds), image)
    _write(files, site / SHOWN_FOLDER / shown.name)


def build_site(site: Path, bricks: Iterable[Shown]) -> None:
    """Write the page and the bricks, each into its folder of the site."""
    bricks = list(bricks)
    projects = [shown for shown in bricks if shown.device is None]
    folders = {shown.name: project_of(shown) for shown in projects}
    with ThreadPoolExecutor(AT_ONCE) as pool:
        list(pool.map(prepare, sorted(set(folders.values()))))
    shutil.rmtree(site / SHOWN_FOLDER, ignore_errors=True)
    for shown in projects:
        _write_brick(shown, folders[shown.name], site)
    for shown in bricks:
        if shown.device is not None:
            _write(device_files(shown.device), site / SHOWN_FOLDER / shown.name)
    page = {name: content for name, content in page_files().items() if name != WORKER}
    _write(page, site / PAGE_FOLDER)


def main(folder: str, *wanted: str) -> int:
    """Build the bricks with these names, those of all pages without names."""
    bricks = {shown.name: shown for shown in all_shown()}
    unknown = sorted(set(wanted) - set(bricks))
    if unknown:
        print(f"no page has the brick '{unknown[0]}'; there are {', '.join(bricks)}")
        return 1
    build_site(Path(folder), [bricks[name] for name in wanted or bricks])
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
