# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The loop: connections that break, records that survive, the command."""

from __future__ import annotations

import json
import os
import pty
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from host.tests.telemetry.fake_program import Program, Server
from typer.testing import CliRunner

from ravenbrick.cli import app
from ravenbrick.errors import ExitCode, UsageError
from ravenbrick.telemetry import Monitor, Session, Spool, open_link, replay


@pytest.fixture
def server() -> Iterator[Server]:
    """A program whose link breaks after every 20 samples."""
    server = Server(Program(), samples=20)
    yield server
    server.close()


def test_nothing_recorded_is_lost_when_links_break(server: Server, tmp_path: Path) -> None:
    """Over three connections all samples are there, and the record gives the same session."""
    record = tmp_path / "live.rbt"
    told: list[str] = []
    with Spool(record) as spool:
        session = Session()
        address = f"tcp:{server.port}"
        monitor = Monitor(session, lambda: open_link(address), spool, told.append)
        session.set_parameter("kp", 1.5)
        while monitor.losses < 3:
            monitor.poll()
        monitor.end()
    assert session.run is not None
    assert session.run.sample_count + session.run.missing == 60
    assert session.run.missing == 0
    assert server.program.gains[0] == 1.5
    assert "connected again" in told
    again = replay(record)
    assert again.run is not None
    assert again.run.recording().digest == session.run.recording().digest


def test_a_torn_record_keeps_what_came_before(server: Server, tmp_path: Path) -> None:
    """Cut anywhere, a record can be read up to the cut; another file is refused in words."""
    record = tmp_path / "live.rbt"
    with Spool(record) as spool:
        monitor = Monitor(Session(), lambda: open_link(f"tcp:{server.port}"), spool)
        while monitor.losses < 1:
            monitor.poll()
    whole = record.read_bytes()
    counts = []
    for end in range(30, len(whole), 37):
        record.write_bytes(whole[:end])
        run = replay(record).run
        counts.append(run.sample_count if run else 0)
    assert counts == sorted(counts) and counts[-1] >= 19
    record.write_bytes(b"something else")
    with pytest.raises(UsageError, match="not a telemetry record"):
        replay(record)
    with pytest.raises(UsageError, match="exists already"):
        Spool(record)


def test_a_pseudo_terminal_is_a_serial_device() -> None:
    """The same conversation over a device."""
    ours, theirs = pty.openpty()
    os.set_blocking(ours, True)
    program = Program()
    finished = threading.Event()

    def brick() -> None:
        while not finished.is_set():
            answer = program.hear(os.read(ours, 1000))
            program.time_us += 1
            os.write(ours, answer + program.sample(1, 2.0, 1.0))

    thread = threading.Thread(target=brick, daemon=True)
    thread.start()
    session = Session()
    monitor = Monitor(session, lambda: open_link(os.ttyname(theirs)))
    while session.run is None or not session.run.sample_count:
        monitor.poll()
    finished.set()
    monitor.end()
    thread.join(timeout=5)
    os.close(ours)
    os.close(theirs)
    assert monitor.losses == 0


class Patient(Monitor):
    """Its thousand seconds are over when the first run is whole and the wish is granted."""

    @property
    def now_s(self) -> float:
        values = self.session.values.values()
        whole = bool(self.session.runs) and self.session.runs[0].sample_count >= 20
        return super().now_s + (1_000 if whole and set(values) == {0.5, 12.0} else 0)


def test_the_command_records_and_changes(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`ravenbrick monitor` writes record, recording and picture, and says what it did."""
    monkeypatch.setattr("ravenbrick.cli.monitor.Monitor", Patient)
    record, stem = tmp_path / "live.rbt", tmp_path / "out" / "live"
    arguments = ["monitor", f"tcp:{server.port}", "--seconds", "1000", "--set", "ki=12"]
    result = CliRunner().invoke(
        app, [*arguments, "--record", str(record), "--out", str(stem), "--json"]
    )
    assert result.exit_code == 0, result.output
    told = json.loads(result.output)
    assert told["parameters"] == {"ki": 12.0, "kp": 0.5}
    assert told["runs"][0]["samples"] >= 20
    assert [Path(name).name for name in told["files"]] == ["live.npz", "live.png"]
    again = CliRunner().invoke(app, ["monitor", str(record), "--json"])
    assert json.loads(again.output)["runs"] == told["runs"]


def test_nobody_there_is_said() -> None:
    """Exit code 11 after the time is over, with what to check."""
    result = CliRunner().invoke(app, ["monitor", "tcp:1", "--seconds", "0.2"])
    assert result.exit_code == ExitCode.CONNECTION_FAILED
    assert "no program with telemetry answered" in result.output


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["tcp:nowhere:x"], "expected tcp:PORT"),
        (["tcp:5555", "--set", "kp"], "expected NAME=VALUE"),
        (["tcp:5555", "--step", "a:b"], "--step and --design go together"),
    ],
)
def test_wrong_arguments_are_named(arguments: list[str], text: str) -> None:
    """Usage errors end with 2 and say what was expected."""
    result = CliRunner().invoke(app, ["monitor", *arguments])
    assert result.exit_code == ExitCode.USAGE
    assert text in result.output


def page_during(seconds: int, server: Server) -> tuple[str, int]:
    """What the live page says while the command runs so long, and the command's exit code."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    code = "from ravenbrick.cli import main; main()"
    arguments = ["monitor", f"tcp:{server.port}", "--page", str(port), "--seconds", str(seconds)]
    process = subprocess.Popen([sys.executable, "-c", code, *arguments], text=True)
    page = ""
    while not page and process.poll() is None:
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=60) as answer:
                page = answer.read().decode("utf-8")
        except OSError:
            time.sleep(0.1)
    return page, process.wait(timeout=60 + seconds)


def test_the_live_page_is_served_on_this_computer(server: Server) -> None:
    """The page answers while the command runs, and the command ends by itself."""
    page, code = page_during(4, server)
    if not page:
        # A busy computer needs longer for the first page.
        page, code = page_during(60, server)
    assert "Ravenbrick monitor" in page or "figure" in page
    assert code == 0
