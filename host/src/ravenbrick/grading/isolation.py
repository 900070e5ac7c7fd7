# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The border around a submission: bubblewrap, or by explicit trust none.

Inside, a program sees the system's programs and the paths that it is given, all read-only, and one
folder in memory that it may write. It has no network, and no process of it outlives the first one.
"""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from ravenbrick.errors import ToolMissingError
from ravenbrick.installation import advice_for_packages

__all__ = [
    "FIRST_USER",
    "TRUST",
    "USERS",
    "Bounds",
    "Isolation",
    "IsolationError",
    "find_isolation",
    "isolation_named",
]

MEGABYTE = 1 << 20
SYSTEM = "/usr"
# Of the root folder: links into /usr on a merged system, folders of their own otherwise.
SYSTEM_PARTS = ("bin", "sbin", "lib", "lib32", "lib64")
# awk is found through the alternatives.
SYSTEM_FILES = ("/etc/alternatives", "/etc/ld.so.cache")
PATH = "/usr/local/bin:/usr/bin:/bin"
SCRATCH = Path("/tmp")
INSIDE = SCRATCH / "submission"
# Of users that no service has, so that the process limit of one sandbox is its own.
FIRST_USER, USERS = 62_000, 2_000
PROBE_S = 20
TRUST = "none (--trust-submissions)"
CURES = (
    ("No permissions to create new namespace", "a container needs the option --privileged or "
     "a seccomp profile that allows user namespaces; elsewhere 'sysctl -w "
     "kernel.unprivileged_userns_clone=1' as root allows them"),
    ("setting up uid map", "AppArmor restricts user namespaces: 'sysctl -w "
     "kernel.apparmor_restrict_unprivileged_userns=0' as root, or a profile for /usr/bin/bwrap"),
    ("loopback", "AppArmor restricts user namespaces: 'sysctl -w "
     "kernel.apparmor_restrict_unprivileged_userns=0' as root, or a profile for /usr/bin/bwrap"),
    ("Operation not permitted", "run the container with --privileged or with a seccomp profile "
     "that allows namespaces, or grade outside of it"),
    ("max_user_namespaces", "'sysctl -w user.max_user_namespaces=1000' as root"),
)  # fmt: skip


class IsolationError(ToolMissingError):
    """Submissions cannot be isolated on this machine; says why and what to do."""


@dataclass(frozen=True)
class Bounds:
    """Limits of one call: processor time and memory of each process, files, number of processes.

    All memory is at most `processes` times `memory_mb`, and `scratch_mb` of files.
    """

    seconds: int
    memory_mb: int
    file_mb: int
    processes: int = 24
    scratch_mb: int = 256

    def command(self) -> list[str]:
        """The program that sets the limits and then becomes the command behind it."""
        return [
            "prlimit",
            f"--cpu={self.seconds}:{self.seconds + 5}",
            f"--as={self.memory_mb * MEGABYTE}",
            f"--fsize={self.file_mb * MEGABYTE}",
            "--core=0",
            f"--nproc={self.processes}",
        ]


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


class Bubblewrap(Isolation):
    """Namespaces of the kernel, set up by bubblewrap."""

    path = PATH

    def __init__(self, program: str, version: str) -> None:
        self.program, self.name = program, version

    @contextmanager
    def call(
        self,
        command: Sequence[str],
        bounds: Bounds,
        readable: Sequence[Path],
        hidden: Sequence[Path],
    ) -> Iterator[tuple[list[str], Path]]:
        whole = [self.program, "--die-with-parent", "--new-session", *_namespaces(), *_system()]
        size = str(bounds.scratch_mb * MEGABYTE)
        whole += ["--size", size, "--perms", "1777", "--tmpfs", str(SCRATCH)]
        whole += ["--perms", "0777", "--dir", str(INSIDE)]
        whole += _read_only([path for path in readable if not path.is_relative_to(SYSTEM)], hidden)
        whole += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", str(INSIDE), "--"]
        yield [*whole, *bounds.command(), *_other_user(), *command], INSIDE


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
        limits = [word for word in bounds.command() if not word.startswith("--nproc")]
        with TemporaryDirectory(prefix="ravenbrick-grade-") as folder:
            yield ["env", "-C", folder, *limits, *command], Path(folder)


def _namespaces() -> list[str]:
    """Root sets the sandbox up itself and leaves its rights inside; others need a user space."""
    apart = ["--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts"]
    apart += ["--unshare-cgroup-try"]
    return apart if os.geteuid() == 0 else [*apart, "--unshare-user", "--disable-userns"]


def _other_user() -> list[str]:
    """Process limits are void for root, so the command runs as a user without any rights."""
    if os.geteuid() != 0:
        return []
    user = FIRST_USER + next(_USERS) % USERS
    return ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups",
            "--inh-caps=-all", "--bounding-set=-all", "--no-new-privs"]  # fmt: skip


def _numbers() -> Iterator[int]:
    number = os.getpid()
    while True:
        yield number
        number += 1


_USERS = _numbers()


def _read_only(paths: Sequence[Path], hidden: Sequence[Path]) -> list[str]:
    """Each path at its own place; folders above them are empty but for these, and passable."""
    words: list[str] = []
    covers = {path for path in hidden if any(path.is_relative_to(folder) for folder in paths)}
    above = {SCRATCH, Path("/")}
    # Folders before what lies in them: else the outer one would cover the inner one.
    for path in sorted({*paths, *covers}, key=lambda path: len(path.parts)):
        for folder in reversed(path.parents):
            if folder not in above:
                words += ["--perms", "0755", "--dir", str(folder)]
                above.add(folder)
        above.add(path)
        if path in covers:
            words += ["--perms", "0755", "--tmpfs", str(path)]
        else:
            words += ["--ro-bind", str(path), str(path)]
    return words + [word for path in covers for word in ("--remount-ro", str(path))]


@functools.cache
def _system() -> tuple[str, ...]:
    words = ["--perms", "0755", "--dir", "/etc", "--ro-bind", SYSTEM, SYSTEM]
    for name in SYSTEM_PARTS:
        path = Path("/") / name
        if path.is_symlink():
            words += ["--symlink", os.readlink(path), str(path)]
        elif path.is_dir():
            words += ["--ro-bind", str(path), str(path)]
    for file in SYSTEM_FILES:
        words += ["--ro-bind-try", file, file]
    return (*words, "--proc", "/proc", "--dev", "/dev")


def _cure(cause: str) -> str:
    for sign, cure in CURES:
        if sign in cause:
            return cure
    return "allow user namespaces on this machine"


@functools.cache
def find_isolation() -> Isolation:
    """The isolation of this machine, tried once; raises `IsolationError` with cause and cure."""
    program = shutil.which("bwrap")
    if program is None:
        raise IsolationError(
            "submissions cannot be isolated: bwrap is not installed; "
            f"{advice_for_packages(['bubblewrap'])}"
        )
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=False)
    found = Bubblewrap(program, done.stdout.strip() or "bubblewrap")
    with found.call(["true"], Bounds(5, 512, 1), [], []) as (command, _folder):
        try:
            done = subprocess.run(
                command, env={"PATH": PATH}, stdin=subprocess.DEVNULL, capture_output=True,
                text=True, timeout=PROBE_S, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise IsolationError("submissions cannot be isolated: bwrap does not end") from None
    if done.returncode != 0:
        cause = (done.stderr.strip().splitlines() or [f"bwrap ends with {done.returncode}"])[-1]
        raise IsolationError(f"submissions cannot be isolated: {cause}; {_cure(cause)}")
    return found


def isolation_named(name: str) -> Isolation:
    """The isolation that a campaign has chosen, on this machine; raises `IsolationError`."""
    return Trust() if name == TRUST else find_isolation()
