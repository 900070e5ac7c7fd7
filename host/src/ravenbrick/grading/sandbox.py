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
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Outcome", "run_limited"]

MEGABYTE = 1 << 20
TAIL = 4000


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
    try:
        output, _ = process.communicate(timeout=10 * seconds)
        timed_out = process.returncode == -signal.SIGXCPU
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        timed_out = True
    return Outcome(process.returncode, output.decode("utf-8", "replace")[-TAIL:], timed_out)
