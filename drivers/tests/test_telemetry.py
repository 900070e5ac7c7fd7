# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Telemetry over Bluetooth, with the host's own session at the other end of the air."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
import pytest
from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.peers import BluetoothComputer
from ravenbrick.telemetry import Session
from ravenbrick.telemetry.frames import frame
from ravenbrick.telemetry.messages import Ask, Refused, SetParameter, Verdict, encode

from drivers.tests.observe import Brick

START_MS = 1500
PERIOD_US = 4_000


class Host:
    """The session on a computer near the brick."""

    def __init__(self, brick: Brick) -> None:
        self.brick = brick
        self.computer = BluetoothComputer(brick.device, pin="1234")
        self.session = Session()

    @property
    def now_s(self) -> float:
        """Seconds since power-on."""
        return MASTER_CLOCK.seconds(self.brick.device.cycles)

    def run(self, ms: float) -> None:
        """Let time pass in silence."""
        self.brick.device.run_until(self.brick.device.cycles + self.brick.cycles(ms))

    def ask(self) -> None:
        """Begin the conversation anew."""
        self.computer.write(self.session.connected(self.now_s))

    def connect(self) -> None:
        """Connect and ask."""
        self.computer.connect(timeout_ms=1000)
        self.run(50)
        self.ask()

    def talk(self, ms: float) -> None:
        """Let time pass in the conversation."""
        end_s = self.now_s + ms / 1000
        while self.now_s < end_s:
            if data := self.session.pending(self.now_s):
                self.computer.write(data)
            self.run(10)
            self.session.receive(self.computer.take())


@pytest.fixture
def host(brick: Callable[..., Brick]) -> Host:
    """A brick whose program listens, and a host near it."""
    device = brick("telemetry")
    device.run(START_MS)
    return Host(device)


def test_signals_arrive_with_their_instants(host: Host) -> None:
    """All signals are described; samples are there, none missing, 4 ms and 100 ms apart."""
    host.connect()
    host.talk(1000)
    session = host.session
    assert session.described and session.run is not None
    assert session.run.name == "test"
    assert session.run.missing == 0 and session.status.dropped == 0
    recording = session.run.recording()
    times, counts = recording.signal("count")
    assert len(counts) > 200
    assert np.all(np.diff(counts) == 1)
    assert np.all(np.abs(np.diff(times) * 1e6 - PERIOD_US) < 100)
    _, odd = recording.signal("odd")
    assert np.array_equal(odd, counts % 2)
    slow_times, slow = recording.signal("slow")
    assert np.all(np.diff(slow) == 25 / 4) and len(slow) >= 9
    assert np.allclose(np.diff(slow_times), 0.1, atol=1e-3)


def test_parameters_change_while_the_program_runs(host: Host) -> None:
    """An accepted value is in force at once; the brick refuses one outside, and what is none."""
    host.connect()
    host.talk(300)
    host.session.set_parameter("ki", 12.5)
    host.talk(100)
    assert host.session.values[1] == 12.5
    assert host.session.run is not None
    assert host.session.run.recording().signal("setpoint")[1][-1] == 12.5
    for number, wrong in enumerate((51.0, -1.0, float("nan"), float("inf"))):
        host.computer.write(frame(encode(SetParameter(1, wrong))))
        host.talk(50)
        assert len(host.session.answers) == 2 + number
        assert host.session.answers[-1].verdict is Verdict.OUT_OF_RANGE
    host.computer.write(frame(encode(SetParameter(2, 1.0))))
    host.talk(50)
    assert host.session.answers[-1].verdict is Verdict.UNKNOWN
    assert host.session.run.recording().signal("setpoint")[1][-1] == 12.5


def test_a_lost_link_loses_no_time_of_the_program(host: Host) -> None:
    """The connection breaks: the program goes on; the next connection continues the same run."""
    host.connect()
    host.talk(300)
    host.computer.close()
    host.run(500)
    host.connect()
    host.talk(300)
    run = host.session.run
    assert run is not None and len(host.session.runs) == 1
    times, counts = run.recording().signal("count")
    assert float(times[-1] - times[0]) > 1.0
    assert np.allclose(np.diff(times) * 1e6, np.diff(counts) * PERIOD_US, atol=100)


def test_a_silent_host_is_left_alone(host: Host) -> None:
    """Three seconds without a word, and the brick is quiet until it is asked again."""
    host.connect()
    host.talk(300)
    host.run(3500)
    host.computer.take()
    host.run(500)
    assert host.computer.take() == b""
    host.ask()
    host.talk(200)
    assert host.session.run is not None and host.session.run.groups[1].times_us[-1] > 5_000_000


def test_another_version_is_refused(host: Host) -> None:
    """The brick says which version it speaks, and nothing else."""
    host.computer.connect(timeout_ms=1000)
    host.run(50)
    host.computer.write(frame(encode(Ask(9))))
    host.run(200)
    answer = host.computer.take()
    assert answer == frame(encode(Refused(1)))


def test_garbage_does_no_harm(host: Host) -> None:
    """Two seconds of noise: the program misses no period and answers afterwards."""
    host.connect()
    host.talk(100)
    rng = random.Random(1)
    for _ in range(40):
        host.computer.write(rng.randbytes(rng.randint(1, 120)))
        host.talk(50)
    before = host.brick.integer("published")
    host.talk(1000)
    assert host.brick.integer("published") - before == pytest.approx(250, abs=1)
    assert host.session.status.damaged > 3
    host.session.set_parameter("kp", 1.5)
    host.talk(700)
    assert host.session.values[0] == 1.5
