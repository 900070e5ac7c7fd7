# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One run, three builds of the virtual brick: the same trace digest."""

from __future__ import annotations

import json
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from verification.support.projects import VEHICLE

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.brick.session import session_of
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace

ROOT = VEHICLE.parent.parent
ELF = Workspace.of(VEHICLE).image("ram", "vehicle")
CRATES = ROOT / "virtual-brick"
PAGE = ROOT / "host" / "src" / "ravenbrick" / "page.zip"
SCENARIOS = ("drive", "step")

pytestmark = pytest.mark.skipif(
    not ELF.is_file(), reason="the vehicle is not built; 'ravenbrick build' builds it"
)


@pytest.fixture(params=SCENARIOS)
def run(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, str]:
    """A run file of a whole scenario, and the digest that the Python module gives it."""
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, request.param), robot)
    recording = VirtualTarget().run(robot, scenario, read_image(ELF))
    ended = {"until_cycles": recording.stop.at_cycles, "digest": recording.digest}
    file = tmp_path / "run.json"
    file.write_text(json.dumps(session_of(robot, scenario) | ended))
    return file, recording.digest


def said(*command: object) -> str:
    """What a program printed."""
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=CRATES, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_native_is_python(run: tuple[Path, str]) -> None:
    """The façade's example, without any binding."""
    file, digest = run
    cargo = ["cargo", "run", "--locked", "--quiet", "-p", "virtual-brick", "--example", "digest"]
    assert said(*cargo, "--", file, ELF) == digest


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed (nodejs)")
def test_web_assembly_is_python(run: tuple[Path, str], tmp_path: Path) -> None:
    """The worker of the shipped page, run by Node.js."""
    file, digest = run
    with zipfile.ZipFile(PAGE) as archive:
        archive.extractall(tmp_path)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (worker,) = tmp_path.glob("assets/worker-*.js")
    script = Path(__file__).with_name("worker_digest.mjs")
    assert said("node", script, worker, file, ELF) == digest
