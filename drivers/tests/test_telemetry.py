# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Telemetry over Bluetooth, with the host's own session at the other end of the air."""

from __future__ import annotations

import json
import random
import threading
from collections.abc import Callable

import numpy as np
import pytest
import virtual_brick
from ravenbrick.brick.links.byte_ports import open_port
from ravenbrick.brick.links.live import LiveRecord, LiveRun, replay_live
from ravenbrick.brick.links.peers import BluetoothComputer, StreamPeer, UsbStream
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.telemetry import Monitor, Session, open_link
from ravenbrick.telemetry.frames import frame
from ravenbrick.telemetry.messages import Ask, Refused, SetParameter, Verdict, encode

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick, bench

START_MS = 1500
PERIOD_US = 4_000


class Host:
    """The session on a computer near the brick."""

    def __init__(self, brick: Brick, computer: StreamPeer) -> None:
        self.brick = brick
        self.computer = computer
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
    return Host(device, BluetoothComputer(device.device, pin="1234"))


@pytest.fixture
def usb_host(brick: Callable[..., Brick]) -> Host:
    """A brick whose program serves its USB, and a host at the other end of the cable."""
    device = brick("telemetry_usb")
    device.run(100)
    return Host(device, UsbStream(device.device))


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


def assert_that_the_run_continues(host: Host) -> None:
    """The host connects again half a second after a loss: the same run, and no time is missing."""
    host.connect()
    host.talk(300)
    run = host.session.run
    assert run is not None and len(host.session.runs) == 1
    times, counts = run.recording().signal("count")
    assert float(times[-1] - times[0]) > 1.0
    assert np.allclose(np.diff(times) * 1e6, np.diff(counts) * PERIOD_US, atol=100)


def test_a_lost_link_loses_no_time_of_the_program(host: Host) -> None:
    """The connection breaks: the program goes on; the next connection continues the same run."""
    host.connect()
    host.talk(300)
    host.computer.close()
    host.run(500)
    assert_that_the_run_continues(host)


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


def test_the_cable_carries_it_too(usb_host: Host) -> None:
    """Eight signals every 4 ms over USB, 11 KB/s: none missing, in time, parameters change."""
    usb_host.connect()
    usb_host.talk(500)
    usb_host.session.set_parameter("ki", 12.5)
    usb_host.talk(500)
    session = usb_host.session
    assert session.described and session.run is not None
    assert session.run.name == "usb test"
    assert session.run.missing == 0 and session.status.dropped == 0
    times, counts = session.run.recording().signal("count")
    assert len(counts) > 220 and np.all(np.diff(counts) == 1)
    assert np.all(np.abs(np.diff(times) * 1e6 - PERIOD_US) < 100)
    assert session.run.recording().signal("gain8")[1][-1] == 12.5


def test_a_cable_that_is_pulled_loses_no_time_of_the_program(usb_host: Host) -> None:
    """Out, in again: the same run goes on, and what was published meanwhile is counted."""
    usb_host.connect()
    usb_host.talk(300)
    usb_host.computer.close()
    usb_host.run(500)
    assert not usb_host.computer.connected
    assert_that_the_run_continues(usb_host)


def test_garbage_on_the_cable_does_no_harm(usb_host: Host) -> None:
    """Noise in packets of all sizes: no period is missed, and the program answers afterwards."""
    usb_host.connect()
    rng = random.Random(1)
    for _ in range(40):
        usb_host.computer.write(rng.randbytes(rng.randint(1, 200)))
        usb_host.talk(20)
    before = usb_host.brick.integer("published")
    usb_host.talk(1000)
    assert usb_host.brick.integer("published") - before == pytest.approx(250, abs=1)
    assert usb_host.session.status.damaged > 3
    usb_host.session.set_parameter("ki", 1.5)
    usb_host.talk(700)
    assert usb_host.session.values[0] == 1.5


def test_a_monitored_run_over_the_cable_plays_again() -> None:
    """What the USB host did is recorded with its cycles and gives the same run."""

    def fresh() -> virtual_brick.VirtualBrick:
        return virtual_brick.VirtualBrick(json.dumps(bench()), image_of("telemetry_usb", "ram"))

    port, record = open_port("tcp:0"), LiveRecord("none")
    session = Session()
    session.set_parameter("ki", 3.0)
    monitor = Monitor(session, lambda: open_link(port.address))
    finished = threading.Event()

    def enough() -> bool:
        return session.run is not None and session.run.sample_count > 100

    def listen() -> None:
        while not finished.is_set():
            monitor.poll()
        monitor.end()

    listener = threading.Thread(target=listen)
    listener.start()
    try:
        LiveRun(fresh(), port, record, None, speed=10.0).run(1_000.0, enough)
    finally:
        finished.set()
        listener.join()
        port.close()
    assert enough() and session.run is not None and session.run.missing == 0
    assert record.cable and not record.signals
    assert replay_live(fresh(), record)
