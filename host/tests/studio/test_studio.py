# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The studio's server: files of the project only, conflicts, who may ask, commands, errors."""

from __future__ import annotations

import json
import os
import re
import socket
import sys
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from verification.support.web import open_page

from ravenbrick.errors import UsageError
from ravenbrick.project.workspace import Workspace
from ravenbrick.studio.project_files import LARGEST_BYTES, FileError, ProjectFiles
from ravenbrick.studio.server import studio_server
from ravenbrick.studio.studio import Studio

TOKEN = "secret"
# In place of the command line: what design.py says decides the answer of `build`.
COMMAND = """
import json, pathlib, sys, time
words = json.loads(input())
wanted = pathlib.Path({design!r}).read_text()
if "slow" in wanted:
    time.sleep(600)
errors = [{design!r} + ":2:7: wrong", "and more"]
bad = {{"ok": False, "exit_code": 5, "error": "x", "errors": errors}}
print(json.dumps(bad if "bad" in wanted else {{"ok": True}}))
"""


@pytest.fixture
def files(project: Path) -> ProjectFiles:
    """The files of a project."""
    (project / "design.py").write_text("1\n")
    return ProjectFiles(project, "my-robot")


@pytest.fixture
def studio(project: Path) -> Iterator[Studio]:
    """A studio whose command line answers by what design.py says."""
    design = project / "design.py"
    design.write_text("good\n")

    def show(scenario: str | None) -> dict[str, bytes]:
        return {"index.html": str(scenario).encode()}

    program = (sys.executable, "-c", COMMAND.format(design=str(design)))
    made = Studio(Workspace.of(project), show, program)
    yield made
    made.close()


@pytest.fixture
def address(studio: Studio) -> Iterator[str]:
    """Where the studio is served."""
    with studio_server(studio, {"index.html": b"page"}, 0, TOKEN) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def post(address: str, path: str, body: object, **headers: str) -> Any:
    """The answer to a POST of the studio's own page, unless headers say otherwise."""
    own = {"Origin": address, "Content-Type": "application/json"}
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    data = json.dumps(body).encode()
    request = urllib.request.Request(f"{address}{path}", data, {**own, **named})
    return json.load(open_page(request))


def ended(studio: Studio, task: str = "build") -> list[dict[str, Any]]:
    """The ends of calls, once the studio has done this task."""
    number, calls = 0, []
    while True:
        for at, event in studio.journal.after(number, 60):
            number = at
            if event["kind"] == "ended":
                calls.append(event)
            if event == {"kind": "idle", "task": task}:
                return calls


def status(address: str, request: bytes) -> str:
    """The status of the answer, "" without one; before a version is known, only its page has it."""
    host, _, port = address.removeprefix("http://").partition(":")
    with socket.create_connection((host, int(port)), 60) as link:
        link.sendall(request)
        stream = link.makefile("rb")
        line = stream.readline()
        if line.startswith(b"HTTP/"):
            return line.split()[1].decode()
        return "".join(re.findall(r"code: (\d+)", stream.read().decode()))


def head(line: str, *fields: str, body: str = "{}") -> bytes:
    """A request of the own page with these header fields in place of the usual ones."""
    own = [f"{line} HTTP/1.0", "Host: localhost", "Origin: http://localhost"]
    usual = ["Content-Type: application/json", f"Content-Length: {len(body)}"]
    return "\r\n".join([*own, *(fields or usual), "", body]).encode("latin-1")


SAVE = f"POST /{TOKEN}/api/save"
NO_TEXT = '{"path": "design.py", "text": "\\ud800", "version": null}'


@pytest.mark.parametrize(
    ("request_text", "expected"),
    [
        (b"GARBAGE\r\n\r\n", "400"),
        (b"GET / HTTP/9.0\r\n\r\n", "505"),
        (b"GET /" + b"x" * (65_537 - 5), "414"),
        (head(SAVE, "Content-Type: application/json", "Content-Length: \xb2"), "413"),
        (head(SAVE, "Content-Type: application/json", f"Content-Length: {'9' * 5_000}"), "413"),
        (head(SAVE, body="[" * 100_000), "400"),
        (head(SAVE, body=NO_TEXT), "400"),
        (head(SAVE, body=NO_TEXT.replace("design", "\\ud800")), "400"),
        (head(f"GET /{TOKEN}/results/{'x' * 300}.html"), "404"),
        (head(f"GET /{TOKEN}/results/\0.html"), "404"),
        (head(f"GET /{TOKEN}/api/file?path={'x' * 5_000}.py"), "403"),
        (head(f"GET /{TOKEN}/api/events", "Last-Event-ID: \xb2"), "200"),
    ],
)
def test_every_request_is_answered(address: str, request_text: bytes, expected: str) -> None:
    """Whatever it is: an error of the server would be a traceback, and no answer."""
    assert status(address, request_text) == expected


