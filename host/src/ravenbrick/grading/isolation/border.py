# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a border around a submission is: limits, and a way to run a command apart."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from ravenbrick.errors import ToolMissingError

__all__ = [
    "FIRST_USER",
    "MEGABYTE",
    "PATH",
    "SYSTEM",
    "SYSTEM_FILES",
    "SYSTEM_PARTS",
    "TRUST",
    "USERS",
    "Bounds",
    "Isolation",
    "IsolationError",
    "Trust",
    "other_user",
]

MEGABYTE = 1 << 20
SYSTEM = "/usr"
# Of the root folder: links into /usr on a merged system, folders of their own otherwise.
SYSTEM_PARTS = ("bin", "sbin", "lib", "lib32", "lib64")
# awk is found through the alternatives.
SYSTEM_FILES = ("/etc/alternatives", "/etc/ld.so.cache")
PATH = "/usr/local/bin:/usr/bin:/bin"
# Of users that no service has, so that the process limit of one sandbox is its own.
FIRST_USER, USERS = 62_000, 2_000
TRUST = "none (--trust-submissions)"


class IsolationError(ToolMissingError):
    """Submissions cannot be isolated on this machine; says why and what to do."""


@dataclass(frozen=True)
class Bounds:
    """Limits of one call: processor time and memory of each process, files, number of processes.

    All memory is at most `processes` times `memory_mb`, and `scratch_mb` of files. Without a limit
    of processes, those of the user are not counted.
    """

    seconds: int
    memory_mb: int
    file_mb: int
    processes: int | None = 24
    scratch_mb: int = 256

    def command(self) -> list[str]:
        """The program that sets the limits and then becomes the command behind it."""
        limits = [
            f"--cpu={self.seconds}:{self.seconds + 5}",
            f"--as={self.memory_mb * MEGABYTE}",
            f"--fsize={self.file_mb * MEGABYTE}",
            "--core=0",
        ]
        return ["prlimit", *limits, *([f"--nproc={self.processes}"] if self.processes else [])]


class Isolation(ABC):
    """A way to run a command apart; `name` is for the report."""

    name: str
    path: str

    @abstractmethod
    @contextmanager
    def call(
        self,
        command: Sequence[str],
        bounds: Bounds,
        readable: Sequence[Path],
        hidden: Sequence[Path],
    ) -> Iterator[tuple[list[str], Path]]:
        """The whole command, and the writable folder in which it starts."""

    def overflows(self, session: int, folder: Path, bounds: Bounds) -> bool:
        """Whether the processes of a session hold more in files than they may; asked often."""
        return False


class Trust(Isolation):
    """No border: the limits only, in a folder of the host."""

    name = TRUST

    @property
    def path(self) -> str:  # type: ignore[override]
        return os.environ.get("PATH", PATH)

    @contextmanager
    def call(
        self,
        command: Sequence[str],
        bounds: Bounds,
        readable: Sequence[Path],
        hidden: Sequence[Path],
    ) -> Iterator[tuple[list[str], Path]]:
        limits = replace(bounds, processes=None).command()
        with TemporaryDirectory(prefix="ravenbrick-grade-") as folder:
            yield ["env", "-C", folder, *limits, *command], Path(folder)


def other_user(right: str = "") -> list[str]:
    """Process limits are void for root, so the command runs as a user with at most one right."""
    if os.geteuid() != 0:
        return []
    user = FIRST_USER + next(_USERS) % USERS
    rights = ",".join(["-all", f"+{right}"] if right else ["-all"])
    sets = [f"--inh-caps={rights}", f"--ambient-caps={rights}"]
    user_and_group = [f"--reuid={user}", f"--regid={user}", "--clear-groups"]
    return ["setpriv", *user_and_group, *sets, f"--bounding-set={rights}", "--no-new-privs"]


def _numbers() -> Iterator[int]:
    number = os.getpid()
    while True:
        yield number
        number += 1


_USERS = _numbers()
