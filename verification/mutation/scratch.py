# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A scratch copy of the tree in which commands run; they can write nowhere else.

Bubblewrap shows them the whole machine, read-only, an empty /tmp and no network. All processes of
a command end with it, and with this one.
"""

from __future__ import annotations

import fcntl
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import TracebackType

from verification.commands import NoResultError, NotRunError
from verification.support.paths import BUILD, ROOT

__all__ = ["PLACE", "Scratch", "unchanged_s"]

PLACE = BUILD / "verification" / "mutation"
MEMORY_KB = 6_000_000
# What waits uses no processor time; a machine that others use gives little of it.
PATIENCE = 20
# Not tracked, but needed by some tests: products of the set-up.
COPIED = ("build", "web/generated")
LINKED = "web/node_modules"
# As pytest, Cargo and Vitest say it; what the first says of tests that are left out.
PASSED = re.compile(r"\b(\d+) passed\b")
SKIPPED, LONG = "SKIPPED", "RAVENBRICK_LONG"
# A Python finds our package beside its own folder, in the grader's sandbox, too.
PYTHON = ".venv"


def _copy_tree(tree: Path) -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name)
    for name in COPIED:
        if (ROOT / name).is_dir():
            skipped = shutil.ignore_patterns("verification", "fuzz", "dist", "outside")
            shutil.copytree(ROOT / name, tree / name, symlinks=True, ignore=skipped)
    if (ROOT / LINKED).exists():
        (tree / LINKED).symlink_to(ROOT / LINKED)
    if (ROOT / PYTHON).exists():
        shutil.copytree(ROOT / PYTHON, tree / PYTHON, symlinks=True, copy_function=os.link)


class Scratch:
    """The copy for one room; a copy that an earlier run left behind is replaced."""

    def __init__(self, room: str) -> None:
        bwrap = shutil.which("bwrap")
        if bwrap is None:
            raise NotRunError("mutants run in bubblewrap: install the Debian package bubblewrap")
        self.folder = PLACE / room
        self.tree = self.folder / "tree"
        self.log = self.folder / "log.txt"
        self.used_s = 0.0  # processor time of all commands
        self._servers: list[subprocess.Popen[str]] = []
        self.wrapper = [
            *(bwrap, "--die-with-parent", "--unshare-pid", "--unshare-net", "--cap-add", "ALL"),
            *("--ro-bind", "/", "/", "--dev", "/dev", "--proc", "/proc", "--tmpfs", "/tmp"),
            *("--bind", str(self.folder), str(self.folder)),
            *("--ro-bind-try", *2 * (str(self.tree / PYTHON),), "--chdir", str(self.tree)),
        ]

    def __enter__(self) -> Scratch:
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock = (self.folder / "lock").open("w")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise NotRunError(f"{self.folder.name}: another campaign runs this room") from None
        shutil.rmtree(self.tree, ignore_errors=True)
        self.tree.mkdir(parents=True)
        _copy_tree(self.tree)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        for server in self._servers:
            server.kill()
            server.communicate()
        shutil.rmtree(self.tree, ignore_errors=True)
        self._lock.close()
        name = self.folder.name
        print(f"{name}: {self.used_s:.0f} s of processor time", file=sys.stderr, flush=True)

    def said(self) -> str:
        """The first failure in the last run's output, or its last line."""
        lines = self.log.read_text(errors="replace").splitlines() or [""]
        failed = (line for line in lines if re.match(r"FAILED|ERROR|test .* FAILED| FAIL", line))
        return next(failed, lines[-1]).strip()

    def _environment(self) -> dict[str, str]:
        return {
            **{k: v for k, v in os.environ.items() if k not in ("RAVENBRICK_BUILD", "MAKEFLAGS")},
            "PYTHONPATH": str(self.tree / "host" / "src"),
            "PYTHONDONTWRITEBYTECODE": "1",
            "CARGO_TARGET_DIR": str(self.folder / "target"),
            "MPLCONFIGDIR": str(self.folder / "matplotlib"),
        }

    def server(self, command: str) -> subprocess.Popen[str]:
        """A command that answers lines with lines until the copy ends; its memory is bounded."""
        server = subprocess.Popen(
            [*self.wrapper, "bash", "-c", f"ulimit -d {MEMORY_KB}; exec {command}"],
            env=self._environment(), text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        self._servers.append(server)
        return server

    def run(self, command: str, limit_s: float) -> tuple[bool, float]:
        """Whether a shell command ends well, and the processor time it took.

        None of its processes may use more than the limit, nor all together wait long for it.
        """
        # A soft limit of time, as tests of the grader raise it; braces, so that bash counts all.
        limits = f"ulimit -d {MEMORY_KB}; ulimit -S -t {math.ceil(limit_s)}"
        times = self.folder / "times.txt"
        limited = f"{limits}; {{ {command}\n}}; code=$?; times > '{times}'; exit $code"
        times.unlink(missing_ok=True)
        with self.log.open("w") as log:
            try:
                done = subprocess.run(
                    [*self.wrapper, "bash", "-c", limited], env=self._environment(),
                    timeout=PATIENCE * limit_s, check=False,
                    stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                )  # fmt: skip
            except subprocess.TimeoutExpired:
                log.write("\nnot ended in time\n")
                return False, limit_s
        if not times.is_file():
            return False, limit_s
        parts = re.findall(r"(\d+)m(\d+)[.,](\d+)s", times.read_text())
        used_s = sum(60 * int(m) + float(f"{s}.{f}") for m, s, f in parts)
        self.used_s += used_s
        return done.returncode == 0, used_s


def unchanged_s(
    scratch: Scratch, command: str, limit_s: float, name: str = "", builds: bool = False
) -> float:
    """The processor time of a command that has to pass while nothing is changed.

    Raises `NoResultError` with its last lines when it fails, and when it builds nothing and no test
    of it passes: any mutant would survive tests that are skipped. Long tests may be all of a file.
    """
    passed, used_s = scratch.run(command, limit_s)
    lines = scratch.log.read_text(errors="replace").splitlines()
    what, last = f"{scratch.folder.name}, nothing changed: {name or command}", lines[-20:]
    if not passed:
        raise NoResultError("\n".join([f"{what} fails", *last]))
    skipped = [line for line in lines if line.startswith(SKIPPED)]
    long = bool(skipped) and all(LONG in line for line in skipped)
    if not (builds or long or any(int(n) for n in PASSED.findall("\n".join(lines)))):
        raise NoResultError("\n".join([f"{what}: no test passes, so it judges nothing", *last]))
    return used_s