@pytest.mark.parametrize(
    "name",
    ["../design.py", "/etc/passwd.py", "", "a\\b.py", "build/x.py", ".git/x.py", "x.elf", "a\0.py"],
)
def test_other_files_are_neither_read_nor_written(files: ProjectFiles, name: str) -> None:
    """Whatever the page asks for."""
    for act in (lambda: files.read(name), lambda: files.write(name, "", None)):
        with pytest.raises(FileError) as refused:
            act()
        assert refused.value.status == 403


def test_a_link_out_of_the_project_is_refused(
    files: ProjectFiles, project: Path, tmp_path: Path
) -> None:
    """A file and a folder; a link inside the project is what it leads to."""
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "secret.py").write_text("secret")
    (project / "link.py").symlink_to(outside / "secret.py")
    (project / "folder").symlink_to(outside)
    (project / "own.py").symlink_to("design.py")
    for name in ("link.py", "folder/secret.py", "folder/new.py"):
        with pytest.raises(FileError, match="leads out of the project"):
            files.write(name, "x", None)
    assert files.read("own.py")["text"] == "1\n"
    assert "link.py" not in {file["path"] for file in files.listed()}
    assert (outside / "secret.py").read_text() == "secret"
    assert os.listdir(outside) == ["secret.py"]


def test_a_change_of_another_program_is_not_overwritten(files: ProjectFiles, project: Path) -> None:
    """The refusal brings the file as it is; with its version it can be replaced."""
    opened = files.read("design.py")
    (project / "design.py").write_text("theirs\n")
    with pytest.raises(FileError) as conflict:
        files.write("design.py", "ours\n", opened["version"])
    assert (conflict.value.status, conflict.value.data["text"]) == (409, "theirs\n")
    assert (project / "design.py").read_text() == "theirs\n"
    files.write("design.py", "ours\n", conflict.value.data["version"])
    assert (project / "design.py").read_text() == "ours\n"


def test_a_new_file_replaces_none(files: ProjectFiles, project: Path) -> None:
    """And keeps to folders that are there."""
    files.write("scenarios/new.toml", "x = 1\n", None)
    assert (project / "scenarios" / "new.toml").read_text() == "x = 1\n"
    with pytest.raises(FileError, match="changed by another"):
        files.write("design.py", "", None)
    with pytest.raises(FileError, match="no such folder"):
        files.write("absent/new.py", "", None)


def test_generated_files_name_the_command_that_makes_them(
    files: ProjectFiles, project: Path
) -> None:
    """They are read, not written."""
    (project / "generated").mkdir(exist_ok=True)
    (project / "generated" / "functional.c").write_text("int x;")
    opened = files.read("generated/functional.c")
    assert "'ravenbrick design my-robot'" in opened["read_only"]
    with pytest.raises(FileError, match="ravenbrick design"):
        files.write("generated/functional.c", "", opened["version"])


def test_large_and_binary_files_are_refused(files: ProjectFiles, project: Path) -> None:
    """Each with a reason."""
    (project / "large.csv").write_bytes(b"1" * (LARGEST_BYTES + 1))
    (project / "binary.csv").write_bytes(b"\xff\xfe")
    with pytest.raises(FileError, match="more than 1000000 bytes"):
        files.read("large.csv")
    with pytest.raises(FileError, match="not UTF-8 at byte 0"):
        files.read("binary.csv")
    with pytest.raises(FileError, match="more than 1000000 bytes"):
        files.write("new.csv", "1" * (LARGEST_BYTES + 1), None)


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        ("/api/stop", {}, 404),
        ("/wrong/api/stop", {}, 404),
        (f"/{TOKEN}/api/stop", {"Origin": "http://example.org"}, 403),
        (f"/{TOKEN}/api/stop", {"Origin": "null"}, 403),
        (f"/{TOKEN}/api/stop", {"Host": "example.org"}, 421),
        (f"/{TOKEN}/api/stop", {"Content_Type": "text/plain"}, 415),
        (f"/{TOKEN}/api/absent", {}, 404),
    ],
)
def test_only_the_own_page_is_obeyed(
    address: str, path: str, headers: dict[str, str], status: int
) -> None:
    """Without the token, from another site, under another name: nothing."""
    with pytest.raises(urllib.error.HTTPError) as refused:
        post(address, path, {}, **headers)
    assert refused.value.code == status


