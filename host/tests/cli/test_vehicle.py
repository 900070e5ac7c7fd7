# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The whole drive: the repository's vehicle, its real image, the real virtual brick."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE

from ravenbrick.project.workspace import Workspace

COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]

pytestmark = [
    NEEDS_TOOLCHAIN,
    NEEDS_VIRTUAL_BRICK,
]


def _answer(*arguments: str) -> dict[str, Any]:
    done = subprocess.run(
        [*COMMAND, *arguments, "--json"], capture_output=True, text=True, check=False
    )
    assert done.stdout, done.stderr
    loaded: dict[str, Any] = json.loads(done.stdout)
    return loaded


@pytest.fixture(scope="module")
def demo() -> dict[str, Any]:
    """One demonstration of the vehicle."""
    answer = _answer("demo", str(VEHICLE))
    assert answer["ok"], f"{answer['error']}\n{answer['detail']}"
    return answer


@pytest.fixture(scope="module")
def figures(demo: dict[str, Any]) -> dict[str, Any]:
    """Its summary."""
    summary: dict[str, Any] = demo["summary"]
    return summary


def test_the_wheel_settles_as_designed(figures: dict[str, Any]) -> None:
    """350 to 450 ms with at most 2 % overshoot, on both motors, with friction too."""
    runs = figures["runs"]
    for scenario in ("step", "step-with-friction"):
        for step in runs[scenario]["steps"].values():
            assert 0.35 <= step["settling_time"] <= 0.45
            assert step["overshoot"] <= 0.02
            assert abs(step["steady_state_error"]) < 0.001


def test_the_brick_agrees_with_the_sampled_simulation(figures: dict[str, Any]) -> None:
    """The true speed stays within 3 % of the set-point of the simulated one throughout."""
    assert figures["simulation_difference"] < 0.03
    simulated = figures["design"]["encoder_settling_time"]
    assert figures["settling_time"] == pytest.approx(simulated, abs=0.02)


def test_the_controller_keeps_the_vehicle_on_its_line(figures: dict[str, Any]) -> None:
    """With motors that differ, at most a tenth of the lateral deviation without it."""
    assert figures["lateral_deviation_without"] > 0.2
    assert figures["lateral_deviation_ratio"] <= 0.1


def test_no_task_misses_a_deadline(figures: dict[str, Any]) -> None:
    """In no run, and the tasks are those of robot.toml with all their releases."""
    for run in figures["runs"].values():
        assert all(task["deadline_misses"] == 0 for task in run["tasks"].values())
    assert figures["tasks"]["control_task"]["releases"] > 4700
    assert figures["tasks"]["coprocessor_task"]["releases"] > 9400
    assert 0.0 < figures["cpu_utilization"] < 0.5


def test_the_same_run_gives_the_same_trace(demo: dict[str, Any]) -> None:
    """Twice within the demonstration, and once more in another process."""
    assert demo["summary"]["same_digest_twice"] is True
    again = _answer("run", str(VEHICLE), "drive")
    assert again["trace_digest"] == demo["summary"]["trace_digest"]


def test_every_file_of_the_report_is_there(demo: dict[str, Any]) -> None:
    """Report, summary and pictures lie in out/vehicle."""
    folder = Path(demo["report"]).parent
    names = {path.name for path in folder.iterdir()}
    assert {"report.html", "summary.json", "figures"} <= names
    drawings = {path.name for path in (folder / "figures").iterdir()}
    assert {"path.svg", "step-response.svg", "run-drive-schedule.svg"} <= drawings


def test_the_memory_report_knows_every_stack(demo: dict[str, Any]) -> None:
    """No stack is full, and the parts of the program are told apart."""
    memory = demo["summary"]["memory"]
    for task in memory["tasks"]:
        assert 0 < task["used_bytes"] < task["storage_size_bytes"]
    assert {"application", "drivers", "generated C", "run-time"} <= set(memory["parts"])


@pytest.mark.usefixtures("demo")
def test_a_truncated_image_is_refused(tmp_path: Path) -> None:
    """Half of the real image is not an image."""
    whole = Workspace.of(VEHICLE).image("ram", "vehicle").read_bytes()
    half = tmp_path / "half.elf"
    half.write_bytes(whole[: len(whole) // 2])
    answer = _answer("run", str(VEHICLE), "drive", "--elf", str(half))
    assert (answer["ok"], answer["exit_code"]) == (False, 6)
    assert "is truncated" in answer["error"]


@pytest.mark.usefixtures("demo")
def test_an_image_too_large_for_ram_is_a_sentence_of_the_real_linker(tmp_path: Path) -> None:
    """A stack that does not fit makes the linker complain, and the build command explain it."""
    for name in ("drivers", "runtime", "tools", "build/runtime"):
        shutil.copytree(VEHICLE.parents[1] / name, tmp_path / name)
    project = tmp_path / "examples" / "vehicle"
    shutil.copytree(VEHICLE, project)
    tasks = project / "src" / "tasks.ads"
    text = tasks.read_text()
    assert "Storage_Size (4096)" in text
    tasks.write_text(text.replace("Storage_Size (4096)", "Storage_Size (40960)"))
    answer = _answer("build", str(project))
    assert (answer["ok"], answer["exit_code"]) == (False, 6), answer
    assert "bytes too large for the" in answer["error"]
