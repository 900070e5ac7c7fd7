# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bubblewrap: namespaces of the kernel in which only the given paths exist."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ravenbrick.grading.isolation.border import (
    MEGABYTE,
    PATH,
    SYSTEM,
    SYSTEM_FILES,
    SYSTEM_PARTS,
    Bounds,
    Isolation,
    other_user,
)
from ravenbrick.grading.isolation.calls import filter_file

__all__ = ["Bubblewrap", "cure_of"]

SCRATCH = Path("/tmp")
INSIDE = SCRATCH / "submission"
# Becomes the command behind the file, which is open as number 9.
WITH_FILTER = ("sh", "-c", 'exec "$@" 9<"$0"')
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
        whole = [*WITH_FILTER, str(filter_file(sets_instants=True)), self.program, "--seccomp", "9"]
        whole += ["--die-with-parent", "--new-session", *_namespaces(), *_system()]
        size = str(bounds.scratch_mb * MEGABYTE)
        whole += ["--size", size, "--perms", "1777", "--tmpfs", str(SCRATCH)]
        whole += ["--perms", "0777", "--dir", str(INSIDE)]
        whole += _read_only([path for path in readable if not path.is_relative_to(SYSTEM)], hidden)
        whole += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", str(INSIDE), "--"]
        yield [*whole, *bounds.command(), *other_user(), *command], INSIDE


def _namespaces() -> list[str]:
    """Root sets the sandbox up itself and leaves its rights inside; others need a user space."""
    apart = ["--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts"]
    apart += ["--unshare-cgroup-try"]
    return apart if os.geteuid() == 0 else [*apart, "--unshare-user", "--disable-userns"]


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


def cure_of(cause: str) -> str:
    """What to do about a message of bubblewrap."""
    for sign, cure in CURES:
        if sign in cause:
            return cure
    return "allow user namespaces on this machine"
