# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands of the command line as child processes: one at a time, each with a time limit."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from typing import Any

from ravenbrick.errors import ExitCode
from ravenbrick.studio.journal import Journal

__all__ = ["Call", "Runner", "Task"]

# Takes its words from standard input: it is started, and has loaded its libraries, before them.
RAVENBRICK = (sys.executable, "-c", "from ravenbrick.cli.prepared import main; main()")
# From an interruption until the child and its children are killed.
GRACE_S = 8.0
# Of an answer, what the page shows.
SHOWN = ("figures", "memory", "steps", "schedulable", "advice", "trace_digest", "problem")


@dataclass(frozen=True)
class Call:
    """A command line without the program's name, and how long it may take.

    `goes_on` are exit codes after which the next call is made; `inside` does the command's work in
    this process, for what the page itself shows.
    """

    words: tuple[str, ...]
    limit_s: float = 120.0
    goes_on: tuple[int, ...] = (ExitCode.OK,)
    inside: Callable[[], dict[str, Any]] | None = None

    @property
    def line(self) -> str:
        """The command as a user types it."""
        return shlex.join(("ravenbrick", *self.words))


@dataclass(frozen=True)
class Task:
    """Calls, one after the other. One that `replaces` ends the one before and those that wait."""

    name: str
    calls: tuple[Call, ...]
    replaces: bool = False


class Runner:
    """Works on one task at a time; the journal gets `started` and `ended` of every call.

    `finished` adds to what `ended` says: it gets the answer and when the call began.
    """

    def __init__(
        self,
        journal: Journal,
        finished: Callable[[dict[str, Any], float], dict[str, Any]],
        program: Sequence[str] = RAVENBRICK,
    ) -> None:
        self._journal, self._finished, self._program = journal, finished, program
        self._waiting: list[Task] = []
        self._changed = threading.Condition()
        self._child: subprocess.Popen[str] | None = None
        self._next: subprocess.Popen[str] | None = None
        self._reason = ""
        self._working = self._closed = False
        self._numbers = count(1)
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def submit(self, task: Task) -> None:
        """Do this next; a task of the same name that waits is left out."""
        with self._changed:
            if task.replaces:
                self._waiting.clear()
                self._interrupt("a newer one replaces it")
            self._waiting = [other for other in self._waiting if other.name != task.name]
            self._waiting.append(task)
            self._changed.notify_all()

    def stop(self, reason: str) -> None:
        """End what is under way, and forget what waits."""
        with self._changed:
            self._waiting.clear()
            self._interrupt(reason)

    def close(self) -> None:
        """End everything; returns when nothing runs any more."""
        with self._changed:
            self._closed = True
            self._waiting.clear()
            self._interrupt("the studio ends")
            self._changed.notify_all()
        self._thread.join(timeout=2 * GRACE_S)
        if self._next is not None:
            _kill(self._next)
            self._next.communicate()

    def _interrupt(self, reason: str) -> None:
        """With the lock: as Ctrl-C would, then without mercy."""
        if not self._working or self._reason:
            return
        self._reason = reason
        child = self._child
        if child is not None:
            with suppress(ProcessLookupError):
                child.send_signal(signal.SIGINT)
            mercy = threading.Timer(GRACE_S, _kill, (child,))
            mercy.daemon = True
            mercy.start()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._next = self._prepared()
                self._changed.wait_for(lambda: self._waiting or self._closed)
                if self._closed:
                    return
                task = self._waiting.pop(0)
                self._working, self._reason = True, ""
            for call in task.calls:
                if self._reason or self._call(task, call) not in call.goes_on:
                    break
            with self._changed:
                self._working = False
            self._journal.add("idle", task=task.name)

    def _call(self, task: Task, call: Call) -> int:
        """Make one call and tell of it; its exit code."""
        number, began, since = next(self._numbers), time.monotonic(), time.time()
        self._journal.add("started", call=number, task=task.name, line=call.line)
        answer = self._child_answer(call) if call.inside is None else call.inside()
        if self._reason:
            answer = {"ok": False, "exit_code": int(ExitCode.INTERRUPTED), "error": self._reason}
        ok = bool(answer["ok"])
        told = {name: answer[name] for name in ("error", "detail", *SHOWN) if name in answer}
        self._journal.add(
            "ended", call=number, task=task.name, ok=ok, stopped=bool(self._reason),
            seconds=round(time.monotonic() - began, 3), **told, **self._finished(answer, since),
        )  # fmt: skip
        return int(answer.get("exit_code", ExitCode.OK))

    def _child_answer(self, call: Call) -> dict[str, Any]:
        with self._changed:
            if self._reason:
                return {"ok": False, "error": self._reason}
            child = self._child = self._prepared()
            self._next = None
        limit = threading.Timer(call.limit_s, self._late, (call,))
        limit.daemon = True
        limit.start()
        try:
            output, errors = child.communicate(json.dumps([*call.words, "--json"]) + "\n")
        finally:
            limit.cancel()
            with self._changed:
                self._child = None
        try:
            answer: dict[str, Any] = json.loads(output)
            return answer
        except ValueError:
            sentence = f"'{call.line}' ended with {child.returncode} and without an answer"
            last = (errors or output).strip().splitlines()[-1:]
            code = int(ExitCode.INTERNAL)
            return {"ok": False, "exit_code": code, "error": ": ".join([sentence, *last])}

    def _prepared(self) -> subprocess.Popen[str]:
        """The process of the next command; another one if it has ended."""
        if self._next is not None and self._next.poll() is None:
            return self._next
        return subprocess.Popen(
            self._program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            encoding="utf-8", errors="replace", start_new_session=True,
        )  # fmt: skip

    def _late(self, call: Call) -> None:
        with self._changed:
            self._interrupt(f"stopped: it took longer than {call.limit_s:g} s")


def _kill(child: subprocess.Popen[str]) -> None:
    """The child and all that it started, if it is still there."""
    if child.poll() is None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, signal.SIGKILL)
