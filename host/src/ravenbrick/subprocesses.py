# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs that a command runs and waits for."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["attended", "run_child"]

# How long an interrupted child and its own children may take to end.
GRACE_S = 5.0


@contextmanager
def attended(child: subprocess.Popen[str]) -> Iterator[subprocess.Popen[str]]:
    """A child whose output is a pipe; an interruption inside leaves nothing running.

    It ends the child, and waits until all that write into its output have ended.
    """
    with child:
        try:
            yield child
        except BaseException:
            child.terminate()
            with suppress(subprocess.TimeoutExpired):
                child.communicate(timeout=GRACE_S)
            child.kill()
            raise


def run_child(
    command: Sequence[str],
    *,
    cwd: Path | None = None,
    env: Mapping[str, str] | None = None,
    errors_apart: bool = False,
    pass_fds: Sequence[int] = (),
) -> subprocess.CompletedProcess[str]:
    """Run a program and keep its output, errors within it or apart; `attended`."""
    errors = subprocess.PIPE if errors_apart else subprocess.STDOUT
    process = subprocess.Popen(
        command,
        cwd=cwd,
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=errors,
        encoding="utf-8",
        errors="replace",
        pass_fds=pass_fds,
    )
    with attended(process) as child:
        output, told = child.communicate()
    return subprocess.CompletedProcess(command, child.returncode, output, told)
