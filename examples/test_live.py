# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program that runs, a monitor on its Bluetooth port, and the same run again from the record."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ravenbrick.brick.links.byte_ports import open_port
from ravenbrick.brick.links.live import LiveRecord, LiveRun, replay_live
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import PeerError
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import MonitorWindow, read_scenario, scenario_path
from ravenbrick.telemetry import Monitor, Session, open_link
from ravenbrick.telemetry.steps import live_steps
from ravenbrick.trace.schedule import jobs_of
from typer.testing import CliRunner

from tools.docs.live_steps import monitored_steps, steps_and_design

BENCH = Path(__file__).resolve().parent / "motor-bench"
LONGEST_S, LATE_S = 60.0, 0.2
SETTLED_US = 1_500_000
WISHES = {"setpoint": 3.0, "kp": 0.4}
WINDOW_S, QUANTUM_V = 0.032, 0.269


@pytest.fixture(scope="module")
def image() -> Any:
    """The image of the motor bench, built."""
    result = CliRunner().invoke(app, ["build", str(BENCH), "--json"])
    assert result.exit_code == 0, result.output
    return read_image(Path(json.loads(result.output)["image"]))


def prepared(image: Any) -> Any:
    """A brick with the step scenario: the motor starts after a second."""
    robot = read_robot(BENCH)
    scenario = read_scenario(scenario_path(BENCH, "step"), robot)
    return VirtualTarget().prepare(robot, scenario, image)


class Pace:
    """The monitor's clock is the brick's, and the brick waits for a monitor that is late: what is
    said again, or given up, does not depend on how busy the computer is."""

    def __init__(self) -> None:
        self.now_s, self._heard_s = 0.0, 0.0
        self._polled = threading.Event()

    def polled(self) -> None:
        """The monitor has taken what had come."""
        self._polled.set()

    def reached(self, now_s: float) -> None:
        """The brick has come so far."""
        self.now_s = now_s
        if self._polled.is_set() or now_s - self._heard_s > LATE_S:
            self._polled.wait(LONGEST_S)
            self._polled.clear()
            self._heard_s = now_s


@pytest.mark.parametrize("kind", ["tcp:0", "pty"])
def test_a_monitored_run_plays_again(image: Any, tmp_path: Path, kind: str) -> None:
    """Signals arrive, set-point and gain change on the brick, the record gives the same run."""
    port, record = open_port(kind), LiveRecord("step")
    session, pace = Session(), Pace()
    monitor = Monitor(session, lambda: open_link(port.address), clock=lambda: pace.now_s)
    for name, value in WISHES.items():
        session.set_parameter(name, value)
    finished = threading.Event()

    def listen() -> None:
        while not finished.is_set():
            monitor.poll()
            pace.polled()
        monitor.end()

    listener = threading.Thread(target=listen)
    listener.start()
    brick = prepared(image)
    accepted_us: list[int] = []

    def settled() -> bool:
        """The monitor has heard that both changes were accepted, and then the speed follow them."""
        pace.reached(MASTER_CLOCK.seconds(brick.cycles))
        run, parameters, values = session.run, dict(session.parameters), dict(session.values)
        wished = {p.name: values.get(i) for i, p in parameters.items() if p.name in WISHES}
        if run is None or wished != pytest.approx(WISHES):
            return False
        if not accepted_us:
            accepted_us.append(run.last_us)
        return run.last_us - accepted_us[0] > SETTLED_US

    try:
        stopped = LiveRun(brick, port, record, "1234").run(LONGEST_S, settled)
    finally:
        finished.set()
        listener.join()
        port.close()
    assert stopped.reason == "reached"
    run = session.run
    assert run is not None and run.missing == 0
    assert {p.name: session.values[i] for i, p in session.parameters.items()} == pytest.approx(
        {**WISHES, "ki_ts": 0.0322144}
    )
    recording = run.recording()
    assert recording.signal("setpoint")[1][-1] == 3.0
    times, speeds = recording.signal("speed")
    assert np.mean(speeds[times > times[-1] - SETTLED_US / 3e6]) == pytest.approx(3.0, abs=0.2)
    assert len(live_steps(recording, "setpoint", "speed")) >= 1
    record.save(tmp_path / "run.json")
    assert replay_live(prepared(image), LiveRecord.load(tmp_path / "run.json"))


