# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The root command, and the error handling of all commands."""

from __future__ import annotations

import errno
import functools
import importlib
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated, Any, NoReturn, ParamSpec

import typer
from typer.core import TyperCommand, TyperGroup

from ravenbrick.cli import VERSION_LINE
from ravenbrick.errors import (
    InterruptError,
    RavenbrickError,
    UsageError,
    printable,
    shown_path,
)

__all__ = [
    "COMMANDS",
    "JsonOption",
    "ProjectArgument",
    "ScenarioArgument",
    "app",
    "command",
    "load",
]

Arguments = ParamSpec("Arguments")
Result = dict[str, Any]

# Commands by name; the sentence is their help.
COMMANDS = {
    "analyse": "Bound execution and response times from the binary and compare them with a run.",
    "bind": "Copy the C of an Embedded Coder model and write its Ada binding.",
    "build": "Compile, bind and link the image, and report its memory use.",
    "check-data": "Check records of bricks against the schema; file, line and field are named.",
    "class": "Make an assignment of their own for each student of a class, from a secret key.",
    "compare-brick": "Compare the self-test of a brick with the virtual brick, row by row.",
    "contribute": "Make a record for the open data of a self-test or a live recording.",
    "debug": "Debug the program with GDB, forwards and backwards in time.",
    "demo": "Design, generate, build, run every scenario, measure, and write the report.",
    "design": "Run design.py: tune, discretise, simulate, and generate the controller's C.",
    "diagram": "Draw a block diagram, beside its C or alone, or save it as text.",
    "doctor": "Check the toolchain, the Python modules and the connection to a real brick.",
    "export": "Convert a recording for Perfetto, GTKWave, Surfer, Foxglove, CSV or Parquet.",
    "firmware": "Test a firmware image: buttons, LCD text, motors, USB and Bluetooth clients.",
    "grade": "Build and run submissions in a sandbox, and grade them by a rubric.",
    "home": "Print the folder of the Ravenbrick tree, for Makefiles.",
    "identify": "Run an experiment on the virtual brick; fit and validate the motor's parameters.",
    "import": "Generate C from a Simulink model, or list the blocks that are not supported.",
    "live": "Run the program in real time for other programs, such as `ravenbrick monitor`.",
    "monitor": "Show and record live telemetry, change parameters, compare with a design.",
    "new": "Create a project folder from a template; existing files are never overwritten.",
    "report": "Write report.html, summary.json and SVG charts of the last recordings.",
    "run": "Run a scenario on the virtual brick, record it, and check its pass criteria.",
    "schedule": "Bound the response times of a task set from a file.",
    "simulate": "Simulate a Simulink model over time, continuous plant and sampled controller.",
    "studio": "Edit, build and run a project in the browser, with the tools of this machine.",
    "sweep": "Run a scenario with random motors within robot.toml's tolerances; check every run.",
    "upload": "Build the image and load it over USB into a brick in its boot monitor.",
    "view": "Show and operate the virtual brick in a browser tab, where the program runs.",
    "wcet": "Bound the execution time of a function of an ELF file.",
}
# As `ravenbrick --help` lists them.
GROUPS = {
    "Design, build and run a robot": "new design build run demo report sweep export",
    "Watch, debug and test": "view studio debug live monitor firmware",
    "Models": "diagram import simulate bind identify",
    "Timing": "analyse schedule wcet",
    "A real brick": "upload compare-brick contribute check-data",
    "A class": "class grade",
    "This installation": "doctor home",
}
# Commands whose module has another name.
ELSEWHERE = {
    "check-data": "check_data",
    "class": "class_folders",
    "compare-brick": "compare_brick",
    "import": "import_model",
    "home": "new",
}
OPTIONS: dict[str, Any] = {"rich_markup_mode": None}  # without rich, which loads slowly


class Program(TyperGroup):
    """The commands; the module of a command is loaded when the command is called.

    What fails is told in one sentence, with `--json` as an object.
    """

    _as_json = False

    def __init__(self, **attributes: Any) -> None:
        listed = {n: TyperCommand(n, help=h, short_help=h, **OPTIONS) for n, h in COMMANDS.items()}
        super().__init__(**{**attributes, "commands": listed})

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """See Typer; by groups."""
        for group, names in GROUPS.items():
            with formatter.section(group):
                formatter.write_dl([(name, COMMANDS[name]) for name in names.split()])

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """See Typer."""
        name, found, rest = super().resolve_command(ctx, args)
        if found is None or name is None:
            return name, found, rest
        with _answering(self._as_json):
            return name, load(name), rest

    def main(self, args: Sequence[str] | None = None, *others: Any, **options: Any) -> NoReturn:
        """See Typer."""
        words = list(sys.argv[1:] if args is None else args)
        self._as_json = "--json" in words
        if "_RAVENBRICK_COMPLETE" in os.environ:
            # Typer would load rich, to take markup out of sentences that have none.
            sys.modules["rich"] = None  # type: ignore[assignment]
        try:
            alone = {**options, "standalone_mode": False}
            code = super().main(words or ["--help"], *others, **alone)
        except (KeyboardInterrupt, typer.Abort):
            code = _told(InterruptError(), self._as_json)
        except Exception as error:
            sentence = getattr(error, "format_message", None)
            if sentence is None:
                raise
            code = _told(_wrong_words(error, sentence()), self._as_json)
        sys.exit(code or 0)


