# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick view`, and runs of the page on the command line."""

from __future__ import annotations

import io
import json
import threading
import urllib.error
import urllib.request
import zipfile
from http.server import ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner
from verification.support.bricks import fake_brick
from verification.support.web import open_page

from ravenbrick.brick import run as virtual
from ravenbrick.brick.session import session_of
from ravenbrick.brick.tunables import read_tunables
from ravenbrick.cli import view
from ravenbrick.cli.app import app
from ravenbrick.cli.view import page_server
from ravenbrick.errors import ExitCode, ProjectFileError
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace


@pytest.fixture(autouse=True)
def brick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A brick whose answers are known."""
    monkeypatch.setattr(virtual, "brick_module", lambda: fake_brick)


def call(*words: object) -> tuple[int, dict[str, Any]]:
    """Exit code and JSON answer of a command."""
    result = CliRunner().invoke(app, [str(word) for word in [*words, "--json"]])
    return result.exit_code, json.loads(result.stdout)


PAGE = {"index.html": b"<p>page</p>", "assets/brick.wasm": b"\0asm"}


def run_file(project: Path, file: Path, **changes: Any) -> Path:
    """A run of the scenario 'drive' as the page would save it."""
    robot = read_robot(project)
    scenario = read_scenario(scenario_path(project, "drive"), robot)
    run = session_of(robot, scenario)
    run |= {"format": "ravenbrick run", "version": 1, "until_ms": 20_000, "digest": "0"}
    file.write_text(json.dumps(run | changes))
    return file


HEADER = """typedef struct {
  real32_T Kp; /* proportional gain, V/V; referenced by '<Root>/Proportional' */
  int16_T Ki; /* integral gain, 2^-12 V/V; referenced by '<Root>/Integral_Gain' */
} Parameters_pi;
"""
CODE = """Parameters_pi pi_P = {
  -0.5F, /* Kp: proportional gain, V/V; '<Root>/Proportional' */
  132 /* Ki: integral gain, 2^-12 V/V; '<Root>/Integral_Gain' */
};
"""


def test_tunable_parameters_are_read_from_the_generated_c(tmp_path: Path) -> None:
    (tmp_path / "pi.h").write_text(HEADER)
    (tmp_path / "pi.c").write_text(CODE)
    (tmp_path / "other.h").write_text("typedef int other;")
    gain, integral = read_tunables(tmp_path)
    assert (gain.path, gain.unit, gain.description) == ("pi_P.Kp", "V/V", "proportional gain")
    assert (gain.value, gain.limits, gain.whole) == (-0.5, (-2.0, 0.0), False)
    assert (integral.unit, integral.value, integral.whole) == ("2^-12 V/V", 132.0, True)
    assert read_tunables(tmp_path / "none") == ()


@pytest.mark.parametrize(
    ("question", "problem"),
    [
        ('measure = "settling_time"\nsignal = "motor.B.angle"', "signal"),
        ('signal = "motor.B.angle"', "from_ms"),
        (
            'signal = "s"\nfrom_ms = 5\nuntil_ms = 5\nlowest = 0\nhighest = 1',
            "expected more than from_ms = 5",
        ),
    ],
)
def test_a_question_that_cannot_be_answered_is_refused(
    project: Path, question: str, problem: str
) -> None:
    path = scenario_path(project, "drive")
    path.write_text(f'{path.read_text()}\n[[questions]]\ntext = "How far?"\n{question}\n')
    with pytest.raises(ProjectFileError, match=problem):
        read_scenario(path, read_robot(project))


def page_whose_data_is_wrong() -> bytes:
    """An archive in order, of whose only file no data can be unpacked."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as page:
        page.writestr("index.html", "<!doctype html>")
    begin = 30 + len("index.html")
    content = bytearray(archive.getvalue())
    content[begin : begin + 4] = b"\xff" * 4
    return bytes(content)


@pytest.mark.parametrize("content", [None, b"PK", page_whose_data_is_wrong()])
def test_a_missing_or_damaged_page_is_named_with_the_command_that_restores_it(
    project: Path, monkeypatch: pytest.MonkeyPatch, content: bytes | None
) -> None:
    """The packed page is part of the repository."""
    packed = project / "page.zip"
    monkeypatch.setattr(view, "PAGE", packed)
    if content is not None:
        packed.write_bytes(content)
    code, answer = call("view", project, "--out", project / "there")
    assert code == ExitCode.TOOL_MISSING
    assert "page.zip: the page is missing or damaged" in answer["error"]
    assert "'git checkout', or build the page with 'make page'" in answer["error"]
    assert not (project / "there").exists()


