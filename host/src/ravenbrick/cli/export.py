# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick export`: a recording in the format of another tool."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.export import Format, export
from ravenbrick.trace.recording import Recording

__all__ = ["export_command"]


def _source(source: Path, scenario: str | None, image: ImageChoice) -> tuple[Path, Path]:
    """File of the recording, and the folder and stem of what is made of it."""
    if source.is_file():
        if scenario is not None:
            raise UsageError(f"'{source}' is a recording; omit '{scenario}'")
        return source, source.with_suffix("")
    if not source.exists() and source.suffix == ".npz":
        raise UsageError(f"{source}: there is no such recording; make one with 'ravenbrick run'")
    workspace = Workspace.of(source)
    if scenario is None:
        raise UsageError(f"name a scenario of '{source}', or a recording instead of the folder")
    # A scenario's file may be named instead, as for 'ravenbrick run'.
    own = workspace.recording(Path(scenario).stem, image.kind)
    file = own if own.is_file() else workspace.named_recording(scenario)
    if not file.is_file() or file.suffix != own.suffix:
        raise UsageError(
            f"{shown_path(own)}: the scenario has not been run yet; "
            f"run it with 'ravenbrick run {source} {scenario}'"
        )
    return file, workspace.results / "exports" / file.with_suffix("").name


@command("ravenbrick export examples/vehicle drive --format perfetto")
def export_command(
    source: Annotated[Path, typer.Argument(help="Recording (.npz) or project folder.")],
    scenario: Annotated[
        str | None, typer.Argument(help="Scenario whose last recording is exported.")
    ] = None,
    file_format: Annotated[Format, typer.Option("--format", help="File format.")] = Format.PERFETTO,
    out: Annotated[
        Path | None, typer.Option(help="File to write (default: beside the recording, or in out/).")
    ] = None,
    image: Annotated[
        ImageChoice, typer.Option(help="Image that was run: RAM or flash.")
    ] = ImageChoice.RAM,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    file, stem = _source(source, scenario, image)
    target = out or stem.with_name(stem.name + file_format.suffix)
    if target.is_dir() or target.resolve() == file.resolve():
        raise UsageError(f"--out {target}: is a folder or the recording; name another file")
    reporter = Reporter(json_output)
    with reporter.step(f"export to {file_format.value}") as step:
        recording = Recording.load(file)
        written = export(recording, file_format, target)
        step.note = ", ".join(shown_path(path) for path in written)
    return {
        "recording": str(file),
        "format": file_format.value,
        "files": [{"file": str(path), "bytes": path.stat().st_size} for path in written],
        "trace_digest": recording.digest,
    }