def test_a_scenario_s_monitor_takes_samples_from_its_begin_to_its_end(image: Any) -> None:
    """The server works while the monitor listens, and every run of the scenario is the same."""
    robot = read_robot(BENCH)
    scenario = read_scenario(scenario_path(BENCH, "monitored"), robot)
    recording = VirtualTarget().run(robot, scenario, image)
    assert VirtualTarget().run(robot, scenario, image).digest == recording.digest
    server_task = [thread.name.lower() for thread in recording.threads].index("server_task")
    jobs = [job for job in jobs_of(recording, server_task)[1:] if job.response_time_cycles]
    second = MASTER_CLOCK.hertz

    def longest(begin_s: float, end_s: float) -> int:
        chosen = [j for j in jobs if begin_s * second <= j.release_cycles < end_s * second]
        return max(job.response_time_cycles or 0 for job in chosen)

    assert longest(2.0, 5.0) > 2 * longest(0.5, 1.0)
    assert longest(5.5, 6.0) < longest(2.0, 5.0) / 2


def test_a_scenario_s_monitor_asks_until_the_program_listens(image: Any) -> None:
    """From the first instant on, before Bluetooth is up; a wrong PIN is told, not passed over."""
    robot = read_robot(BENCH)
    scenario = read_scenario(scenario_path(BENCH, "monitored"), robot)
    early = replace(scenario, duration_ms=2_500, monitor=MonitorWindow("1234", 0, None))
    recording = VirtualTarget().run(robot, early, image)
    server_task = [thread.name.lower() for thread in recording.threads].index("server_task")
    latest = [job for job in jobs_of(recording, server_task) if job.response_time_cycles][-20:]
    idle = VirtualTarget().run(robot, replace(early, monitor=None), image)
    quiet = [job for job in jobs_of(idle, server_task) if job.response_time_cycles][-20:]
    longest, usual = (max(j.response_time_cycles or 0 for j in jobs) for jobs in (latest, quiet))
    assert longest > 2 * usual
    wrong = replace(early, monitor=MonitorWindow("4321", 0, None))
    with pytest.raises(PeerError, match=r"got no connection from 0 ms on; .* PIN of \[monitor\]"):
        VirtualTarget().run(robot, wrong, image)


def test_live_steps_lie_on_the_design() -> None:
    """Four steps up and down on the axes of the design: late by the speed's window, then on it,
    but for the counts of which the program makes the speed."""
    steps, design = steps_and_design(each_ms=600)
    assert [round(step.height, 3) for step in steps] == [4.0, -2.0, 3.0, -2.0]
    sampled = design.responses["sampled"]
    for step in steps:
        designed = np.interp(step.times, sampled.times, sampled.values)
        off = step.values - designed
        assert abs(np.mean(off[step.times > 0.3])) < 0.02
        assert np.mean(np.abs(off)) < QUANTUM_V / abs(step.height)
        delayed = np.interp(step.times - WINDOW_S / 2, sampled.times, sampled.values)
        assert np.mean(np.abs(step.values - delayed)) < np.mean(np.abs(off))


@pytest.mark.long("fits two recordings")
def test_a_live_record_feeds_identification(image: Any, tmp_path: Path) -> None:
    """Voltage and angle as the program published them: the motor's gain and time constant."""
    for name, steps in (
        ("fit", [4.0, 2.0, -3.0, 1.0, 5.0, -1.5, 3.0, -4.5, 2.5]),
        ("check", [2.0, 4.5, -2.0, 3.0, -4.0, 1.0, 3.5]),
    ):
        run = monitored_steps(image, steps, 400).run
        assert run is not None and run.missing == 0
        run.recording().save(tmp_path / f"{name}.npz")
    command = ["identify", str(BENCH), str(tmp_path / "fit.npz"), str(tmp_path / "check.npz")]
    result = CliRunner().invoke(app, [*command, "--output", str(tmp_path / "motor.toml"), "--json"])
    assert result.exit_code == 0, result.output
    found = json.loads(result.output)["parameters"]
    assert found["gain"]["value"] == pytest.approx(2.029, rel=0.01)
    assert found["time_constant"]["value"] == pytest.approx(0.037, rel=0.05)
    wrong = CliRunner().invoke(app, [*command, "--signals", "speed"])
    assert wrong.exit_code == 2 and "expected VOLTAGE:ANGLE" in wrong.output


def test_a_changed_record_is_another_run(image: Any, tmp_path: Path) -> None:
    """The comparison can fail; a damaged record is refused in words."""
    port, record = open_port("tcp:0"), LiveRecord("step")
    LiveRun(prepared(image), port, record, "1234", speed=0.0).run(0.5)
    port.close()
    record.digest = record.digest[::-1]
    assert not replay_live(prepared(image), record)
    broken = tmp_path / "run.json"
    broken.write_text('{"format": "ravenbrick live run 1", "signals": 3}')
    result = CliRunner().invoke(app, ["live", str(BENCH), "step", "--replay", str(broken)])
    assert result.exit_code == 2 and "not the record of a live run" in result.output
