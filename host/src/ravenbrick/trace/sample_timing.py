# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From a recorded run to when a controller really samples and acts."""

from __future__ import annotations

import numpy as np

from ravenbrick.control.estimation.encoder_run import SampleTiming
from ravenbrick.errors import UsageError
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import jobs_of

__all__ = ["sample_timing"]


def sample_timing(recording: Recording, task: str, motor: int) -> SampleTiming:
    """Release latencies of `task` and the delays from there to the new voltage of motor 0 to 2.

    A job whose command did not change the motor leaves no event; it gets the median delay of the
    others. Raises `UsageError` if the task or its commands were not recorded.
    """
    names = [thread.name for thread in recording.threads]
    if task not in names:
        raise UsageError(f"the run has no task '{task}'; there are: {', '.join(names)}")
    jobs = [job for job in jobs_of(recording, names.index(task)) if job.start_cycles is not None]
    events = recording.of_kind(EventKind.MOTOR_COMMAND)
    commands = events["at_cycles"][events["subject"] == motor].astype(np.int64)
    starts = np.array([job.start_cycles for job in jobs], dtype=np.int64)
    nominal = np.array([job.release_cycles for job in jobs], dtype=np.int64)
    if len(starts) < 2:
        raise UsageError(f"the task '{task}' did not run twice; record a longer run")
    place = np.searchsorted(commands, starts[:-1])
    following = np.append(commands, np.iinfo(np.int64).max)[place]
    known = following < starts[1:]
    if not known.any():
        raise UsageError(f"no command of '{task}' reached motor {motor} in this run")
    delays = np.where(known, following - starts[:-1], 0)
    delays[~known] = int(np.median(delays[known]))
    hertz = float(recording.clock.hertz)
    return SampleTiming((starts - nominal)[:-1] / hertz, delays / hertz)
