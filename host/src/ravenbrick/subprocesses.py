# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs that a command runs and waits for."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["attended", "run_child", "run_script"]

# How long an interrupted child and its own children may take to end.
GRACE_S = 5.0
# This process has loaded what scripts load, and one thread: a script runs in a copy of it.
scripts_share_libraries = False


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


def run_script(words: Sequence[str], cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a Python script of a folder with its arguments; output and errors together."""
    if not scripts_share_libraries:
        return run_child([sys.executable, *words], cwd=cwd)
    import multiprocessing  # which no other command needs

    reading, writing = os.pipe()
    child = multiprocessing.get_context("fork").Process(
        target=_be_script, args=(words, cwd, writing)
    )
    child.start()
    os.close(writing)
    try:
        with open(reading, encoding="utf-8", errors="replace") as pipe:
            output = pipe.read()
        child.join()
    except BaseException:
        child.terminate()
        child.join(GRACE_S)
        child.kill()
        raise
    return subprocess.CompletedProcess(words, child.exitcode or 0, output)


def _be_script(words: Sequence[str], cwd: Path, output: int) -> None:
    for stream in (sys.stdout, sys.stderr):
        os.dup2(output, stream.fileno())
    os.chdir(cwd)
    sys.argv, sys.path[0] = list(words), str(cwd)
    runpy.run_path(words[0], run_name="__main__")
