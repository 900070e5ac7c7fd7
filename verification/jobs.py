# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Suites in processes of their own, as many at a time as there are processors for them."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

from verification.support.paths import BUILD, ROOT
from verification.table import Suite

__all__ = ["Answer", "begin_order", "grouped", "run_jobs"]

LOGS = BUILD / "verification" / "logs"
LIMIT_S = 3_600
"""Of the suites of one job together; a process that is not done then is ended."""
PROGRESS_S = 30
CAUSE_LINES = 8

Answer = dict[str, Any]
Show = Callable[[Suite, str], None]


def grouped(suites: list[Suite]) -> list[list[Suite]]:
    """Jobs: suites with the same `job` together, every other one alone."""
    jobs: dict[str, list[Suite]] = {}
    for suite in suites:
        jobs.setdefault(suite.job or suite.name, []).append(suite)
    return list(jobs.values())


def begin_order(jobs: list[list[Suite]], minutes: Callable[[Suite], float]) -> list[list[Suite]]:
    """Jobs that use several processors first, then long ones before short ones."""
    return sorted(
        jobs, key=lambda job: (-max(s.workers for s in job), -sum(minutes(s) for s in job))
    )


class _Process:
    """A process with the suites of one job: its log, its progress, its answers."""

    def __init__(self, table: Path, job: list[Suite], environment: dict[str, str]) -> None:
        self.job = job
        self.current = job[0]
        self.late = False
        self.stopped = False
        LOGS.mkdir(parents=True, exist_ok=True)
        name = re.sub(r"[^a-z0-9]+", "-", f"{job[0].area} {job[0].name}".lower()).strip("-")
        self.log = LOGS / f"{name}.txt"
        self.last: deque[str] = deque(maxlen=CAUSE_LINES)
        command = [sys.executable, "-m", "verification.job", str(table), *(s.name for s in job)]
        self.process = subprocess.Popen(
            command, cwd=ROOT, env={**os.environ, **environment}, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, errors="replace",
            start_new_session=True,
        )  # fmt: skip

    def relay(self, show: Callable[[str], None]) -> None:
        """Standard error into the log; now and then a line is shown as progress."""
        shown = time.monotonic()
        with self.log.open("w") as log:
            for line in self.process.stderr or ():
                log.write(line)
                log.flush()
                text = line.rstrip()
                if text:
                    self.last.append(text)
                if text and time.monotonic() - shown > PROGRESS_S:
                    shown = time.monotonic()
                    show(text[-100:])

    def answer(self) -> Answer:
        """The next answer; the last lines that were printed go with an error."""
        line = self.process.stdout.readline() if self.process.stdout else ""
        if line:
            answer: Answer = json.loads(line)
        else:
            code = self.process.wait()
            how = f"given up after {LIMIT_S // 60} min" if self.late else f"ended with {code}"
            answer = {"error": f"the process of the suite: {how}"}
        if "error" in answer:
            time.sleep(0.2)  # for the thread that reads what was printed
            # The last line is the cause, the others lead to it.
            lines = [answer["error"], *list(self.last)[-1:], *list(self.last)[:-1]]
            answer["error"] = "\n".join(lines).replace(f"{ROOT}/", "")
        return answer

    def give_up(self) -> None:
        """It takes too long."""
        self.late = True
        self.end()

    def end(self) -> None:
        """Kill the process and all that it started."""
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()


def _run_job(process: _Process, show: Show, answered: Callable[[Suite, Answer], None]) -> None:
    """Until the process has answered for each suite, ended, or taken too long."""
    relay = threading.Thread(
        target=process.relay, args=(lambda text: show(process.current, text),), daemon=True
    )
    timer = threading.Timer(LIMIT_S, process.give_up)
    relay.start()
    timer.start()
    try:
        for number, suite in enumerate(process.job):
            process.current = suite
            if number:
                show(suite, "begins")
            answer = process.answer()
            if process.stopped:
                return
            answered(suite, {**answer, "log": os.path.relpath(process.log, ROOT)})
    finally:
        timer.cancel()
        process.end()
        relay.join(timeout=5)


def run_jobs(
    table: Path,
    jobs: list[list[Suite]],
    processors: int,
    show: Show,
    answered: Callable[[Suite, Answer], None],
) -> None:
    """Run the jobs in their order, each when its processors are free.

    `show` gets lines of progress, `answered` the answer of each suite, from several threads.
    """
    waiting, running = list(jobs), dict[Future[None], tuple[int, _Process]]()
    with ThreadPoolExecutor(processors) as pool:
        try:
            while waiting or running:
                free = processors - sum(count for count, _ in running.values())
                needed = min(processors, max(s.workers for s in waiting[0])) if waiting else 0
                if waiting and needed <= free:
                    job = waiting.pop(0)
                    show(job[0], "begins")
                    found = {d.variable: str(d.place()) for s in job for d in s.data()}
                    process = _Process(table, job, found)
                    running[pool.submit(_run_job, process, show, answered)] = needed, process
                    continue
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    del running[future]
                    future.result()
        finally:
            for _, process in running.values():
                process.stopped = True
                process.end()