def load(name: str) -> Any:
    """The command of this name, for Typer; raises KeyError."""
    importlib.import_module(f"ravenbrick.cli.{ELSEWHERE.get(name, name)}")
    single = typer.Typer(add_completion=False, **OPTIONS)
    function, example = _FUNCTIONS[name]
    single.command(name, help=COMMANDS[name], epilog=f"Example: {example}")(function)
    return typer.main.get_command(single)


REFUSALS = {
    errno.ENOENT: "correct its name",
    errno.EACCES: "name another folder, or ask for permission to write there",
    errno.ENOSPC: "free space on the disk, or name another folder",
    errno.ENOTDIR: "a part of the path is a file and not a folder; correct it",
    errno.EISDIR: "name a file in it",
}
_FUNCTIONS: dict[str, tuple[Callable[..., None], str]] = {}
app = typer.Typer(
    name="ravenbrick",
    cls=Program,
    help="Design, build, run and measure real-time control on the LEGO MINDSTORMS NXT.",
    epilog="Exit codes: docs/reference/exit-codes.md. Example: ravenbrick demo examples/vehicle",
    **OPTIONS,
)
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON object instead of text and progress.")
]
ProjectArgument = Annotated[Path, typer.Argument(help="Project folder with robot.toml.")]
ScenarioArgument = Annotated[str, typer.Argument(help="Scenario: name in scenarios/, or file.")]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(VERSION_LINE)
        raise typer.Exit


@app.callback()
def _root(
    _version_wanted: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def _wrong_words(error: Exception, sentence: str) -> UsageError:
    """What Typer found wrong in the command line."""
    context = getattr(error, "ctx", None)
    name = f" {context.info_name}" if context is not None and context.parent else ""
    sentence = sentence.rstrip(".").replace(": Value error, ", ": ")
    return UsageError(f"{sentence}; see 'ravenbrick{name} --help'")


def _told(error: RavenbrickError, as_json: bool) -> int:
    """Print an error, without JSON where the output takes none; its exit code."""
    code = int(error.exit_code)
    failure = {"ok": False, "exit_code": code, "error": error.sentence, "detail": error.detail}
    if as_json:
        with suppress(OSError):
            typer.echo(json.dumps({**failure, **error.data}, indent=1))
            return code
    typer.echo(f"ravenbrick: {printable(error.sentence)}", err=True)
    for line in printable(error.detail).splitlines():
        typer.echo(f"    {line}", err=True)
    return code


def _end(error: RavenbrickError, as_json: bool) -> NoReturn:
    raise typer.Exit(_told(error, as_json))


def _refused(error: OSError) -> RavenbrickError:
    place = shown_path(error.filename) if error.filename else "the output"
    advice = REFUSALS.get(error.errno or 0, "check that it exists and that you may write there")
    return UsageError(f"{place}: {error.strerror or type(error).__name__}; {advice}")


def _defect(error: Exception) -> RavenbrickError:
    where = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(where.filename)}:{where.lineno}"
    return RavenbrickError(
        f"internal error of Ravenbrick: {type(error).__name__} at {place}: {error}; "
        "please report it; set RAVENBRICK_TRACEBACK=1 for a traceback"
    )


@contextmanager
def _answering(as_json: bool) -> Iterator[None]:
    """Tell in one sentence what fails inside, and end the program with its exit code."""
    try:
        yield
    except (typer.Exit, BrokenPipeError):
        raise  # nobody reads on, which Typer ends without a word
    except RavenbrickError as error:
        _end(error, as_json)
    except OSError as error:
        _end(_refused(error), as_json)
    except KeyboardInterrupt:
        _end(InterruptError(), as_json)
    except Exception as error:
        if os.environ.get("RAVENBRICK_TRACEBACK"):
            traceback.print_exc(file=sys.stderr)
        _end(_defect(error), as_json)


def command(example: str) -> Callable[[Callable[Arguments, Result]], Callable[Arguments, None]]:
    """Make a function a command: errors become a sentence and an exit code, `--json` prints.

    The function is called after the command and `_command`, and returns what `--json` prints
    besides `ok`; `example` is shown by `--help`.
    """

    def register(function: Callable[Arguments, Result]) -> Callable[Arguments, None]:
        @functools.wraps(function)
        def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
            as_json = bool(kwargs.get("json_output", False))
            with _answering(as_json):
                result = function(*args, **kwargs)
                if as_json:
                    typer.echo(json.dumps({"ok": True, **result}, indent=1))

        run.__annotations__["return"] = None
        name = function.__name__.removesuffix("_command").replace("_", "-")
        _FUNCTIONS[name] = run, example
        return run

    return register
