# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs of pytest in forks of one process that has loaded what takes long to load.

A line of the input asks for a run: `arguments`, `log`, `limit_s` for each test, `wait_s` for all.
The line that answers has the exit `code` and the processor time `used_s`.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import time
from contextlib import suppress
from typing import Any

import pytest

from verification.mutation.recorder import LIMIT_S

# Nothing of the package but what limits the threads of linear algebra: a mutant may be anywhere.
LOADED = (
    "ravenbrick",
    "numpy",
    "scipy.signal",
    "control",
    "matplotlib.figure",
    "jsonschema",
    "typer",
)
POLL_S = 0.02


def _become(request: dict[str, Any]) -> None:
    """The run; it never returns."""
    code = 70
    try:
        os.setsid()
        log = os.open(request["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        for number, file in ((0, os.open(os.devnull, os.O_RDONLY)), (1, log), (2, log)):
            os.dup2(file, number)
        os.environ[LIMIT_S] = str(request["limit_s"])
        code = int(pytest.main(request["arguments"]))
        sys.stdout.flush()
    finally:
        os._exit(code)


def _run(request: dict[str, Any]) -> dict[str, float]:
    run = os.fork()
    if run == 0:
        _become(request)
    end = time.monotonic() + request["wait_s"]
    while True:
        done, status, used = os.wait4(run, os.WNOHANG)
        with suppress(ProcessLookupError):
            if done or time.monotonic() > end:
                os.killpg(run, signal.SIGKILL)
        if done:
            code = os.waitstatus_to_exitcode(status)
            return {"code": code, "used_s": used.ru_utime + used.ru_stime}
        time.sleep(POLL_S)


def main() -> None:
    """Answer until the input ends."""
    answers = os.fdopen(os.dup(1), "w")
    for name in LOADED:
        importlib.import_module(name)
    for line in sys.stdin:
        answers.write(json.dumps(_run(json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
