# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A process with limits: time, memory, file size; own session and a bare environment.

This keeps a bad program from taking the machine; it is not a border against an attacker who has
found a way to execute code on the host. Such code has no place in a submission: only the compiler
reads it, and it runs on the virtual brick.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Outcome", "allow_sessions", "end_sessions", "run_limited"]

MEGABYTE = 1 << 20
TAIL = 4000
# Sessions by their process numbers, of all threads.
_RUNNING: set[int] = set()
_STOPPED = threading.Event()


@dataclass(frozen=True)
class Outcome:
    """Exit code, end of the output, and whether a limit ended it."""

    code: int
    output: str
    timed_out: bool


def _limit(seconds: int, memory_mb: int, file_mb: int) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    resource.setrlimit(resource.RLIMIT_AS, (memory_mb * MEGABYTE,) * 2)
    resource.setrlimit(resource.RLIMIT_FSIZE, (file_mb * MEGABYTE,) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _kill(session: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(session, signal.SIGKILL)


def allow_sessions() -> None:
    """Let processes start, after `end_sessions`."""
    _STOPPED.clear()


def end_sessions() -> None:
    """Kill what runs, in whichever thread; nothing starts any more."""
    _STOPPED.set()
    for session in list(_RUNNING):
        _kill(session)


def run_limited(
    command: Sequence[str],
    folder: Path,
    seconds: int,
    memory_mb: int,
    file_mb: int,
    extra: dict[str, str] | None = None,
) -> Outcome:
    """Run a command in `folder`; its whole session is killed after ten times `seconds`.

    `seconds` bounds the processor time; waiting for a busy machine is not the program's fault.
    """
    environment = {
        "PATH": os.environ.get("PATH", os.defpath),
        "HOME": str(folder),
        "TMPDIR": str(folder),
        "LANG": "C.UTF-8",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        **(extra or {}),
    }
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=lambda: _limit(seconds, memory_mb, file_mb),
    )
    _RUNNING.add(process.pid)
    if _STOPPED.is_set():
        _kill(process.pid)
    try:
        output, _ = process.communicate(timeout=10 * seconds)
        timed_out = process.returncode == -signal.SIGXCPU
    except subprocess.TimeoutExpired:
        _kill(process.pid)
        output, _ = process.communicate()
        timed_out = True
    except BaseException:
        _kill(process.pid)
        process.wait()
        raise
    finally:
        _RUNNING.discard(process.pid)
    return Outcome(process.returncode, output.decode("utf-8", "replace")[-TAIL:], timed_out)
