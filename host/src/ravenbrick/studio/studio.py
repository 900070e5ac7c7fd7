# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The studio of one project: its files, the commands that it offers, and the page that it shows."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ravenbrick.errors import ExitCode, RavenbrickError, shown_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.studio.journal import Journal
from ravenbrick.studio.problems import problems_of
from ravenbrick.studio.project_files import FileError, ProjectFiles
from ravenbrick.studio.runner import RAVENBRICK, Call, Runner, Task

__all__ = ["COMMANDS", "ShowPage", "Studio"]

# What a page can ask for.
COMMANDS = ("build", "view", "design", "diagram", "analyse", "report")
LONG_S = 1800.0
# A page that is loaded again listens again within this time.
LEAVE_S = 3.0
RESULTS = {".html", ".svg"}

# The files of the page with the image that was built, for a scenario or none.
ShowPage = Callable[[str | None], dict[str, bytes]]


class Studio:
    """What the server of a project asks; `page` are the brick's files, {} before the first image.

    `show` makes them. `program` is the command line, for tests another one.
    """

    def __init__(
        self, workspace: Workspace, show: ShowPage, program: tuple[str, ...] = RAVENBRICK
    ) -> None:
        self._workspace, self._show = workspace, show
        self._project = shown_path(workspace.project)
        self.files = ProjectFiles(workspace.project, self._project)
        self.journal = Journal()
        self.page: dict[str, bytes] = {}
        self.closed = False
        self._runner = Runner(self.journal, self._finished, program)
        self._listeners = 0
        self._counting = threading.Lock()

    def described(self) -> dict[str, Any]:
        """The project for the page."""
        return {
            "name": self._workspace.project.name, "files": self.files.listed(),
            "scenarios": self.files.scenarios(), "image": bool(self.page),
        }  # fmt: skip

    def run(self, name: str, scenario: str | None) -> None:
        """Start one of `COMMANDS`; raises `FileError` for a name that is none."""
        if name not in COMMANDS:
            raise FileError(400, f"'{name}': expected one of {', '.join(COMMANDS)}")
        known = self.files.scenarios()
        if scenario is not None and scenario not in known:
            raise FileError(400, f"'{scenario}': expected a scenario: {', '.join(known)}")
        calls = tuple(self._calls(name, scenario))
        self._runner.submit(Task(name, calls, replaces=name == "build"))

    def stop(self) -> None:
        """End the command that runs."""
        self._runner.stop("stopped")

    def result(self, name: str) -> bytes | None:
        """A report or picture of the project's results; None where there is none."""
        folder = self._workspace.results.resolve()
        try:
            file = (folder / name).resolve()
            inside = file.is_relative_to(folder) and file.suffix in RESULTS
            return file.read_bytes() if inside and file.is_file() else None
        except (OSError, ValueError):  # a name that no file can have
            return None

    @contextmanager
    def listening(self) -> Iterator[None]:
        """A page is there; when the last one has left, what runs is ended."""
        with self._counting:
            self._listeners += 1
        try:
            yield
        finally:
            with self._counting:
                self._listeners -= 1
            left = threading.Timer(LEAVE_S, self._stop_if_alone)
            left.daemon = True
            left.start()

    def close(self) -> None:
        """End everything."""
        self.closed = True
        self._runner.close()

    def _stop_if_alone(self) -> None:
        with self._counting:
            alone = self._listeners == 0
        if alone:
            self._runner.stop("stopped: no page of the studio is open")

    def _calls(self, name: str, scenario: str | None) -> Iterator[Call]:
        project, results = self._project, shown_path(self._workspace.results)
        named = () if scenario is None else (scenario,)
        view = Call(("view", project, *named), inside=lambda: self._shown(scenario))
        if name == "build":
            yield Call(("build", project))
            yield view
        elif name == "view":
            yield view
        elif name == "design":
            yield Call(("design", project, "--plots"), LONG_S)
        elif name == "diagram":
            design, page = f"{project}/design.py:design", f"{results}/diagram.html"
            yield Call(("diagram", design, "--out", page))
        elif name == "analyse":
            option = () if scenario is None else ("--scenario", scenario)
            late = (ExitCode.OK, ExitCode.DEADLINE_CAN_BE_MISSED)
            yield Call(("analyse", project, *option), LONG_S, late)
            yield view
        else:
            ran = (ExitCode.OK, ExitCode.CRITERIA_NOT_MET, ExitCode.RUN_FAULT)
            first = named or tuple(self.files.scenarios()[:1])
            yield Call(("run", project, *first), LONG_S, ran)
            yield Call(("report", project))

    def _shown(self, scenario: str | None) -> dict[str, Any]:
        try:
            self.page = self._show(scenario)
        except RavenbrickError as error:
            failed = {"ok": False, "exit_code": int(error.exit_code)}
            return {**failed, "error": error.sentence, "detail": error.detail}
        self.journal.add("image")
        return {"ok": True}

    def _finished(self, answer: dict[str, Any], since: float) -> dict[str, Any]:
        """Places of errors, and results that were written since then."""
        folder = self._workspace.results
        written = [
            path.relative_to(folder).as_posix()
            for path in sorted(folder.rglob("*"))
            if path.suffix in RESULTS and path.stat().st_mtime >= since
        ]
        problems = [] if answer["ok"] else problems_of(answer, self.files.inside)
        return {"problems": problems, "results": written}
