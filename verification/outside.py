# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Data from outside, which suites need and which is no part of this project.

`python -m verification.outside [NAME ...] [--list]` clones the repositories of `outside.toml` at
their commits into `build/outside/<name>/<owner>/<repository>`, the listed paths only. Programs that
a suite compiles are not cloned: whoever wants to run them gets and reads them first.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from verification.support.paths import BUILD

__all__ = ["Data", "FetchError", "Repository", "data_sets", "fetch"]

TABLE = Path(__file__).with_name("outside.toml")
FOLDER = BUILD / "outside"
HOST = "https://github.com"
LIMIT_S = 600


class FetchError(Exception):
    """Data could not be fetched; the text says what, and what git said."""


@dataclass(frozen=True)
class Repository:
    """A public repository at a commit: licence, size of the checkout, and the paths taken of it."""

    name: str
    commit: str
    licence: str
    megabytes: float
    paths: tuple[str, ...] = ()

    @property
    def address(self) -> str:
        """Where git finds it."""
        return f"{HOST}/{self.name}"

    @property
    def content(self) -> str:
        """What a checkout holds, in one line."""
        return f"{self.commit} {', '.join(self.paths) or 'whole'}"


@dataclass(frozen=True)
class Data:
    """What an environment variable names: a folder of one or several checkouts.

    `compiled`: a suite compiles programs of it, so that nobody but a person fetches it.
    """

    name: str
    variable: str
    repositories: tuple[Repository, ...]
    folder: str = ""
    compiled: bool = False

    @property
    def home(self) -> Path:
        """The folder into which it is fetched."""
        return FOLDER / self.name

    def place(self) -> Path | None:
        """The folder for the variable: the one it already names, or the one fetched, or none."""
        named = os.environ.get(self.variable)
        if named:
            return Path(named)
        complete = not self.compiled and all(
            is_fetched(self.home / r.name, r) for r in self.repositories
        )
        return self.home / self.folder if complete else None

    def sources(self) -> str:
        """The repositories with commit, licence and size."""
        return ", ".join(
            f"{r.name} at {r.commit[:8]} (licence: {r.licence}; {r.megabytes:g} MB)"
            for r in self.repositories
        )

    def advice(self) -> str:
        """Why it is not there and what to do."""
        if self.compiled:
            part = self.folder.removeprefix(self.repositories[0].name).strip("/")
            place = (
                "a folder that holds the checkouts as owner/repository"
                if not self.folder
                else f"the folder {part} of the checkout"
                if part
                else "the checkout"
            )
            return (
                f"{self.name} is absent: get {self.sources()} from {HOST}, read what will be "
                f"compiled, and let {self.variable} name {place}"
            )
        return (
            f"{self.name} is absent: 'python -m verification.outside {self.name}' clones "
            f"{self.sources()} from {HOST}; or let {self.variable} name a folder"
        )


@cache
def data_sets() -> dict[str, Data]:
    """The entries of the table by name."""
    found = {}
    for entry in tomllib.loads(TABLE.read_text(encoding="utf-8"))["data"]:
        repositories = tuple(
            Repository(**{**repository, "paths": tuple(repository.get("paths", ()))})
            for repository in entry.pop("repositories")
        )
        found[entry["name"]] = Data(**entry, repositories=repositories)
    return found


def is_fetched(folder: Path, repository: Repository) -> bool:
    """Whether the checkout is complete and of the commit."""
    mark = folder / ".fetched"
    return mark.is_file() and mark.read_text() == repository.content


def _git(folder: Path, *words: str) -> None:
    try:
        done = subprocess.run(
            ["git", *words], cwd=folder, capture_output=True, text=True, timeout=LIMIT_S,
            env={**os.environ, "GIT_TERMINAL_PROMPT": "0"},
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise FetchError(f"git {words[0]}: no end after {LIMIT_S} s") from None
    if done.returncode:
        said = done.stderr.strip().splitlines()[-1:] or ["no message"]
        raise FetchError(f"git {words[0]}: {said[0]}")


def _clone(repository: Repository, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    _git(folder, "init", "--quiet")
    _git(folder, "remote", "add", "origin", repository.address)
    if repository.paths:
        _git(folder, "sparse-checkout", "set", "--no-cone", *repository.paths)
    options = ("--quiet", "--depth=1", "--filter=blob:none")
    _git(folder, "fetch", *options, "origin", repository.commit)
    _git(folder, "checkout", "--quiet", "FETCH_HEAD")
    (folder / ".fetched").write_text(repository.content)


def fetch(data: Data) -> Path:
    """Clone what is absent; the folder for the variable. Raises FetchError."""
    for repository in data.repositories:
        folder = data.home / repository.name
        if is_fetched(folder, repository):
            continue
        try:
            _clone(repository, folder)
        except FetchError as error:
            raise FetchError(f"{repository.address}: {error}") from None
    return data.home / data.folder


def main(arguments: list[str] | None = None) -> int:
    """Fetch, or list; 1 when something could not be fetched, 2 for an unknown name."""
    parser = argparse.ArgumentParser(prog="python -m verification.outside", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="data sets (default: all)")
    parser.add_argument("--list", action="store_true", help="list the data sets and their folders")
    options = parser.parse_args(arguments)
    known = data_sets()
    if unknown := sorted(set(options.names) - set(known)):
        print(f"{', '.join(unknown)}: no such data; there are {', '.join(known)}", file=sys.stderr)
        return 2
    failed = 0
    for data in (known[name] for name in options.names or known):
        place = data.place()
        if place is None and not options.list and not data.compiled:
            try:
                place = fetch(data)
            except FetchError as error:
                print(f"{data.name}: {error}", file=sys.stderr)
                failed = 1
                continue
        print(f"{data.name}: {place}" if place else data.advice())
    return failed


if __name__ == "__main__":
    sys.exit(main())
