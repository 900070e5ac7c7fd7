# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line in a process that is there before its words.

It loads what a build and a design need, then takes its words as a JSON list from the first line of
its standard input; without a line it ends.
"""

from __future__ import annotations

import importlib
import json
import os
import sys

from ravenbrick import subprocesses
from ravenbrick.cli import main as command_line
from ravenbrick.cli.app import load

__all__ = ["main", "prepare"]

# What a command of the studio or a design.py would load first.
LOADED = (
    "elftools.elf.elffile", "ravenbrick.codegen", "ravenbrick.control", "ravenbrick.model",
    "scipy.linalg", "scipy.optimize", "scipy.signal",
)  # fmt: skip


def prepare() -> None:
    """Load libraries, also those that Typer loads when it reads the words of a command."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy, as the command line does
    for name in LOADED:
        importlib.import_module(name)
    load("build").make_context("build", ["."])
    subprocesses.scripts_share_libraries = True


def main() -> None:
    """Load, wait for words, and be that command."""
    prepare()
    line = sys.stdin.readline()
    if not line:
        return
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, sys.stdin.fileno())
    sys.argv[1:] = json.loads(line)
    command_line()
