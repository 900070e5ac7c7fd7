# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result
from verification.support.bricks import fake_brick
from verification.support.elf_files import make_elf
from verification.support.fake_tools import install_fake_tools, write_recipe
from verification.support.projects import VEHICLE, make_project, put_image

from ravenbrick.brick import run as virtual
from ravenbrick.cli.app import app
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.exit_codes import exit_code_table
from ravenbrick.cli.pipeline import built_file
from ravenbrick.errors import ExitCode
from ravenbrick.image import build
from ravenbrick.image.design_script import adopt_design
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording

Edit = Callable[[str, str, str], int]
COMMANDS = ("design", "build", "run", "export", "report", "demo", "doctor")
DRIVE = "scenarios/drive.toml"
MASS = 'mass = { value = 0.7, unit = "kg", tolerance = 0.1, source = "test" }\n'


@pytest.fixture(autouse=True)
def brick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A brick whose answers are known, and no toolchain but make."""
    monkeypatch.setattr(virtual, "brick_module", lambda: fake_brick)
    monkeypatch.setattr(build, "TOOLS", build.TOOLS[:1])


def complete(project: Path) -> Path:
    """The project with all that it takes to 'build' it, or to design it again."""
    shutil.copy2(VEHICLE / "design.py", project)
    shutil.copytree(VEHICLE / "generated", project / "generated")
    adopt_design(Workspace.of(project))
    write_recipe(project)
    return project


@pytest.fixture
def whole(project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project that can be designed and 'built'."""
    install_fake_tools(tmp_path / "tool-folder", monkeypatch)
    return complete(project)


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Result]]:
    """The folder of results and the output of one demonstration without --json."""
    whole = complete(make_project(tmp_path_factory.mktemp("demo")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(virtual, "brick_module", lambda: fake_brick)
        install_fake_tools(whole.parent / "tool-folder", patch)
        yield Workspace.of(whole).results, call("demo", whole)


def call(*arguments: object) -> Result:
    """Run the command line."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def failure(result: Result, code: ExitCode) -> str:
    """The one sentence of a failing command, which ended with `code` and no traceback."""
    assert result.exit_code == code, result.output
    assert "Traceback" not in result.output
    first: str = result.stderr.splitlines()[0]
    assert first.startswith("ravenbrick: ")
    return first


def parsed(result: Result) -> dict[str, Any]:
    """The JSON of a command that succeeded."""
    assert result.exit_code == 0, result.output
    loaded: dict[str, Any] = json.loads(result.stdout)
    assert loaded.pop("ok") is True
    return loaded


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_every_command_shows_an_example(command: str) -> None:
    """Help ends with a line that can be typed."""
    result = call(command, "--help")
    assert result.exit_code == 0
    assert f"Example: ravenbrick {command}" in " ".join(result.output.split())
    assert "--json" in result.output


def test_the_page_of_exit_codes_is_the_one_in_the_program() -> None:
    """The documentation cannot drift from the code."""
    page = VEHICLE.parents[1] / "docs" / "reference" / "exit-codes.md"
    assert page.read_text() == exit_code_table()


def test_an_unknown_command_is_a_usage_error() -> None:
    """Two is the exit code of a wrong command line."""
    assert call("brew").exit_code == ExitCode.USAGE


def test_a_folder_that_is_not_there_is_a_usage_error(tmp_path: Path) -> None:
    """The sentence names the folder."""
    sentence = failure(call("run", tmp_path / "absent", "drive"), ExitCode.USAGE)
    assert "is not a folder" in sentence


def test_a_broken_robot_toml_names_line_and_field(project: Path, edit: Edit) -> None:
    """Exit code 3."""
    line = edit("robot.toml", "priority = 30", 'priority = "high"')
    sentence = failure(call("run", project, "drive"), ExitCode.PROJECT_FILE)
    assert f"robot.toml:{line}: tasks[0].priority: is 'high'; expected a whole number" in sentence


def test_an_unknown_port_names_line_and_ports(project: Path, edit: Edit) -> None:
    """Exit code 3."""
    line = edit("robot.toml", "[ports.1]", "[ports.7]")
    sentence = failure(call("run", project, "drive"), ExitCode.PROJECT_FILE)
    assert f"robot.toml:{line}: ports.7: unknown port '7'" in sentence


def test_a_named_image_that_is_missing_says_how_to_build_it(project: Path) -> None:
    """Exit code 6."""
    sentence = failure(call("run", project, "drive", "--elf", "no.elf"), ExitCode.BAD_IMAGE)
    assert "build it with 'ravenbrick build'" in sentence


@pytest.mark.parametrize("change", [Path.unlink, Path.touch, lambda p: p.write_bytes(b"cut")])
def test_an_image_that_is_not_the_built_one_is_built_again(
    whole: Path, change: Callable[[Path], object]
) -> None:
    """Missing, or truncated; one that was only touched is taken as it is."""
    image = Workspace.of(whole).image("ram", "vehicle")
    call("build", whole)
    change(image)
    done = call("run", whole, "drive")
    assert image.read_bytes() == make_elf()
    assert ("build the ram image" in done.output) == (change is not Path.touch)


@pytest.mark.parametrize(
    "words",
    [
        ("run", "drive"),
        ("view", "drive", "--out", "page"),
        ("debug", "drive"),
        ("live", "drive"),
        ("analyse",),
        ("identify", "drive", "drive", "--motor", "B"),
        ("sweep", "drive"),
        ("upload", "--out", "plain.bin"),
        ("build",),
    ],
    ids=lambda words: words[0],
)
def test_no_command_takes_an_image_whose_source_does_not_compile(
    whole: Path, words: tuple[str, ...]
) -> None:
    """The compiler's error is the first line of each."""
    assert call("build", whole).exit_code == ExitCode.OK
    (whole / "src" / "main.adb").write_text("procedure Main is")
    write_recipe(whole, "echo 'main.adb:12:7: error: missing \";\"'; exit 4")
    name, *options = words
    sentence = failure(call(name, whole, *options), ExitCode.BUILD_FAILED)
    assert sentence == 'ravenbrick: main.adb:12:7: missing ";"'


def test_a_named_elf_file_of_a_project_is_built_before_it_is_bounded(whole: Path) -> None:
    """`wcet` names the file; one that no build left is taken as it is."""
    assert call("build", whole).exit_code == ExitCode.OK
    image = Workspace.of(whole).image("ram", "vehicle")
    before = image.stat().st_mtime_ns
    assert built_file(image, Reporter(True)).stat().st_mtime_ns == before
    (whole / "src" / "more.adb").touch()
    assert built_file(image, Reporter(True)).stat().st_mtime_ns > before
    assert built_file(whole / "small.elf", Reporter(True)).is_file()


def test_an_image_too_large_for_ram_is_refused(whole: Path) -> None:
    """Exit code 6, with the number of bytes."""
    write_recipe(whole, 'echo "region \\`RAM\' overflowed by 12 bytes"; exit 1')
    assert "12 bytes too large" in failure(call("build", whole), ExitCode.BAD_IMAGE)


def test_a_missing_scenario_is_unreachable(project: Path) -> None:
    """Exit code 9."""
    sentence = failure(call("run", project, "dirve"), ExitCode.SCENARIO_UNREACHABLE)
    assert "known scenarios: drive" in sentence


def test_an_input_beyond_the_duration_is_unreachable(project: Path, edit: Edit) -> None:
    """Exit code 9."""
    edit(DRIVE, "at_ms = 19_000", "at_ms = 20_001")
    sentence = failure(call("run", project, "drive"), ExitCode.SCENARIO_UNREACHABLE)
    assert "20001 ms is beyond the duration of 20000 ms" in sentence


def test_an_input_after_power_off_is_unreachable(project: Path, edit: Edit) -> None:
    """What was scheduled for a brick that is off never happens."""
    line = edit(DRIVE, "at_ms = 17_650", "at_ms = 19_500")
    sentence = failure(call("run", project, "drive"), ExitCode.SCENARIO_UNREACHABLE)
    assert f"drive.toml:{line}: " in sentence
    assert "never happens: the brick was powered off at 19000." in sentence


def test_a_criterion_that_the_run_never_reaches_is_unreachable(project: Path, edit: Edit) -> None:
    """A vehicle that never drives the distance has no deviation over it."""
    edit(DRIVE, "distance = 2.0", "distance = 200.0")
    sentence = failure(call("run", project, "drive"), ExitCode.SCENARIO_UNREACHABLE)
    assert "'lateral_deviation' was never reached in the run" in sentence


def test_a_criterion_that_is_not_met_has_its_own_exit_code(project: Path, edit: Edit) -> None:
    """Exit code 8, with value and bound."""
    line = edit(DRIVE, "minimum = 3.0", "minimum = 30.0")
    sentence = failure(call("run", project, "drive"), ExitCode.CRITERIA_NOT_MET)
    assert f"drive.toml:{line - 2}: distance is 4." in sentence
    assert "expected at least 30" in sentence


def test_a_fault_on_the_brick_ends_the_run_with_its_sentence(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 7: the fault, behind it the instant and what is on the LCD."""
    monkeypatch.setattr(fake_brick.VirtualBrick, "fault_ms", 700)
    result = call("run", project, "drive")
    sentence = failure(result, ExitCode.RUN_FAULT)
    assert sentence == "ravenbrick: read of the unmodelled register 0xFFFA0000"
    assert "scenario 'drive' ended after 0.700000 s" in result.stderr
    assert "vehicle.adb:12" in result.stderr


def test_a_task_set_that_is_not_the_images_is_refused(project: Path, edit: Edit) -> None:
    """A stack, a priority or a period that differs is named with its line."""
    line = edit("robot.toml", "period_us = 4_000", "period_us = 5_000")
    sentence = failure(call("run", project, "drive"), ExitCode.PROJECT_FILE)
    assert f"robot.toml:{line}: tasks[1].period_us: is 5000, but the image that ran" in sentence


def test_an_error_is_json_when_asked_for(project: Path) -> None:
    """Programs get code and sentence on standard output."""
    result = call("run", project, "dirve", "--json")
    assert result.exit_code == ExitCode.SCENARIO_UNREACHABLE
    answer = json.loads(result.stdout)
    assert answer["ok"] is False
    assert answer["exit_code"] == ExitCode.SCENARIO_UNREACHABLE
    assert "there is no such scenario" in answer["error"]


def test_a_failing_design_shows_its_last_line(whole: Path) -> None:
    """Exit code 10."""
    (whole / "design.py").write_text("raise SystemExit('no gain meets the specification')\n")
    sentence = failure(call("design", whole), ExitCode.DESIGN_FAILED)
    assert "no gain meets the specification" in sentence


def test_a_report_without_a_run_says_what_to_run(project: Path) -> None:
    """There is nothing to report yet."""
    assert "has been run yet" in failure(call("report", project), ExitCode.USAGE)


def test_run_answers_with_the_measures_of_the_run(project: Path) -> None:
    """The figures are those that the made-up run was given."""
    answer = parsed(call("run", project, "drive", "--json"))
    control = answer["tasks"]["control_task"]
    assert control["releases"] == 4748
    assert control["response_time_cycles_min"] == control["response_time_cycles_max"] == 20_150
    assert control["response_time_cycles_mean"] == 20_150
    assert control["release_jitter_cycles"] == 0
    assert control["deadline_misses"] == 0
    assert answer["lateral_deviation"] == pytest.approx(0.004, abs=1e-5)
    assert answer["stop"] == "power_off"
    assert Path(answer["recording"]).is_file()


def test_another_seed_or_another_robot_is_another_run(project: Path, edit: Edit) -> None:
    """The digest stands for image, inputs and the whole configuration."""

    def digest() -> str:
        return Recording.load(
            Path(parsed(call("run", project, "drive", "--json"))["recording"])
        ).digest

    first = digest()
    assert digest() == first
    edit(DRIVE, "seed = 1", "seed = 2")
    second = digest()
    edit("robot.toml", 'left = "B"', MASS + 'left = "B"')
    assert len({first, second, digest()}) == 3


def test_a_report_is_made_again_from_the_recordings(project: Path) -> None:
    """What was recorded is enough; nothing runs again."""
    parsed(call("run", project, "drive", "--json"))
    answer = parsed(call("report", project, "--json"))
    assert answer["summary"]["lateral_deviation_with"] == pytest.approx(0.004, abs=1e-5)
    assert answer["summary"]["settling_time"] is None
    assert "with all tasks at work" in Path(answer["report"]).read_text()


def test_a_damaged_recording_is_refused(project: Path) -> None:
    """The sentence says to run the scenario again."""
    parsed(call("run", project, "drive", "--json"))
    recording = Workspace.of(project).recording("drive")
    recording.write_bytes(recording.read_bytes()[:2000])
    assert "run the scenario again" in failure(call("report", project), ExitCode.USAGE)


def test_the_demo_leaves_report_pictures_and_summary(demo: tuple[Path, Result]) -> None:
    """One command gives every file, and the summary has the stable keys."""
    folder, result = demo
    assert result.exit_code == 0, result.output
    drawings = {path.stem for path in (folder / "figures").glob("*.svg")}
    assert {"path", "step-response", "run-drive-dynamics"} <= drawings
    for run in ("drive", "drive-open-loop", "step", "step-with-friction"):
        parts = ("lcd-1", "responses", "schedule", "schedule-close", "signals", "slowest")
        assert {f"run-{run}-{part}" for part in parts} <= drawings
    figures = json.loads((folder / "summary.json").read_text())
    assert figures["settling_time"] == pytest.approx(0.391, abs=0.006)
    assert figures["overshoot"] < 0.005
    assert figures["lateral_deviation_with"] == pytest.approx(0.004, abs=1e-5)
    assert figures["lateral_deviation_without"] == pytest.approx(0.0999, abs=1e-3)
    assert figures["same_digest_twice"] is True
    assert re.fullmatch("[0-9a-f]{64}", figures["trace_digest"])
    assert 0.1 < figures["cpu_utilization"] < 0.5
    assert set(figures["tasks"]) == {"coprocessor_task", "control_task", "display_task"}


def test_the_demo_answers_with_summary_and_steps(whole: Path) -> None:
    """With --json, the figures are those of summary.json."""
    answer = parsed(call("demo", whole, "--json"))
    assert answer["summary"] == json.loads(Path(answer["summary_file"]).read_text())
    assert [step["name"] for step in answer["steps"]][:2] == [
        "design and generate C",
        "build the RAM image",
    ]


def test_the_report_stands_alone_and_says_what_it_must(demo: tuple[Path, Result]) -> None:
    """Pictures are inside, nothing is fetched, and each part of the demonstration is there."""
    page = (demo[0] / "report.html").read_text()
    assert not re.search(r'(?:src|href)="(?!data:|#run-)', page)
    assert "<script" not in page and "@import" not in page
    assert page.count("<svg ") == len(list((demo[0] / "figures").glob("*.svg")))
    for part in (
        "Step response",
        "continuous design",
        "sampled simulation",
        "on the brick, motor C",
        "set-point",
        "Path from above",
        "Tasks and schedule",
        "release jitter",
        "with all tasks at work",
        "LCD after",
        "high-water mark",
        "gave the same digest",
        "@media print",
    ):
        assert part in page, part


def test_progress_names_each_step_with_its_duration(demo: tuple[Path, Result]) -> None:
    """Without --json, every step is one numbered line."""
    result = demo[1]
    assert re.search(r"\[1/8\] design and generate C +\d+\.\d\d s", result.stdout)
    assert re.search(r"\[7/8\] run 'drive' again +\d+\.\d\d s +same trace digest", result.stdout)
    assert "report.html in a browser" in result.stdout


def test_a_file_in_the_way_of_the_results_is_named(project: Path) -> None:
    """What the system refuses is a sentence too."""
    (Workspace.of(project).root / "out").write_text("not a folder")
    sentence = failure(call("run", project, "drive"), ExitCode.USAGE)
    assert "out" in sentence
    assert "name another" in sentence or "is a file and not a folder" in sentence


def test_recordings_of_both_kinds_of_image_are_kept_apart(project: Path) -> None:
    """A run from flash does not replace the one from RAM."""
    put_image(project, make_elf(base=0x100000), "flash")
    kept = {
        parsed(call("run", project, "drive", "--image", kind, "--json"))["recording"]
        for kind in ("ram", "flash")
    }
    assert len(kept) == 2


def test_a_recording_without_a_scenario_of_its_name_is_reported(project: Path) -> None:
    """Whatever was run is shown."""
    parsed(call("run", project, "drive", "--json"))
    kept = Workspace.of(project).recording("drive")
    kept.rename(kept.with_name("trial.npz"))
    page = Path(parsed(call("report", project, "--json"))["report"]).read_text()
    assert "Run: trial" in page and "whose scenario is not in the project" in page
