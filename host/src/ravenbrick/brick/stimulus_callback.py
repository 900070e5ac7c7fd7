# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stimuli from a Python function that the user names on the command line.

The function is called every `period_ms` of virtual time with a `BrickState`, and returns the inputs
that change at that instant: a mapping, pairs, or None. What it returned is recorded with the run,
which therefore can be played again without it.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import os
import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

from ravenbrick.errors import UsageError

__all__ = ["BrickState", "Callback", "load_callback"]


class BrickState(Protocol):
    """The brick as a callback sees it."""

    @property
    def time(self) -> float:
        """Since power-on, in s."""

    @property
    def cycles(self) -> int:
        """The same instant in cycles."""

    @property
    def lcd(self) -> tuple[str, ...]:
        """Text on the LCD, a string per line."""

    def signal(self, name: str) -> float:
        """The last sample of a signal."""

    def read(self, symbol: str) -> float:
        """A variable of the program, by its name."""


class Callback:
    """A user's function and how often it is asked."""

    def __init__(self, function: Callable[[BrickState], Any], name: str, period_ms: int) -> None:
        self._function = function
        self.name = name
        self.period_ms = period_ms

    def inputs(self, state: BrickState) -> list[tuple[str, float]]:
        """What changes now; raises `UsageError` with file and line of what went wrong."""
        try:
            answer = self._function(state)
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            raise UsageError(
                f"{where.filename}:{where.lineno}: {self.name} at {state.time:.6f} s: "
                f"{type(error).__name__}: {error}; correct the function"
            ) from None
        try:
            items = answer.items() if isinstance(answer, Mapping) else (answer or ())
            found = [(str(name), float(value)) for name, value in items]
        except (TypeError, ValueError):
            found = [("", math.nan)]
        if all(math.isfinite(value) for _, value in found):
            return found
        raise self.error(
            f"returned {answer!r} at {state.time:.6f} s; return a mapping from input names to "
            "finite numbers, pairs of them, or None"
        )

    def error(self, problem: str) -> UsageError:
        """A problem with what the function returned, with file and line of the function."""
        code = getattr(self._function, "__code__", None)
        place = f"{code.co_filename}:{code.co_firstlineno}: " if code else ""
        return UsageError(f"{place}{self.name} {problem}")


def _module(name: str) -> Any:
    if name.endswith(".py"):
        path = Path(name)
        specification = importlib.util.spec_from_file_location(path.stem, path)
        if not path.is_file() or specification is None or specification.loader is None:
            raise UsageError(f"{name}: there is no such Python file; correct --callback")
        module = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(module)
        return module
    # Last, so that no file of the folder hides an installed module.
    here = os.getcwd()
    if here not in sys.path:
        sys.path.append(here)
    return importlib.import_module(name)


def load_callback(text: str, period_ms: int) -> Callback:
    """`module:function` or `file.py:function`; raises `UsageError`."""
    module_name, colon, function_name = text.rpartition(":")
    if not colon or not module_name or not function_name.isidentifier():
        raise UsageError(f"'{text}' is not of the form module:function; correct --callback")
    try:
        module = _module(module_name)
    except UsageError:
        raise
    except Exception as error:
        raise UsageError(
            f"--callback {text}: cannot import '{module_name}' "
            f"({type(error).__name__}: {error}); correct the name or the module"
        ) from None
    function = getattr(module, function_name, None)
    if not callable(function):
        raise UsageError(f"--callback {text}: '{module_name}' has no function '{function_name}'")
    return Callback(function, text, period_ms)
