# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick monitor`: the signals of a running program, live; its parameters, changed."""

from __future__ import annotations

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import ConnectionFailedError, InterruptError, UsageError, shown_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.report.plots.style import png_bytes
from ravenbrick.telemetry.links import check_address, open_link
from ravenbrick.telemetry.messages import Answer, Hello, Message, Verdict
from ravenbrick.telemetry.monitor import Monitor, replay
from ravenbrick.telemetry.picture import signals_figure, steps_figure
from ravenbrick.telemetry.session import Session
from ravenbrick.telemetry.spool import Spool
from ravenbrick.telemetry.steps import live_steps
from ravenbrick.telemetry.window import show_live
from ravenbrick.trace.design import read_design

__all__ = ["monitor_command"]

_RECORD_SUFFIX = ".rbt"


def _assignment(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    try:
        if not name or not equals:
            raise ValueError
        return name.strip(), float(value)
    except ValueError:
        raise UsageError(f"--set {text}: expected NAME=VALUE, as in --set kp=0.35") from None


def _step_names(text: str) -> tuple[str, str]:
    setpoint, colon, output = text.partition(":")
    if not (setpoint and colon and output):
        raise UsageError(f"--step {text}: expected SETPOINT:OUTPUT, the names of two signals")
    return setpoint, output


class _Listener:
    """Says on the terminal what the brick says about itself."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self.session: Session | None = None

    def show(self, message: Message) -> None:
        """One message of the brick."""
        session = self.session
        match message:
            case Hello():
                self._reporter.print(
                    f"program '{message.name}': {message.signal_count} signals, "
                    f"{message.parameter_count} parameters"
                )
            case Answer(index, verdict, value) if session is not None:
                name = session.parameters[index].name if index in session.parameters else "?"
                refused = {Verdict.OUT_OF_RANGE: ": out of its range", Verdict.UNKNOWN: ": unknown"}
                text = f"refused{refused[verdict]}; " if verdict in refused else ""
                self._reporter.print(f"{name}: {text}{value:g} is in force")
            case _:
                pass


def _watch(
    address: str, monitor: Monitor, seconds: float | None, port: int | None, reporter: Reporter
) -> bool:
    """Until `seconds` are over, or until Ctrl-C: then the answer is False."""

    def over() -> bool:
        return seconds is not None and monitor.now_s >= seconds

    reporter.print(f"{address}: connecting; Ctrl-C ends")
    try:
        if port is not None:
            show_live(monitor, port, reporter.tell, over)
        else:
            while not over():
                monitor.poll()
    except KeyboardInterrupt:
        return False
    finally:
        monitor.end()
    return True


def _write_outputs(
    session: Session, stem: Path, step: str | None, mean: int, project: Path | None
) -> list[Path]:
    """Recordings and pictures of the runs of a session."""
    written: list[Path] = []
    for index, run in enumerate(session.runs):
        if not run.sample_count:
            continue
        name = stem.name + (f"-{index + 1}" if len(session.runs) > 1 else "")
        recording = run.recording()
        recording.save(stem.with_name(f"{name}.npz"))
        pictures = {f"{name}.png": signals_figure(run)}
        if step is not None and project is not None:
            design = read_design(Workspace.of(project).design_file)
            names = _step_names(step)
            steps = live_steps(recording, *names, mean)
            if not steps:
                raise UsageError(f"--step {step}: the set-point never changed while connected")
            pictures[f"{name}-steps.png"] = steps_figure(steps, design, *names)
        written.append(stem.with_name(f"{name}.npz"))
        for file, figure in pictures.items():
            atomic_write(stem.with_name(file), png_bytes(figure))
            written.append(stem.with_name(file))
    return written


def _summary(session: Session, files: list[Path]) -> dict[str, Any]:
    runs = [
        {
            "program": run.name,
            "samples": run.sample_count,
            "missing": run.missing,
            "signals": sorted(s.name for g in run.groups.values() for s in g.signals.values()),
        }
        for run in session.runs
    ]
    values = {p.name: session.values[i] for i, p in sorted(session.parameters.items())}
    return {
        "runs": runs,
        "parameters": values,
        "dropped_by_brick": session.status.dropped,
        "damaged_frames": session.damaged,
        "files": [str(path) for path in files],
    }


@command("ravenbrick monitor tcp:5555 --set kp=0.35 --record out/live.rbt --seconds 20")
def monitor_command(
    address: Annotated[
        str,
        typer.Argument(
            help="tcp:PORT, tcp:HOST:PORT, serial device, usb, usb:SERIAL, or record (.rbt)."
        ),
    ],
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="Duration in seconds (default: until Ctrl-C).")
    ] = None,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", help="Parameter to change, as NAME=VALUE; may be repeated."),
    ] = None,
    record: Annotated[
        Path | None, typer.Option(help="New file (.rbt) for all received bytes.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Path without suffix for the recording (.npz) and the picture (.png)."),
    ] = None,
    step: Annotated[
        str | None,
        typer.Option(help="Signals SETPOINT:OUTPUT whose steps are compared with a design."),
    ] = None,
    mean: Annotated[
        int, typer.Option(min=1, help="Number of samples averaged in the output of --step.")
    ] = 1,
    design: Annotated[
        Path | None, typer.Option(help="Project folder with the design for --step.")
    ] = None,
    page: Annotated[
        int | None,
        typer.Option(min=1024, max=65535, help="TCP port on 127.0.0.1 for a live web page."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    if (step is None) != (design is None):
        raise UsageError("--step and --design go together: a pair of signals and a project folder")
    wanted = [_assignment(text) for text in assignments or []]
    reporter, finished = Reporter(json_output), True
    if address.endswith(_RECORD_SUFFIX):
        session = replay(Path(address))
    else:
        check_address(address)
        listener = _Listener(reporter)
        session = Session(on_message=listener.show)
        listener.session = session
        for name, value in wanted:
            session.set_parameter(name, value)
        with ExitStack() as stack:
            spool = stack.enter_context(Spool(record)) if record is not None else None
            monitor = Monitor(session, partial(open_link, address), spool, reporter.print)
            finished = _watch(address, monitor, seconds, page, reporter)
        if not session.runs and not finished:
            raise InterruptError
        if not session.runs:
            raise ConnectionFailedError(
                f"{address}: no program with telemetry answered; check that the brick runs one, "
                "that it is in range, and that nothing else is connected with it"
            )
    files = _write_outputs(session, out, step, mean, design) if out is not None else []
    summary = _summary(session, files)
    for run in summary["runs"]:
        reporter.print(
            f"{run['program']}: {run['samples']} samples of {len(run['signals'])} signals, "
            f"{run['missing']} missing"
        )
    for path in files:
        reporter.print(f"written: {shown_path(path)}")
    if not finished:
        raise InterruptError(**summary)
    return summary
