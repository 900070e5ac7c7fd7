# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick bind`: a model that Embedded Coder generated, for an Ada application."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.codegen import read_binding, read_coder_model
from ravenbrick.errors import UsageError
from ravenbrick.image.controller_origin import replace_controller

__all__ = ["bind_command"]


@command("ravenbrick bind functional_ert_rtw binding.toml --output generated")
def bind_command(
    model: Annotated[Path, typer.Argument(help="Folder that Embedded Coder wrote.")],
    binding: Annotated[Path, typer.Argument(help="TOML file: package, names, types, ports.")],
    output: Annotated[Path, typer.Option(help="Folder for the C and the Ada binding.")],
    json_output: JsonOption = False,
) -> dict[str, Any]:
    if not model.is_dir():
        raise UsageError(f"{model}: there is no such folder")
    reporter = Reporter(json_output, total=2)
    with reporter.step("read the model") as step:
        wanted = read_binding(binding)
        found = read_coder_model(model)
        interface = found.interface
        form = "one instance" if not interface.reusable else "reusable functions"
        step.note = f"{interface.model}, {form}"
    with reporter.step("write C and binding") as step:
        files = found.files_with_binding(wanted)
        replace_controller(output, "bind", model, files)
        step.note = f"{len(files)} files"
    rows = [[role, interface.types[role], str(interface.sizes[role])] for role in interface.types]
    reporter.table(("data", "type", "bytes"), rows, left=("type",))
    if found.supplied:
        reporter.print(f"not in the folder, supplied: {', '.join(found.supplied)}")
    return {
        "model": interface.model,
        "form": form,
        "types": dict(interface.types),
        "bytes": dict(interface.sizes),
        "supplied": list(found.supplied),
        "files": sorted(files),
    }
