# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tasks and launches of a folder as VS Code runs them when it was started from the desktop."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

__all__ = ["VSCode", "matcher_problems", "problems_in"]


def matcher_problems(matcher: Mapping[str, Any]) -> list[str]:
    """Why VS Code would not take a problem matcher, by its own rules of validity."""
    pattern = matcher["pattern"]
    found = [] if {"file", "message"} <= set(pattern) else ["the pattern needs file and message"]
    if pattern.get("kind") != "file" and not {"line", "location"} & set(pattern):
        found.append("the pattern needs a line or a location")
    background = matcher.get("background")
    if background is not None and not {"beginsPattern", "endsPattern"} <= set(background):
        found.append("the background task needs beginsPattern and endsPattern")
    return found


def problems_in(matcher: Mapping[str, Any], output: str) -> list[tuple[str, int]]:
    """File and line of the problems that VS Code finds in the output of a task."""
    pattern = matcher["pattern"]
    found = (re.search(pattern["regexp"], line) for line in output.splitlines())
    return [(m[pattern["file"]], int(m[pattern["line"]])) for m in found if m]


class VSCode:
    """VS Code with a folder open; its environment has no shell's PATH and no virtual environment.

    A `port` in place of 3333, which another program may use.
    """

    def __init__(self, folder: Path, home: Path, port: int) -> None:
        self.folder, self.port = folder, port
        self.environment = {"PATH": "/usr/bin:/bin", "HOME": str(home), "LANG": "C.UTF-8"}
        self.settings = self._read("settings.json", resolve=False)
        self.tasks = {task["label"]: task for task in self._read("tasks.json")["tasks"]}
        self.launches = {c["name"]: c for c in self._read("launch.json")["configurations"]}

    def _value(self, name: str) -> str:
        kind, _, rest = name.partition(":")
        if kind == "workspaceFolder":
            return str(self.folder)
        if kind == "input":
            text = (self.folder / ".vscode" / "tasks.json").read_text()
            return str({i["id"]: i["default"] for i in json.loads(text)["inputs"]}[rest])
        return self.environment[rest] if kind == "env" else str(self.settings[rest])

    def _resolved(self, value: Any) -> Any:
        if isinstance(value, dict):
            return {key: self._resolved(item) for key, item in value.items()}
        if isinstance(value, list):
            return [self._resolved(item) for item in value]
        if not isinstance(value, str):
            return value
        return re.sub(r"\$\{([^}]+)\}", lambda m: self._value(m[1]), value)

    def _read(self, name: str, *, resolve: bool = True) -> Any:
        text = (self.folder / ".vscode" / name).read_text(encoding="utf-8")
        content = json.loads(text.replace("3333", str(self.port)))
        return self._resolved(content) if resolve else content

    def start(self, label: str) -> subprocess.Popen[str]:
        """Start a task, after those that it depends on."""
        task = self.tasks[label]
        if "dependsOn" in task:
            before = self.start(task["dependsOn"])
            assert before.wait() == 0, before.communicate()
        words = [task["command"], *task.get("args", [])]
        options = task.get("options", {})
        return subprocess.Popen(
            words if task["type"] == "process" else ["/bin/bash", "-c", *words],
            cwd=options.get("cwd", self.folder),
            env={**self.environment, **options.get("env", {})},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    @contextmanager
    def background(self, label: str) -> Iterator[subprocess.Popen[str]]:
        """A background task, from when its matcher says that it is ready."""
        task = self.start(label)
        matchers = self.tasks[label]["problemMatcher"]
        (matcher,) = matchers if isinstance(matchers, list) else [matchers]
        assert matcher_problems(matcher) == []
        background, said = matcher["background"], []
        try:
            assert task.stdout is not None
            for line in task.stdout:
                said.append(line)
                # VS Code looks for the end only in a line that is not a beginning.
                if re.search(background["beginsPattern"], line.rstrip("\n")):
                    continue
                if re.search(background["endsPattern"], line.rstrip("\n")):
                    break
            else:
                raise AssertionError("never ready: " + "".join(said))
            yield task
        finally:
            if task.poll() is None:
                os.killpg(task.pid, signal.SIGTERM)
            task.communicate()

    def debug(self, name: str, *orders: str) -> str:
        """Start the task before a launch, then GDB as the extension for C and C++ does; what GDB
        answers to its MI commands."""
        launch = self.launches[name]
        program = shutil.which(launch["miDebuggerPath"], path=self.environment["PATH"])
        assert program is not None and launch["type"] == "cppdbg" and launch["MIMode"] == "gdb"
        setup = [f'-interpreter-exec console "{c["text"]}"' for c in launch["setupCommands"]]
        symbols = json.dumps(launch["program"], ensure_ascii=False)
        connect = f"-target-select remote {launch['miDebuggerServerAddress']}"
        with self.background(launch["preLaunchTask"]) as task:
            commands = [*setup, f"-file-exec-and-symbols {symbols}", connect, *orders]
            said = talk_mi(program, commands, self.environment, launch["cwd"])
            assert task.wait(60) == 0, "the server ends with the session"
        return said


def talk_mi(program: str, commands: list[str], environment: dict[str, str], folder: str) -> str:
    """Hold a session in GDB's machine interface; after `-exec-…`, wait until the program stops."""
    gdb = subprocess.Popen(
        [program, "--interpreter=mi", "--quiet"],
        cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert gdb.stdin is not None and gdb.stdout is not None
    said = []
    for command in [*commands, "kill"]:
        gdb.stdin.write(command + "\n")
        gdb.stdin.flush()
        wanted = "*stopped" if command.startswith("-exec-") else "^"
        for line in gdb.stdout:
            said.append(line)
            if line.startswith((wanted, "^error")):
                break
    gdb.stdin.write("-gdb-exit\n")
    gdb.stdin.close()
    gdb.stdout.read()
    assert gdb.wait(60) == 0
    return "".join(said)