def test_a_folder_for_any_web_server_has_page_session_and_image(
    project: Path, tmp_path: Path
) -> None:
    """`--out` writes what the server would serve."""
    folder = tmp_path / "there"
    assert call("view", project, "drive", "--out", folder)[0] == ExitCode.OK
    session = json.loads((folder / "session.json").read_text())
    assert (session["project"], session["scenario"]) == ("vehicle", "drive")
    assert session["inputs"][0] == {"at_cycles": 48_054_858, "name": "touch.1", "value": 1.0}
    assert {task["name"] for task in session["tasks"]} >= {"control_task", "display_task"}
    assert (folder / "image.elf").read_bytes()[:4] == b"\x7fELF"
    assert list(folder.glob("assets/*.wasm")) and (folder / "index.html").is_file()
    assert json.loads((folder / "sources.json").read_text()) == {}
    assert call("view", project, "--out", folder)[0] == ExitCode.USAGE


def test_what_the_page_lacks_is_named_with_its_command(project: Path, tmp_path: Path) -> None:
    """A fresh clone has the generated C, and neither design.json nor timing.json."""
    (project / "design.py").touch()
    image = Workspace.of(project).image("ram", "vehicle")
    words = ["view", project, "--elf", image, "--out", tmp_path / "there"]
    said = CliRunner().invoke(app, [str(word) for word in words]).stdout
    assert "no response-time bounds; run 'ravenbrick analyse'" in said
    assert "no diagram, no designed response; run 'ravenbrick design'" in said


def timing_file(project: Path, **changes: Any) -> Path:
    """Bounds as `ravenbrick analyse` writes them, where it writes them."""
    image = read_image(Workspace.of(project).image("ram", "vehicle"))
    tasks = [{"name": "control_task", "response_bound_cycles": 9000}]
    tasks += [{"name": "display_task", "response_bound_cycles": None}]
    file = Workspace.of(project).results / "timing.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"image_sha256": image.digest, "tasks": tasks} | changes))
    return file


def bounds_in(folder: Path) -> dict[str, int | None]:
    """The bound of each task of a page."""
    session = json.loads((folder / "session.json").read_text())
    return {task["name"]: task["bound_cycles"] for task in session["tasks"]}


def test_bounds_of_this_image_go_to_the_page_and_those_of_another_do_not(
    project: Path, tmp_path: Path
) -> None:
    """Without being named where `analyse` left them; named, a wrong one is refused."""
    assert call("view", project, "--out", tmp_path / "none")[0] == ExitCode.OK
    assert set(bounds_in(tmp_path / "none").values()) == {None}
    file = timing_file(project)
    assert call("view", project, "--out", tmp_path / "own")[0] == ExitCode.OK
    assert bounds_in(tmp_path / "own")["control_task"] == 9000
    assert bounds_in(tmp_path / "own")["display_task"] is None
    timing_file(project, image_sha256="0")
    assert call("view", project, "--out", tmp_path / "other")[0] == ExitCode.OK
    assert bounds_in(tmp_path / "other")["control_task"] is None
    code, answer = call("view", project, "--bounds", file, "--out", tmp_path / "refused")
    assert (code, "another image" in answer["error"]) == (ExitCode.USAGE, True)


@pytest.mark.parametrize("changes", [{"tasks": 5}, {"tasks": [{}]}, {"tasks": [{"name": "x"}]}])
def test_a_wrong_file_of_bounds_is_named(
    project: Path, tmp_path: Path, changes: dict[str, Any]
) -> None:
    """With its field."""
    file = timing_file(project, **changes)
    code, answer = call("view", project, "--bounds", file, "--out", tmp_path / "there")
    assert (code, str(file) in answer["error"]) == (ExitCode.PROJECT_FILE, True)