def test_the_page_saves_and_builds(address: str, studio: Studio, project: Path) -> None:
    """The image's page is there afterwards, and each command line was told."""
    with open_page(f"{address}/{TOKEN}/api/file?path=design.py") as answer:
        opened = json.load(answer)
    body = {"path": "design.py", "text": "better\n", "version": opened["version"]}
    assert post(address, f"/{TOKEN}/api/save", body)["version"] != opened["version"]
    assert (project / "design.py").read_text() == "better\n"
    post(address, f"/{TOKEN}/api/run", {"command": "build", "scenario": "drive"})
    assert [call["ok"] for call in ended(studio)] == [True, True]
    lines = [event["line"] for _, event in studio.journal.after(0, 1) if "line" in event]
    assert [line.split()[:2] for line in lines] == [["ravenbrick", "build"], ["ravenbrick", "view"]]
    with open_page(f"{address}/{TOKEN}/brick/") as answer:
        assert (answer.read(), answer.headers["Content-Type"]) == (b"drive", "text/html")


def test_a_failed_build_has_places_and_keeps_the_image(studio: Studio, project: Path) -> None:
    """Line and column from 1, in files of the project."""
    studio.page = {"index.html": b"old"}
    (project / "design.py").write_text("bad\n")
    studio.run("build", None)
    (failed,) = ended(studio)
    place = {"file": "design.py", "line": 2, "column": 7, "message": "wrong"}
    other = {"file": None, "line": 0, "column": 0, "message": "and more"}
    assert failed["problems"] == [place, other]
    assert studio.page == {"index.html": b"old"}


def test_a_newer_build_replaces_the_one_that_runs(studio: Studio, project: Path) -> None:
    """The older one ends as if interrupted; the newer one is done."""
    (project / "design.py").write_text("slow\n")
    studio.run("build", None)
    studio.journal.after(0, 60)
    (project / "design.py").write_text("good\n")
    studio.run("build", None)
    first = ended(studio)
    while not any(call["ok"] for call in first):
        first = [event for _, event in studio.journal.after(len(first), 1) if "ok" in event]
    assert first[0]["stopped"] and first[0]["error"] == "a newer one replaces it"


def test_what_runs_is_ended_when_the_page_leaves(studio: Studio, project: Path) -> None:
    """Nobody waits for it."""
    (project / "design.py").write_text("slow\n")
    with studio.listening():
        studio.run("build", None)
    (stopped,) = ended(studio)
    assert stopped["error"] == "stopped: no page of the studio is open"


def test_other_commands_and_scenarios_are_refused(studio: Studio) -> None:
    """Nothing that the page sends becomes a word of a command line."""
    with pytest.raises(FileError, match="expected one of build"):
        studio.run("upload", None)
    with pytest.raises(FileError, match="expected a scenario"):
        studio.run("build", "--help")


def test_results_are_those_of_the_project(studio: Studio, project: Path) -> None:
    """Reports and pictures, nothing beside them."""
    results = Workspace.of(project).results
    results.mkdir(parents=True, exist_ok=True)
    (results / "report.html").write_text("report")
    (results / "summary.json").write_text("{}")
    assert studio.result("report.html") == b"report"
    assert studio.result("summary.json") is None
    assert studio.result("../../robot.toml") is None


def test_an_image_that_cannot_be_shown_is_an_error(studio: Studio) -> None:
    """With its sentence."""

    def refuse(_scenario: str | None) -> dict[str, bytes]:
        raise UsageError("no image")

    studio._show = refuse
    studio.run("view", None)
    (failed,) = ended(studio, "view")
    assert (failed["ok"], failed["error"]) == (False, "no image")
