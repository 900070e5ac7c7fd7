# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The conversation: descriptions, samples, parameters, losses, restarts, other versions."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from verification.support.paths import ROOT
from verification.support.telemetry_program import SIGNALS, Program, sent

from ravenbrick.errors import UsageError
from ravenbrick.telemetry import Session, VersionError, messages
from ravenbrick.trace.export import Format, export
from ravenbrick.trace.recording import Recording


def talking(program: Program) -> Session:
    """A session that has heard all descriptions."""
    session = Session()
    session.receive(program.receive(session.connected(0.0)))
    assert session.described
    return session


EXAMPLES: list[messages.Message] = [
    messages.Hello(1, 3, 2, 5_000_000_000, "vehicle"),
    *SIGNALS,
    messages.ParameterDescription(3, -1.0, 1.0, 0.25, "kp", "V/rad"),
    messages.Sample(2, 65_535, 4_294_967_295, (b"abcd", b"efgh")),
    messages.Answer(1, messages.Verdict.OUT_OF_RANGE, 0.5),
    messages.Status(1, 2, 3),
    messages.Refused(2),
    messages.Ask(),
    messages.SetParameter(1, 2.5),
    messages.KeepAlive(),
    messages.Stop(),
]


@pytest.mark.parametrize("message", EXAMPLES, ids=lambda m: type(m).__name__)
def test_messages_survive(message: messages.Message) -> None:
    """What is encoded is decoded, and no part of it is."""
    content = messages.encode(message)
    assert messages.decode(content) == message
    if not isinstance(message, messages.Sample):
        assert messages.decode(content + b"x") is None
    assert all(
        messages.decode(content[:end]) is None for end in range(1, len(content)) if end % 4 != 0
    )


def test_random_contents_are_messages_or_nothing() -> None:
    """No content raises anything."""
    rng = random.Random(1)
    for _ in range(20_000):
        message = messages.decode(rng.randbytes(rng.randint(0, 40)))
        assert message is None or messages.decode(messages.encode(message)) is not None


def test_a_sample_that_comes_again_is_refused() -> None:
    """It is no loss of all numbers between."""
    program = Program()
    session = talking(program)
    first, second = program.sample(1, 1.0, 2.0), program.sample(1, 3.0, 4.0)
    session.receive(first + second + first + program.sample(1, 5.0, 6.0))
    run = session.run
    assert run is not None
    assert (run.sample_count, run.refused, run.missing) == (3, 1, 0)
    assert run.recording().signal("setpoint")[1].tolist() == [1.0, 3.0, 5.0]


def test_numbers_and_instants_wrap() -> None:
    """After 65,535 comes 0, and a pause of half an hour is one, though instants have 32 bits."""
    program = Program(time_us=2**32 - 6_000)
    session = talking(program)
    program.numbers[1] = 65_534
    pauses_us = (4_000, 4_000, 1_800_000_000)
    for pause_us in (*pauses_us, 0):
        session.receive(program.sample(1, 0.0, 0.0))
        program.time_us += pause_us
    run = session.run
    assert run is not None
    assert (run.sample_count, run.refused, run.missing) == (4, 0, 0)
    recording = run.recording()
    assert np.diff(recording.signal("speed")[0]).tolist() == pytest.approx([0.004, 0.004, 1_800])
    assert recording.stop.at_cycles == 2**32 - 6_000 + sum(pauses_us)


def test_the_version_is_the_one_of_the_drivers() -> None:
    """Each side has it once."""
    spec = ROOT / "drivers" / "src" / "telemetry" / "nxt-telemetry-messages.ads"
    assert f"Protocol_Version : constant := {messages.VERSION};" in spec.read_text()


def test_samples_become_a_recording(tmp_path: Path) -> None:
    """Values, instants and numbers of what was missing; the trace tools take it."""
    program = Program(time_us=2**32 - 6_000)
    session = talking(program)
    for step in range(4):
        data = program.sample(1, step, 0.5 * step) + program.sample(2, 7900 + step)
        if step != 2:
            session.receive(data)
        program.time_us += 4_000
    run = session.run
    assert run is not None and (run.sample_count, run.missing) == (6, 2)
    recording = run.recording()
    times, values = recording.signal("speed")
    begin = (2**32 - 6_000) / 1e6
    assert np.allclose(times - begin, [0, 0.004, 0.012], atol=1e-9)
    assert values.tolist() == [0.0, 0.5, 1.5]
    assert recording.signal("battery")[1].tolist() == [7900, 7901, 7903]
    recording.save(tmp_path / "live.npz")
    loaded = Recording.load(tmp_path / "live.npz")
    assert loaded.digest == recording.digest
    for file_format in Format:
        files = export(loaded, file_format, tmp_path / f"live{file_format.suffix}")
        assert all(path.stat().st_size > 0 for path in files)


