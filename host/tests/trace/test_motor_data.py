# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run tells of one motor and its controller, of made runs of one cycle per microsecond."""

from __future__ import annotations

import pytest
from verification.support.recordings import Event, made, sampled

from ravenbrick.errors import UsageError
from ravenbrick.trace.motor_data import motor_data, signal_data
from ravenbrick.trace.recording import IDLE, EventKind, Recording
from ravenbrick.trace.sample_timing import sample_timing

K = EventKind
BRAKE = 0x100
MS = 1_000


def command(at_ms: int, motor: int, duty: int, mode: int = BRAKE) -> Event:
    """Percent, and whether the bridge brakes between the pulses."""
    return (MS * at_ms, K.MOTOR_COMMAND, motor, mode | (duty & 0xFF))


def driven(*commands: Event) -> Recording:
    """Motor B of a run of 300 ms; the battery falls from 9 V to 8 V at 120 ms, to 7 V at 260 ms."""
    every = range(0, 300 * MS, MS)
    duty = [0.0 if at <= 100 else 0.5 if at <= 200 else -0.25 for at in range(300)]
    volts = [9.0 if at < 120 else 8.0 if at < 260 else 7.0 for at in range(300)]
    signals = {
        "motor.B.encoder": sampled(every, [float(at // 10) for at in range(300)]),
        "motor.B.duty": sampled(every, duty),
        "battery.voltage": sampled(every, volts),
    }
    return made(commands, 300 * MS, signals=signals)


def test_a_motor_has_duty_times_battery_from_its_first_voltage_to_the_next_stop() -> None:
    """Other motors' commands are theirs; the voltage changes with each command and battery step."""
    other = command(50, 0, 80)
    data = motor_data(
        driven(other, command(60, 1, 0), command(100, 1, 50), command(200, 1, -25),
               command(250, 1, 0), command(270, 1, 90)), "B"
    )  # fmt: skip
    assert data.change.tolist() == pytest.approx([0.1, 0.12, 0.2])
    assert data.voltage.tolist() == pytest.approx([4.5, 4.0, -2.0])
    assert data.time[-1] == pytest.approx(0.249) and data.count[-1] == 24.0
    unstopped = motor_data(driven(command(100, 1, 50)), "B")
    assert unstopped.change.tolist() == pytest.approx([0.1, 0.12, 0.26])
    assert len(unstopped.time) == 300


def test_a_battery_that_steps_with_a_command_changes_the_voltage_once() -> None:
    """And at the stop not at all."""
    data = motor_data(driven(command(120, 1, 50), command(260, 1, 0)), "B")
    assert data.change.tolist() == pytest.approx([0.12])


@pytest.mark.parametrize(
    ("motor", "commands", "sentence"),
    [
        ("D", [], "there are the motors A, B and C, not 'D'"),
        ("B", [command(10, 0, 50), command(20, 1, 0)], "motor B was not driven"),
        ("B", [command(10, 1, 50), command(20, 1, 40, mode=0)], "open windings"),
    ],
)
def test_what_tells_nothing_of_a_motor_is_refused(
    motor: str, commands: list[Event], sentence: str
) -> None:
    """With what to do instead; windings that are open after the stop do not matter."""
    with pytest.raises(UsageError, match=sentence):
        motor_data(driven(*commands), motor)
    stopped = driven(command(10, 1, 50), command(200, 1, 0), command(250, 1, 50, mode=0))
    assert len(motor_data(stopped, "B").time) == 200


def published(volts: list[float]) -> Recording:
    """Signals that a program published every ms."""
    every = range(0, MS * len(volts), MS)
    counts = [float(number) for number in range(len(volts))]
    return made([], 10**6, signals={"u": sampled(every, volts), "angle": sampled(every, counts)})


def test_published_signals_count_from_the_first_voltage_to_the_next_zero() -> None:
    """The counts before it belong to the rest, the sample at the stop does not."""
    data = signal_data(
        published([0.0] * 50 + [3.0] * 30 + [-2.0] * 40 + [0.0] * 9 + [5.0]), "u", "angle"
    )
    assert data.change[0] == pytest.approx(0.05) and data.change[-1] == pytest.approx(0.119)
    assert data.voltage.tolist() == [3.0] * 30 + [-2.0] * 40
    assert data.time.tolist() == pytest.approx([number / 1000 for number in range(120)])
    endless = signal_data(published([0.0] * 50 + [3.0] * 70), "u", "angle")
    assert (len(endless.time), len(endless.change)) == (120, 70)
    for volts in ([0.0] * 120, [1.0] * 120):
        with pytest.raises(UsageError, match="'u' must be 0 at first and then not"):
            signal_data(published(volts), "u", "angle")


def jobs(*commands: Event) -> Recording:
    """Jobs of task 1 released every 10 ms; the n-th starts n * 100 us later."""
    events: list[Event] = list(commands)
    for number in range(1, 5):
        at = 10 * MS * number
        start = at + 100 * number
        events += [(at, K.RELEASE, 1, at), (start, K.THREAD_RUNNING, 1, 0)]
        events += [(at + 5 * MS, K.COMPLETION, 1, at), (at + 5 * MS, K.THREAD_RUNNING, IDLE, 0)]
    return made(sorted(events), 100 * MS)


def test_a_controllers_delay_runs_from_its_start_to_the_motors_command() -> None:
    """The last job is left out; one without a command has the median of the others."""
    found = sample_timing(
        jobs(command(12, 0, 50), command(15, 2, 9), command(33, 0, 60)), "task_1", 0
    )
    assert found.release.tolist() == pytest.approx([1e-4, 2e-4, 3e-4])
    assert found.delay.tolist() == pytest.approx([1.9e-3, 2.3e-3, 2.7e-3])
    at_start = (20_200, K.MOTOR_COMMAND, 0, BRAKE | 60)
    assert sample_timing(jobs(at_start), "task_1", 0).delay.tolist() == [0.0] * 3
    alone = sample_timing(jobs(command(12, 0, 50)), "task_1", 0)
    assert alone.delay.tolist() == pytest.approx([1.9e-3] * 3)


def test_a_controller_that_commands_nothing_has_no_timing() -> None:
    """Unknown tasks, tasks that ran once and motors without a command are named."""
    with pytest.raises(UsageError, match="no task 'task_7'; there are: task_0, task_1"):
        sample_timing(jobs(), "task_7", 0)
    with pytest.raises(UsageError, match="'task_0' did not run twice"):
        sample_timing(jobs(), "task_0", 0)
    for commands in ([], [command(1, 0, 50)], [command(48, 0, 50)]):
        with pytest.raises(UsageError, match="no command of 'task_1' reached motor 0"):
            sample_timing(jobs(*commands), "task_1", 0)
