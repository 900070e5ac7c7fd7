# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line's root, and how every command ends."""

from __future__ import annotations

import functools
import importlib
import json
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Annotated, Any, NoReturn, ParamSpec

import typer
from typer.core import TyperGroup
from typer.models import CommandInfo

from ravenbrick import __version__
from ravenbrick.errors import ExitCode, RavenbrickError, UsageError, shown_path

__all__ = ["COMMANDS", "JsonOption", "app", "command"]

Arguments = ParamSpec("Arguments")
Result = dict[str, Any]

# Commands whose module has another name.
ELSEWHERE = {"import": "import_model", "home": "new"}
COMMANDS = (
    "analyse",
    "bind",
    "build",
    "debug",
    "demo",
    "design",
    "doctor",
    "export",
    "grade",
    "home",
    "identify",
    "import",
    "live",
    "monitor",
    "new",
    "report",
    "run",
    "schedule",
    "sweep",
    "upload",
    "view",
    "wcet",
)


class Program(typer.Typer):
    """The commands, whose modules are loaded when they are asked for: some load slowly."""

    _loaded = False
    _registered: list[CommandInfo]

    def load(self, names: Sequence[str] = COMMANDS) -> None:
        """Load the named commands; all, unless each name is a command. Only the first call does."""
        if self._loaded:
            return
        self._loaded = True
        for name in names if names and set(names) <= set(COMMANDS) else COMMANDS:
            importlib.import_module(f"ravenbrick.cli.{ELSEWHERE.get(name, name)}")

    def register(self, name: str, example: str, function: Callable[..., None]) -> None:
        """Add a command; nothing else is loaded for it."""
        loaded, self._loaded = self._loaded, True
        self.command(name, epilog=f"Example: {example}")(function)
        self._loaded = loaded

    @property
    def registered_commands(self) -> list[CommandInfo]:
        """Of Typer, which asks when it runs or describes the program."""
        self.load()
        return self._registered

    @registered_commands.setter
    def registered_commands(self, commands: list[CommandInfo]) -> None:
        self._registered = commands


class Answers(TyperGroup):
    """The command line that answers in JSON, where it asks for that, also when it is wrong."""

    def main(self, args: Sequence[str] | None = None, *others: Any, **options: Any) -> Any:
        """See Typer."""
        if "--json" not in (sys.argv[1:] if args is None else args):
            return super().main(args, *others, **options)
        try:
            code = super().main(args, *others, **{**options, "standalone_mode": False})
        except Exception as error:
            sentence = getattr(error, "format_message", None)
            if sentence is None:
                raise
            code = _told(UsageError(f"{sentence().rstrip('.')}; see 'ravenbrick --help'"), True)
        sys.exit(code or 0)


app = Program(
    name="ravenbrick",
    cls=Answers,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    help="Design, build, run and measure real-time control on the LEGO MINDSTORMS NXT.",
    epilog="Exit codes: docs/reference/exit-codes.md. Example: ravenbrick demo examples/vehicle",
)
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON object instead of text; no progress.")
]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"ravenbrick {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    _version_wanted: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Design, build, run and measure real-time control on the LEGO MINDSTORMS NXT."""


def _told(error: RavenbrickError, as_json: bool) -> int:
    """Print an error, without JSON where the output takes none; its exit code."""
    code = int(error.exit_code)
    failure = {"ok": False, "exit_code": code, "error": error.sentence, "detail": error.detail}
    if as_json:
        with suppress(OSError):
            typer.echo(json.dumps({**failure, **error.data}, indent=1))
            return code
    typer.echo(f"ravenbrick: {error.sentence}", err=True)
    for line in error.detail.splitlines():
        typer.echo(f"    {line}", err=True)
    return code


def _end(error: RavenbrickError, as_json: bool) -> NoReturn:
    raise typer.Exit(_told(error, as_json))


def _refused(error: OSError) -> RavenbrickError:
    place = shown_path(error.filename) if error.filename else "the output"
    return UsageError(
        f"{place}: {error.strerror or type(error).__name__}; "
        "check that it exists, that you may write there, and that the disk is not full"
    )


def _defect(error: Exception) -> RavenbrickError:
    where = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(where.filename)}:{where.lineno}"
    return RavenbrickError(
        f"defect of Ravenbrick itself: {type(error).__name__} at {place}: {error}; "
        "please report it; RAVENBRICK_TRACEBACK=1 shows the way to it"
    )


def command(example: str) -> Callable[[Callable[Arguments, Result]], Callable[Arguments, None]]:
    """Make a function a command: errors become a sentence and an exit code, `--json` prints.

    The function returns what `--json` prints besides `ok`; `example` is shown by `--help`.
    """

    def register(function: Callable[Arguments, Result]) -> Callable[Arguments, None]:
        @functools.wraps(function)
        def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
            as_json = bool(kwargs.get("json_output", False))
            try:
                result = function(*args, **kwargs)
                if as_json:
                    typer.echo(json.dumps({"ok": True, **result}, indent=1))
            except RavenbrickError as error:
                _end(error, as_json)
            except OSError as error:
                _end(_refused(error), as_json)
            except KeyboardInterrupt:
                stopped = RavenbrickError("interrupted")
                stopped.exit_code = ExitCode.INTERRUPTED
                _end(stopped, as_json)
            except Exception as error:
                if os.environ.get("RAVENBRICK_TRACEBACK"):
                    traceback.print_exc(file=sys.stderr)
                _end(_defect(error), as_json)

        name = function.__name__.removesuffix("_command")
        run.__annotations__["return"] = None
        app.register(name, example, run)
        return run

    return register