def test_the_server_gives_the_page_the_project_and_nothing_else() -> None:
    """Types, policy, and no file of the disk."""
    with page_server(PAGE | {"session.json": b"{}"}, 0) as server:
        assert server.server_address[0] == "127.0.0.1"
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}"
        with open_page(f"{address}/assets/brick.wasm") as answer:
            assert answer.headers["Content-Type"] == "application/wasm"
            assert "default-src 'self'" in answer.headers["Content-Security-Policy"]
        with open_page(f"{address}/session.json") as answer:
            assert (answer.read(), answer.headers["Content-Type"]) == (b"{}", "application/json")
        with open_page(f"{address}/?any") as answer:
            assert (answer.read(), answer.headers["Content-Type"]) == (b"<p>page</p>", "text/html")
        for path in ("/../etc/passwd", "//etc/passwd", "/absent"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                open_page(f"{address}{path}")
        server.shutdown()


def test_a_port_in_use_is_a_sentence(project: Path) -> None:
    """As for the debugger's server."""
    with page_server(PAGE, 0) as server:
        code, answer = call("view", project, "--port", server.server_port, "--no-browser")
    assert code == ExitCode.USAGE
    assert f"port {server.server_port}" in answer["error"]


def test_the_address_is_told_at_once_also_for_json(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On standard error, since the answer on standard output comes at the end of the run."""
    monkeypatch.setattr(ThreadingHTTPServer, "serve_forever", lambda _server, **_options: None)
    result = CliRunner().invoke(
        app, ["view", str(project), "--port", "0", "--no-browser", "--json"]
    )
    assert json.loads(result.stdout)["address"] in result.stderr


def test_a_run_of_the_page_is_replayed_to_its_end(project: Path, tmp_path: Path) -> None:
    """Inputs and end are the page's; the digest is compared."""
    file = run_file(project, tmp_path / "kept.json")
    code, answer = call("run", project, "drive", "--replay", file)
    assert code == ExitCode.OK
    assert answer["same_as_replayed"] is False
    file = run_file(project, tmp_path / "same.json", digest=answer["trace_digest"])
    assert call("run", project, "drive", "--replay", file)[1]["same_as_replayed"] is True


def test_a_run_that_the_reader_stopped_early_tells_nothing_of_periods(
    project: Path, tmp_path: Path
) -> None:
    """A task may set up with other waits by then; in a whole run the period is compared."""
    robot = project / "robot.toml"
    robot.write_text(robot.read_text().replace("period_us = 4_000", "period_us = 5_000"))
    file = run_file(project, tmp_path / "stopped.json", until_ms=200, inputs=[])
    code, answer = call("run", project, "drive", "--replay", file)
    assert code == ExitCode.OK, answer
    file = run_file(project, tmp_path / "whole.json")
    code, answer = call("run", project, "drive", "--replay", file)
    assert code == ExitCode.PROJECT_FILE and "period_us: is 5000" in answer["error"]


def test_inputs_of_the_page_are_a_stimulus(project: Path, tmp_path: Path) -> None:
    """They come besides those of the scenario."""
    turn = {"name": "motor.A.hand_angle"}
    inputs = [turn | {"at_cycles": 478_145_829, "value": 0.2}]
    inputs += [turn | {"at_cycles": 479_106_926, "value": 0.0}]
    file = run_file(project, tmp_path / "hand.json", inputs=inputs)
    code, fed = call("run", project, "drive", "--stimulus", file)
    assert code == ExitCode.OK, fed
    assert fed["trace_digest"] != call("run", project, "drive")[1]["trace_digest"]


@pytest.mark.parametrize(
    ("changes", "code", "named"),
    [
        ({"format": "other"}, ExitCode.PROJECT_FILE, "format"),
        ({"version": 2}, ExitCode.PROJECT_FILE, "version"),
        ({"inputs": [{"name": "touch.1"}]}, ExitCode.PROJECT_FILE, "at_cycles"),
        ({"inputs": 5}, ExitCode.PROJECT_FILE, "inputs"),
        ({"configuration": {}}, ExitCode.USAGE, "another environment"),
    ],
)
def test_a_wrong_run_file_is_refused(
    project: Path, tmp_path: Path, changes: dict[str, Any], code: int, named: str
) -> None:
    """With the field, or what differs."""
    file = run_file(project, tmp_path / "wrong.json", **changes)
    found, answer = call("run", project, "drive", "--replay", file)
    assert (found, named in answer["error"]) == (code, True)


@pytest.mark.parametrize("host", ["attacker.example", "attacker.example:8080", "127.0.0.1.example"])
def test_a_name_of_another_site_gets_nothing(host: str) -> None:
    """A site can have its name lead to this machine, and would be the page's own origin."""
    with page_server(PAGE, 0, "token") as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/token/"
        with open_page(address) as answer:
            assert answer.read() == b"<p>page</p>"
        request = urllib.request.Request(address, headers={"Host": host})
        with pytest.raises(urllib.error.HTTPError, match="421"):
            open_page(request)
        with pytest.raises(urllib.error.HTTPError, match="404"):
            open_page(f"http://127.0.0.1:{server.server_port}/")
        server.shutdown()
