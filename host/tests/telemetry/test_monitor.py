# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The loop: connections that break, records that survive, the command."""

from __future__ import annotations

import json
import os
import pty
import re
import socket
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.telemetry_program import Program, Server, sent
from verification.support.web import open_page

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode, UsageError
from ravenbrick.telemetry import Monitor, Session, Spool, open_link, replay
from ravenbrick.telemetry.links import LinkLostError
from ravenbrick.telemetry.messages import Ask
from ravenbrick.telemetry.spool import Direction, Entry, read_spool


@pytest.fixture
def server() -> Iterator[Server]:
    """A program whose link breaks after every 20 samples."""
    server = Server(Program(), samples=20)
    yield server
    server.close()


def test_nothing_recorded_is_lost_when_links_break(server: Server, tmp_path: Path) -> None:
    """Over at least three connections all samples are there; the record gives the same session."""
    record = tmp_path / "live.rbt"
    told: list[str] = []
    with Spool(record) as spool:
        session = Session()
        address = f"tcp:{server.port}"
        monitor = Monitor(session, lambda: open_link(address), spool, told.append)
        session.set_parameter("kp", 1.5)
        while monitor.losses < 3 or server.program.gains[0] != 1.5:
            monitor.poll()
        monitor.end()
    assert session.run is not None
    assert (session.run.sample_count, session.run.missing) == (20 * monitor.losses, 0)
    assert "connected again" in told
    again = replay(record)
    assert again.run is not None
    assert again.run.recording().digest == session.run.recording().digest


class Silent:
    """A link over which nothing comes."""

    def __init__(self) -> None:
        self.written: list[bytes] = []
        self.closed = False

    def read(self, timeout_s: float) -> bytes:
        """Nothing."""
        return b""

    def write(self, data: bytes) -> None:
        """Keep it."""
        self.written.append(data)

    def close(self) -> None:
        """Let go."""
        self.closed = True


def test_a_link_that_ends_is_closed_and_one_that_does_not_come_is_told_once() -> None:
    """Half a second passes between attempts."""
    link, missing, told, pauses = Silent(), [1, 2, 3], list[str](), list[float]()

    def connect() -> Silent:
        if missing:
            missing.pop()
            raise LinkLostError("no brick")
        return link

    monitor = Monitor(Session(), connect, tell=told.append, clock=lambda: 0.0, pause=pauses.append)
    while not monitor.connections:
        monitor.poll()
    assert told == ["no brick; trying again until it works", "connected"]
    assert pauses == [0.5, 0.5, 0.5]
    assert not link.closed
    monitor.end()
    assert link.closed


def test_a_record_can_be_read_while_it_grows_and_ends(tmp_path: Path) -> None:
    """What is added is there at once; nothing is added behind the end."""
    path, entry = tmp_path / "live.rbt", Entry(Direction.RECEIVED, 7, b"abc")
    with Spool(path) as spool:
        assert list(read_spool(path)) == []
        spool.add(entry)
        assert list(read_spool(path)) == [entry]
    with pytest.raises(ValueError, match="closed"):
        spool.add(entry)


def test_nothing_is_written_while_there_is_nothing_to_say() -> None:
    """After the question at the beginning, until time has passed."""
    link = Silent()
    monitor = Monitor(Session(), lambda: link, clock=lambda: 0.0)
    for _ in range(5):
        monitor.poll()
    assert len(link.written) == 1


def test_a_torn_record_keeps_what_came_before(tmp_path: Path) -> None:
    """Cut anywhere, a record can be read up to the cut; another file is refused in words."""
    record, program = tmp_path / "live.rbt", Program()
    pieces = [program.receive(sent(Ask())), *(program.sample(1, 1.0, 0.5) for _ in range(20))]
    with Spool(record) as spool:
        spool.add(Entry(Direction.CONNECTED, 0, b""))
        for at_us, piece in enumerate(pieces):
            spool.add(Entry(Direction.RECEIVED, at_us, piece))
    whole = record.read_bytes()
    counts = []
    for end in range(30, len(whole), 37):
        record.write_bytes(whole[:end])
        run = replay(record).run
        counts.append(run.sample_count if run else 0)
    assert counts == sorted(counts) and counts[-1] == 19
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
            answer = program.receive(os.read(ours, 1000))
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
    thread.join(timeout=60)
    os.close(ours)
    os.close(theirs)
    assert monitor.losses == 0


class Patient(Monitor):
    """Its thousand seconds are over when the first run is whole and the request is accepted."""

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


# The command, whose thousand seconds are over once a program has answered and a file is there.
COMMAND = """
import sys
from pathlib import Path
import ravenbrick.cli.monitor as monitor
from ravenbrick.cli import main
seen = Path(sys.argv.pop())

class Patient(monitor.Monitor):
    @property
    def now_s(self):
        return super().now_s + (1_000 if self.session.runs and seen.exists() else 0)

monitor.Monitor = Patient
main()
"""


def test_the_live_page_is_served_on_this_computer(server: Server, tmp_path: Path) -> None:
    """The page answers while the command runs, and the command ends by itself."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    arguments = ["monitor", f"tcp:{server.port}", "--page", str(port), "--seconds", "1000"]
    process = subprocess.Popen(
        [sys.executable, "-u", "-c", COMMAND, *arguments, str(tmp_path / "seen")],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    # The command takes another port than the one that was free, if that is in use by now.
    said = (
        re.search(r"the page is (http://127\.0\.0\.1:\d+/\S+/);", line) for line in process.stdout
    )
    address = next(found[1] for found in said if found)
    with open_page(address) as answer:
        page = answer.read().decode("utf-8")
    # A site whose name leads here by now, a socket of the sliders, a page without the token.
    for url, host, code in (
        (address, "attacker.example", 421),
        (f"{address}1/ws", "attacker.example", 421),
        (re.sub(r"/[^/]+/$", "/", address), "localhost", 404),
    ):
        with pytest.raises(urllib.error.HTTPError, match=str(code)):
            open_page(urllib.request.Request(url, headers={"Host": host}))
    (tmp_path / "seen").touch()
    told, _ = process.communicate(timeout=300)
    assert "Ravenbrick monitor" in page or "figure" in page
    assert process.returncode == 0, told