def test_parameters_change_within_their_limits() -> None:
    """A request is sent, repeated while unanswered, and done; wrong ones are refused in words."""
    program = Program()
    session = talking(program)
    session.set_parameter("kp", 1.25)
    program.ignores = 1
    session.receive(program.receive(session.pending(0.1)))
    assert session.values[0] == 0.5
    assert session.pending(0.2) == b""
    session.receive(program.receive(session.pending(0.7)))
    assert program.gains[0] == session.values[0] == 1.25
    assert session.pending(0.8) == b""
    for outside in (3.0, -0.01):
        with pytest.raises(UsageError, match=f"kp = {outside:g} is outside 0 to 2"):
            session.set_parameter("kp", outside)
    with pytest.raises(UsageError, match="no parameter 'kd'; it has: ki, kp"):
        session.set_parameter("kd", 1.0)


@pytest.mark.parametrize("limit", [0.0, 2.0])
def test_a_parameter_may_have_the_value_of_either_limit(limit: float) -> None:
    """Both limits belong to the range."""
    program = Program()
    session = talking(program)
    session.set_parameter("kp", limit)
    session.receive(program.receive(session.pending(0.1)))
    assert program.gains[0] == session.values[0] == limit


def test_the_brick_has_the_last_word() -> None:
    """A value that the host would send, but the brick refuses, is not in force."""
    program = Program()
    session = Session()
    session.set_parameter("kp", 7.0)
    session.receive(program.receive(session.connected(0.0)))
    session.receive(program.receive(session.pending(0.1)))
    assert session.answers == [messages.Answer(0, messages.Verdict.OUT_OF_RANGE, 0.5)]
    assert program.gains[0] == session.values[0] == 0.5


def test_requests_outlive_a_lost_link() -> None:
    """What was requested before the loss is sent after it; the samples so far stay."""
    program = Program()
    session = talking(program)
    session.receive(program.sample(1, 1, 1))
    session.set_parameter("ki", 9.0)
    session.pending(0.1)
    program.numbers[1] += 5
    program.time_us += 1_000_000
    session.receive(program.receive(session.connected(1.0)))
    session.receive(program.receive(session.pending(1.1)))
    session.receive(program.sample(1, 2, 2))
    assert program.gains[1] == 9.0
    assert len(session.runs) == 1 and session.run is not None
    assert (session.run.sample_count, session.run.missing) == (2, 5)


def test_a_restart_begins_another_run() -> None:
    """The brick's clock went back: its samples do not mix with the old ones."""
    program = Program(time_us=9_000_000)
    session = talking(program)
    session.receive(program.sample(1, 1, 1))
    again = Program(time_us=1_000)
    session.receive(again.receive(session.connected(1.0)))
    session.receive(again.sample(1, 5, 5))
    assert [run.sample_count for run in session.runs] == [1, 1]


def test_other_versions_are_named() -> None:
    """Which side to bring up to date is said."""
    for version, older in ((2, "Ravenbrick"), (0, "the program on the brick")):
        program = Program(version=version)
        session = Session()
        with pytest.raises(VersionError, match=f"version {version} .*bring {older} up to date"):
            session.receive(program.receive(session.connected(0.0)))


def test_a_silent_host_keeps_alive_and_asks_again() -> None:
    """Without an answer the question is repeated; afterwards a word per second is enough."""
    program = Program(ignores=1)
    session = Session()
    assert program.receive(session.connected(0.0)) == b""
    assert session.pending(0.4) == b""
    session.receive(program.receive(session.pending(0.5)))
    assert session.described
    assert session.pending(1.4) == b""
    program.receive(session.pending(1.5))
    assert isinstance(program.heard[-1], messages.KeepAlive)


@pytest.mark.parametrize("seed", range(10))
def test_hostile_bytes_do_no_harm(seed: int) -> None:
    """Random frames with right check values, and random bytes: counted, never raised."""
    rng = random.Random(seed)
    session = talking(Program())
    strange: list[messages.Message] = [
        messages.Sample(9, 1, 1, (b"abcd",)),
        messages.Sample(1, 1, 1, (b"abcd",) * 3),
        messages.Answer(77, messages.Verdict.ACCEPTED, float("nan")),
        messages.SignalDescription(1, 0, messages.Kind.TRUTH, "speed", ""),
        messages.Ask(),
    ]
    for _ in range(300):
        session.receive(rng.randbytes(rng.randint(0, 30)) + sent(rng.choice(strange)))
    assert session.run is not None and session.damaged > 0
