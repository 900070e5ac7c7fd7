# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick debug`: GDB itself on the vehicle's real image."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
from queue import Queue
from threading import Thread

import pytest
from tools.docs import gdb_session
from tools.docs.gdb_session import talk
from typer.testing import CliRunner
from verification.support.gdb_replies import whole_reply
from verification.support.needed_tools import NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.cli.debug import GDB, gdb_command
from ravenbrick.errors import ExitCode
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace

COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()", "debug", str(VEHICLE)]
COMMAND += ["--image", "ram"]
ELF = Workspace.of(VEHICLE).image("ram", "vehicle")
LONGEST_S = 300

pytestmark = [
    pytest.mark.skipif(
        shutil.which(GDB) is None,
        reason=f"{GDB} is not installed (Debian package gdb-multiarch)",
    ),
    NEEDS_VIRTUAL_BRICK,
    pytest.mark.skipif(
        not ELF.is_file(), reason="the vehicle is not built; 'ravenbrick build' builds it"
    ),
]


def drive() -> tuple[Robot, Scenario, ElfImage]:
    """The vehicle's drive."""
    robot = read_robot(VEHICLE)
    return robot, read_scenario(scenario_path(VEHICLE, "drive"), robot), read_image(ELF)


def gdb(*commands: str) -> list[str]:
    """GDB on a drive of the vehicle, served from this process."""
    brick = VirtualTarget().prepare(*drive())
    ports: Queue[int] = Queue()
    server = Thread(
        target=brick.serve_debugger, kwargs={"on_listening": ports.put, "once": True}, daemon=True
    )
    server.start()
    program, *words = gdb_command(GDB, ELF, ports.get(timeout=LONGEST_S))
    said = talk([program, "-l", str(LONGEST_S), *words], commands)
    server.join(timeout=LONGEST_S)
    assert not server.is_alive()
    return said


def brick_seconds(said: str) -> float:
    """The time that `monitor time` tells."""
    found = re.search(r"cycle \d+, ([\d.]+) s", said)
    assert found, said
    return float(found.group(1))


def test_a_breakpoint_in_a_task_shows_its_source_and_all_tasks_by_name() -> None:
    """Ada source, backtraces of running and waiting tasks, names, states, a variable."""
    _, stop, backtrace, threads, mode, others = gdb(
        "tbreak tasks.adb:26",
        "continue",
        "bt",
        "info threads",
        "print vehicle.now.mode",
        "thread apply all bt",
    )
    assert re.search(r"tasks\.adb:26\n26\s+Driving\.Control \(Vehicle\);", stop)
    assert re.search(r"#0 +tasks\.control_task .*tasks\.adb:26", backtrace)
    assert re.search(r"\* \d+ +Thread 1\.4 \(control_task: running, priority 2\)", threads)
    assert "(coprocessor_task: delayed, priority 30)" in threads
    assert re.search(r"\(display_task: \w+, priority 1\)", threads)
    assert mode == "$1 = stopped"
    # Tasks that wait are unwound through the run-time into their bodies.
    assert re.search(r"delay_until .*\n.*nxt\.avr\.coprocessor_task .*nxt-avr\.adb", others)
    assert re.search(r"delay_until .*\n.*vehicle \(\) at .*vehicle\.adb", others)


def test_going_back_finds_who_wrote_a_variable() -> None:
    """From the display task back to the assignment in the control task, and forwards again."""
    *_, value, _, written, backtrace, earlier, before, _, again, later = gdb(
        "break driving.begin_drive",
        "continue",
        "delete",
        "tbreak panel.draw",
        "continue",
        "monitor time",
        "print vehicle_control_left",
        "watch vehicle_control_left",
        "reverse-continue",
        "bt",
        "monitor time",
        "print vehicle_control_left",
        "delete",
        "next",
        "print vehicle_control_left",
    )
    new = value.removeprefix("$1 = ")
    assert float(new) > 1.0
    old = before.removeprefix("$2 = ")
    assert f"Old value = {new}\nNew value = {old}\npanel.publish" in written
    assert re.search(r"Control_Left := Now\.Wheels \(Left\)\.Control;$", written)
    assert re.search(r"#1 .* tasks\.control_task .*tasks\.adb:27", backtrace)
    assert 1.0 < brick_seconds(earlier) < 1.6
    assert "panel.adb:6" in again or "Now." in again
    assert later == f"$3 = {new}"


def test_the_session_of_the_guide_is_what_gdb_says() -> None:
    """Held again, it has the same stops, callers and values' names, and finds the same line."""
    shown = gdb_session.guide_session()
    told = gdb_session.compared(gdb_session.hold())
    assert told == gdb_session.compared(shown)
    assert any(gdb_session.FOUND in line for line in told)
    assert "No more reverse-execution history." in shown


