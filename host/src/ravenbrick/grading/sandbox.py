# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One call in the sandbox: content in, a result and messages out by two pipes, all bounded."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import IO

from ravenbrick.grading.isolation import Bounds, Isolation

__all__ = ["Outcome", "allow_sessions", "end_sessions", "run_isolated"]

TAIL = 20_000
PIECE = 1 << 16
MESSAGES_MAX = 4 << 20
RESULT_MAX = 64 << 20
# A program that waits uses no processor time; a busy machine is not its fault.
PATIENCE = 4
# How long what still holds the pipes may do so after the first process has ended.
GRACE_S = 1.0
POLL_S = 0.2
XCPU = 128 + signal.SIGXCPU
TIME_WORDS = "CPU time limit exceeded"
# Sessions by their process numbers, of all threads.
_RUNNING: set[int] = set()
_STOPPED = threading.Event()


@dataclass(frozen=True)
class Outcome:
    """Exit code, end of the messages, the result, and which limit ended it."""

    code: int
    output: str
    result: bytes
    timed_out: bool = False
    flooded: bool = False
    full: bool = False


@dataclass
class _Pipes:
    """What goes through the pipes of one process."""

    process: subprocess.Popen[bytes]
    content: memoryview
    result: bytearray = field(default_factory=bytearray)
    messages: bytearray = field(default_factory=bytearray)
    said: int = 0
    full: bool = False
    overflows: Callable[[], bool] = lambda: False

    def write(self, pipe: IO[bytes]) -> bool:
        """Pass on a piece of the content; whether that was all, or nobody reads any more."""
        try:
            self.content = self.content[os.write(pipe.fileno(), self.content[:PIECE]) :]
        except BrokenPipeError:
            return True
        return not self.content

    def read(self, pipe: IO[bytes]) -> bool:
        """Take a piece; whether the pipe has ended."""
        piece = os.read(pipe.fileno(), PIECE)
        if pipe is self.process.stdout:
            self.result += piece
        else:
            self.said += len(piece)
            self.messages = (self.messages + piece)[-TAIL:]
        return not piece

    @property
    def flooded(self) -> bool:
        """Too much came through the pipes."""
        return self.said > MESSAGES_MAX or len(self.result) > RESULT_MAX

    @property
    def excess(self) -> bool:
        """Too much was written, into the pipes or into files."""
        return self.flooded or self.full

    def attend(self, seconds: float) -> bool:
        """Serve the pipes until they end, too much came, or the time is over; whether it is."""
        process, end, look = self.process, time.monotonic() + seconds, 0.0
        assert process.stdin and process.stdout and process.stderr
        with selectors.DefaultSelector() as ready:
            ready.register(process.stdin, selectors.EVENT_WRITE, self.write)
            ready.register(process.stdout, selectors.EVENT_READ, self.read)
            ready.register(process.stderr, selectors.EVENT_READ, self.read)
            while ready.get_map() and not self.excess:
                if time.monotonic() > end:
                    return process.poll() is None
                for key, _events in ready.select(POLL_S):
                    pipe: IO[bytes] = key.fileobj  # type: ignore[assignment]
                    if key.data(pipe):
                        ready.unregister(pipe)
                        pipe.close()
                if time.monotonic() > look:
                    self.full, look = self.overflows(), time.monotonic() + POLL_S
                if process.poll() is not None:
                    end = min(end, time.monotonic() + GRACE_S)
        with suppress(subprocess.TimeoutExpired):
            process.wait(0 if self.excess else max(end - time.monotonic(), 0))
        return process.poll() is None and not self.excess


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


def run_isolated(
    isolation: Isolation,
    command: Sequence[str],
    bounds: Bounds,
    *,
    content: bytes = b"",
    readable: Sequence[Path] = (),
    hidden: Sequence[Path] = (),
    variables: dict[str, str] | None = None,
) -> Outcome:
    """Run a command with `content` as its input; it is killed after a multiple of its seconds.

    Its standard output is the result, its error output the messages for people. It can read the
    paths of `readable`, but nothing in a folder of `hidden` that is not named itself.
    """
    with isolation.call(command, bounds, readable, hidden) as (whole, folder):
        environment = {
            "PATH": isolation.path,
            "HOME": str(folder),
            "TMPDIR": str(folder),
            "MPLCONFIGDIR": str(folder),
            "LANG": "C.UTF-8",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            **(variables or {}),
        }
        with subprocess.Popen(
            whole,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        ) as process:
            pipes = _Pipes(process, memoryview(content))
            pipes.overflows = partial(isolation.overflows, process.pid, folder, bounds)
            return _outcome(pipes, PATIENCE * bounds.seconds)


def _outcome(pipes: _Pipes, seconds: float) -> Outcome:
    process = pipes.process
    _RUNNING.add(process.pid)
    try:
        if _STOPPED.is_set():
            _kill(process.pid)
        late = pipes.attend(seconds)
    finally:
        _kill(process.pid)
        process.wait()
        _RUNNING.discard(process.pid)
    output = pipes.messages.decode("utf-8", "replace")
    timed_out = late or process.returncode in (XCPU, -signal.SIGXCPU) or TIME_WORDS in output
    return Outcome(
        process.returncode, output, bytes(pipes.result), timed_out, pipes.flooded, pipes.full
    )
