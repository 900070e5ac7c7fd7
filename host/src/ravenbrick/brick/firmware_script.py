# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Test scripts for firmware images: functions of a Python file, each with a brick of its own.

A function whose name begins with `test_` gets a `FirmwareBrick`. A function `boot`, if there is
one, runs once before all of them, and each test continues from there. The dictionary
`CONFIGURATION` changes what is plugged in.
"""

from __future__ import annotations

import importlib.util
import inspect
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.brick.firmware import FirmwareBrick
from ravenbrick.errors import RavenbrickError, UsageError

__all__ = ["FirmwareScript", "ScriptResult"]

Test = Callable[[FirmwareBrick], None]


@dataclass(frozen=True)
class ScriptResult:
    """How a test ended: `failure` is the cause with its line, None when it passed."""

    name: str
    failure: str | None
    seconds: float
    trace_digest: str
    lcd: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """With plain types."""
        return {**vars(self), "passed": self.failure is None, "lcd": list(self.lcd)}


class FirmwareScript:
    """A script file. Raises UsageError when it cannot be used."""

    def __init__(self, path: Path) -> None:
        specification = importlib.util.spec_from_file_location(path.stem, path)
        if not path.is_file() or specification is None or specification.loader is None:
            raise UsageError(f"{path}: there is no such script; name a Python file")
        module = importlib.util.module_from_spec(specification)
        sys.path.insert(0, str(path.parent.resolve()))
        try:
            specification.loader.exec_module(module)
        except Exception as error:
            place = _place(error, path)
            raise UsageError(f"{place}: {_cause(error)}; correct the script") from None
        finally:
            sys.path.pop(0)
        self._path = path
        found = inspect.getmembers(module, inspect.isfunction)
        tests = [(name, function) for name, function in found if name.startswith("test_")]
        tests.sort(key=lambda test: test[1].__code__.co_firstlineno)
        self.tests: dict[str, Test] = dict(tests)
        self._boot: Test | None = getattr(module, "boot", None)
        self._configuration: Mapping[str, Any] = getattr(module, "CONFIGURATION", {})
        if not self.tests:
            raise UsageError(f"{path}: has no function whose name begins with 'test_'")

    def run(
        self, image: bytes, address: int, settings: Mapping[str, Any], names: str = ""
    ) -> Iterator[ScriptResult]:
        """The results of the tests whose name contains `names`, each when it is there.

        `settings` are further fields of the brick's configuration. Raises ImageFileError for an
        image that cannot be loaded; whatever a test or `boot` raises is a failure.
        """
        chosen = {name: test for name, test in self.tests.items() if names in name}
        if not chosen:
            there = ", ".join(self.tests)
            raise UsageError(f"no test's name contains '{names}'; there are {there}")

        def switched_on() -> FirmwareBrick:
            return FirmwareBrick(image, address, **self._configuration, **settings)

        first = switched_on()
        if self._boot is not None:
            booted = self._result("boot", self._boot, first)
            if booted.failure is not None:
                yield booted
                return
        start = first.device.snapshot()
        for name, test in chosen.items():
            brick = switched_on()
            brick.device.restore(start)
            yield self._result(name, test, brick)

    def _result(self, name: str, test: Test, brick: FirmwareBrick) -> ScriptResult:
        failure = None
        try:
            test(brick)
        except Exception as error:
            failure = f"{_place(error, self._path)}: {_cause(error)}"
        try:
            lcd = brick.lines
        except RavenbrickError:
            lcd = ()
        return ScriptResult(name, failure, brick.seconds, brick.device.trace_digest(), lcd)


def _place(error: Exception, path: Path) -> str:
    """File and line in the script where it went wrong."""
    if isinstance(error, SyntaxError):
        return f"{path}:{error.lineno}"
    own = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).resolve() == path.resolve()
    ]
    return f"{path}:{own[-1].lineno}" if own else str(path)


def _cause(error: Exception) -> str:
    if isinstance(error, (AssertionError, RavenbrickError)):
        return str(error) or "an assertion without a text failed"
    return f"{type(error).__name__}: {error}"