def test_the_monitor_shows_record_peripherals_and_plant() -> None:
    """At a release of the control task, on the vehicle."""
    *_, trace, timer, plant = gdb(
        "tbreak tasks.adb:26",
        "continue",
        "monitor trace",
        "monitor peripherals TC0",
        "monitor plant",
    )
    assert re.search(r"^ *\d+ +thread_running +control_task", trace, re.MULTILINE)
    assert re.search(r"^TC0 CV +FFFA0010 +[0-9A-F]{8}$", timer, re.MULTILINE)
    assert re.search(r"^battery\.voltage +[78]\.\d+$", plant, re.MULTILINE)


def test_a_step_over_a_delay_follows_the_task_forwards_and_backwards() -> None:
    """`next` over `delay until` is 4 ms later in the same task; a breakpoint leads back."""
    said = gdb(
        "tbreak tasks.adb:28",
        "continue",
        "next",
        "monitor time",
        "next",
        "monitor time",
        "reverse-stepi",
        "bt",
        "tbreak tasks.adb:25",
        "reverse-continue",
        "monitor time",
    )
    at_delay, after_delay, back = (brick_seconds(said[index]) for index in (3, 5, 10))
    assert "delay until Next_Release;" in said[2]
    assert "Driving.Control (Vehicle);" in said[4]
    assert 0.003 < after_delay - at_delay < 0.0041
    assert re.search(r"tasks\.control_task .*tasks\.adb:2[56]", said[7])
    assert back == at_delay


def test_watched_registers_stop_at_each_access_and_say_what_is_written() -> None:
    """GDB itself would pass in silence over a write that it cannot read back."""
    _, _, _, write, written_by, backwards, *_, access = gdb(
        "tbreak tasks.control_task",
        "continue",
        "watch nxt.registers.pio.pioa.pio_sodr",
        "continue",
        "bt 1",
        "reverse-continue",
        "delete",
        "awatch nxt.registers.pio.pioa.pio_sodr",
        "continue",
    )
    assert write.count("stops (SIGUSR1) when the program writes it, not when the hardware") == 1
    for stop in (write, backwards, access):
        assert "watched register: the program writes 0x00001000 to 0xfffff430" in stop
    assert "SIGUSR1" in write and "SIGUSR1" in backwards
    assert "nxt-spi-bus.adb" in written_by
    assert "Hardware access (read/write) watchpoint" in access


def test_the_debugged_run_is_the_run() -> None:
    """With a stop, back to the beginning and to the end, its digest is `ravenbrick run`'s."""
    _, stop, _, begin, _, why, digest = gdb(
        "tbreak driving.begin_drive",
        "continue",
        "reverse-continue",
        "bt",
        "continue",
        "monitor why",
        "monitor digest",
    )
    assert "driving.begin_drive" in stop
    assert begin.startswith("#0  ravenbrick_vectors ()")
    assert why.startswith("power_off at cycle")
    assert digest == VirtualTarget().run(*drive()).digest


def test_inputs_set_by_hand_drive_the_vehicle_and_the_display_is_read_as_text() -> None:
    """The command itself, without a scenario: `monitor set` presses, `reset` begins again."""
    commands = (
        "tbreak panel.draw",
        "continue",
        "monitor set touch.1 1",
        "tbreak driving.begin_drive",
        "continue",
        "tbreak panel.draw",
        "continue",
        "finish",
        "tbreak driving.control",
        "continue",
        "monitor lcd",
        "reset",
        "bt",
        "monitor time",
    )
    said = talk([*COMMAND, "--gdb", "--port", "0"], commands)
    assert said[2] == "touch.1 = 1 from now on"
    assert "driving.begin_drive" in said[4]
    assert "|volts left right|" in said[10]
    assert said[12].startswith("#0  ravenbrick_vectors ()")
    assert brick_seconds(said[13]) == 0.0


def test_a_debugger_of_ones_own_connects_to_the_printed_port() -> None:
    """The server prints GDB's command line, serves who connects, and ends when killed."""
    server = subprocess.Popen([*COMMAND, "drive", "--port", "0"], stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        first, second = server.stdout.readline(), server.stdout.readline()
        port = int(re.findall(r"127\.0\.0\.1:(\d+)", first)[0])
        assert f"'target remote 127.0.0.1:{port}' {ELF}" in second
        with socket.create_connection(("127.0.0.1", port), timeout=LONGEST_S) as client:
            client.sendall(b"$?#3f")
            assert b"T05" in whole_reply(client)
            client.sendall(b"$k#6b")
        assert server.wait(timeout=LONGEST_S) == 0
    finally:
        server.kill()
        server.communicate()


def test_a_port_in_use_and_a_missing_gdb_are_sentences_with_exit_codes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing of Python's own shows."""
    run = CliRunner().invoke
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        done = run(app, ["debug", str(VEHICLE), "drive", "--port", port])
        assert done.exit_code == int(ExitCode.USAGE)
        assert f"cannot use port {port}" in done.stderr
        done = run(app, ["debug", str(VEHICLE), "drive", "--gdb", "--port", port])
        assert done.exit_code == int(ExitCode.USAGE)
    monkeypatch.setenv("PATH", "")
    done = run(app, ["debug", str(VEHICLE), "drive", "--gdb"])
    assert done.exit_code == int(ExitCode.TOOL_MISSING)
    assert "Debian package gdb-multiarch" in done.stderr
